#include "host/requests/potential.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/physics/body_field.hpp"
#include "host/physics/magnetisation.hpp"
#include "host/report/result.hpp"
#include "host/requests/limits.hpp"
#include "host/requests/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cowgpu {

using namespace physics;

namespace {

constexpr int usual_degree = 32;

// Pairs of faces and points that the closed form is summed for in 80-bit arithmetic, so that all the digits shown are right and
// the error told is as small as they promise: seconds. Beyond, in double precision.
constexpr double most_extended_pairs = 5e7;

FieldSum sum_of(const Body& body, std::size_t points) {
  double faces = double(body.surface.faces().size());
  for (const Part& part : body.parts) faces += double(part.surface.faces().size());
  return faces * double(points) <= most_extended_pairs ? FieldSum::extended : FieldSum::device;
}

void refuse_coefficients(const char* what, const std::string& file) {
  if (is_coefficient_file(file))
    throw Error(Fault::file_format,
                fmt::format("{} takes the exact polyhedron, and {} holds multipoles: take the mesh", what, file));
}

[[noreturn]] void refuse_inside(const PotentialResult& s, const std::vector<std::size_t>& inside, bool has_mesh) {
  const Vec3& p = s.points[inside.front()];
  const double r = (p - s.origin).norm();
  throw Error(
      Fault::point_inside,
      fmt::format("{}: point {} of {} ({:.6g}, {:.6g}, {:.6g}) is {:.6g} from the body's origin and {:.6g} inside "
                  "the sphere of radius {:.6g} that holds it, where the series is not the potential{}; {}",
                  s.places, inside.front() + 1, s.points.size(), p[0], p[1], p[2], r, s.radius - r, s.radius,
                  inside.size() > 1 ? fmt::format(" ({} points are)", inside.size()) : "",
                  has_mesh ? "--inside exact takes the polyhedron there"
                           : "move it outside, or take the mesh with --inside exact"));
}

void take(const PotentialField& from, const std::vector<std::size_t>& to, PotentialField& field) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    field.value[to[i]] = from.value[i];
    if (!from.gradient.empty()) field.gradient[to[i]] = from.gradient[i];
    if (!from.hessian.empty()) field.hessian[to[i]] = from.hessian[i];
  }
}

std::vector<Vec3> chosen(const std::vector<Vec3>& points, const std::vector<std::size_t>& which, const Vec3& origin) {
  std::vector<Vec3> some;
  for (const std::size_t i : which) some.push_back(points[i] - origin);
  return some;
}

// Where the sphere that holds the body is not known the sum of the file's terms is the field that it describes, below its
// reference radius too, as on the ground of a planet. The moments, over the distance of the nearest point. Refuses places
// where the terms grow with their degree, which no field does outside of its body.
Multipoles continued_down(const Multipoles& moments, const PotentialResult& s) {
  std::size_t nearest = 0, below = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    const double r = (s.points[i] - s.origin).norm();
    below += r < s.radius ? 1 : 0;
    if (r < least) nearest = i;
    least = std::min(least, r);
  }
  if (below == 0) return moments;
  const Vec3& p = s.points[nearest];
  const std::string place = fmt::format("{}: point {} of {} ({:.6g}, {:.6g}, {:.6g}) is {:.6g} from the origin",
                                        s.places, nearest + 1, s.points.size(), p[0], p[1], p[2], least);
  if (!(least > 0)) throw Error(Fault::point_inside, place + ", where no series of multipoles is the potential");
  if (const double times = term_growth(moments, s.lmax, least);
      times > 1 && term_growth(moments, s.lmax, s.radius) <= 1)
    throw Error(Fault::point_inside,
                fmt::format("{}, {:.3g} of the file's reference radius {:.6g}: there the terms of degrees {} to {} are "
                            "up to {:.2g} times those below, so that the series does not converge, and the place is "
                            "inside the body or close to it; move it outwards, or lower --order",
                            place, least / s.radius, s.radius, s.lmax / 2 + 1, s.lmax, times));
  return over_radius(moments, least);
}

