// The kernel polyhedron: closed forms of triangles in strips at groups of points. The equations stand in
// host/plan/polyhedron.hpp, the shader's interface in shaders/polyhedron.h.
#pragma once

#include "engine/gpu.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace cowgpu::engine {

class Buffer;

/// Points of a group, and numbers of a step.
inline constexpr std::size_t polyhedron_points = 64, polyhedron_numbers = 20;

struct PolyhedronInput {
  std::span<const double> steps; ///< [step][polyhedron_numbers], as host/plan/polyhedron_strips.hpp lays them out
  bool second = false;           ///< second derivatives too
  double touching = 0;           ///< what is nearer to a face or an edge is on it
  std::uint32_t iteration_budget = 60000;
  bool seeds = false; ///< quotients and roots from single-precision ones on software devices too
};

/// For each group of points ranges of steps: of group g those from starts[g] on.
struct PolyhedronList {
  std::span<const std::array<std::uint32_t, 2>> ranges;
  std::span<const std::uint32_t> starts;
};

/// Faces on a device.
class Polyhedron {
public:
  /// Throws Error(out_of_range) for more steps than the device reads from a buffer.
  Polyhedron(Device& device, const PolyhedronInput& input);
  ~Polyhedron();

  /// Rows of the sums: V twice, -grad V, w, then dd V (xx, xy, xz, yy, yz, zz), its jump, edges the point is on.
  std::size_t rows() const;
  /// Upper bound of the bytes on the device: of the steps, and of sum().
  static std::uint64_t step_bytes(std::uint64_t steps) { return 8 * polyhedron_numbers * steps; }
  static std::uint64_t sum_bytes(std::uint64_t groups, std::uint64_t ranges, bool second);

  /// points[group][3][64], of which the first counts[group] are asked for, to sums[group][rows][64]. `near` is summed everywhere; `far` where its points are at least 2.6 edges
  /// away from its faces' edges. In dispatches of at most 1e9 pairs of a step and a point. Throws Error(stopped), Error(cut_short).
  void sum(std::span<const double> points, std::span<const std::uint32_t> counts, const PolyhedronList& near,
           const PolyhedronList& far, std::span<double> sums, const Hook& hook);

private:
  Device& device_;
  bool second_, seeds_;
  double touching_;
  std::uint32_t budget_;
  std::unique_ptr<Buffer> steps_;
  std::vector<std::uint32_t> strips_; // steps that strips begin with
};

} // namespace cowgpu::engine
