// Verifies the stage `moments`, then times it: against a lattice quadrature at degree 32, and alone up to degree 2048.
// How to read the output stands in bench/moments.md.
#include "bench/moments_quadrature.hpp"
#include "bench/report.hpp"
#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/subdivide.hpp"
#include "host/parallel.hpp"
#include "host/plan/moments.hpp"
#include "host/reference/moments.hpp"
#include "tests/support/bound_errors.hpp"

#include "bench/command_line.hpp"
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <utility>

namespace cowgpu::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double flops_per_element = 60;
constexpr int rival_lmax = 32, reference_lmax = 64;
constexpr double reference_tolerance = 1e-22;
constexpr double year = 365.25 * 86400;

using test::BoundErrors, test::compare_by_bound;

// What correct paths agree to on the cow: the rounding of a vertex enters a degree l with the factor l.
double expected_error(int lmax) {
  return 3e-14 * std::max(1.0, lmax / 512.0);
}

struct Options {
  std::string mesh, instruction_set;
  bool quick = false, json = false, shapes = false;
  int runs = 0;
  GpuOptions gpu;
};

std::string milliseconds(double seconds) {
  if (std::isnan(seconds)) return "-";
  return seconds < 0.1 ? fmt::format("{:.2f}", seconds * 1e3) : fmt::format("{:.0f}", seconds * 1e3);
}

// A way to compute moments, and the times it took.
struct Path {
  Path(std::string title, std::string json_key, std::unique_ptr<Backend> engine)
      : name(std::move(title)), key(std::move(json_key)), backend(std::move(engine)) {}

  std::string name, key;
  std::unique_ptr<Backend> backend;
  double peak = 0, first = 0; // first: seconds of the last run that was not timed
  std::vector<double> wall, kernel, setup;
  RunReport report;
  Multipoles result;

  void clear() {
    wall.clear();
    kernel.clear();
    setup.clear();
  }

  // One run; `timed` false for the first, which compiles and faults memory in.
  void run(const MomentProblem& problem, bool timed = true) {
    Monitor monitor;
    const auto start = Clock::now();
    result = backend->moments(problem)->run(monitor, &report);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (!timed) {
      first = seconds;
      return;
    }
    wall.push_back(seconds);
    setup.push_back(report.setup_seconds);
    double kernels = 0;
    for (const KernelTime& k : report.kernels) kernels += k.seconds;
    if (!report.kernels.empty()) kernel.push_back(kernels);
  }

  Json times() const {
    Json j = {{"median_s", median(wall)}, {"runs_s", wall}};
    if (!kernel.empty()) j["kernels_median_s"] = median(kernel);
    return j;
  }
};

class Bench : Report {
public:
  explicit Bench(const Options& options) : Report(options.json), options_(options) {
    runs_ = options.runs > 0 ? options.runs : (options.quick ? 3 : 7);
  }

  int run() {
    open();
    describe();
    if (verify()) {
      if (options_.shapes) {
        shapes();
      } else {
        against_lattice();
        alone();
      }
    }
    return finish();
  }

private:
  void open() {
    const ClosedSurface surface = ClosedSurface::from(benchmark_mesh(options_.mesh, "builtin:cow"));
    mesh_ = surface.mesh();
    base_.origin = centre_of_mass(surface);
    base_.reference_radius = brillouin_radius(surface, base_.origin);
    longest_side_ = bounding_box(surface).longest_side();

    const unsigned all = all_threads();
    paths_.emplace_back("CPU, 1 thread", "cpu_1", make_cpu_backend(1));
    paths_.emplace_back(fmt::format("CPU, {} threads", all), "cpu_all", make_cpu_backend(all));
    try {
      paths_.emplace_back("Vulkan", "vulkan", make_gpu_backend(options_.gpu));
    } catch (const Error& error) {
      if (error.fault() != Fault::no_loader && error.fault() != Fault::no_device && error.fault() != Fault::no_fp64)
        throw;
      no_vulkan_ = error.what();
    }
    for (Path& path : paths_)
      for (int i = 0; i < 5; ++i) path.peak = std::max(path.peak, path.backend->measured_peak());
  }

