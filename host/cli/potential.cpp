#include "host/cli/physics.hpp"

#include "host/cli/potential_errors.hpp"
#include "host/cli/potential_places.hpp"
#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/io/potential_file.hpp"
#include "host/number.hpp"
#include "host/physics/far_field.hpp"
#include "host/physics/polyhedron.hpp"
#include "host/physics/potential.hpp"
#include "host/plot/plot.hpp"
#include "host/report/result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cowgpu::cli {
namespace {

using namespace physics;

constexpr int usual_degree = 32;
constexpr std::size_t most_shown = 20, most_in_json = 200; // points

struct Options {
  PlaceOptions places;
  int lmax = -1, derivatives = 2;
  bool exact = false, errors = false;
  std::string inside = "refuse", output, distances = "1,1.1,1.5,2,3,5,10";
  std::vector<std::string> plots;
  std::vector<std::string> orders = {"0,1,2,4,8,16,32"};
};

struct Units {
  FieldLaw law;
  std::string length, potential, force, tensor;
};

Units units_of(bool metric, bool charge) {
  const std::string g = charge ? "k" : "G";
  Units units;
  units.law.charge = charge;
  if (!metric) {
    units.length = std::string(mesh_length_unit);
    units.potential = g + " * density * length^2";
    units.force = g + " * density * length";
    units.tensor = g + " * density";
    return units;
  }
  units.length = "m";
  units.law.constant = charge ? coulomb_constant_si : gravitational_constant_si;
  units.potential = charge ? "V" : "J/kg";
  units.force = charge ? "V/m" : "m/s^2";
  units.tensor = charge ? "V/m^2" : "1/s^2";
  return units;
}

// A body's field at its places, as `potential` needs it.
struct Solved {
  Units units;
  PlaceFrame frame;
  bool radius_known = true;    // whether that of the sphere that holds the body is known
  double reference_radius = 0; // where a file has one
  Places places;
  int lmax = 0;
  PotentialField field; // V; later in the units
  std::vector<std::uint8_t> exact;
  std::vector<double> density;                              // where exact
  std::size_t exact_points = 0, far_points = 0;             // by the polyhedron; where its series was better
  double exact_error = 0;                                   // estimated, the largest of all points
  double nearest = std::numeric_limits<double>::infinity(); // point of the series, in radii
};

[[noreturn]] void refuse_inside(const Solved& s, const std::vector<std::size_t>& inside, bool has_mesh) {
  const Vec3& p = s.places.points[inside.front()];
  const double r = (p - s.frame.origin).norm();
  throw Error(
      Fault::point_inside,
      fmt::format("{}: point {} of {} ({:.6g}, {:.6g}, {:.6g}) is {:.6g} from the body's origin and {:.6g} inside "
                  "the sphere of radius {:.6g} that holds it, where the series is not the potential{}; {}",
                  s.places.name, inside.front() + 1, s.places.points.size(), p[0], p[1], p[2], r, s.frame.radius - r,
                  s.frame.radius, inside.size() > 1 ? fmt::format(" ({} points are)", inside.size()) : "",
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
Multipoles continued_down(const Multipoles& moments, const Solved& s) {
  std::size_t nearest = 0, below = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < s.places.points.size(); ++i) {
    const double r = (s.places.points[i] - s.frame.origin).norm();
    below += r < s.frame.radius ? 1 : 0;
    if (r < least) nearest = i;
    least = std::min(least, r);
  }
  if (below == 0) return moments;
  const Vec3& p = s.places.points[nearest];
  const std::string place = fmt::format("{}: point {} of {} ({:.6g}, {:.6g}, {:.6g}) is {:.6g} from the origin",
                                        s.places.name, nearest + 1, s.places.points.size(), p[0], p[1], p[2], least);
  if (!(least > 0)) throw Error(Fault::point_inside, place + ", where no series of multipoles is the potential");
  if (const double times = term_growth(moments, s.lmax, least);
      times > 1 && term_growth(moments, s.lmax, s.frame.radius) <= 1)
    throw Error(Fault::point_inside,
                fmt::format("{}, {:.3g} of the file's reference radius {:.6g}: there the terms of degrees {} to {} are "
                            "up to {:.2g} times those below, so that the series does not converge, and the place is "
                            "inside the body or close to it; move it outwards, or lower --order",
                            place, least / s.frame.radius, s.frame.radius, s.lmax / 2 + 1, s.lmax, times));
  return over_radius(moments, least);
}

void compute(const LoadedMass& input, const Options& options, const Multipoles& moments, Backend& backend,
             unsigned threads, Monitor& monitor, Solved& s) {
  const auto derivatives = Derivatives(options.derivatives);
  const std::size_t count = s.places.points.size();
  std::vector<std::size_t> inside, outside;
  for (std::size_t i = 0; i < count; ++i) {
    const double r = (s.places.points[i] - s.frame.origin).stableNorm();
    if (!std::isfinite(r) || (!options.exact && !(r < 1e150 * s.frame.radius)))
      throw Error(Fault::file_format,
                  fmt::format("{}: point {} of {} is farther than {}, beyond what doubles hold of its field{}",
                              s.places.name, i + 1, count, options.exact ? "any double" : "1e150 radii of the body",
                              options.exact || !input.mesh ? "" : "; --exact goes farther"));
    // On the sphere itself, where a vertex may lie, the series does not converge either.
    const double nearest = options.inside == "exact" ? 1 + 1e-9 : nearest_potential;
    const bool by_polyhedron = options.exact || (s.radius_known && !(r >= nearest * s.frame.radius));
    if (!by_polyhedron) s.nearest = std::min(s.nearest, r / s.frame.radius);
    (by_polyhedron ? inside : outside).push_back(i);
  }
  if (!inside.empty() && !options.exact && options.inside != "exact") refuse_inside(s, inside, input.mesh.has_value());
  s.field.value.resize(count);
  if (derivatives != Derivatives::none) s.field.gradient.resize(count);
  if (derivatives == Derivatives::second) s.field.hessian.resize(count);
  const Multipoles reach = s.radius_known ? moments : continued_down(moments, s);
  if (!outside.empty())
    take(backend.potential({reach, chosen(s.places.points, outside, s.frame.origin), s.lmax, derivatives}, monitor),
         outside, s.field);
  if (inside.empty()) return;
  const std::vector<Vec3> points = chosen(s.places.points, inside, Vec3::Zero());
  ExactField exact = exact_field(*input.mesh, points, derivatives, threads, monitor);
  take(exact.field, inside, s.field);
  s.exact.assign(count, 0);
  for (std::size_t i = 0; i < inside.size(); ++i) s.exact[inside[i]] = exact.by_series[i] ? 0 : 1;
  s.far_points = std::size_t(std::count(exact.by_series.begin(), exact.by_series.end(), 1));
  s.exact_points = inside.size() - s.far_points;
  s.exact_error = exact.error;
  s.density = std::move(exact.density);
}

void apply_law(const FieldLaw& law, PotentialField& field) {
  for (double& v : field.value) v = law.potential(v);
  for (Vec3& g : field.gradient) g = law.force(g);
  for (SymmetricTensor& h : field.hessian) h = law.tensor(h);
}

const char* force_name(const Units& units) {
  return units.law.charge ? "field" : "acceleration";
}

void add_one_point(const Solved& s, Findings& found) {
  const PotentialField& f = s.field;
  found.rows.push_back({"at", "place", s.places.points[0], s.units.length});
  found.rows.push_back({"potential", "potential", f.value[0], s.units.potential});
  if (!f.gradient.empty())
    found.rows.push_back({force_name(s.units), force_name(s.units), f.gradient[0], s.units.force});
  if (!f.hessian.empty()) {
    const SymmetricTensor& h = f.hessian[0];
    Eigen::Matrix3d tensor;
    tensor << h[0], h[1], h[2], h[1], h[3], h[4], h[2], h[4], h[5];
    found.rows.push_back({"gradient", fmt::format("gradient of the {}", force_name(s.units)), tensor, s.units.tensor});
  }
  if (!s.density.empty())
    found.rows.push_back({"density", "density at the place", s.density[0],
                          s.units.length == "m" ? (s.units.law.charge ? "C/m^3" : "kg/m^3") : "of the body"});
}

void add_ranges(const Solved& s, Findings& found) {
  const auto [least, most] = std::minmax_element(s.field.value.begin(), s.field.value.end());
  found.rows.push_back({"potential_min", "least potential", *least, s.units.potential});
  found.rows.push_back({"potential_max", "greatest potential", *most, s.units.potential});
  if (s.field.gradient.empty()) return;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const Vec3& g : s.field.gradient) {
    low = std::min(low, g.norm());
    high = std::max(high, g.norm());
  }
  const std::string name = force_name(s.units);
  found.rows.push_back({name + "_min", "least " + name, low, s.units.force});
  found.rows.push_back({name + "_max", "greatest " + name, high, s.units.force});
}

void add_table(const Solved& s, bool json, Findings& found) {
  const std::size_t count = s.places.points.size();
  if (count > (json ? most_in_json : most_shown)) {
    found.notes.push_back(fmt::format("{} points: -o FILE.csv writes each of them", count));
    return;
  }
  Table table{"points", "point by point", {{"x", s.units.length}, {"y", s.units.length}, {"z", s.units.length}}, {}};
  table.columns.push_back({"potential", s.units.potential});
  const char letter = s.units.law.charge ? 'e' : 'a';
  if (!s.field.gradient.empty())
    for (const char c : {'x', 'y', 'z'}) table.columns.push_back({fmt::format("{}{}", letter, c), s.units.force});
  if (!s.field.hessian.empty())
    for (const char* c : {"xx", "xy", "xz", "yy", "yz", "zz"})
      table.columns.push_back({fmt::format("{}{}", letter, c), s.units.tensor});
  table.columns.push_back({"exact"});
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& p = s.places.points[i];
    std::vector<Value> row = {p[0], p[1], p[2], s.field.value[i]};
    if (!s.field.gradient.empty())
      for (int c = 0; c < 3; ++c) row.emplace_back(s.field.gradient[i][c]);
    if (!s.field.hessian.empty()) row.insert(row.end(), s.field.hessian[i].begin(), s.field.hessian[i].end());
    row.emplace_back(!s.exact.empty() && s.exact[i] != 0);
    table.rows.push_back(row);
  }
  found.tables.push_back(std::move(table));
}

void check_options(const PhysicsCall& common, const Options& options) {
  const auto refuse = [](const std::string& why) { throw Error(Fault::bad_argument, why); };
  const bool file = is_coefficient_file(common.body.mesh);
  if (options.errors && (options.places.any() || options.exact || !options.output.empty()))
    refuse("--errors has places of its own: leave --at, --sphere, --plane, --exact and -o out");
  if (!options.errors && !options.plots.empty()) refuse("--plot draws the errors of --errors");
  if (options.output == "-") refuse("-o -: the standard output has the report; name a file");
  if (file && (options.errors || options.exact || options.inside == "exact"))
    throw Error(Fault::file_format, fmt::format("{} takes the exact polyhedron, and {} holds multipoles: take the mesh",
                                                options.errors  ? "--errors"
                                                : options.exact ? "--exact"
                                                                : "--inside exact",
                                                common.body.mesh));
  if (!options.output.empty()) file_format(options.output);
  for (const std::string& picture : options.plots) plot::picture_format(picture);
  std::vector<std::string> outputs = options.plots;
  if (!options.output.empty()) outputs.push_back(options.output);
  for (const std::string& output : outputs) {
    for (const std::string& name : input_files(common.body)) refuse_mesh_as_output(name, output);
    refuse_same_file(options.places.at, output);
  }
}

// Which places have the closed form, which its series, and what doubles do not hold.
void add_exact_notes(const Options& options, const Solved& s, Findings& found) {
  const std::size_t count = s.places.points.size(), closed = s.exact_points + s.far_points;
  if (options.exact && s.far_points == 0)
    found.notes.push_back("everywhere the exact potential of the polyhedron (Werner and Scheeres 1997)");
  else if (!options.exact && closed > 0)
    found.notes.push_back(
        fmt::format("{} of {} points lie inside the sphere that holds the body: there the exact potential "
                    "of the polyhedron (Werner and Scheeres 1997)",
                    closed, count));
  if (s.far_points > 0)
    found.notes.push_back(fmt::format("at {} of {} points the closed form of the polyhedron (Werner and Scheeres "
                                      "1997), a difference of large numbers "
                                      "far away and beside thin bodies, has larger errors than the body's series to "
                                      "degree {} about the middle of its "
                                      "box, and that series was taken",
                                      s.far_points, count, FarField::degree));
  std::size_t lost = 0;
  constexpr double least = std::numeric_limits<double>::min();
  for (std::size_t i = 0; i < count; ++i) {
    if (s.field.value[i] == 0) continue;
    const auto small = [](double component) { return std::abs(component) < least; };
    const bool force = !s.field.gradient.empty() && !(s.field.gradient[i].cwiseAbs().maxCoeff() >= least);
    const bool tensor =
        !s.field.hessian.empty() && std::all_of(s.field.hessian[i].begin(), s.field.hessian[i].end(), small);
    lost += force || tensor ? 1 : 0;
  }
  if (lost > 0)
    found.notes.push_back(fmt::format("at {} of {} points, far away, derivatives of the potential are smaller than "
                                      "doubles hold in all their digits ({:.3g}), and may be shown as 0",
                                      lost, count, least));
}

// What computed the points: the series on a device, the closed form and its series in 80-bit numbers.
std::string computed_by(const Solved& s, const Backend& backend, unsigned threads) {
  const std::size_t closed = s.exact_points + s.far_points;
  const std::string extended =
      fmt::format("CPU, 80-bit arithmetic, {} threads", threads ? threads : make_cpu_backend(0)->facts().threads);
  if (closed == s.places.points.size()) return extended;
  if (closed == 0) return device_line(backend.facts());
  return fmt::format("series: {}; polyhedron: {}", device_line(backend.facts()), extended);
}

void add_head(const LoadedMass& input, const Options& options, const Solved& s, bool metric, Findings& found) {
  if (!metric)
    found.notes.push_back(
        fmt::format("lengths and densities are in the mesh's units and {} = 1; --length-unit or --length, "
                    "and --density, make it SI",
                    s.units.law.charge ? "k" : "G"));
  if (s.units.law.charge)
    found.notes.push_back("densities are of charge: potential k Q/r, field -grad of it, away from positive charges");
  if (!input.mesh && !input.coefficients->origin)
    found.notes.push_back("the file does not say its origin: places are counted from it");
  add_exact_notes(options, s, found);
  if (const double rest = std::pow(s.nearest, -(s.lmax + 1));
      s.radius_known && rest > 1e-12) // as many digits are shown
    found.notes.push_back(
        fmt::format("the nearest point of the series is {:.6g} radii away: to degree {} its terms have fallen "
                    "to {:.2g} there at most; {} is nearer to the truth",
                    s.nearest, s.lmax, rest,
                    input.mesh ? "a higher --lmax, or --exact," : "the mesh, with --exact or a higher --lmax,"));
  if (!s.radius_known) {
    found.notes.push_back(unknown_radius_note(input) +
                          "; 1R is the reference radius here, and the sum of the file's terms is taken everywhere");
    if (s.nearest < 1)
      found.notes.push_back(fmt::format("the nearest point is {:.6g} reference radii from the origin: the field is "
                                        "continued downwards to it, and terms of degree {} and their errors have "
                                        "grown {:.3g} times",
                                        s.nearest, s.lmax, std::pow(s.nearest, -(s.lmax + 1))));
  }
  found.rows = {{"law", "law", std::string(s.units.law.charge ? "charge" : "gravity")},
                {"constant", s.units.law.charge ? "Coulomb's constant" : "Newton's constant", s.units.law.constant,
                 metric ? (s.units.law.charge ? "N m^2/C^2" : "m^3/(kg s^2)") : ""},
                {"lmax", "series to degree", options.exact ? Value() : Value(double(s.lmax))},
                {"origin", "origin", s.frame.origin, s.units.length},
                {"brillouin_radius", "Brillouin radius", s.radius_known ? Value(s.frame.radius) : Value(),
                 s.units.length, "not known: the file does not say it"},
                {"places", "places", s.places.name},
                {"point_count", "points", double(s.places.points.size())},
                {"exact_count", "points by the polyhedron's closed form", double(s.exact_points)}};
  if (s.exact_points + s.far_points > 0) {
    found.rows.push_back({"far_count", "points by the polyhedron's series", double(s.far_points)});
    found.rows.push_back({"exact_error", "estimated relative error at these",
                          std::isfinite(s.exact_error) ? Value(s.exact_error) : Value(), "",
                          "none: the potential is 0"});
  }
  if (!input.mesh)
    found.rows.push_back({"reference_radius", "reference radius of the file", s.reference_radius, s.units.length});
}

// The paper's formula has another factor before the moments.
std::vector<Comparison> beside_paper() {
  std::vector<Comparison> rows;
  for (const int l : {0, 2}) {
    const double factor = 4 * std::numbers::pi / (2 * l + 1);
    rows.push_back({fmt::format("factor of G Q_lm / r^(l+1), l = {}", l), factor, std::sqrt(factor),
                    l == 0 ? "Q_00 = M/sqrt(4 pi) must give -G M/r: 4 pi/(2l + 1), not its square root"
                           : "the same for the quadrupole"});
  }
  return rows;
}

int degree_wanted(const LoadedMass& input, const Options& options) {
  if (options.lmax >= 0) {
    if (input.coefficients && options.lmax > input.coefficients->lmax)
      throw Error(Fault::bad_argument, fmt::format("--order {}: the file's coefficients end at degree {}", options.lmax,
                                                   input.coefficients->lmax));
    return options.lmax;
  }
  return input.mesh ? usual_degree : std::min(input.coefficients->lmax, largest_potential_degree);
}

Findings solve(const PhysicsCall& call, const Options& options, const Common& common) {
  check_options(call, options);
  std::unique_ptr<AtomicFile> file;
  if (!options.output.empty()) file = std::make_unique<AtomicFile>(options.output);
  ConsoleMonitor monitor(common.style());
  const LoadedMass input = load_mass(call.body, Motion::held, monitor);
  std::string note;
  // The closed form is computed in 80-bit numbers, which no device has.
  const bool on_device = !options.exact;
  const auto backend = on_device ? open_backend(common, &note) : make_cpu_backend(common.threads);
  if (!on_device && common.device != "auto" && common.device != "cpu")
    note =
        fmt::format("--device {} is not used: the closed form of the polyhedron is computed in 80-bit arithmetic, on "
                    "the CPU",
                    common.device);
  if (!common.quiet && !note.empty()) say(fmt::format("cowgpu: {}\n", note));
  if (options.errors)
    return series_errors_found(input, {options.orders, options.distances, options.plots}, *backend, common.threads,
                               monitor);

  Solved s;
  s.lmax = options.exact ? 0 : degree_wanted(input, options);
  const Multipoles own = moments(input, s.lmax, *backend, monitor);
  const bool si = input.units.stated;
  s.units = units_of(si, call.body.charge);
  s.frame = {own.origin, own.reference_radius, si};
  s.radius_known = input.mesh || input.coefficients->brillouin_radius;
  if (input.coefficients) s.reference_radius = *input.coefficients->reference_radius * input.units.metre;
  const auto check_count = [&](std::size_t count) {
    MemoryNeed need = backend->potential_memory(count, s.lmax, Derivatives(options.derivatives));
    need.host += 64 * count + (options.output.empty() ? 0 : potential_file_bytes(count));
    check_memory(need, *backend, options.exact ? "ask for fewer points" : "ask for fewer points or a lower --order");
  };
  check_count(count_places(options.places));
  s.places = read_places(options.places, s.frame);
  check_count(s.places.points.size());
  compute(input, options, own, *backend, common.threads, monitor, s);
  monitor.clear();
  apply_law(s.units.law, s.field);

  Findings found(subject(input));
  if (!note.empty()) found.notes.push_back(note);
  add_head(input, options, s, si, found);
  if (s.places.points.size() == 1) {
    add_one_point(s, found);
  } else {
    add_ranges(s, found);
    add_table(s, call.json, found);
  }
  found.rows.push_back({"device", "device", computed_by(s, *backend, common.threads)});
  if (call.paper) found.paper = beside_paper();
  if (file) {
    const PotentialTable table{found.input_name,   s.places.points, s.field,           s.exact,
                               s.units.law.charge, s.units.length,  s.units.potential, s.units.force,
                               s.units.tensor,     s.places.grid,   s.places.radius};
    write_potentials(table, file_format(options.output), *file, monitor);
    check_stop(monitor);
    file->commit();
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  }
  return found;
}

} // namespace

