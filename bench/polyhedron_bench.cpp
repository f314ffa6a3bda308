// Verifies the verb `polyhedron` against the reference in 80-bit arithmetic, then times the direct sum of both paths and the
// reference in one run.
#include "bench/report.hpp"
#include "host/backend.hpp"
#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/mesh/builtin.hpp"
#include "host/mesh/subdivide.hpp"
#include "host/reference/polyhedron.hpp"

#include "bench/command_line.hpp"
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace cowgpu::bench {
namespace {

constexpr std::size_t verified = 48; // points held against the reference

struct Options {
  std::string mesh = "cow";
  int cuts = 0;
  std::size_t points = 4096, device_points = 1024;
  int runs = 3;
  unsigned threads = 0;
  bool cpu_only = false, second = false, json = false;
};