void compute(const LoadedMass& input, const PotentialRequest& request, const Multipoles& moments, Backend& backend,
             unsigned threads, Monitor& monitor, PotentialResult& s) {
  const Derivatives derivatives = request.derivatives;
  const std::size_t count = s.points.size();
  std::vector<std::size_t> inside, outside;
  for (std::size_t i = 0; i < count; ++i) {
    const double r = (s.points[i] - s.origin).stableNorm();
    if (!std::isfinite(r) || (!request.exact && !(r < 1e150 * s.radius)))
      throw Error(Fault::file_format,
                  fmt::format("{}: point {} of {} is farther than {}, beyond what doubles hold of its field{}",
                              s.places, i + 1, count, request.exact ? "any double" : "1e150 radii of the body",
                              request.exact || !input.mesh ? "" : "; --exact goes farther"));
    // On the sphere itself, where a vertex may lie, the series does not converge either.
    const double nearest = request.inside_exact ? 1 + 1e-9 : nearest_potential;
    const bool by_polyhedron = request.exact || (s.radius_known() && !(r >= nearest * s.radius));
    if (!by_polyhedron) s.nearest = std::min(s.nearest, r / s.radius);
    (by_polyhedron ? inside : outside).push_back(i);
  }
  if (!inside.empty() && !request.exact && !request.inside_exact) refuse_inside(s, inside, input.mesh.has_value());
  s.field.value.resize(count);
  if (derivatives != Derivatives::none) s.field.gradient.resize(count);
  if (derivatives == Derivatives::second) s.field.hessian.resize(count);
  const Multipoles reach = s.radius_known() ? moments : continued_down(moments, s);
  if (!outside.empty())
    take(backend.exterior_potential({reach, s.lmax, derivatives})->at(chosen(s.points, outside, s.origin), monitor),
         outside, s.field);
  if (inside.empty()) return;
  const std::vector<Vec3> points = chosen(s.points, inside, Vec3::Zero());
  s.exact_sum = sum_of(*input.mesh, points.size());
  const auto cpu = make_cpu_backend(threads);
  const BodyField closed(*input.mesh, {derivatives, s.exact_sum, threads}, *cpu);
  check_memory(closed.memory(points.size()), *cpu, "ask for fewer points");
  BodyFieldValues exact = closed.at(points, monitor);
  take(exact.field, inside, s.field);
  s.exact.assign(count, 0);
  for (std::size_t i = 0; i < inside.size(); ++i) s.exact[inside[i]] = exact.by_series[i] ? 0 : 1;
  s.far_points = std::size_t(std::count(exact.by_series.begin(), exact.by_series.end(), 1));
  s.exact_points = inside.size() - s.far_points;
  s.exact_error = exact.error;
  s.density = std::move(exact.density);
}

void check_magnet(const PotentialRequest& r) {
  if (!r.magnetisation) return;
  const auto refuse = [](const std::string& why) { throw Error(Fault::bad_argument, "--magnetisation " + why); };
  if (!r.magnetisation->allFinite()) refuse("takes three finite numbers, in A/m");
  if (r.derivatives != Derivatives::second)
    refuse("is multiplied with second derivatives of the potential: leave --derivatives out");
  if (r.body.charge) refuse("and --charge are two kinds of bodies: leave one out");
  if (r.body.density)
    refuse("says how strong the magnet is: leave --density out, which is 1 then; a --part has its own part "
           "of the magnetisation, -1 for a hole");
  refuse_coefficients("--magnetisation", r.body.mesh);
}

void apply_law(const FieldLaw& law, PotentialField& field) {
  for (double& v : field.value) v = law.potential(v);
  for (Vec3& g : field.gradient) g = law.force(g);
  for (SymmetricTensor& h : field.hessian) h = law.tensor(h);
}