  MomentProblem problem(int lmax, double cut_off = default_cut_off) const {
    MomentProblem p = base_;
    p.vertices = mesh_.vertices;
    p.faces = mesh_.faces;
    p.lmax = lmax;
    p.cut_off = cut_off;
    return p;
  }

  void describe() {
    const std::string date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
    document_ = {{"benchmark", "moments"},
                 {"date", date},
                 {"mesh", {{"name", mesh_.name}, {"sha256", mesh_.sha256}, {"triangles", mesh_.faces.size()}}},
                 {"runs", runs_},
                 {"flops_per_element", flops_per_element}};
    say("Benchmark of moments, {}\n", date);
    say("mesh     {}, {} triangles, sha256 {}\n", mesh_.name, mesh_.faces.size(), mesh_.sha256);
    for (const Path& path : paths_) {
      const DeviceFacts& facts = path.backend->facts();
      say("{:<16} {}; {}; {}; {} lanes; multiply-add peak {:.1f} GFlop/s\n", path.name, facts.name, facts.driver,
          facts.api, facts.subgroup, path.peak * 1e-9);
      document_["paths"][path.key] = {{"name", path.name},  {"device", facts.name},    {"driver", facts.driver},
                                      {"api", facts.api},   {"lanes", facts.subgroup}, {"threads", facts.threads},
                                      {"type", facts.type}, {"peak_flops", path.peak}};
    }
    if (!no_vulkan_.empty()) {
      say("Vulkan           none: {}\n", no_vulkan_);
      document_["no_vulkan"] = no_vulkan_;
    }
    say("Times are medians of {} runs in milliseconds; the ways compared take turns.\n", runs_);
  }

  // Every path against extended precision and against each other; leaves the CPU's error at the rival's degree.
  bool verify() {
    say("\nVerification: worst error of a degree, relative to the degree's norm\n");
    const MomentProblem p = problem(reference_lmax);
    const std::vector<double> bound = plan::degree_bound(p);
    const std::vector<long double> truth = reference::moments<long double>(p, reference_tolerance);
    for (Path& path : paths_) {
      path.run(p, false);
      const BoundErrors errors = compare_by_bound(path.result, truth, bound);
      check(fmt::format("lmax {}, {}, against long double", reference_lmax, path.name), errors.worst,
            expected_error(reference_lmax));
    }
    agree(fmt::format("lmax {}", reference_lmax), p);

    const MomentProblem low = problem(rival_lmax);
    paths_[0].run(low, false);
    own_error_ = compare_by_bound(paths_[0].result, truth, plan::degree_bound(low)).worst;
    return check(fmt::format("lmax {}, {}, against long double", rival_lmax, paths_[0].name), own_error_,
                 expected_error(rival_lmax)) &&
           passed_;
  }

  // The paths' last results against each other: threads change no bit, Vulkan stays within the bound.
  bool agree(const std::string& what, const MomentProblem& p) {
    const bool same = paths_[0].result.values == paths_[1].result.values;
    bool good = check(fmt::format("{}, bits that differ between 1 and all threads", what), same ? 0 : 1, 0);
    if (paths_.size() > 2) {
      const BoundErrors errors = compare_by_bound(paths_[2].result, paths_[1].result, plan::degree_bound(p));
      good = check(fmt::format("{}, Vulkan against CPU", what), errors.worst, expected_error(p.lmax)) && good;
    }
    return good;
  }

