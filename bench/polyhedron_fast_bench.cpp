// Verifies the fast sum of the verb `polyhedron` against sums in 80-bit arithmetic, then times it: the facets of a mesh on
// themselves. How to read the output stands in bench/polyhedron_fast.md.
#include "bench/polyhedron_crossover.hpp"
#include "bench/report.hpp"
#include "bench/resident.hpp"
#include "host/backend.hpp"
#include "host/clock.hpp"
#include "host/cpu/polyhedron_fast.hpp"
#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mesh/subdivide.hpp"
#include "host/plan/polyhedron_settings.hpp"
#include "host/reference/polyhedron.hpp"
#include "host/report/result.hpp"

#include "bench/command_line.hpp"
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

namespace cowgpu::bench {
namespace {

constexpr std::size_t verified = 400; // points held against the reference

struct Options {
  std::string mesh;
  int splits = 2, runs = 3;
  double tolerance = 0;
  unsigned threads = 0;
  bool guarantee = false, tensor = false, device = false, everywhere = false, crossover = false, lists = false,
       json = false;
};

// ESA's polyhedral-gravity-model 3.3.1 (J. Schuhmacher et al., 2024) as shipped, V, gradient and second derivatives of 5,520
// faces at 1,000 points outside, on two threads of a Zen 5 with AVX-512: faces times points a second.
constexpr double peer_rate = 6.80e6;

// Double-precision instructions of a face at a point on a GPU, as bench/polyhedron.md counts them.
constexpr double face_operations = 150;

// One row: what is asked for of all centroids.
struct Way {
  double tolerance;
  bool guarantee, tensor, device;
};

// Parts of the tolerance: of the gradient over v/R^2, of V over v/R.
struct Errors {
  double gradient = 0, value = 0, bound = 0;
  bool bounded = true; // every point's error by its bound, but for rounding
};

class Bench : Report {
public:
  explicit Bench(const Options& options) : Report(options.json), options_(options) {}

  int run() {
    const RawMesh whole = benchmark_mesh(options_.mesh, "builtin:cow@1");
    mesh_ = whole;
    for (int i = 0; i < options_.splits; ++i) mesh_ = split_midpoint(mesh_);
    if (options_.lists) return polyhedron_lists(mesh_, options_.guarantee);
    document_ = {{"benchmark", "polyhedron_fast"},
                 {"faces", mesh_.faces.size()},
                 {"runs", options_.runs},
                 {"results", Json::array()}};
    for (const Face& f : mesh_.faces)
      points_.push_back((mesh_.vertices[f[0]] + mesh_.vertices[f[1]] + mesh_.vertices[f[2]]) / 3);
    find_truth(whole);
    if (options_.device) {
      gpu_ = make_gpu_backend({});
      say("device: {}\n", device_line(gpu_->facts()));
    }
    say("{}, split {} times: {} faces at their centroids, median of {} runs with set-up\n", whole.name, options_.splits,
        mesh_.faces.size(), options_.runs);
    say("{:<16} {:>8} {:>9} {:>7} {:>10} {:>8} {:>7} {:>7} {:>6} {:>8} {:>8}\n", "tolerance", "wall s", "core s",
        "us a pt", "as direct", "x ESA", "g", "V", "bound", "near", "MB of");
    for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
      if (options_.tolerance != 0 && options_.tolerance != tolerance) continue;
      time({tolerance, false, false, false});
      if (options_.guarantee) time({tolerance, true, false, false});
      if (options_.tensor) time({tolerance, false, true, false});
      if (gpu_) time({tolerance, false, false, true});
    }
    say("us a pt: of a core; as direct: faces times points over wall time, in millions a second; g, V: largest errors, "
        "and\n"
        "bound: the largest, in parts of the tolerance; near: faces whose closed form a point takes; MB: most that "
        "was\n"
        "resident, of what memory() says\n"
        "operations a point: about {:.0f} double-precision instructions on a GPU for a near face, and the "
        "translations' multiply-adds\n",
        face_operations);
    return finish();
  }

private:
  // The surface is the same before it is split, with fewer faces.
  void find_truth(const RawMesh& whole) {
    double volume = 0;
    for (const Face& f : whole.faces)
      volume += whole.vertices[f[0]].dot(whole.vertices[f[1]].cross(whole.vertices[f[2]])) / 6;
    radius_ = std::cbrt(0.75 * volume * std::numbers::inv_pi);
    volume_ = volume;
    std::mt19937 random(17);
    std::uniform_int_distribution<std::size_t> any(0, points_.size() - 1);
    const reference::Polyhedron<long double> reference(whole.vertices, whole.faces);
    for (std::size_t i = 0; i < verified; ++i) {
      where_.push_back(any(random));
      const reference::PolyhedronAt<long double> at = reference.at(points_[where_.back()]);
      value_.push_back(double(at.value));
      gradient_.push_back(at.gradient.cast<double>());
    }
    if (!options_.everywhere) return;
    PolyhedronProblem problem;
    problem.vertices = whole.vertices;
    problem.faces = whole.faces;
    const PolyhedronValues all = make_cpu_backend(options_.threads)->polyhedron(problem)->at(points_, silent_monitor());
    double apart = 0;
    for (std::size_t i = 0; i < verified; ++i)
      apart = std::max(apart, (all.field.gradient[where_[i]] - gradient_[i]).norm() * radius_ * radius_ / volume_);
    check("direct sum, which is the truth everywhere: gradient", apart, 1e-14);
    where_.resize(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) where_[i] = i;
    value_ = all.field.value;
    gradient_ = all.field.gradient;
  }

