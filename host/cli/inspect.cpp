#include "host/cli/commands.hpp"

#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mesh/audit.hpp"
#include "host/report/result.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string mesh = "builtin:cow";
  bool json = false;
};

nlohmann::ordered_json json_of(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

// Which of the two types the mesh satisfies, and the first reason where it does not.
struct Fitness {
  std::string moments = "yes", maps = "yes";
};

Fitness fitness(const RawMesh& mesh) {
  Fitness fit;
  try {
    ClosedSurface closed = ClosedSurface::from(mesh);
    try {
      ManifoldSurface::from(std::move(closed));
    } catch (const Error& error) {
      fit.maps = fmt::format("no [{}]: {}", name(error.fault()), error.what());
    }
  } catch (const Error& error) {
    fit.moments = fit.maps = fmt::format("no [{}]: {}", name(error.fault()), error.what());
  }
  return fit;
}

void write_json(const RawMesh& mesh, const Audit& a, const Fitness& fit) {
  nlohmann::ordered_json out = {{"schema", "cowgpu.inspect.v1"},
                                {"name", mesh.name},
                                {"sha256", mesh.sha256},
                                {"vertices", a.vertices},
                                {"faces", a.faces},
                                {"edges", a.edges},
                                {"moments", fit.moments},
                                {"maps", fit.maps},
                                {"finite", a.finite},
                                {"closed", a.closed},
                                {"edge_manifold", a.edge_manifold},
                                {"vertex_manifold", a.vertex_manifold},
                                {"consistently_oriented", a.consistently_oriented},
                                {"outward", a.outward},
                                {"components", a.components},
                                {"cavities", a.cavities},
                                {"euler_characteristic", a.euler_characteristic},
                                {"open_edges", a.open_edges},
                                {"unbalanced_edges", a.unbalanced_edges},
                                {"crowded_edges", a.crowded_edges},
                                {"pinched_vertices", a.pinched_vertices},
                                {"unused_vertices", a.unused_vertices},
                                {"degenerate_faces", a.degenerate_faces},
                                {"duplicate_faces", a.duplicate_faces},
                                {"coincident_groups", a.coincident_groups}};
  if (a.genus) out["genus"] = *a.genus;
  if (a.finite) {
    out["area"] = a.area;
    out["bounding_box"] = {json_of(a.box.min), json_of(a.box.max)};
    out["shortest_edge"] = a.shortest_edge;
    out["longest_edge"] = a.longest_edge;
  }
  if (a.volume) out["volume"] = *a.volume;
  if (a.centre_of_mass) {
    out["centre_of_mass"] = json_of(*a.centre_of_mass);
    out["brillouin_radius"] = brillouin_radius(mesh.vertices, mesh.faces, *a.centre_of_mass);
  }
  out["notes"] = mesh.notes;
  write_stdout(out.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void write_text(const RawMesh& mesh, const Audit& a, const Fitness& fit) {
  const auto row = [](const char* what, const std::string& value) {
    write_stdout(fmt::format("  {:<24} {}\n", what, value));
  };
  const auto yes = [](bool value) { return std::string(value ? "yes" : "no"); };
  const auto point = [](const Vec3& v) { return fmt::format("({:.15g}, {:.15g}, {:.15g})", v.x(), v.y(), v.z()); };
  write_stdout(mesh_line(mesh) + "\n");
  for (const std::string& note : mesh.notes) write_stdout("note: " + note + "\n");
  row("fit for moments", fit.moments);
  row("fit for sphere maps", fit.maps);
  row("vertices, edges, faces", fmt::format("{}, {}, {}", a.vertices, a.edges, a.faces));
  row("finite", yes(a.finite));
  row("closed", a.closed ? "yes" : fmt::format("no: {} open edges", a.open_edges));
  row("oriented", a.consistently_oriented ? "yes" : fmt::format("no: {} unbalanced edges", a.unbalanced_edges));
  row("edge-manifold", a.edge_manifold ? "yes" : fmt::format("no: {} edges with more than two faces", a.crowded_edges));
  row("vertex-manifold", a.vertex_manifold ? "yes" : fmt::format("no: {} pinched vertices", a.pinched_vertices));
  row("outward", yes(a.outward));
  row("shells, cavities", fmt::format("{}, {}", a.components, a.cavities));
  row("Euler characteristic",
      fmt::format("{}{}", a.euler_characteristic, a.genus ? fmt::format(", genus {}", *a.genus) : ""));
  row("degenerate, duplicate", fmt::format("{}, {} faces", a.degenerate_faces, a.duplicate_faces));
  row("unused, coincident", fmt::format("{} vertices, {} places", a.unused_vertices, a.coincident_groups));
  if (a.finite) {
    row("bounding box", point(a.box.min) + " to " + point(a.box.max));
    row("area", fmt::format("{:.15g}", a.area));
    row("edge lengths", fmt::format("{:.6g} to {:.6g}", a.shortest_edge, a.longest_edge));
  }
  if (a.volume) row("volume", fmt::format("{:.15g}", *a.volume));
  if (a.centre_of_mass) {
    row("centre of mass", point(*a.centre_of_mass));
    row("Brillouin radius",
        fmt::format("{:.15g} about it", brillouin_radius(mesh.vertices, mesh.faces, *a.centre_of_mass)));
  }
}

void run(const Options& options) {
  const RawMesh mesh = load_mesh(options.mesh);
  const ConsoleMonitor stop(ProgressStyle::none);
  check_stop(stop);
  const Audit facts = audit(mesh);
  check_stop(stop);
  const Fitness fit = fitness(mesh);
  check_stop(stop);
  if (options.json)
    write_json(mesh, facts, fit);
  else
    write_text(mesh, facts, fit);
}

} // namespace

void add_inspect(CLI::App& app, Common&) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("inspect", "Facts about a mesh: topology, size, what it is fit for");
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->capture_default_str();
  command->add_flag("--json", options->json, "As JSON");
  command->callback([options] { run(*options); });
}

} // namespace cowgpu::cli
