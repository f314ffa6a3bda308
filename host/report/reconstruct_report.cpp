#include "host/report/reconstruct_report.hpp"

#include "host/mesh/tensors.hpp"
#include "host/report/json_parts.hpp"
#include "host/report/order_names.hpp"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

using nlohmann::ordered_json;

const char* fields_name(SurfaceFields fields) {
  return fields == SurfaceFields::xyz ? "xyz" : "f";
}

/// Ascending.
Vec3 principal_moments(const Eigen::Matrix3d& inertia) {
  if (!inertia.allFinite()) return Vec3::Constant(std::nan(""));
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

// Rounded first: no minus before zero.
std::string triple(const Vec3& v, int digits) {
  const double unit = std::pow(10, -digits);
  std::string text;
  for (int c = 0; c < 3; ++c) {
    const double rounded = std::abs(v[c]) < unit / 2 ? 0 : v[c];
    text += fmt::format("{}{:.{}f}", c == 0 ? "" : " ", rounded, digits);
  }
  return text;
}

std::string moments_text(const Vec3& moments) {
  return fmt::format("{:.4g} {:.4g} {:.4g}", moments[0], moments[1], moments[2]);
}

// Enough digits of coordinates for four of the body's size.
int coordinate_digits(double size) {
  if (!(size > 0)) return 4;
  return std::clamp(3 - int(std::floor(std::log10(size))), 0, 12);
}

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json();
}

ordered_json finite_json(const Vec3& v) {
  return {number(v.x()), number(v.y()), number(v.z())};
}

ordered_json finite_json(const Eigen::Matrix3d& m) {
  ordered_json rows = ordered_json::array();
  for (int row = 0; row < 3; ++row) rows.push_back(finite_json(Vec3(m.row(row))));
  return rows;
}

ordered_json json_of(const OneWayDistance& way) {
  return {{"rms", way.rms}, {"largest", way.largest}, {"where", finite_json(way.where)}};
}

ordered_json measures_json(const SurfaceMeasures& m) {
  return {{"volume", number(m.volume)},
          {"centre_of_mass", finite_json(m.centre_of_mass)},
          {"inertia", finite_json(m.inertia)},
          {"principal_moments", finite_json(principal_moments(m.inertia))}};
}

ordered_json order_json(const ReconstructReport& report, const RebuiltOrder& order) {
  ordered_json row = {{"order", order.order},
                      {"name", order_name(order.order)},
                      {"description", describe_order(report.expansion, report.fields, order.order)}};
  row.update(measures_json(order.measures));
  row["distance"] = nullptr;
  if (order.distance)
    row["distance"] = {{"rms", order.distance->rms()},
                       {"largest", order.distance->largest()},
                       {"from_surface", json_of(order.distance->forth)},
                       {"from_mesh", json_of(order.distance->back)}};
  row["resolution"] = order.resolution;
  row["vertices"] = order.vertices;
  row["faces"] = order.faces;
  row["output"] = order.output.empty() ? ordered_json() : ordered_json(order.output);
  row["seconds"] = order.seconds;
  return row;
}

/// The mesh itself, about the expansion's origin.
SurfaceMeasures mesh_measures(const ReconstructReport& report) {
  Body body = *report.body;
  body.origin = report.expansion.origin;
  return {body.volume, body.centre_of_mass, tensors(body).inertia};
}

} // namespace

std::vector<std::string> order_facts(const ReconstructReport& report, int order) {
  return {fmt::format("order {}, {}", order, order_name(order)),
          "shape " + describe_order(report.expansion, report.fields, order),
          fmt::format("expansion {}, lmax {}", report.name, report.expansion.coefficients.lmax), "mesh " + report.mesh,
          "mesh_sha256 " + report.mesh_hash};
}

