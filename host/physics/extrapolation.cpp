#include "host/physics/extrapolation.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cowgpu::physics {
namespace {

constexpr std::size_t columns = 10;

// Gragg's smoothing at the end, so that the error is a series in h^2 from the start.
State midpoint(const Slope& slope, const State& y, const State& first, long double t, long double step, int parts) {
  const long double h = step / parts;
  State before = y, now = y + h * first;
  for (int n = 1; n < parts; ++n) {
    State next = before + 2 * h * slope(t + n * h, now);
    before = std::move(now);
    now = std::move(next);
  }
  return (now + before + h * slope(t + step, now)) / 2;
}

// The largest difference of a block over its size.
long double distance(const State& a, const State& b, const State& start, const std::vector<Block>& blocks) {
  long double largest = 0;
  for (const Block& block : blocks) {
    const long double apart = State(a(block.entries) - b(block.entries)).stableNorm();
    if (!std::isfinite(apart)) return std::numeric_limits<long double>::infinity();
    const auto norm = [&](const State& s) { return State(s(block.entries)).stableNorm(); };
    const long double size = std::max({norm(a), norm(start), block.least});
    if (apart > 0) largest = std::max(largest, apart / size);
  }
  return largest;
}

struct Trial {
  State y;
  std::size_t column;
};

// A step of this length, if it is short enough.
std::optional<Trial> try_step(const Slope& slope, const State& y, long double t, long double step,
                              const std::vector<Block>& blocks, long double tolerance) {
  const State first = slope(t, y);
  std::vector<State> row; // row of the extrapolation table, by Aitken and Neville
  for (std::size_t k = 0; k < columns; ++k) {
    const int parts = 2 * int(k + 1);
    State value = midpoint(slope, y, first, t, step, parts);
    for (std::size_t j = 0; j < k; ++j) {
      const long double ratio = (long double)(parts) / (2 * int(k - j)), factor = ratio * ratio - 1;
      State better = value + (value - row[j]) / factor;
      row[j] = std::move(value);
      value = std::move(better);
    }
    if (k >= 2 && distance(value, row[k - 1], y, blocks) <= tolerance) return Trial{std::move(value), k};
    row.push_back(std::move(value));
  }
  return std::nullopt;
}

} // namespace

State extrapolate(const Slope& slope, State y, long double from, long double to, const std::vector<Block>& blocks,
                  long double& step, long double tolerance) {
  const long double way = to - from;
  long double t = from, size = step == 0 ? std::abs(way) : std::abs(step);
  while (t != to) {
    const long double left = to - t;
    const bool last = size >= std::abs(left);
    const long double h = last ? left : std::copysign(size, way);
    const auto trial = try_step(slope, y, t, h, blocks, tolerance);
    if (!trial) {
      size = std::abs(h) / 2;
      if (!(size > 1e-12L * std::abs(way)))
        throw Error(Fault::check_failed,
                    fmt::format("the motion cannot be followed beyond {} s: steps shrink to nothing", double(t)));
      continue;
    }
    y = trial->y;
    t = last ? to : t + h;
    const long double next = trial->column < columns - 3 ? 1.7L * std::abs(h) : std::abs(h);
    size = last ? std::max(size, next) : next;
  }
  step = size;
  return y;
}

} // namespace cowgpu::physics