  void against_lattice() {
    struct Lattice {
      int cells = 0;
      std::vector<double> one, all;
      LatticeMoments result;
      BoundErrors errors;
    };
    const MomentProblem p = problem(rival_lmax);
    const std::vector<double> bound = plan::degree_bound(p);
    std::vector<Lattice> lattices;
    for (const int cells : options_.quick ? std::vector{16, 32, 64} : std::vector{16, 32, 64, 128, 256})
      lattices.push_back({cells, {}, {}, {}, {}});
    for (Path& path : paths_) {
      path.clear();
      path.run(p, false);
    }
    const unsigned threads = all_threads();
    for (int round = 0; round < runs_; ++round) {
      for (Lattice& lattice : lattices) {
        const double spacing = longest_side_ / lattice.cells;
        lattice.one.push_back(lattice_moments(p, spacing, 1).seconds);
        lattice.result = lattice_moments(p, spacing, threads);
        lattice.all.push_back(lattice.result.seconds);
      }
      for (Path& path : paths_) path.run(p);
    }

    say("\nLattice quadrature at lmax {}: {} cells along the longest side; relative error of degrees\n", rival_lmax,
        "N");
    say("{:>5} {:>9} {:>10} {:>10}   {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "N", "inside", "1 thread",
        fmt::format("{} thr.", threads), "l=0", "l=2", "l=8", "l=16", "l=32", "worst");
    double x = 0, y = 0, xx = 0, xy = 0;
    for (Lattice& lattice : lattices) {
      lattice.errors = compare_by_bound(lattice.result.moments, paths_[0].result, bound);
      const auto& e = lattice.errors.relative;
      say("{:>5} {:>9} {:>10} {:>10}   {:8.1e} {:8.1e} {:8.1e} {:8.1e} {:8.1e} {:8.1e}\n", lattice.cells,
          lattice.result.cells, milliseconds(median(lattice.one)), milliseconds(median(lattice.all)), e[0], e[2], e[8],
          e[16], e[32], lattice.errors.worst);
      document_["lattice"].push_back({{"cells_along_longest_side", lattice.cells},
                                      {"cells_inside", lattice.result.cells},
                                      {"one_thread_s", median(lattice.one)},
                                      {"all_threads_s", median(lattice.all)},
                                      {"degree_errors", e},
                                      {"worst_error", lattice.errors.worst}});
      const double u = std::log(1.0 / lattice.cells), v = std::log(lattice.errors.worst);
      x += u;
      y += v;
      xx += u * u;
      xy += u * v;
    }
    const double n = double(lattices.size());
    const double fitted = (n * xy - x * y) / (n * xx - x * x);
    const Lattice& finest = lattices.back();
    check("the lattice's worst error, finest over coarsest", finest.errors.worst / lattices.front().errors.worst, 0.5);

    // In the rival's favour: at least order 2, the best that midpoints reach, although the surface cuts its cells.
    const double order = std::max(fitted, 2.0);
    const double growth = std::pow(finest.errors.worst / own_error_, 3 / order);
    say("Error falls with order {:.2f} in the spacing (fitted). The CPU path's error is {:.1e}; extrapolated with "
        "order "
        "{:.2f},\nthe lattice needs {:.1e} times the finest run's work for it: {:.0e} years on {} threads.\n",
        fitted, own_error_, order, growth, growth * median(finest.all) / year, threads);
    say("\n{:<18} {:>9}   {:>28} {:>28}\n", fmt::format("lmax {}", rival_lmax), "time",
        fmt::format("lattice N={} / ours", finest.cells), "same accuracy (extrapolated)");
    document_["extrapolation"] = {
        {"fitted_order", fitted},  {"order_used", order},
        {"own_error", own_error_}, {"lattice_error", finest.errors.worst},
        {"work_factor", growth},   {"years_on_all_threads", growth * median(finest.all) / year}};
    for (const Path& path : paths_) {
      const bool one = &path == &paths_[0]; // one thread is compared with one thread
      const double ratio = median_ratio(one ? finest.one : finest.all, path.wall);
      say("{:<18} {:>9}   {:>28} {:>28}\n", path.name, milliseconds(median(path.wall)), fmt::format("{:.3g}", ratio),
          fmt::format("{:.0e}", ratio * growth));
      Json j = path.times();
      j["lattice_over_ours"] = ratio;
      j["lattice_over_ours_at_same_accuracy"] = ratio * growth;
      document_["against_lattice"][path.key] = j;
    }
  }

