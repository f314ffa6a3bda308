#include "host/mesh/tensors.hpp"

#include <Eigen/Geometry>

namespace cowgpu {

Tensors tensors(const Body& body) {
  using Extended = long double;
  using Vec = Eigen::Matrix<Extended, 3, 1>;
  using Mat = Eigen::Matrix<Extended, 3, 3>;
  const Vec origin = body.origin.cast<Extended>();
  Mat sum = Mat::Zero();
  for (const Face& face : body.surface.faces()) {
    const Vec a = body.surface.vertices()[face[0]].cast<Extended>() - origin;
    const Vec b = body.surface.vertices()[face[1]].cast<Extended>() - origin;
    const Vec c = body.surface.vertices()[face[2]].cast<Extended>() - origin;
    const Extended det = a.dot(Vec(b - a).cross(Vec(c - a)));
    const Vec s = a + b + c;
    sum += det / 120 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  sum *= Extended(body.density);
  const Mat trace = Mat::Identity() * sum.trace();
  return {sum.cast<double>(), Mat(3 * sum - trace).cast<double>(), Mat(trace - sum).cast<double>()};
}

} // namespace cowgpu
