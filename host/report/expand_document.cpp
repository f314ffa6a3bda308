#include "host/coefficient_set.hpp"
#include "host/report/document_parts.hpp"
#include "host/report/result.hpp"

#include <array>

namespace cowgpu {
namespace {

Object members(const Part& part) {
  Object all = members(part.surface.mesh());
  all.add({{"density", part.density},
           {"volume", part.volume},
           {"mass", part.mass()},
           {"centre_of_mass", part.centre_of_mass}});
  return all;
}

Object members(const Body& body) {
  List parts;
  for (const Part& part : body.parts) parts.push_back(members(part));
  Object all = members(body.surface.mesh());
  all.add({{"volume", body.volume},
           {"area", body.area},
           {"mass", body.mass()},
           {"centre_of_mass", body.centre_of_mass}, // not finite where the parts' masses cancel
           {"bounding_box", List{body.box.min, body.box.max}},
           {"brillouin_radius", body.brillouin_radius},
           {"placement", Object{{"metres_per_unit", body.units().stated ? Value(body.units().metre) : Value()},
                                {"rotation", body.placement.rotation}}},
           {"parts", parts}});
  return all;
}

Object members(const Tensors& tensors, const Body& body) {
  return {{"origin", body.origin},
          {"units", body.units().stated ? "kg m^2" : "density * length^5, in the mesh's length unit"},
          {"quadrupole", tensors.quadrupole},
          {"inertia", tensors.inertia},
          {"second_moment", tensors.second_moment}};
}

Object members(const Timings& t, const RunReport& run) {
  return {{"load", t.load},         {"device", t.device}, {"moments", t.moments},           {"verify", t.verify},
          {"surfaces", t.surfaces}, {"total", t.total},   {"kernels", entries(run.kernels)}};
}

Object members(const ErrorEstimate& estimate) {
  const WorstDegree known = worst_known_degree(estimate);
  const bool any = known.degree >= 0;
  return {{"sentences", sentences(estimate)},
          {"relative", any ? Value(known.relative) : Value()},
          {"worst_degree", any ? Value(known.degree) : Value()},
          {"error", estimate.error},
          {"norm", estimate.norm},
          {"bound", estimate.bound}};
}

Object members(const Accuracy& accuracy) {
  constexpr std::array how = {"none", "sample", "full"};
  List agreements;
  for (const Agreement& a : accuracy.agreements)
    agreements.push_back(Object{{"path", a.path},
                                {"against", a.against},
                                {"worst", a.errors.relative()},
                                {"worst_degree", a.errors.degree},
                                {"weighed", a.errors.ratio}});
  const Agreement* worst = accuracy.worst(); // an unchecked result must not look like a checked one
  Object all = {{"verify", how[std::size_t(accuracy.how)]},
                {"triangles", accuracy.triangles},
                {"seed", accuracy.seed},
                {"bound", worst ? Value(Accuracy::bound) : Value()},
                {"worst", worst ? Value(worst->errors.ratio) : Value()},
                {"passed", worst ? Value(accuracy.passed()) : Value()},
                {"agreements", agreements}};
  if (worst) all.add("estimate", members(accuracy.estimate));
  return all;
}

Object mass_members(const ExpandResult& result) {
  const Multipoles& q = result.mass;
  return {{"lmax", q.lmax},
          {"origin", q.origin},
          {"origin_kind", result.body.origin_kind},
          {"reference_radius", q.reference_radius},
          {"brillouin_radius", result.body.brillouin_radius},
          {"normalisation", "orthonormal"},
          {"condon_shortley", true},
          {"conjugated", false},
          {"axes", "the mesh's; theta from +z, phi from +x towards +y"},
          {"units", std::string(result.body.units().stated ? "kg, lengths in metres"
                                                           : "density * length^3, in the mesh's length unit") +
                        "; Q_lm = value * reference_radius^l"},
          {"density", q.density},
          {"cut_off", result.cut_off},
          {"coefficients", CoefficientRows{q.lmax, [&q](int l, int m, Numbers& row) {
                                             row.push_back(q(l, m).real());
                                             row.push_back(q(l, m).imag());
                                           }}}};
}

} // namespace

std::uint64_t json_bytes(int lmax) {
  return 4096 + 80 * std::uint64_t(lmax) + 61 * std::uint64_t(Multipoles::count(lmax));
}

Object document(const ExpandResult& result) {
  Object expansions;
  if (result.has_mass) expansions.add(mass_expansion, mass_members(result));
  for (const SurfaceResult& surface : result.surfaces) expansions.add(std::string(name(surface.of)), members(surface));
  Object all = opening("cowgpu.result.v1", result.command, result.created);
  all.add({{"mesh", members(result.body)},
           {"device", members(result.device)},
           {"notes", result.notes},
           {"tensors", members(result.tensors, result.body)},
           {"timings", members(result.timings, result.run)},
           {"accuracy", members(result.accuracy)},
           {"expansions", std::move(expansions)}});
  return all;
}

} // namespace cowgpu
