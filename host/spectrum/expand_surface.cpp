#include "host/spectrum/expand_surface.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/map/closest_point.hpp"
#include "host/map/sample_fields.hpp"
#include "host/spectrum/power.hpp"
#include "host/spectrum/surface_fields.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace cowgpu {
namespace {

constexpr int fields = int(surface_field_names.size());

void check(const ExpandSurfaceOptions& options) {
  if (options.lmax < 0 || options.lmax > largest_surface_degree)
    throw Error(Fault::bad_argument,
                fmt::format("surfaces are expanded to degree 0 to {}, not {}", largest_surface_degree, options.lmax));
  if (options.grid_degree != 0 && (options.grid_degree < 2 * options.lmax || options.grid_degree > largest_grid_degree))
    throw Error(Fault::bad_argument, fmt::format("a grid of degree {} cannot sample an expansion to degree {}: it must "
                                                 "be twice that at least, and not beyond the largest grid",
                                                 options.grid_degree, options.lmax));
  if (!options.origin.allFinite()) throw Error(Fault::bad_argument, "the origin of an expansion must be finite");
}

// The integral over the sphere of each field squared.
std::array<double, fields> squares_of(const std::vector<double>& values, const SphereGrid& grid) {
  const auto length = std::size_t(grid.ring_length), n = grid.points();
  std::array<double, fields> squares{};
  for (std::size_t f = 0; f < fields; ++f)
    for (std::size_t ring = 0; ring < std::size_t(grid.rings); ++ring) {
      double sum = 0;
      for (std::size_t j = 0; j < length; ++j) sum += std::pow(values[f * n + ring * length + j], 2);
      squares[f] += grid.weights[ring] * 2 * std::numbers::pi / double(length) * sum;
    }
  return squares;
}

// What the degrees above each leave out, from Parseval's equation.
std::vector<std::array<double, 6>> truncation_of(const SphereCoefficients& a,
                                                 const std::array<double, fields>& squares) {
  std::vector<std::array<double, 6>> rows(std::size_t(a.lmax) + 1);
  for (int f = 0; f < fields; ++f) {
    const std::vector<double> s = power(a, f);
    double above = squares[std::size_t(f)]; // power above lmax; the smallest degrees go first
    for (const double part : s) above -= part;
    above = std::max(0.0, above);
    for (int l = a.lmax; l >= 0; --l) {
      rows[std::size_t(l)][std::size_t(f)] = std::sqrt(above / (4 * std::numbers::pi));
      above += s[std::size_t(l)];
    }
  }
  return rows;
}

SphereCoefficients expand_on(const SphereGrid& grid, const SurfaceSampler& sampler, const ExpandSurfaceOptions& options,
                             Backend& backend, Monitor& monitor, ExpandSurfaceReport& report) {
  const auto start = Clock::now();
  report.rings = grid.rings;
  report.ring_length = grid.ring_length;
  const std::vector<double> values = sampler(grid, report);
  if (values.size() != std::size_t(fields) * grid.points())
    throw Error(Fault::bad_argument,
                fmt::format("{} values are not six fields on {} points", values.size(), grid.points()));
  report.sample_seconds = seconds_since(start);
  const auto sampled = Clock::now();
  SphereCoefficients coefficients(options.lmax, fields);
  backend.sphere_transform(grid, options.lmax)->analyse(fields, values, coefficients.values, monitor);
  report.truncation = truncation_of(coefficients, squares_of(values, grid));
  report.analyse_seconds = seconds_since(sampled);
  return coefficients;
}

std::vector<std::array<double, 6>> differences(const SphereCoefficients& a, const SphereCoefficients& b) {
  std::vector<std::array<double, 6>> norms(std::size_t(a.lmax) + 1);
  for (int l = 0; l <= a.lmax; ++l)
    for (int f = 0; f < fields; ++f) {
      double sum = 0;
      for (int m = 0; m <= l; ++m) sum += (m == 0 ? 1 : 2) * std::norm(a.at(f, l, m) - b.at(f, l, m));
      norms[std::size_t(l)][std::size_t(f)] = std::sqrt(sum);
    }
  return norms;
}

} // namespace

int surface_grid_degree(int lmax) {
  return std::max(2 * lmax, least_surface_grid_degree);
}

SurfaceExpansion expand_surface(const SurfaceSampler& sampler, const ExpandSurfaceOptions& options, Backend& backend,
                                Monitor& monitor, ExpandSurfaceReport* report) {
  check(options);
  ExpandSurfaceReport own;
  ExpandSurfaceReport& found = report ? *report : own;
  found = {};
  const auto on_grid = [&](int degree, ExpandSurfaceReport& to) {
    return expand_on(make_grid(GridKind::gauss_legendre, degree), sampler, options, backend, monitor, to);
  };
  SurfaceExpansion expansion;
  const int degree = options.grid_degree > 0 ? options.grid_degree : surface_grid_degree(options.lmax);
  expansion.coefficients = on_grid(degree, found);
  if (options.estimate_aliasing) {
    ExpandSurfaceReport coarse;
    found.aliasing = differences(expansion.coefficients, on_grid(degree / 2, coarse));
  }
  expansion.origin = options.origin;
  expansion.signed_dphi = options.signed_dphi;
  const auto take_mean = [&](int field) {
    const double mean = expansion.coefficients.at(field, 0, 0).real() / std::sqrt(4 * std::numbers::pi);
    expansion.coefficients.at(field, 0, 0) = 0;
    return mean;
  };
  expansion.mean_dtheta = take_mean(1);
  expansion.mean_dphi = take_mean(2);
  return expansion;
}

SurfaceExpansion expand_surface(std::span<const Vec3> vertices, std::span<const Face> faces, const SphereMap& map,
                                const ExpandSurfaceOptions& options, Backend& backend, Monitor& monitor,
                                ExpandSurfaceReport* report) {
  check(options);
  if (map.positions.size() != vertices.size())
    throw Error(Fault::bad_argument,
                fmt::format("the map has {} positions and the mesh {} vertices: it is of another mesh",
                            map.positions.size(), vertices.size()));
  const auto sampler = [&](const SphereGrid& grid, ExpandSurfaceReport& found) {
    const SphereSamples samples = options.closest_point
                                      ? closest_samples(map.positions, faces, grid, monitor)
                                      : backend.sphere_sampler(grid)->sample(map.positions, faces, monitor);
    found.faces_hit = samples.faces_hit;
    found.flipped_faces = samples.flipped_faces;
    found.folded_points = samples.folded_points;
    found.exact_decisions = samples.exact_decisions;
    return surface_fields(sample_positions(samples, faces, vertices), grid, options.origin, options.signed_dphi);
  };
  return expand_surface(sampler, options, backend, monitor, report);
}

MemoryNeed expand_surface_memory(std::uint64_t faces, int lmax, const Backend& backend) {
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, surface_grid_degree(lmax));
  const MemoryNeed sampling = backend.sphere_sampler(grid)->memory(faces);
  const MemoryNeed transform = backend.sphere_transform(grid, lmax)->memory(fields);
  const std::uint64_t point = sizeof(double);
  const std::uint64_t coefficients = 2 * fields * SphereCoefficients::count(lmax) * sizeof(std::complex<double>);
  // Positions and all six fields beside the samples; then the six fields beside the transform.
  return {
      std::max(sampling.host + (3 + fields) * point * grid.points(), transform.host + fields * point * grid.points()) +
          coefficients,
      std::max(sampling.device, transform.device)};
}

} // namespace cowgpu
