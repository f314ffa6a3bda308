#include "host/mesh/tensors.hpp"

#include <Eigen/Geometry>

namespace cowgpu {

namespace {

using Extended = long double;
using Vec = Eigen::Matrix<Extended, 3, 1>;
using Mat = Eigen::Matrix<Extended, 3, 3>;

Mat second_moment(const ClosedSurface& surface, const Vec& origin) {
  Mat sum = Mat::Zero();
  for (const Face& face : surface.faces()) {
    const Vec a = surface.vertices()[face[0]].cast<Extended>() - origin;
    const Vec b = surface.vertices()[face[1]].cast<Extended>() - origin;
    const Vec c = surface.vertices()[face[2]].cast<Extended>() - origin;
    const Extended det = a.dot(Vec(b - a).cross(Vec(c - a)));
    const Vec s = a + b + c;
    sum += det / 120 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  return sum;
}

} // namespace

Tensors tensors(const Body& body) {
  const Vec origin = body.origin.cast<Extended>();
  Mat sum = second_moment(body.surface, origin) * Extended(body.density);
  for (const Part& part : body.parts) sum += second_moment(part.surface, origin) * Extended(part.density);
  const Mat trace = Mat::Identity() * sum.trace();
  return {sum.cast<double>(), Mat(3 * sum - trace).cast<double>(), Mat(trace - sum).cast<double>()};
}

} // namespace cowgpu