// What computed the points: the series on a device, the closed form and its series on the CPU.
std::string computed_by(const PotentialResult& s, const Backend& backend, unsigned threads) {
  const std::size_t closed = s.exact_points + s.far_points;
  const std::string exact =
      fmt::format("CPU, {}, {} threads", s.exact_sum == FieldSum::extended ? "80-bit arithmetic" : "double precision",
                  threads ? threads : make_cpu_backend(0)->facts().threads);
  if (closed == s.points.size()) return exact;
  if (closed == 0) return device_line(backend.facts());
  return fmt::format("series: {}; polyhedron: {}", device_line(backend.facts()), exact);
}

int degree_wanted(const LoadedMass& input, const PotentialRequest& request) {
  if (request.lmax >= 0) {
    if (input.coefficients && request.lmax > input.coefficients->lmax)
      throw Error(Fault::bad_argument, fmt::format("--order {}: the file's coefficients end at degree {}", request.lmax,
                                                   input.coefficients->lmax));
    return request.lmax;
  }
  return input.mesh ? usual_degree : std::min(input.coefficients->lmax, largest_potential_degree);
}

} // namespace

PotentialResult potential(const PotentialRequest& request, Backend& backend, unsigned threads, Monitor& monitor) {
  require_range("the degree of the series is", std::max(request.lmax, 0), 0, largest_potential_degree);
  require_member("the derivatives are", request.derivatives, Derivatives::second);
  if (request.exact || request.inside_exact)
    refuse_coefficients(request.exact ? "--exact" : "--inside exact", request.body.mesh);
  check_magnet(request);
  const LoadedMass loaded = load_mass(request.body, Motion::held, monitor);
  PotentialResult s;
  s.subject = subject(loaded);
  s.subject.notes.insert(s.subject.notes.end(), request.notes.begin(), request.notes.end());
  s.all_exact = request.exact;
  s.lmax = request.exact ? 0 : degree_wanted(loaded, request);
  const Multipoles own = moments(loaded, s.lmax, backend, monitor);
  s.si = loaded.units.stated;
  s.law.charge = request.body.charge;
  if (s.si) s.law.constant = s.law.charge ? coulomb_constant_si : gravitational_constant_si;
  s.origin = own.origin;
  s.origin_known = loaded.mesh || loaded.coefficients->origin;
  s.radius = own.reference_radius;
  s.radius_note = unknown_radius_note(loaded);
  if (loaded.coefficients) s.reference_radius = *loaded.coefficients->reference_radius * loaded.units.metre;
  const std::size_t count = count_places(request.places);
  MemoryNeed need = backend.exterior_potential({own, s.lmax, request.derivatives})->memory(count);
  need.host += (request.magnetisation ? 88 : 64) * count + request.extra_bytes;
  check_memory(need, backend, request.exact ? "ask for fewer points" : "ask for fewer points or a lower --order");
  Places places = find_places(request.places, {s.origin, s.radius, s.si});
  s.places = std::move(places.name);
  s.points = std::move(places.points);
  s.grid = places.grid;
  s.sphere_radius = places.radius;
  s.lattice = places.lattice;
  compute(loaded, request, own, backend, threads, monitor, s);
  s.magnetisation = request.magnetisation;
  if (s.magnetisation) s.induction = magnetic_induction(s.field.hessian, *s.magnetisation);
  apply_law(s.law, s.field);
  s.device = computed_by(s, backend, threads);
  return s;
}

SeriesErrorsResult series_errors(const SeriesErrorsRequest& request, Backend& backend, unsigned threads,
                                 Monitor& monitor) {
  refuse_coefficients("--errors", request.body.mesh);
  for (const int order : request.orders)
    if (order < 0 || order > largest_potential_degree)
      throw Error(Fault::bad_argument,
                  fmt::format("--orders: {} is not from 0 to {}, the largest degree of a potential", order,
                              largest_potential_degree));
  const LoadedMass loaded = load_mass(request.body, Motion::held, monitor);
  const Body& body = *loaded.mesh;
  return {subject(loaded), loaded.units.stated, body.origin, body.brillouin_radius,
          physics::series_errors(body, request.orders, request.distances, backend, threads, monitor)};
}

} // namespace cowgpu