  void alone() {
    RawMesh split = mesh_;
    for (int i = 0; i < 3; ++i) split = split_midpoint(split);
    struct Case {
      std::string name;
      MomentProblem problem;
    };
    std::vector<Case> cases = {{"lmax 64", problem(64)}, {"lmax 128", problem(128)}, {"lmax 512", problem(512)}};
    if (!options_.quick) {
      cases.push_back({"lmax 512, no cut-off", problem(512, 0)});
      cases.push_back({"lmax 1024", problem(1024)});
      cases.push_back({"lmax 2048", problem(2048)});
      cases.push_back({"lmax 128, split 3 times", problem(128)});
      cases.back().problem.vertices = split.vertices;
      cases.back().problem.faces = split.faces;
      // A midpoint is rounded, and may lie that much outside.
      cases.back().problem.reference_radius *= 1 + 1e-15;
    }
    say("\nOur paths alone. GFlop/s: {} flops an element, elements as evaluated, over the wall time; peak: share of "
        "the "
        "measured\nmultiply-add peak; kept: elements over those without cut-off; setup: planning on the host; kernels: "
        "time on the device\nand its share of the peak; last column: wall over that of one thread\n",
        flops_per_element);
    for (const Case& c : cases) {
      for (Path& path : paths_) {
        path.clear();
        path.run(c.problem, false);
      }
      say("\n{}, {} triangles\n", c.name, c.problem.faces.size());
      if (!agree(c.name, c.problem)) continue;
      for (int round = 0; round < runs_; ++round)
        for (Path& path : paths_) path.run(c.problem);
      Json j = {{"name", c.name},
                {"lmax", c.problem.lmax},
                {"triangles", c.problem.faces.size()},
                {"cut_off", c.problem.cut_off}};
      say("  {:<18} {:>9} {:>9} {:>8} {:>6} {:>8} {:>9} {:>7} {:>10}\n", "", "wall", "GFlop/s", "peak", "kept", "setup",
          "kernels", "peak", "/CPU 1 th.");
      for (const Path& path : paths_) {
        const double flops = flops_per_element * path.report.elements, wall = median(path.wall);
        const double on_device = median(path.kernel);
        const std::string share =
            path.kernel.empty() ? "-" : fmt::format("{:.0f} %", 100 * flops / on_device / path.peak);
        const double kept = path.report.elements / path.report.full_elements;
        const double ratio = median_ratio(path.wall, paths_[0].wall);
        say("  {:<18} {:>9} {:>9.1f} {:>6.0f} % {:>4.0f} % {:>8} {:>9} {:>7} {:>10.2f}\n", path.name,
            milliseconds(wall), flops / wall * 1e-9, 100 * flops / wall / path.peak, 100 * kept,
            milliseconds(median(path.setup)), milliseconds(on_device), share, ratio);
        j["paths"][path.key] = path.times();
        j["paths"][path.key].update({{"elements", path.report.elements},
                                     {"full_elements", path.report.full_elements},
                                     {"setup_s", median(path.setup)},
                                     {"flops_per_s", flops / wall},
                                     {"peak_share", flops / wall / path.peak},
                                     {"over_cpu_1", ratio}});
      }
      document_["alone"].push_back(j);
    }
  }

