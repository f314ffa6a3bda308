#include "host/spectrum/reconstruct.hpp"

#include "host/error.hpp"
#include "host/mesh/builtin.hpp"
#include "host/spectrum/derivatives.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu {
namespace {

constexpr double pi = std::numbers::pi;

void check_order(const SurfaceExpansion& expansion, SurfaceFields fields, int order) {
  const SphereCoefficients& all = expansion.coefficients;
  if (all.fields != 6 || all.values.size() != 6 * SphereCoefficients::count(all.lmax))
    throw Error(Fault::bad_argument,
                fmt::format("a surface takes the six fields f_r, f_dtheta, f_dphi, x, y, z; there are {}", all.fields));
  if (order < 0 || order > all.lmax)
    throw Error(Fault::bad_argument,
                fmt::format("order {} cannot be rebuilt from coefficients of degrees 0 to {}; expand to a higher lmax",
                            order, all.lmax));
  if (fields == SurfaceFields::f && !expansion.signed_dphi)
    throw Error(Fault::bad_argument,
                "the surface cannot be rebuilt from the absolute value of dphi; expand the signed dphi, "
                "or take the fields x, y, z");
}

/// The three fields, to degree `order`.
SphereCoefficients truncated(const SurfaceExpansion& expansion, SurfaceFields fields, int order) {
  const int first = fields == SurfaceFields::f ? 0 : 3;
  SphereCoefficients part(order, 3);
  for (int f = 0; f < 3; ++f)
    for (int m = 0; m <= order; ++m)
      for (int l = m; l <= order; ++l) part.at(f, l, m) = expansion.coefficients.at(first + f, l, m);
  return part;
}

/// The point of the fields' values at (theta, phi).
Vec3 place(const SurfaceExpansion& expansion, SurfaceFields fields, const Vec3& values, double theta, double phi) {
  if (fields == SurfaceFields::xyz) return values;
  const double t = theta + values[1] + expansion.mean_dtheta, p = phi + values[2] + expansion.mean_dphi;
  return expansion.origin + values[0] * Vec3(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
}

TriangleSurface finished(SurfaceFields fields, int order, std::vector<Vec3> vertices, std::vector<Face> faces) {
  TriangleSurface surface;
  surface.name =
      order == 0 ? "order 0" : fmt::format("order {} ({})", order, fields == SurfaceFields::xyz ? "x, y, z" : "f");
  surface.vertices = std::move(vertices);
  surface.faces = std::move(faces);
  surface.normals = vertex_normals(surface.vertices, surface.faces);
  return surface;
}

std::vector<Vec3> sphere_about(const SurfaceExpansion& expansion, std::span<const Vec3> directions) {
  const double radius = spherical_radius(expansion);
  std::vector<Vec3> vertices;
  vertices.reserve(directions.size());
  for (const Vec3& d : directions) {
    if (!(d.squaredNorm() > 0))
      throw Error(Fault::bad_argument, fmt::format("direction {} is zero or not finite", vertices.size()));
    vertices.push_back(expansion.origin + radius * d.stableNormalized());
  }
  return vertices;
}

/// Integrals over a body of 1, P and P P^T, P from the expansion's origin.
struct Sums {
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

/// Adds the tetrahedron (0, a, b, c), signed (F. Tonon, J. Math. Stat. 1 (2005) 8).
void add(Sums& sums, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 s = a + b + c;
  const double cone = a.dot(b.cross(c));
  sums.volume += cone / 6;
  sums.first += cone / 24 * s;
  sums.second += cone / 120 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
}

/// Every point of the grid, [ring][longitude], mesh coordinates.
std::vector<Vec3> grid_points(const SurfaceExpansion& expansion, SurfaceFields fields, int order,
                              const SphereGrid& grid, Backend& backend, Monitor& monitor) {
  const std::size_t points = grid.points(), length = std::size_t(grid.ring_length);
  std::vector<double> values(3 * points);
  backend.sphere_transform(grid, order)->synthesise(3, truncated(expansion, fields, order).values, values, monitor);
  std::vector<Vec3> found;
  found.reserve(points);
  for (std::size_t i = 0; i < points; ++i)
    found.push_back(place(expansion, fields, {values[i], values[points + i], values[2 * points + i]},
                          grid.theta[i / length], grid.phi(int(i % length))));
  return found;
}

/// Of the polyhedron over a grid with poles, whose first and last ring are closed by flat polygons.
Sums sums_on(const SphereGrid& grid, const std::vector<Vec3>& points, const Vec3& origin) {
  const std::size_t rings = std::size_t(grid.rings), length = std::size_t(grid.ring_length);
  const auto at = [&](std::size_t ring, std::size_t j) { return Vec3(points[ring * length + j % length] - origin); };
  Sums sums;
  for (std::size_t j = 1; j + 1 < length; ++j) {
    add(sums, at(0, 0), at(0, j), at(0, j + 1));
    add(sums, at(rings - 1, 0), at(rings - 1, j + 1), at(rings - 1, j));
  }
  for (std::size_t i = 0; i + 1 < rings; ++i)
    for (std::size_t j = 0; j < length; ++j) {
      add(sums, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add(sums, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return sums;
}

SurfaceMeasures measures(double volume, const Vec3& first, const Eigen::Matrix3d& second, const Vec3& origin) {
  SurfaceMeasures result;
  result.volume = volume;
  result.centre_of_mass = origin + first / volume;
  result.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return result;
}

} // namespace

double spherical_radius(const SurfaceExpansion& expansion) {
  return expansion.coefficients.at(0, 0, 0).real() / std::sqrt(4 * pi);
}

std::string describe_order(const SurfaceExpansion& expansion, SurfaceFields fields, int order) {
  if (order > 0) return fmt::format("degrees 0 to {} of {}", order, fields == SurfaceFields::xyz ? "x, y, z" : "f");
  std::string text =
      fmt::format("the sphere of radius f_r00 / sqrt(4 pi) = {:.6g} about the origin", spherical_radius(expansion));
  if (fields == SurfaceFields::xyz) text += "; the expansion of x, y, z is a point at order 0 and starts at order 1";
  return text;
}

SphereTriangulation icosphere(int level) {
  RawMesh mesh = builtin_mesh(fmt::format("sphere:1@{}", level));
  return {std::move(mesh.vertices), std::move(mesh.faces)};
}

SphereTriangulation triangulation(const SphereGrid& grid) {
  if (grid.kind != GridKind::clenshaw_curtis || grid.ring_length < 3 || grid.rings < 3)
    throw Error(Fault::bad_argument, "only grids with both poles, three rings and three points a ring can be cut into "
                                     "triangles: take a Clenshaw-Curtis grid of degree 1 or more");
  SphereTriangulation sphere;
  const auto length = std::uint32_t(grid.ring_length), rings = std::uint32_t(grid.rings);
  sphere.directions.reserve(2 + std::size_t(rings - 2) * length);
  sphere.directions.emplace_back(0, 0, 1);
  for (std::uint32_t i = 1; i + 1 < rings; ++i)
    for (std::uint32_t j = 0; j < length; ++j) {
      const double phi = grid.phi(int(j)), s = double(grid.sine[i]);
      sphere.directions.emplace_back(s * std::cos(phi), s * std::sin(phi), double(grid.cosine[i]));
    }
  sphere.directions.emplace_back(0, 0, -1);
  const std::uint32_t south = std::uint32_t(sphere.directions.size()) - 1;
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return 1 + (i - 1) * length + j % length; };
  for (std::uint32_t j = 0; j < length; ++j) sphere.faces.push_back({0, at(1, j), at(1, j + 1)});
  for (std::uint32_t i = 1; i + 2 < rings; ++i)
    for (std::uint32_t j = 0; j < length; ++j) {
      sphere.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      sphere.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  for (std::uint32_t j = 0; j < length; ++j) sphere.faces.push_back({at(rings - 2, j), south, at(rings - 2, j + 1)});
  return sphere;
}

TriangleSurface reconstruct(const SurfaceExpansion& expansion, SurfaceFields fields, int order,
                            const SphereTriangulation& sphere, unsigned threads, Monitor& monitor) {
  check_order(expansion, fields, order);
  if (order == 0) return finished(fields, order, sphere_about(expansion, sphere.directions), sphere.faces);
  std::vector<Direction> directions;
  directions.reserve(sphere.directions.size());
  for (const Vec3& d : sphere.directions) directions.push_back(direction(d));
  const DirectionValues found =
      DirectionSynthesis(truncated(expansion, fields, order), false, threads).at(directions, monitor);
  std::vector<Vec3> vertices;
  const std::size_t n = directions.size();
  vertices.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double theta = double(std::atan2(directions[i].sine, directions[i].cosine));
    vertices.push_back(place(expansion, fields, {found.values[i], found.values[n + i], found.values[2 * n + i]}, theta,
                             directions[i].phi));
  }
  return finished(fields, order, std::move(vertices), sphere.faces);
}

TriangleSurface reconstruct(const SurfaceExpansion& expansion, SurfaceFields fields, int order, const SphereGrid& grid,
                            Backend& backend, Monitor& monitor) {
  check_order(expansion, fields, order);
  SphereTriangulation sphere = triangulation(grid);
  if (order == 0) return finished(fields, order, sphere_about(expansion, sphere.directions), std::move(sphere.faces));
  const std::vector<Vec3> points = grid_points(expansion, fields, order, grid, backend, monitor);
  const auto length = std::ptrdiff_t(grid.ring_length);
  std::vector<Vec3> vertices = {points.front()}; // the poles' rings are one vertex each
  vertices.reserve(sphere.directions.size());
  vertices.insert(vertices.end(), points.begin() + length, points.end() - length);
  vertices.push_back(points[points.size() - std::size_t(length)]);
  return finished(fields, order, std::move(vertices), std::move(sphere.faces));
}

SurfaceMeasures measure(const SurfaceExpansion& expansion, SurfaceFields fields, int order, Backend& backend,
                        Monitor& monitor) {
  check_order(expansion, fields, order);
  SurfaceMeasures result;
  if (order == 0) {
    const double radius = spherical_radius(expansion);
    result.volume = 4 * pi / 3 * radius * radius * radius;
    result.centre_of_mass = expansion.origin;
    result.inertia = 0.4 * result.volume * radius * radius * Eigen::Matrix3d::Identity();
    return result;
  }
  if (fields == SurfaceFields::f) {
    const int coarse = std::clamp(2 * order, 64, largest_grid_degree / 2);
    const auto on_grid = [&](int degree) {
      const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, degree);
      return sums_on(grid, grid_points(expansion, fields, order, grid, backend, monitor), expansion.origin);
    };
    const Sums a = on_grid(coarse), b = on_grid(2 * coarse);
    return measures((4 * b.volume - a.volume) / 3, (4 * b.first - a.first) / 3, (4 * b.second - a.second) / 3,
                    expansion.origin);
  }
  const int degree = std::min((5 * order + 1) / 2, largest_grid_degree);
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, degree);
  const std::size_t points = grid.points(), length = std::size_t(grid.ring_length);
  std::vector<double> values(3 * points), by_theta(3 * points), by_phi(3 * points);
  const SphereCoefficients part = truncated(expansion, fields, order);
  const auto transform = backend.sphere_transform(grid, order);
  transform->synthesise(3, part.values, values, monitor);
  synthesise_derivatives(*transform, 3, part.values, by_theta, by_phi, monitor);

  const auto vector = [&](const std::vector<double>& of, std::size_t i) {
    return Vec3(of[i], of[points + i], of[2 * points + i]);
  };
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (std::size_t ring = 0; ring < std::size_t(grid.rings); ++ring) {
    double ring_volume = 0;
    Vec3 ring_first = Vec3::Zero();
    Eigen::Matrix3d ring_second = Eigen::Matrix3d::Zero();
    for (std::size_t j = 0; j < length; ++j) {
      const std::size_t i = ring * length + j;
      const Vec3 t = vector(by_theta, i), p = vector(by_phi, i);
      const Vec3 at = vector(values, i) - expansion.origin;
      const double cone = at.dot(t.cross(p));
      ring_volume += cone;
      ring_first += cone * at;
      ring_second += cone * (at * at.transpose());
    }
    const double weight = grid.weights[ring] * 2 * pi / double(length) / double(grid.sine[ring]);
    volume += weight * ring_volume;
    first += weight * ring_first;
    second += weight * ring_second;
  }
  return measures(volume / 3, first / 4, second / 5, expansion.origin);
}

} // namespace cowgpu
