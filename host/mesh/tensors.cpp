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

using Third = std::array<Mat, 3>;

void add_third_moment(const ClosedSurface& surface, const Vec& origin, Extended density, Third& sum) {
  for (const Face& face : surface.faces()) {
    std::array<Vec, 3> corner;
    for (std::size_t c = 0; c < 3; ++c) corner[c] = surface.vertices()[face[c]].cast<Extended>() - origin;
    const Extended det = corner[0].dot(Vec(corner[1] - corner[0]).cross(Vec(corner[2] - corner[0])));
    const Vec s = corner[0] + corner[1] + corner[2];
    Mat p = Mat::Zero();
    for (const Vec& a : corner) p += a * a.transpose();
    for (Eigen::Index i = 0; i < 3; ++i) {
      Mat term = s[i] * (s * s.transpose() + p) + s * p.row(i) + p.col(i) * s.transpose();
      for (const Vec& a : corner) term += 2 * a[i] * a * a.transpose();
      sum[std::size_t(i)] += density * det / 720 * term;
    }
  }
}

} // namespace

Tensors tensors(const Body& body) {
  const Vec origin = body.origin.cast<Extended>();
  Mat sum = second_moment(body.surface, origin) * Extended(body.density);
  for (const Part& part : body.parts) sum += second_moment(part.surface, origin) * Extended(part.density);
  const Mat trace = Mat::Identity() * sum.trace();
  return {sum.cast<double>(), Mat(3 * sum - trace).cast<double>(), Mat(trace - sum).cast<double>()};
}

Tensor3 third_moment(const Body& body) {
  Third sum = {Mat::Zero(), Mat::Zero(), Mat::Zero()};
  const Vec origin = body.origin.cast<Extended>();
  add_third_moment(body.surface, origin, body.density, sum);
  for (const Part& part : body.parts) add_third_moment(part.surface, origin, part.density, sum);
  return {Mat(sum[0]).cast<double>(), Mat(sum[1]).cast<double>(), Mat(sum[2]).cast<double>()};
}

} // namespace cowgpu
