#include "host/gpu/backend.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <string>

namespace cowgpu::gpu {
namespace {

// Each invocation keeps the state of its pairs of rings in private memory.
constexpr std::uint32_t most_pairs = 8192;

void require(bool holds, const char* option, std::uint64_t value, const std::string& possible) {
  if (!holds)
    throw Error(Fault::bad_argument, fmt::format("GpuOptions::{} is {}; it takes 0, for what suits the device, or {}",
                                                 option, value, possible));
}

bool power_of_two(std::uint32_t value, std::uint32_t least, std::uint32_t largest) {
  return std::has_single_bit(value) && value >= least && value <= largest;
}

} // namespace

void check(const GpuOptions& o) {
  require(o.levels == 0 || power_of_two(o.levels, 2, 16), "levels", o.levels, "2, 4, 8 or 16");
  require(o.workgroups == 0 || power_of_two(o.workgroups, 1, 64), "workgroups", o.workgroups,
          "a power of two up to 64");
  require(o.transform_steps % 8 == 0 && o.transform_steps <= 64, "transform_steps", o.transform_steps, "8, 16, ... 64");
  require(o.transform_rings == 0 || power_of_two(o.transform_rings, 1, 8), "transform_rings", o.transform_rings,
          "1, 2, 4 or 8");
  // Four is what no device's own choice of rings goes beyond.
  const std::uint32_t rings = o.transform_rings ? o.transform_rings : 4;
  require(o.transform_pairs % rings == 0 && o.transform_pairs <= most_pairs, "transform_pairs", o.transform_pairs,
          fmt::format("a multiple of {} up to {}", rings, most_pairs));
  if (o.iteration_budget == 0 || o.state_budget == 0)
    throw Error(Fault::bad_argument, "GpuOptions::iteration_budget and state_budget must be above 0");
}

} // namespace cowgpu::gpu
