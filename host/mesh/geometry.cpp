#include "host/mesh/geometry.hpp"

#include "host/geometry/determinant.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

using Real = long double;
using Wide3 = Eigen::Matrix<Real, 3, 1>;

/// Neumaier's sum: the error does not grow with the number of terms.
class Sum {
public:
  void add(Real term) {
    const Real total = sum_ + term;
    lost_ += std::fabs(sum_) >= std::fabs(term) ? (sum_ - total) + term : (term - total) + sum_;
    sum_ = total;
  }
  Real value() const { return sum_ + lost_; }

private:
  Real sum_ = 0, lost_ = 0;
};

struct Triangle {
  Wide3 a, b, c;
  Real area() const { return (b - a).cross(c - a).norm() / 2; }
};

/// Calls f(Triangle) for every face, relative to `origin`.
template <class Function>
void for_each_triangle(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& origin, Function&& f) {
  const Wide3 o = origin.cast<Real>();
  for (const Face& face : faces)
    f(Triangle{vertices[face[0]].cast<Real>() - o, vertices[face[1]].cast<Real>() - o,
               vertices[face[2]].cast<Real>() - o});
}

} // namespace

Box bounding_box(std::span<const Vec3> vertices, std::span<const Face> faces) {
  if (faces.empty()) return {};
  Box box{vertices[faces[0][0]], vertices[faces[0][0]]};
  for (const Face& face : faces)
    for (const std::uint32_t vertex : face) {
      box.min = box.min.cwiseMin(vertices[vertex]);
      box.max = box.max.cwiseMax(vertices[vertex]);
    }
  return box;
}

double volume(std::span<const Vec3> vertices, std::span<const Face> faces) {
  return static_cast<double>(sum_of_determinants(vertices, faces, bounding_box(vertices, faces).middle()) / 6);
}

double area(std::span<const Vec3> vertices, std::span<const Face> faces) {
  Sum sum;
  for_each_triangle(vertices, faces, Vec3::Zero(), [&](const Triangle& t) { sum.add(t.area()); });
  return static_cast<double>(sum.value());
}

Vec3 centre_of_mass(std::span<const Vec3> vertices, std::span<const Face> faces) {
  const Vec3 middle = bounding_box(vertices, faces).middle();
  Sum moment[3];
  Real sizes = 0;
  for (const Face& face : faces) {
    const Vec3 &a = vertices[face[0]], &b = vertices[face[1]], &c = vertices[face[2]];
    const Real weight = determinant(a, b, c, middle);
    sizes += std::fabs(weight);
    for (int i = 0; i < 3; ++i)
      moment[i].add(weight * ((Real(a[i]) - middle[i]) + (Real(b[i]) - middle[i]) + (Real(c[i]) - middle[i])));
  }
  const Real mass = sum_of_determinants(vertices, faces, middle);
  Real first[3] = {moment[0].value(), moment[1].value(), moment[2].value()};
  if (std::fabs(mass) < Real{0x1p-6L} * sizes) { // the sums cancel, and with them what is left
    Quad exact[3] = {0, 0, 0};
    for (const Face& face : faces) {
      const Vec3 &a = vertices[face[0]], &b = vertices[face[1]], &c = vertices[face[2]];
      const Quad weight = determinant_in<Quad>(a, b, c, middle);
      for (int i = 0; i < 3; ++i)
        exact[i] += weight * ((Quad(a[i]) - middle[i]) + (Quad(b[i]) - middle[i]) + (Quad(c[i]) - middle[i]));
    }
    for (int i = 0; i < 3; ++i) first[i] = static_cast<Real>(exact[i]);
  }
  Vec3 centre;
  for (int i = 0; i < 3; ++i) centre[i] = static_cast<double>(middle[i] + first[i] / (4 * mass));
  return centre;
}

double volume_noise(std::span<const Vec3> vertices, std::span<const Face> faces) {
  const Box box = bounding_box(vertices, faces);
  const double largest = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
  return static_cast<double>(Real{area(vertices, faces)} * 0x1p-52L * largest);
}

double brillouin_radius(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& origin) {
  Real largest = 0;
  for_each_triangle(vertices, faces, origin, [&](const Triangle& t) {
    largest = std::max({largest, t.a.squaredNorm(), t.b.squaredNorm(), t.c.squaredNorm()});
  });
  return static_cast<double>(std::sqrt(largest));
}

std::vector<ShellSize> shell_sizes(std::span<const Vec3> vertices, std::span<const Face> faces,
                                   std::span<const std::uint32_t> shell, std::size_t count) {
  struct Sums {
    Sum determinant, area;
  };
  std::vector<Sums> sums(count);
  const Vec3 middle = bounding_box(vertices, faces).middle();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Face& face = faces[f];
    sums[shell[f]].determinant.add(determinant(vertices[face[0]], vertices[face[1]], vertices[face[2]], middle));
  }
  std::size_t face = 0;
  for_each_triangle(vertices, faces, middle, [&](const Triangle& t) { sums[shell[face++]].area.add(t.area()); });
  std::vector<ShellSize> sizes;
  sizes.reserve(count);
  for (const Sums& s : sums)
    sizes.push_back({static_cast<double>(s.determinant.value() / 6), static_cast<double>(s.area.value())});
  return sizes;
}

} // namespace cowgpu
