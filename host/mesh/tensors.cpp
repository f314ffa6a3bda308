#include "host/mesh/tensors.hpp"

#include "host/geometry/determinant.hpp"
#include "host/mesh/geometry.hpp"

namespace cowgpu {

namespace {

using Extended = long double;
using Vec = Eigen::Matrix<Extended, 3, 1>;
using Mat = Eigen::Matrix<Extended, 3, 3>;

using Third = std::array<Mat, 3>;

// Integrals of 1, x_i, x_i x_j and x_i x_j x_k over a body.
struct Moments {
  Extended mass = 0;
  Vec first = Vec::Zero();
  Mat second = Mat::Zero();
  Third third = {Mat::Zero(), Mat::Zero(), Mat::Zero()};
};

void add_third_moment(const std::array<Vec, 3>& corner, Extended det, Third& sum) {
  const Vec s = corner[0] + corner[1] + corner[2];
  Mat p = Mat::Zero();
  for (const Vec& a : corner) p += a * a.transpose();
  for (Eigen::Index i = 0; i < 3; ++i) {
    Mat term = s[i] * (s * s.transpose() + p) + s * p.row(i) + p.col(i) * s.transpose();
    for (const Vec& a : corner) term += 2 * a[i] * a * a.transpose();
    sum[std::size_t(i)] += det / 720 * term;
  }
}

// About the middle of the surface's box, where the least cancels.
Moments about_middle(const ClosedSurface& surface, const Vec3& middle, bool third) {
  const auto& vertices = surface.vertices();
  Moments sum;
  for (const Face& face : surface.faces()) {
    std::array<Vec, 3> corner;
    for (std::size_t c = 0; c < 3; ++c) corner[c] = vertices[face[c]].cast<Extended>() - middle.cast<Extended>();
    const Extended det = determinant(vertices[face[0]], vertices[face[1]], vertices[face[2]], middle);
    const auto& [a, b, c] = corner;
    const Vec s = a + b + c;
    sum.first += det / 24 * s;
    sum.second += det / 120 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
    if (third) add_third_moment(corner, det, sum.third);
  }
  sum.mass = sum_of_determinants(vertices, surface.faces(), middle) / 6;
  return sum;
}

// The same about a point that is -d from there: of x + d in place of x.
Moments shifted(const Moments& m, const Vec& d) {
  Moments result = m;
  result.first += m.mass * d;
  result.second += d * m.first.transpose() + m.first * d.transpose() + m.mass * d * d.transpose();
  for (Eigen::Index i = 0; i < 3; ++i)
    result.third[std::size_t(i)] += d[i] * m.second + d * m.second.row(i) + m.second.col(i) * d.transpose() +
                                    d[i] * (d * m.first.transpose() + m.first * d.transpose()) +
                                    m.first[i] * d * d.transpose() + m.mass * d[i] * d * d.transpose();
  return result;
}

// All parts, each by its density.
Moments moments(const Body& body, bool third) {
  Moments sum;
  const auto add = [&](const ClosedSurface& surface, double density) {
    const Vec3 middle = bounding_box(surface).middle();
    const Moments own =
        shifted(about_middle(surface, middle, third), middle.cast<Extended>() - body.origin.cast<Extended>());
    sum.second += own.second * Extended(density);
    for (std::size_t i = 0; i < 3; ++i) sum.third[i] += own.third[i] * Extended(density);
  };
  add(body.surface, body.density);
  for (const Part& part : body.parts) add(part.surface, part.density);
  return sum;
}

} // namespace

Tensors tensors(const Body& body) {
  const Mat sum = moments(body, false).second;
  const Mat trace = Mat::Identity() * sum.trace();
  return {sum.cast<double>(), Mat(3 * sum - trace).cast<double>(), Mat(trace - sum).cast<double>()};
}

Tensor3 third_moment(const Body& body) {
  const Third sum = moments(body, true).third;
  return {Mat(sum[0]).cast<double>(), Mat(sum[1]).cast<double>(), Mat(sum[2]).cast<double>()};
}

} // namespace cowgpu