Solve add_potential(Command& command, Common& common, BodyOptions& body) {
  const auto options = std::make_shared<Options>();
  command
      .add_option("--at", options->places.at,
                  "X,Y,Z in the body's coordinates, or a text file of points, one a line (- for standard input)")
      ->type_name("POINTS");
  command
      .add_option(
          "--sphere", options->places.sphere,
          "A sphere about the origin, of radius R: a length, or 1.5R for multiples of the sphere that holds the body "
          "(of the reference radius of a file that does not say it)")
      ->type_name("R");
  command.add_option("--resolution", options->places.resolution, "Rings of the Gauss-Legendre grid of --sphere")
      ->check(in_range(1, largest_grid_degree + 1))
      ->capture_default_str()
      ->type_name("N");
  command
      .add_option(
          "--plane", options->places.plane,
          "A plane AXIS,OFFSET,EXTENT,N: across x, y or z, OFFSET from the origin, EXTENT to all sides, N x N points")
      ->type_name("PLANE");
  command
      .add_option("--order,--lmax", options->lmax,
                  fmt::format("Degree that the series goes to (default {}, of a file all it has)", usual_degree))
      ->check(in_range(0, largest_potential_degree))
      ->type_name("L");
  command
      .add_option("--derivatives", options->derivatives,
                  "0 potential, 1 acceleration too, 2 the acceleration's gradient too")
      ->check(in_range(0, 2))
      ->capture_default_str()
      ->type_name("N");
  command
      .add_option("--inside", options->inside,
                  "Points inside the sphere that holds the body: refuse, or exact, the polyhedron's closed form")
      ->check(one_of({"refuse", "exact"}))
      ->capture_default_str();
  command.add_flag("--exact", options->exact,
                   "The polyhedron's closed form everywhere, or where it is nearer to the truth (far away) its series");
  command.add_flag("--charge", body.charge, "--density is one of charge (C/m3): volts, and volts a metre");
  command.add_flag("--errors", options->errors,
                   "Instead of the field, relative errors of the series against the polyhedron, by distance and order");
  command.add_option("--orders", options->orders, "Orders of --errors, such as 0..4,8")
      ->capture_default_str()
      ->allow_extra_args(false)
      ->type_name("LIST");
  command
      .add_option("--distances", options->distances,
                  "Distances of --errors, in radii of the sphere that holds the body")
      ->capture_default_str()
      ->type_name("LIST");
  command.add_option("--plot", options->plots, "Picture of what --errors finds: FILE.png or FILE.svg; can be repeated")
      ->allow_extra_args(false)
      ->type_name("FILE");
  command.add_option("-o,--output", options->output, "Point by point: FILE.csv or FILE.nc")->type_name("FILE");
  add_common_options(command, common);
  return [options, &common](const PhysicsCall& call) { return solve(call, *options, common); };
}

} // namespace cowgpu::cli