  // The layouts of the Vulkan kernels side by side.
  void shapes() {
    if (paths_.size() < 3) return;
    const MomentProblem p = problem(options_.quick ? 128 : 512);
    const std::vector<double> bound = plan::degree_bound(p);
    std::vector<Path> all;
    const auto add = [&](std::uint32_t levels, std::uint32_t workgroups, bool in_buffer) {
      GpuOptions gpu = options_.gpu;
      gpu.levels = levels;
      gpu.workgroups = workgroups;
      gpu.rows_in_buffer = in_buffer;
      all.emplace_back(fmt::format("{:>6} {:>10}  {}", levels, workgroups, in_buffer ? "buffer " : "private"), "",
                       make_gpu_backend(gpu));
    };
    for (const std::uint32_t levels : {2U, 4U, 8U, 16U})
      for (const std::uint32_t workgroups : {2U, 4U, 8U, 16U}) add(levels, workgroups, false);
    for (const std::uint32_t levels : {4U, 8U})
      for (const std::uint32_t workgroups : {4U, 16U}) add(levels, workgroups, true);
    paths_[1].run(p, false);
    bool good = true;
    for (Path& path : all) {
      path.run(p, false);
      const double error = compare_by_bound(path.result, paths_[1].result, bound).worst;
      good = check("levels, workgroups, rows: " + path.name, error, expected_error(p.lmax)) && good;
    }
    if (!good) return;
    for (int round = 0; round < runs_; ++round)
      for (Path& path : all) path.run(p);
    say("\nlmax {}: first run (compiles, unless the driver's cache has the shader), wall, kernels\n", p.lmax);
    say("{:>6} {:>10}  {:<7} {:>9} {:>9} {:>9}\n", "levels", "workgroups", "rows", "first", "wall", "kernels");
    for (const Path& path : all) {
      say("{} {:>9} {:>9} {:>9}\n", path.name, milliseconds(path.first), milliseconds(median(path.wall)),
          milliseconds(median(path.kernel)));
      Json j = path.times();
      j["shape"] = path.name;
      j["first_s"] = path.first;
      document_["shapes"].push_back(j);
    }
  }

  Options options_;
  int runs_ = 1;
  RawMesh mesh_;
  MomentProblem base_;
  double longest_side_ = 0;
  double own_error_ = 0;
  std::vector<Path> paths_; // CPU with one thread, with all, and Vulkan if there is a device
  std::string no_vulkan_;
};

} // namespace
} // namespace cowgpu::bench

int main(int argc, char** argv) {
  using namespace cowgpu;
  bench::Options options;
  cli::CommandLine app("moments_bench",
                       "Verifies and times the stage moments: against a lattice quadrature, and alone.");
  app.add_option("mesh", options.mesh, "a mesh file or a name; without it cow.off of the catalogue, or builtin:cow");
  app.add_flag("--quick", options.quick, "three runs of the short cases");
  app.add_flag("--json", options.json, "print a JSON document");
  app.add_flag("--shapes", options.shapes, "time the layouts of the Vulkan kernels instead");
  app.add_option("--runs", options.runs, "runs of each case")->check(cli::positive_number());
  app.add_option("--device", options.gpu.device, "Vulkan device: auto, an index, or a part of its name");
  app.add_option("--levels", options.gpu.levels, "degrees a sweep of the Vulkan kernel advances");
  app.add_option("--workgroups", options.gpu.workgroups, "workgroups of the Vulkan kernel");
  app.add_flag("--rows-in-buffer", options.gpu.rows_in_buffer, "recursion rows in device memory");
  app.add_option("--instruction-set", options.instruction_set, "the widest the CPU path may use")
      ->check(cli::one_of({"AVX3", "AVX2", "SSE4", "SSSE3"}));
  if (const auto end = bench::read_command_line(app, argc, argv)) return *end;
  try {
    bench::use_instruction_set(options.instruction_set);
    return bench::Bench(options).run();
  } catch (const Error& error) {
    fmt::print(stderr, "moments_bench: {}\n", error.what());
    return exit_code(error.fault());
  } catch (const std::exception& error) {
    fmt::print(stderr, "moments_bench: {}\n", error.what());
    return 5;
  }
}