  Errors errors(const Way& way, const PolyhedronValues& found) const {
    Errors worst;
    const double weight = volume_ / (radius_ * radius_);
    const auto larger = [](double error, double& most) {
      if (!(error <= most)) most = error;
    };
    for (std::size_t i = 0; i < where_.size(); ++i) {
      const double off = (found.field.gradient[where_[i]] - gradient_[i]).norm() / weight;
      larger(off / way.tolerance, worst.gradient);
      larger(std::abs(found.field.value[where_[i]] - value_[i]) * radius_ / volume_ / way.tolerance, worst.value);
      if (way.guarantee) worst.bounded = worst.bounded && off <= found.bound[where_[i]] / weight + 3e-14;
    }
    for (const double bound : found.bound) larger(bound / weight / way.tolerance, worst.bound);
    return worst;
  }

  // A time is told of values that were verified.
  void time(const Way& way) {
    PolyhedronProblem problem;
    problem.vertices = mesh_.vertices;
    problem.faces = mesh_.faces;
    problem.tolerance = way.tolerance;
    problem.guarantee = way.guarantee;
    problem.derivatives = way.tensor ? Derivatives::second : Derivatives::first;
    const std::string name = fmt::format("{:.0e}{}", way.tolerance,
                                         way.guarantee ? ", proven"
                                         : way.tensor  ? ", tensor"
                                         : way.device  ? ", device"
                                                       : "");
    std::vector<double> seconds, used;
    RunReport report;
    Errors worst;
    double need = 0, peak = 0;
    for (int run = 0; run < options_.runs; ++run) {
      Resident resident;
      const double before = processor_seconds();
      const auto prepared = way.device ? gpu_->polyhedron(problem) : cpu::fast_polyhedron(problem, options_.threads);
      const PolyhedronValues found = prepared->at(points_, silent_monitor(), &report);
      used.push_back(processor_seconds() - before);
      seconds.push_back(report.seconds);
      if (run > 0) continue;
      peak = resident.most();
      need = double(prepared->memory(points_.size()).host);
      worst = errors(way, found);
    }
    const double wall = median(seconds), core = median(used), count = double(points_.size());
    const double rate = report.full_elements / wall;
    say("{:<16} {:>8.3f} {:>9.3f} {:>7.1f} {:>10.0f} {:>8.0f} {:>7.3f} {:>7.3f} {:>6.2f} {:>8.0f} {:>4.0f} of {:.0f}\n",
        name, wall, core, 1e6 * core / count, rate / 1e6, rate / peer_rate, worst.gradient, worst.value, worst.bound,
        report.elements / count, peak / 1e6, need / 1e6);
    for (const KernelTime& kernel : report.kernels)
      say("  {:<20} {:>8} dispatches, {:.3f} s\n", kernel.kernel, kernel.dispatches, kernel.seconds);
    if (way.device)
      say("  operations a point: {:.0f} near by, {:.0f} of {:.2f} pairs of cells\n",
          face_operations * report.elements / count, report.multiply_adds / count, double(report.pairs) / count);
    check(name + ": gradient", worst.gradient * way.tolerance, way.tolerance);
    check(name + ": V", worst.value * way.tolerance, way.tolerance);
    if (way.guarantee) check(name + ": largest bound", worst.bound * way.tolerance, way.tolerance);
    // Bounds leave out rounding, and so that of single precision.
    const bool single = plan::fast_settings(problem).near == plan::NearDigits::single;
    if (way.guarantee && !single) check(name + ": errors above their bounds", worst.bounded ? 0 : 1, 0);
    check(name + ": memory over what was told", peak / need, 1);
    document_["results"].push_back({{"tolerance", way.tolerance},
                                    {"guarantee", way.guarantee},
                                    {"second_derivatives", way.tensor},
                                    {"seconds", wall},
                                    {"core_seconds", core},
                                    {"gradient_error", worst.gradient * way.tolerance},
                                    {"value_error", worst.value * way.tolerance},
                                    {"bound", worst.bound * way.tolerance},
                                    {"near_faces", report.elements / count},
                                    {"resident", peak},
                                    {"memory", need}});
  }

