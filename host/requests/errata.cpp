#include "host/requests/errata.hpp"

#include "host/backend.hpp"
#include "host/flow/flow_map.hpp"
#include "host/map/harmonic.hpp"
#include "host/map/laplacian.hpp"
#include "host/map/quality.hpp"
#include "host/mesh/half_edges.hpp"
#include "host/paper/recipe.hpp"
#include "host/paper/surface_tables.hpp"
#include "host/report/order_names.hpp"
#include "host/spectrum/expand_surface.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

using paper::erratum_number;
using physics::Comparison;

// The degree whose name the paper gives to l = 256.
Comparison name_of_256() {
  int l = 0;
  while (l < 14 && order_name(l) != "hexapentacontadictapole") ++l;
  return erratum_number(6, "l of the hexapentacontadictapole", double(l), 256);
}

SurfaceExpansion expanded(const ClosedSurface& cow, const SphereMap& map, bool signed_dphi, Backend& backend,
                          Monitor& monitor) {
  ExpandSurfaceOptions options;
  options.lmax = 3;
  options.closest_point = true;
  options.signed_dphi = signed_dphi;
  return expand_surface(cow.vertices(), cow.faces(), map, options, backend, monitor);
}

Comparison misfit_of_dphi(const char* what, const ClosedSurface& cow, const SphereMap& map,
                          std::span<const PaperRow> table, Backend& backend, Monitor& monitor) {
  return erratum_number(8, fmt::format("misfit of the {} table's f_dphi: |dphi|, signed", what),
                        paper_misfits(expanded(cow, map, false, backend, monitor), table)[2],
                        paper_misfits(expanded(cow, map, true, backend, monitor), table)[2]);
}

// Numbers about the harmonic map by the paper's recipe.
void add_harmonic(const ManifoldSurface& surface, Backend& backend, Monitor& monitor, ErrataResult& found) {
  const SphereMap map = harmonic_map(surface, paper::harmonic_map(), monitor);
  found.numbers.push_back(misfit_of_dphi("harmonic", surface.closed(), map, paper_harmonic_table(), backend, monitor));
  const SparseMatrix l = laplacian(surface, HalfEdges(surface), EdgeWeights::cotangent);
  int negative = 0;
  for (Eigen::Index column = 0; column < l.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry(l, column); entry; ++entry)
      negative += entry.row() < entry.col() && entry.value() > 0; // -w
  found.numbers.push_back(erratum_number(16, "negative cotangent weights", double(negative), 0));
  found.numbers.push_back(erratum_number(16, "inverted triangles", double(judge(surface, map, 32).flipped.size()), 0));
}

constexpr double expand_tolerance = 1e-6; // as `expand --of flow` has it

// At t = 0.2, all sheets over a direction with their signs, extrapolated over refinements of the mesh.
Comparison refined_monopole(const ClosedSurface& cow, double table, Backend& backend, Monitor& monitor) {
  ExpandSurfaceOptions options;
  options.lmax = 3;
  options.grid_degree = 256;
  const auto flow = backend.distance_flow(cow.vertices(), cow.faces());
  const SheetExpansion sheets =
      expand_sheets(cow.mesh(), paper::flow_time, 2, expand_tolerance, options, *flow, backend, monitor);
  return erratum_number(15, "monopole of f_r at t = 0.2, mesh refined",
                        sheets.expansion.coefficients.at(0, 0, 0).real(), table, sheets.uncertainty[0][0]);
}

void add_flow(const ClosedSurface& cow, Backend& backend, Monitor& monitor, ErrataResult& found) {
  const SphereMap map =
      stepped_flow_map(cow.mesh(), Vec3::Zero(), paper::flow_time, paper::flow_step, backend, monitor);
  found.numbers.push_back(misfit_of_dphi("flow", cow, map, paper_flow_table(), backend, monitor));
  const double table = paper_flow_table().front().values[0].real();
  found.numbers.push_back(erratum_number(15, "monopole of f_r at large times",
                                         monopole_at_large_times(cow.vertices(), Vec3::Zero()), table));
  found.numbers.push_back(erratum_number(15, "monopole of f_r at t = 0.2, of the vertices in coarse steps",
                                         expanded(cow, map, false, backend, monitor).coefficients.at(0, 0, 0).real(),
                                         table));
  found.numbers.push_back(refined_monopole(cow, table, backend, monitor));
  const StarShapeTime star = star_shape_time(cow.vertices(), cow.faces(), Vec3::Zero(), 1e-6, backend, monitor);
  found.numbers.push_back(erratum_number(17, "least time for a star-shaped cow", star.upper, paper::flow_time));
}

} // namespace

ErrataResult find_errata(std::optional<RawMesh> benchmark, Monitor& monitor) {
  ErrataResult found;
  found.numbers = paper::errata_numbers();
  found.numbers.push_back(name_of_256());
  if (benchmark) {
    const ClosedSurface cow = ClosedSurface::from(std::move(*benchmark));
    const auto backend = make_cpu_backend();
    const auto of_body = paper::errata_numbers(make_body(cow, {}, 1));
    found.numbers.insert(found.numbers.end(), of_body.begin(), of_body.end());
    add_harmonic(ManifoldSurface::from(cow), *backend, monitor, found);
    add_flow(cow, *backend, monitor, found);
  }
  std::stable_sort(found.numbers.begin(), found.numbers.end(),
                   [](const Comparison& a, const Comparison& b) { return a.erratum < b.erratum; });
  check_stop(monitor);
  return found;
}

} // namespace cowgpu
