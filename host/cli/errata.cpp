#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"

#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/flow/flow_map.hpp"
#include "host/io/mesh_source.hpp"
#include "host/map/harmonic.hpp"
#include "host/map/laplacian.hpp"
#include "host/map/quality.hpp"
#include "host/mesh/half_edges.hpp"
#include "host/physics/errata.hpp"
#include "host/report/json_parts.hpp"
#include "host/report/order_names.hpp"
#include "host/spectrum/expand_surface.hpp"
#include "host/spectrum/paper_tables.hpp"
#include "host/sphere_grid.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace cowgpu::cli {
namespace {

using nlohmann::ordered_json;
using physics::ErratumNumber;

struct Errata {
  std::vector<ErratumNumber> numbers;
  std::vector<std::string> notes;
};

// The degree whose name the paper gives to l = 256.
ErratumNumber name_of_256() {
  int l = 0;
  while (l < 14 && order_name(l) != "hexapentacontadictapole") ++l;
  return {6, "l of the hexapentacontadictapole", double(l), 256};
}

SurfaceExpansion expanded(const ClosedSurface& cow, const SphereMap& map, bool signed_dphi, Backend& backend,
                          Monitor& monitor) {
  ExpandSurfaceOptions options;
  options.lmax = 3;
  options.closest_point = true;
  options.signed_dphi = signed_dphi;
  return expand_surface(cow.vertices(), cow.faces(), map, options, backend, monitor);
}

ErratumNumber misfit_of_dphi(const char* what, const ClosedSurface& cow, const SphereMap& map,
                             std::span<const PaperRow> table, Backend& backend, Monitor& monitor) {
  return {8, fmt::format("misfit of the {} table's f_dphi: |dphi|, signed", what),
          paper_misfits(expanded(cow, map, false, backend, monitor), table)[2],
          paper_misfits(expanded(cow, map, true, backend, monitor), table)[2]};
}

// Of the harmonic map, by the paper's recipe.
void add_harmonic(const ManifoldSurface& surface, Backend& backend, Monitor& monitor, Errata& found) {
  const SphereMap map = harmonic_map(surface, HarmonicOptions::paper_recipe(), monitor);
  found.numbers.push_back(misfit_of_dphi("harmonic", surface.closed(), map, paper_harmonic_table(), backend, monitor));
  const SparseMatrix l = laplacian(surface, HalfEdges(surface), EdgeWeights::cotangent);
  int negative = 0;
  for (Eigen::Index column = 0; column < l.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry(l, column); entry; ++entry)
      negative += entry.row() < entry.col() && entry.value() > 0; // -w
  found.numbers.push_back({16, "negative cotangent weights", double(negative), 0});
  found.numbers.push_back({16, "inverted triangles", double(judge(surface, map, 32).flipped.size()), 0});
}

constexpr double flow_tolerance = 1e-6; // as `expand --of flow` has it

// At t = 0.2, all sheets over a direction with their signs, extrapolated over refinements of the mesh.
ErratumNumber refined_monopole(const ClosedSurface& cow, double table, Backend& backend, Monitor& monitor) {
  ExpandSurfaceOptions options;
  options.lmax = 3;
  options.grid_degree = 256;
  const auto flow = backend.distance_flow(cow.vertices(), cow.faces());
  const SheetExpansion sheets = expand_sheets(cow.mesh(), 0.2, 2, flow_tolerance, options, *flow, backend, monitor);
  return {15, "monopole of f_r at t = 0.2, mesh refined", sheets.expansion.coefficients.at(0, 0, 0).real(), table,
          sheets.uncertainty[0][0]};
}

void add_flow(const ClosedSurface& cow, Backend& backend, Monitor& monitor, Errata& found) {
  const SphereMap map = paper_flow_map(cow.mesh(), Vec3::Zero(), backend, monitor);
  found.numbers.push_back(misfit_of_dphi("flow", cow, map, paper_flow_table(), backend, monitor));
  const double table = paper_flow_table().front().values[0].real();
  found.numbers.push_back(
      {15, "monopole of f_r at large times", monopole_at_large_times(cow.vertices(), Vec3::Zero()), table});
  found.numbers.push_back({15, "monopole of f_r at t = 0.2, of the vertices in coarse steps",
                           expanded(cow, map, false, backend, monitor).coefficients.at(0, 0, 0).real(), table});
  found.numbers.push_back(refined_monopole(cow, table, backend, monitor));
  const StarShapeTime star = star_shape_time(cow.vertices(), cow.faces(), Vec3::Zero(), 1e-6, backend, monitor);
  found.numbers.push_back({17, "least time for a star-shaped cow", star.upper, 0.2});
}

Errata computed(Monitor& monitor) {
  Errata found;
  found.numbers = physics::errata_numbers();
  found.numbers.push_back(name_of_256());
  std::optional<ClosedSurface> cow;
  try {
    cow = ClosedSurface::from(load_mesh("benchmark"));
  } catch (const Error& error) {
    if (error.fault() != Fault::mesh_missing) throw;
    found.notes.push_back(fmt::format("numbers of the paper's mesh are left out: {}", error.what()));
  }
  if (cow) {
    const auto backend = make_cpu_backend();
    const auto of_body = physics::errata_numbers(make_body(*cow, {}, 1));
    found.numbers.insert(found.numbers.end(), of_body.begin(), of_body.end());
    add_harmonic(ManifoldSurface::from(*cow), *backend, monitor, found);
    add_flow(*cow, *backend, monitor, found);
  }
  std::stable_sort(found.numbers.begin(), found.numbers.end(),
                   [](const ErratumNumber& a, const ErratumNumber& b) { return a.erratum < b.erratum; });
  return found;
}

ordered_json errata_json(const Errata& found, const std::vector<std::string>& command) {
  ordered_json list = ordered_json::array();
  for (const physics::Erratum& e : physics::errata()) {
    ordered_json numbers = ordered_json::array();
    for (const ErratumNumber& n : found.numbers)
      if (n.erratum == e.number)
        numbers.push_back(
            {{"quantity", n.quantity}, {"right", n.right}, {"uncertainty", n.uncertainty}, {"paper", n.printed}});
    list.push_back({{"number", e.number},
                    {"paper", e.printed},
                    {"right", e.right},
                    {"why", e.why},
                    {"shown_by", e.shown_by},
                    {"numbers", numbers}});
  }
  return {{"schema", "cowgpu.errata.v1"}, {"program", program_json()}, {"command", command},
          {"created", utc_now()},         {"notes", found.notes},      {"errata", list}};
}

void write_text(const Errata& found) {
  write_stdout("errata of Higher multipoles of the cow\n");
  for (const std::string& note : found.notes) write_stdout("note: " + note + "\n");
  for (const physics::Erratum& e : physics::errata()) {
    write_stdout(
        fmt::format("\n{:>2}. paper: {}\n    right: {}\n    why:   {}\n", e.number, e.printed, e.right, e.why));
    if (*e.shown_by) write_stdout(fmt::format("    see:   {}\n", e.shown_by));
    for (const ErratumNumber& n : found.numbers)
      if (n.erratum == e.number)
        write_stdout(fmt::format("    {:<55} {:>13.8g}  paper {:>12.6g}{}\n", n.quantity, n.right, n.printed,
                                 n.uncertainty > 0 ? fmt::format("  (+- {:.1g})", n.uncertainty) : ""));
  }
}

} // namespace

void add_errata(Command& app, Common& common) {
  Command* command = app.add_subcommand("errata", "What is wrong in Higher multipoles of the cow, with both numbers");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "As JSON (data/schemas/cowgpu.errata.v1.json)");
  command->callback([json, &common] {
    ConsoleMonitor monitor(ProgressStyle::none);
    const Errata found = computed(monitor);
    check_stop(monitor);
    if (*json)
      write_stdout(json_text(errata_json(found, common.command)) + "\n");
    else
      write_text(found);
  });
}

} // namespace cowgpu::cli