  Options options_;
  std::unique_ptr<Backend> gpu_;
  RawMesh mesh_;
  double volume_ = 0, radius_ = 0;
  std::vector<Vec3> points_, gradient_;
  std::vector<double> value_;
  std::vector<std::size_t> where_; // the points whose truth is known
};

} // namespace
} // namespace cowgpu::bench

int main(int argc, char** argv) {
  using namespace cowgpu;
  bench::Options options;
  cli::CommandLine app("polyhedron_fast_bench", "Verifies and times the fast sum of the verb polyhedron");
  app.add_option("mesh", options.mesh, "A mesh file or a name; without it cow.off of the catalogue, or builtin:cow@1");
  app.add_option("--splits", options.splits, "Splits at midpoints")->check(cli::in_range(0, 5));
  app.add_option("--tolerance", options.tolerance, "1e-6, 1e-9 or 1e-12 alone");
  app.add_option("--runs", options.runs, "Runs; medians are shown")->check(cli::in_range(1, 1000));
  app.add_option("--threads", options.threads, "0: all");
  app.add_flag("--guarantee", options.guarantee, "With proven bounds too");
  app.add_flag("--tensor", options.tensor, "With second derivatives too");
  app.add_flag("--device", options.device, "The Vulkan path too");
  app.add_flag("--everywhere", options.everywhere,
               "Errors at all points, against the direct sum of the mesh before it is split");
  app.add_flag("--crossover", options.crossover, "Times the direct sum against the fast one at small sizes instead");
  app.add_flag("--lists", options.lists, "Tells instead what the lists of pairs take");
  app.add_flag("--json", options.json, "As JSON");
  if (const auto end = bench::read_command_line(app, argc, argv)) return *end;
  try {
    if (options.crossover)
      return bench::polyhedron_crossover({options.runs, options.threads, options.guarantee, options.tensor});
    return bench::Bench(options).run();
  } catch (const Error& error) {
    fmt::print(stderr, "polyhedron_fast_bench: {}\n", error.what());
    return 1;
  }
}
