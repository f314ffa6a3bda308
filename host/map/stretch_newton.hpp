// The minimum of the stretch over all vertices together. Part of stretch.hpp.
#pragma once

#include "host/map/stretch_energy.hpp"
#include "host/monitor.hpp"

#include <span>
#include <vector>

namespace cowgpu {

/// The energy of a whole surface as a function of its vertices' places on the sphere.
class StretchSum {
public:
  /// Of a surface of area 4 pi, by points and rings (see CanonicalSurface).
  StretchSum(std::span<const Vec3> points, const std::vector<std::vector<std::uint32_t>>& rings, double lambda);

  /// The sum over the faces, over 4 pi; infinite if a face is not positively oriented.
  double energy(std::span<const Vec3> positions) const;
  /// Of that, along the sphere: the component along the position is zero. The energy must be finite.
  std::vector<Vec3> gradient(std::span<const Vec3> positions) const;

  const std::vector<Face>& faces() const { return faces_; }
  const std::vector<StretchWeights>& weights() const { return weights_; }

private:
  std::vector<Face> faces_;
  std::vector<StretchWeights> weights_;
};

struct NewtonResult {
  unsigned steps = 0;
  bool converged = false; ///< a further step would lower the energy by less than rounding shows
};

/// Moves the positions, unit vectors of finite energy, to a minimum nearby; the energy falls at every step. The linear
/// systems are sparse; where the Hessian is not positive definite, as much of the sum of the faces' positive parts is mixed
/// in as makes it so. It ends at a minimum, not at a saddle, but for eigenvalues below 1e-8 of the diagonal.
NewtonResult minimise_stretch(const StretchSum& sum, std::vector<Vec3>& positions, Monitor& monitor);

} // namespace cowgpu
