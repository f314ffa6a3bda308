// Closed forms of patches of triangles at groups of points: the inner loop of the CPU path of the verb `polyhedron`. The
// equations stand in host/plan/polyhedron.hpp. Lanes are points.
#pragma once

#include "host/plan/polyhedron.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::cpu {

/// Points are given in multiples of this.
inline constexpr std::size_t polyhedron_group = 8;

/// Of sums in double precision.
enum class SumDigits {
  full, ///< right to rounding
  nine, ///< logarithms and angles to 2e-11, a tenth faster
};

/// What is summed.
struct PolyhedronTerms {
  /// Rows of dd V, jump and on_edge too. dd V is the mean of both sides' limits on faces, and leaves out the edges a point is
  /// on. The limit on a face's outer side is dd V + jump, on its inner side dd V - jump: jump = 2 pi n n inside the face, less
  /// on its boundary, 0 elsewhere. on_edge counts the sharp edges that the point is on.
  bool second = false;
  SumDigits digits = SumDigits::full;
  double touching = 0; ///< plan::touching_distance(), in units
};

/// Room for a patch's distances and logarithms: one for each thread.
class PolyhedronScratch {
public:
  void* room(std::size_t bytes);

private:
  struct alignas(64) Line {
    char bytes[64];
  };
  std::vector<Line> lines_;
};

/// Adds what the patches `which` make at `count` points (a multiple of polyhedron_group) to sums[row][count], the rows of plan::PolyhedronRows. points[3][count]
/// in units, of the mesh's origin. The sums over a patch are formed in Real, those over patches in double precision, in the
/// order of `which`. In single precision errors are some 1e-7 of each patch's own part, and `digits` means nothing.
void sum_patches(const plan::PolyhedronPatches<double>& patches, std::span<const std::uint32_t> which,
                 const double* points, std::size_t count, const PolyhedronTerms& terms, PolyhedronScratch& scratch,
                 double* sums);
void sum_patches(const plan::PolyhedronPatches<float>& patches, std::span<const std::uint32_t> which,
                 const double* points, std::size_t count, const PolyhedronTerms& terms, PolyhedronScratch& scratch,
                 double* sums);

} // namespace cowgpu::cpu
