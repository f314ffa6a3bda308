#include "host/paper/recipe.hpp"

namespace cowgpu::paper {

HarmonicOptions harmonic_map() {
  HarmonicOptions options;
  options.disk_scale = 10;
  options.polish = false;
  options.align = false;
  return options;
}

} // namespace cowgpu::paper