void write_screen(const ReconstructReport& report, const Sink& sink) {
  const SurfaceExpansion& expansion = report.expansion;
  const Vec3& o = expansion.origin;
  if (report.from_file)
    sink(fmt::format("{}: expansion {} of mesh {}, sha256 {}\n", report.input, report.name, report.mesh,
                     report.mesh_hash));
  else
    sink(mesh_line(report.body->surface.mesh()) + "\n");
  for (const std::string& note : report.notes) sink("note: " + note + "\n");
  sink(fmt::format("surface: {} map, {} of degrees 0 to {}, origin ({:.9g}, {:.9g}, {:.9g})\n", report.name,
                   report.fields == SurfaceFields::xyz ? "x, y, z" : "f_r, f_dtheta, f_dphi",
                   expansion.coefficients.lmax, o.x(), o.y(), o.z()));
  sink(fmt::format("order 0: {}\n", describe_order(expansion, report.fields, 0)));
  sink("device: " + device_line(report.device) + "\n");
  sink(fmt::format("time: map and expansion {:.3f} s, in all {:.3f} s\n", report.source_seconds, report.total_seconds));
  sink(fmt::format(
      "the body by order, density 1, in the length unit of the expansion; moments of inertia about the origin{}\n",
      report.body ? fmt::format("; distance between body and mesh, both ways, from {} points each", report.samples)
                  : ""));

  std::size_t names = 4, places = 14, moments = 17;
  const int digits = coordinate_digits(2 * std::abs(spherical_radius(expansion)));
  for (const RebuiltOrder& order : report.orders) {
    names = std::max(names, order_name(order.order).size());
    places = std::max(places, triple(order.measures.centre_of_mass, digits).size());
    moments = std::max(moments, moments_text(principal_moments(order.measures.inertia)).size());
  }
  const auto row = [&](const std::string& order, const std::string& name, const SurfaceMeasures& m,
                       const std::string& rest) {
    std::string line = fmt::format("  {:>5}  {:<{}}  {:>11.6g}  {:<{}}  {:<{}}  {}", order, name, names, m.volume,
                                   triple(m.centre_of_mass, digits), places, moments_text(principal_moments(m.inertia)),
                                   moments, rest);
    line.erase(line.find_last_not_of(' ') + 1);
    sink(line + "\n");
  };
  std::string head =
      fmt::format("  {:>5}  {:<{}}  {:>11}  {:<{}}  {:<{}}  {}", "order", "name", names, "volume", "centre of mass",
                  places, "principal moments", moments, report.body ? "      rms   largest" : "");
  head.erase(head.find_last_not_of(' ') + 1);
  sink(head + "\n");
  for (const RebuiltOrder& order : report.orders)
    row(fmt::format("{}", order.order), order_name(order.order), order.measures,
        order.distance ? fmt::format("{:>9.3g} {:>9.3g}", order.distance->rms(), order.distance->largest()) : "");
  if (report.body) row("mesh", "", mesh_measures(report), "");
}

void write_json(const ReconstructReport& report, const Sink& sink) {
  const SurfaceExpansion& expansion = report.expansion;
  ordered_json mesh = {{"name", report.mesh}, {"sha256", report.mesh_hash}};
  ordered_json truth;
  if (report.body) {
    truth = {{"name", report.body->surface.mesh().name},
             {"sha256", report.body->surface.mesh().sha256},
             {"vertices", report.body->surface.vertices().size()},
             {"faces", report.body->surface.faces().size()}};
    truth.update(measures_json(mesh_measures(report)));
  }
  ordered_json orders = ordered_json::array();
  for (const RebuiltOrder& order : report.orders) orders.push_back(order_json(report, order));
  const ordered_json all = {
      {"schema", "cowgpu.reconstruct.v1"},
      {"program", program_json()},
      {"command", report.command},
      {"created", report.created},
      {"input", report.input},
      {"device", device_json(report.device)},
      {"notes", report.notes},
      {"expansion",
       {{"name", report.name},
        {"mesh", mesh},
        {"map", report.map_method},
        {"recipe", report.recipe},
        {"lmax", expansion.coefficients.lmax},
        {"origin", finite_json(expansion.origin)},
        {"dphi", expansion.signed_dphi ? "signed" : "absolute"},
        {"spherical_radius", spherical_radius(expansion)}}},
      {"fields", fields_name(report.fields)},
      {"units", "lengths in the mesh's unit, coordinates and axes the mesh's; density 1; inertia about the expansion's "
                "origin"},
      {"mesh", truth},
      {"samples", report.body ? ordered_json(report.samples) : ordered_json()},
      {"orders", orders},
      {"timings", {{"source", report.source_seconds}, {"total", report.total_seconds}}}};
  sink(json_text(all) + "\n");
}

} // namespace cowgpu
