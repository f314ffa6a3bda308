#include "host/map/stretch.hpp"

#include "host/error.hpp"
#include "host/geometry/orientation.hpp"
#include "host/map/canonical_surface.hpp"
#include "host/map/stretch_embedding.hpp"
#include "host/map/stretch_newton.hpp"
#include "host/mesh/half_edges.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace cowgpu {
namespace {

// The rotation R for which the sum of a_i (R X_i) . (V_i - c) is largest.
Eigen::Matrix3d aligning_rotation(const CanonicalSurface& surface, const std::vector<Vec3>& positions) {
  std::vector<double> weight(positions.size(), 0.0);
  for_each_face(surface.rings, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Vec3& p = surface.points[a];
    const double area = (surface.points[b] - p).cross(surface.points[c] - p).norm();
    for (const std::uint32_t v : {a, b, c}) weight[v] += area;
  });
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero(); // c is the origin
  for (std::size_t v = 0; v < positions.size(); ++v)
    covariance += weight[v] * surface.points[v] * positions[v].transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double handedness = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Vec3(1, 1, handedness).asDiagonal() * svd.matrixV().transpose();
}

void certify(const ManifoldSurface& surface, const SphereMap& map) {
  std::size_t wrong = 0, first = 0;
  const auto& faces = surface.faces();
  for (std::size_t f = faces.size(); f-- > 0;)
    if (orientation(map.positions[faces[f][0]], map.positions[faces[f][1]], map.positions[faces[f][2]]) <= 0) {
      ++wrong;
      first = f;
    }
  if (wrong > 0)
    throw Error(
        Fault::map_failed,
        fmt::format("the stretch map turned over {} of {} triangles by rounding, face {} first: the surface is too "
                    "thin there for double precision. Remesh it with better triangles",
                    wrong, faces.size(), first));
}

double norm(const std::vector<Vec3>& vectors) {
  double sum = 0;
  for (const Vec3& v : vectors) sum += v.squaredNorm();
  return std::sqrt(sum);
}

} // namespace

SphereMap stretch_map(const ManifoldSurface& surface, const StretchOptions& options, Monitor& monitor) {
  if (!(options.lambda >= 0 && options.lambda <= 1e6))
    throw Error(Fault::bad_argument,
                fmt::format("lambda, the weight of the stretch back to the sphere, is {}: it must lie from 0 to 1e6",
                            options.lambda));
  require_sphere(surface);
  const CanonicalSurface canonical = canonical_surface(surface);
  StretchEmbedding embedding(canonical.points, canonical.rings, options.lambda);
  embedding.build(monitor);
  unsigned sweeps = 0;
  for (double moved = 1; sweeps < options.sweeps && moved > 1e-6; ++sweeps) {
    check_stop(monitor);
    monitor.progress("relaxing the map", double(sweeps) / options.sweeps);
    moved = embedding.sweep();
  }
  std::vector<Vec3> positions = embedding.positions();
  const StretchSum sum(canonical.points, canonical.rings, options.lambda);
  SphereMap map{MapMethod::stretch, std::vector<Vec3>(surface.vertices().size(), Vec3::Zero()), {}};
  map.notes.push_back(fmt::format("relaxed {} {} after all {} vertices had their place", sweeps,
                                  sweeps == 1 ? "time" : "times", positions.size()));
  if (options.converge) {
    const NewtonResult newton = minimise_stretch(sum, positions, monitor);
    map.notes.push_back(fmt::format("{} after {} steps of Newton's method on all vertices",
                                    newton.converged ? "converged" : "not converged", newton.steps));
  }
  map.notes.push_back(fmt::format("mean squared stretch {:.6f}, gradient {:.1e}{}", sum.energy(positions),
                                  norm(sum.gradient(positions)),
                                  options.converge ? "" : ": not a minimum, which takes the option to converge"));
  const Eigen::Matrix3d rotation = aligning_rotation(canonical, positions);
  for (std::size_t k = 0; k < positions.size(); ++k)
    map.positions[canonical.original[k]] = (rotation * positions[k]).normalized();
  certify(surface, map);
  return map;
}

StretchMeasure measure_stretch(const ManifoldSurface& surface, const SphereMap& map, double lambda) {
  const CanonicalSurface canonical = canonical_surface(surface);
  const StretchSum sum(canonical.points, canonical.rings, lambda);
  std::vector<Vec3> positions;
  for (const std::uint32_t v : canonical.original) positions.push_back(map.positions[v]);
  StretchMeasure measure{sum.energy(positions), std::numeric_limits<double>::quiet_NaN()};
  if (std::isfinite(measure.energy)) measure.gradient = norm(sum.gradient(positions));
  return measure;
}

} // namespace cowgpu
