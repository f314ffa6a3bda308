#include "host/physics/zero_velocity.hpp"

#include "host/error.hpp"
#include "host/mesh/marching_tetrahedra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace cowgpu::physics {
namespace {

constexpr std::size_t batch = 65536;
constexpr int most_steps = 60;

// A vertex between two points of the lattice, where -W is less and more than the constant.
struct Bracket {
  Vec3 below, above;
  double less, more; // -W less the constant
  int kept = 0;      // steps that the same end has stayed
};

} // namespace

TriangleSurface zero_velocity_surface(const Body& body, const ZeroVelocityProblem& problem, const Backend& backend,
                                      Monitor& monitor) {
  if (!(problem.extent > 0) || !std::isfinite(problem.extent))
    throw Error(Fault::bad_argument, fmt::format("a cube of half side {} holds no surface", problem.extent));
  if (problem.cells < 4 || problem.cells > 512)
    throw Error(Fault::bad_argument,
                fmt::format("a zero-velocity surface is looked for in 4 to 512 cells a side, not {}", problem.cells));
  if (!std::isfinite(problem.jacobi)) throw Error(Fault::bad_argument, "the Jacobi constant is not finite");
  const int n = problem.cells + 1;
  const double step = 2 * problem.extent / problem.cells;
  const Vec3 first = problem.spin.through - Vec3::Constant(problem.extent);
  const auto place = [&](std::uint64_t i) {
    const auto side = std::uint64_t(n);
    return Vec3(first + step * Vec3(double(i % side), double(i / side % side), double(i / side / side)));
  };
  const auto count = std::uint64_t(n) * std::uint64_t(n) * std::uint64_t(n);
  std::vector<double> values(count);
  double largest = 0;
  {
    const SpinningField field(body, problem.constant, problem.spin, problem.tolerance, backend, Derivatives::none);
    for (std::uint64_t begin = 0; begin < count; begin += batch) {
      check_stop(monitor);
      const std::uint64_t end = std::min<std::uint64_t>(count, begin + batch);
      std::vector<Vec3> points;
      for (std::uint64_t i = begin; i < end; ++i) points.push_back(place(i));
      const SpinningValues at = field.at(points, false, monitor);
      for (std::uint64_t i = begin; i < end; ++i) {
        values[i] = at.geopotential[i - begin];
        largest = std::max(largest, std::abs(values[i]));
      }
      monitor.progress("zero-velocity surface", double(end) / double(count));
    }
  }
  LatticeSurface marched = march_tetrahedra(values, {n, n, n}, problem.jacobi);
  TriangleSurface surface;
  surface.faces = std::move(marched.faces);
  std::vector<Bracket> brackets;
  for (const auto& [a, b] : marched.edges)
    brackets.push_back({place(a), place(b), values[a] - problem.jacobi, values[b] - problem.jacobi});
  surface.vertices.resize(brackets.size());
  surface.normals.assign(brackets.size(), Vec3::UnitZ());
  const SpinningField field(body, problem.constant, problem.spin, 0, backend, Derivatives::first);
  std::vector<std::uint32_t> left(brackets.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = std::uint32_t(i);
  // False position with the Illinois rule: the end that stays counts half.
  for (int pass = 0; pass < most_steps && !left.empty(); ++pass) {
    std::vector<std::uint32_t> next;
    for (std::size_t begin = 0; begin < left.size(); begin += batch) {
      check_stop(monitor);
      const std::size_t end = std::min(left.size(), begin + batch);
      std::vector<Vec3> points;
      for (std::size_t i = begin; i < end; ++i) {
        const Bracket& b = brackets[left[i]];
        const double part = std::clamp(b.less / (b.less - b.more), 1e-3, 1 - 1e-3);
        points.push_back(b.below + part * (b.above - b.below));
      }
      const SpinningValues at = field.at(points, false, monitor);
      for (std::size_t i = begin; i < end; ++i) {
        Bracket& b = brackets[left[i]];
        const Vec3& p = surface.vertices[left[i]] = points[i - begin];
        const double value = at.geopotential[i - begin] - problem.jacobi, size = at.acceleration[i - begin].norm();
        if (size > 0) surface.normals[left[i]] = at.acceleration[i - begin] / size;
        if (std::abs(value) <= 1e-12 * largest || (b.above - b.below).norm() < 1e-12 * step) continue;
        const bool low = value < 0;
        (low ? b.below : b.above) = p;
        (low ? b.less : b.more) = value;
        if (b.kept * (low ? 1 : -1) > 0) (low ? b.more : b.less) /= 2;
        b.kept = low ? 1 : -1;
        next.push_back(left[i]);
      }
    }
    left = std::move(next);
  }
  return surface;
}

} // namespace cowgpu::physics
