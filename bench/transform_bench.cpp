// Verifies the verbs `synthesise` and `analyse`, then times them against libsharp on the same grid in the same run. How
// to read the output stands in bench/transforms.md.
#include "bench/report.hpp"
#include "host/backend.hpp"
#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "tests/support/libsharp.hpp"

#include "bench/command_line.hpp"
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <omp.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <utility>

namespace cowgpu::bench {
namespace {

constexpr double map_tolerance = 1e-11; // against libsharp, of the largest value, to degree 1024
constexpr double slow_call = 1;         // seconds; slower cases get fewer rounds

struct Options {
  std::vector<int> degrees = {255, 511, 1023, 2047}, fields = {1, 3};
  int runs = 9;
  std::string device = "auto", instruction_set;
  bool json = false, growth = false;
};

// OMP_PROC_BIND pins the first thread when OpenMP's library is loaded. While one of these lives it may run anywhere, and
// so may the threads that it starts.
class Unbound {
public:
  Unbound() {
    CPU_ZERO(&saved_);
    sched_getaffinity(0, sizeof saved_, &saved_);
    cpu_set_t all;
    CPU_ZERO(&all);
    for (int place = 0; place < omp_get_num_places(); ++place) {
      std::vector<int> ids(std::size_t(omp_get_place_num_procs(place)));
      omp_get_place_proc_ids(place, ids.data());
      for (const int id : ids) CPU_SET(id, &all);
    }
    if (CPU_COUNT(&all) > 0) sched_setaffinity(0, sizeof all, &all);
  }
  ~Unbound() { sched_setaffinity(0, sizeof saved_, &saved_); }
  Unbound(const Unbound&) = delete;
  Unbound& operator=(const Unbound&) = delete;

private:
  cpu_set_t saved_;
};

// Times of one direction of one way, a call each.
struct Times {
  std::vector<double> wall, legendre, fourier;
  TransformReport last;

  void add(const TransformReport& report) {
    wall.push_back(report.seconds);
    legendre.push_back(report.legendre_seconds);
    fourier.push_back(report.fourier_seconds);
    last = report;
  }
};

// One of our engines.
struct Path {
  std::string name, key;
  std::unique_ptr<Backend> backend;
  double peak = 0;

  std::unique_ptr<SphereTransform> transform; // of the case at hand
  double setup = 0;
  std::string why_not; // there is no transform
  std::vector<double> values;
  std::vector<std::complex<double>> coefficients;
  Times synthesis, analysis;
};

class Bench : Report {
public:
  explicit Bench(const Options& options) : Report(options.json), options_(options) {}

  int run() {
    open();
    describe();
    if (options_.growth) {
      growth();
    } else {
      for (const int lmax : options_.degrees)
        for (const int fields : options_.fields) compare(lmax, fields);
    }
    return finish();
  }

private:
  void open() {
    const Unbound unbound;
    threads_ = unsigned(omp_get_max_threads());
    paths_.push_back(
        {fmt::format("CPU, {} threads", threads_), "cpu", make_cpu_backend(threads_), 0, {}, 0, {}, {}, {}, {}, {}});
    if (options_.device != "none") {
      try {
        GpuOptions gpu;
        gpu.device = options_.device;
        paths_.push_back({"Vulkan", "vulkan", make_gpu_backend(gpu), 0, {}, 0, {}, {}, {}, {}, {}});
      } catch (const Error& error) {
        no_vulkan_ = error.what();
      }
    }
    for (Path& path : paths_)
      for (int i = 0; i < 5; ++i) path.peak = std::max(path.peak, path.backend->measured_peak());
  }

  void describe() {
    const std::string date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
    document_ = {{"benchmark", "transform"}, {"date", date}, {"runs", options_.runs}, {"threads", threads_}};
    say("Benchmark of the sphere transforms, {}\n", date);
    for (const Path& path : paths_) {
      const DeviceFacts& facts = path.backend->facts();
      say("{:<16} {}; {}; {}; multiply-add peak {:.1f} GFlop/s\n", path.name, facts.name, facts.driver, facts.api,
          path.peak * 1e-9);
      document_["paths"][path.key] = {{"name", path.name}, {"device", facts.name}, {"driver", facts.driver},
                                      {"api", facts.api},  {"type", facts.type},   {"peak_flops", path.peak}};
    }
    if (!no_vulkan_.empty()) say("Vulkan           none: {}\n", no_vulkan_);
    const char* wait = std::getenv("OMP_WAIT_POLICY");
    say("libsharp         {} threads of OpenMP, {}, waiting {}\n", threads_,
        omp_get_proc_bind() == omp_proc_bind_false ? "not bound" : "bound", wait ? wait : "as it likes");
    document_["libsharp"] = {{"threads", threads_},
                             {"bound", omp_get_proc_bind() != omp_proc_bind_false},
                             {"wait_policy", wait ? wait : ""}};
    say("Times are medians of {} calls in milliseconds; the ways compared take turns, ratios are medians of those of "
        "one round.\nShares are of the measured multiply-add peak.\n",
        options_.runs);
  }

  // Prepares every path; says which has no transform.
  void prepare(const SphereGrid& grid, int lmax) {
    const Unbound unbound;
    for (Path& path : paths_) {
      path.transform.reset();
      path.synthesis = path.analysis = {};
      path.why_not.clear();
      std::vector<double> times;
      try {
        for (int i = 0; i < 3; ++i) {
          path.transform.reset();
          const auto start = Clock::now();
          path.transform = path.backend->sphere_transform(grid, lmax);
          path.transform->prepare();
          times.push_back(seconds_since(start));
          if (times.back() > slow_call) break;
        }
      } catch (const Error& error) {
        path.why_not = error.what();
        say("  {}: no transform: {}\n", path.name, path.why_not);
      }
      path.setup = median(times);
    }
  }

  // Without the rings next to the poles: there libsharp's cos theta, rounded to double, costs lmax^2 times that rounding.
  static double largest_difference(const std::vector<double>& a, const std::vector<double>& b, const SphereGrid& grid) {
    double difference = 0, largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const std::size_t ring = i % grid.points() / std::size_t(grid.ring_length);
      const double error = std::abs(a[i] - b[i]);
      if (ring > 0 && ring + 1 < std::size_t(grid.rings) && !(error <= difference)) difference = error;
      largest = std::max(largest, std::abs(b[i]));
    }
    return difference / largest;
  }

  // Relative to the largest value: on the first and last ring, where libsharp's cos theta, rounded to double, costs
  // lmax^2 times that rounding, and on the others.
  static std::pair<double, double> map_differences(const std::vector<double>& a, const std::vector<double>& b,
                                                   const SphereGrid& grid) {
    double near_poles = 0, elsewhere = 0, largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const std::size_t ring = i % grid.points() / std::size_t(grid.ring_length);
      double& worst = ring == 0 || ring + 1 == std::size_t(grid.rings) ? near_poles : elsewhere;
      const double error = std::abs(a[i] - b[i]);
      if (!(error <= worst)) worst = error; // NaN stays
      largest = std::max(largest, std::abs(b[i]));
    }
    return {near_poles / largest, elsewhere / largest};
  }

  template <class Value>
  static double largest_difference(const std::vector<Value>& a, const std::vector<Value>& b) {
    double difference = 0, largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double error = std::abs(a[i] - b[i]);
      if (!(error <= difference)) difference = error; // NaN stays
      largest = std::max(largest, std::abs(b[i]));
    }
    return difference / largest;
  }

  // Threads that are still awake after a call would slow the next one.
  static void settle() {
    const auto start = Clock::now();
    while (seconds_since(start) < 2e-4) {
    }
  }

  void call(Path& path, int fields, const std::vector<std::complex<double>>& coefficients, bool timed) {
    const Unbound unbound;
    Monitor monitor;
    TransformReport report;
    settle();
    path.transform->synthesise(fields, coefficients, path.values, monitor, &report);
    if (timed) path.synthesis.add(report);
    settle();
    path.transform->analyse(fields, path.values, path.coefficients, monitor, &report);
    if (timed) path.analysis.add(report);
  }

  static double timed(const std::function<void()>& body) {
    settle();
    const auto start = Clock::now();
    body();
    return seconds_since(start);
  }

  void compare(int lmax, int fields) {
    say("\nlmax {}, {} field{}\n", lmax, fields, fields == 1 ? "" : "s");
    auto start = Clock::now();
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, lmax);
    const double grid_seconds = seconds_since(start);
    prepare(grid, lmax);
    const support::Libsharp rival(grid, lmax);
    const auto coefficients = random_coefficients(lmax, fields, 1).values;
    const std::size_t points = grid.points(), count = SphereCoefficients::count(lmax);
    std::vector<double> values(std::size_t(fields) * points);
    std::vector<std::complex<double>> back(coefficients.size());
    const auto rival_synthesis = [&] {
      for (std::size_t f = 0; f < std::size_t(fields); ++f)
        rival.synthesise(&coefficients[f * count], &values[f * points]);
    };
    const auto rival_analysis = [&] {
      for (std::size_t f = 0; f < std::size_t(fields); ++f) rival.analyse(&values[f * points], &back[f * count]);
    };

    double slowest = timed(rival_synthesis);
    rival_analysis();
    bool good = check("libsharp, round trip", largest_difference(back, coefficients), 1e-10);
    for (Path& path : paths_) {
      if (!path.transform) continue;
      path.values.assign(values.size(), 0);
      path.coefficients.assign(back.size(), 0);
      call(path, fields, coefficients, false);
      slowest = std::max(slowest, timed([&] { call(path, fields, coefficients, false); }) / 2);
      const auto [near_poles, elsewhere] = map_differences(path.values, values, grid);
      const double tolerance = map_tolerance * std::max(1.0, std::pow(lmax / 1024.0, 2));
      good = check(path.name + ", map against libsharp", elsewhere, tolerance) && good;
      good = check(path.name + ", the rings next to the poles", near_poles, 10 * tolerance) && good;
      good = check(path.name + ", round trip", largest_difference(path.coefficients, coefficients),
                   round_trip_bound(lmax)) &&
             good;
    }
    if (!good) return;

    const int runs = slowest > slow_call ? std::min(options_.runs, 3) : options_.runs;
    std::vector<double> synthesis, analysis;
    for (int round = 0; round < runs; ++round) {
      for (Path& path : paths_)
        if (path.transform) call(path, fields, coefficients, true);
      synthesis.push_back(timed(rival_synthesis));
      analysis.push_back(timed(rival_analysis));
    }
    table(lmax, fields, grid_seconds, synthesis, analysis);
  }

  void table(int lmax, int fields, double grid_seconds, const std::vector<double>& synthesis,
             const std::vector<double>& analysis) {
    Json j = {{"lmax", lmax}, {"fields", fields}, {"grid_s", grid_seconds}};
    say("  {:<28} {:>9} {:>9} {:>6} {:>9} {:>6} {:>15}\n", "", "ms", "Legendre", "share", "Fourier", "share",
        "libsharp / ours");
    const auto line = [&](const Path& path, const char* direction, const Times& times,
                          const std::vector<double>& rival) {
      const double legendre = median(times.legendre), fourier = median(times.fourier);
      const double ratio = median_ratio(rival, times.wall);
      say("  {:<28} {:>9.2f} {:>9.2f} {:>4.0f} % {:>9.2f} {:>4.0f} % {:>15.2f}\n", path.name + ", " + direction,
          1e3 * median(times.wall), 1e3 * legendre, 100 * times.last.legendre_flops / legendre / path.peak,
          1e3 * fourier, 100 * times.last.fourier_flops / fourier / path.peak, ratio);
      j["paths"][path.key][direction] = {{"median_s", median(times.wall)},
                                         {"legendre_s", legendre},
                                         {"legendre_peak_share", times.last.legendre_flops / legendre / path.peak},
                                         {"fourier_s", fourier},
                                         {"fourier_peak_share", times.last.fourier_flops / fourier / path.peak},
                                         {"libsharp_over_ours", ratio},
                                         {"runs_s", times.wall}};
    };
    for (const Path& path : paths_) {
      if (!path.transform) {
        j["paths"][path.key] = {{"why_not", path.why_not}};
        continue;
      }
      line(path, "synthesis", path.synthesis, synthesis);
      line(path, "analysis", path.analysis, analysis);
      j["paths"][path.key]["setup_s"] = path.setup;
    }
    say("  {:<28} {:>9.2f}\n  {:<28} {:>9.2f}\n", "libsharp, synthesis", 1e3 * median(synthesis), "libsharp, analysis",
        1e3 * median(analysis));
    say("  set-up: grid {:.1f} ms", 1e3 * grid_seconds);
    for (const Path& path : paths_)
      if (path.transform) say(", {} {:.1f} ms", path.name, 1e3 * path.setup);
    say("\n");
    j["libsharp"] = {{"synthesis_s", median(synthesis)},
                     {"analysis_s", median(analysis)},
                     {"synthesis_runs_s", synthesis},
                     {"analysis_runs_s", analysis}};
    document_["cases"].push_back(j);
  }

  // How cost and memory grow with the degree.
  void growth() {
    say("\nOne field. Cost: nanoseconds over (lmax + 1)^3; memory: bytes that a transform needs beside its input and "
        "output,\nover (lmax + 1)^2.\n");
    say("{:>6} {:<16} {:>10} {:>10} {:>10} {:>9} {:>9} {:>8} {:>10}\n", "lmax", "", "set-up ms", "synth. ms",
        "analys. ms", "synthesis", "analysis", "memory", "round trip");
    for (int lmax = 127; lmax <= 4096; lmax = lmax == 4095 ? 4096 : 2 * lmax + 1) {
      const SphereGrid grid = make_grid(GridKind::gauss_legendre, lmax);
      prepare(grid, lmax);
      const auto coefficients = random_coefficients(lmax, 1, 1).values;
      for (Path& path : paths_) {
        if (!path.transform) continue;
        path.values.assign(grid.points(), 0);
        path.coefficients.assign(coefficients.size(), 0);
        call(path, 1, coefficients, false);
        for (int run = 0; run < (lmax > 1100 ? 3 : options_.runs); ++run) call(path, 1, coefficients, true);
        const double error = largest_difference(path.coefficients, coefficients);
        const double n = lmax + 1, synthesis = median(path.synthesis.wall), analysis = median(path.analysis.wall);
        const MemoryNeed need = path.transform->memory(1);
        const double bytes = double(need.host + need.device);
        const bool good = error <= round_trip_bound(lmax);
        passed_ = passed_ && good;
        say("{:>6} {:<16} {:>10.1f} {:>10.2f} {:>10.2f} {:>9.3f} {:>9.3f} {:>8.1f} {:>10.1e}{}\n", lmax, path.name,
            1e3 * path.setup, 1e3 * synthesis, 1e3 * analysis, 1e9 * synthesis / (n * n * n),
            1e9 * analysis / (n * n * n), bytes / (n * n), error, good ? "" : "  FAILED");
        document_["growth"].push_back({{"lmax", lmax},
                                       {"path", path.key},
                                       {"setup_s", path.setup},
                                       {"synthesis_s", synthesis},
                                       {"analysis_s", analysis},
                                       {"memory_bytes", bytes},
                                       {"round_trip", error}});
        path.transform.reset();
      }
    }
  }

  Options options_;
  unsigned threads_ = 1;
  std::vector<Path> paths_; // the CPU, and Vulkan if there is a device
  std::string no_vulkan_;
};

// OpenMP reads its environment when it is loaded: bound threads that sleep between calls, or the rival's idle threads
// would take our time, and its own.
void set_up_openmp(char** argv) {
  const bool bound = std::getenv("OMP_PROC_BIND"), waits = std::getenv("OMP_WAIT_POLICY");
  if (bound && waits) return;
  setenv("OMP_PROC_BIND", "true", 0);
  setenv("OMP_WAIT_POLICY", "passive", 0);
  execv("/proc/self/exe", argv);
  throw Error(Fault::bad_argument,
              "the benchmark could not start itself again with OMP_PROC_BIND and OMP_WAIT_POLICY set: set "
              "them to true and passive yourself");
}

} // namespace
} // namespace cowgpu::bench

int main(int argc, char** argv) {
  using namespace cowgpu;
  bench::Options options;
  cli::CommandLine app("transform_bench", "Verifies and times the sphere transforms, against libsharp.");
  app.add_option("--lmax", options.degrees, "degrees")->delimiter(',');
  app.add_option("--fields", options.fields, "numbers of fields")->delimiter(',');
  app.add_option("--runs", options.runs, "calls of each case")->check(cli::positive_number());
  app.add_option("--device", options.device, "Vulkan device: auto, none, an index, or a part of its name");
  app.add_option("--instruction-set", options.instruction_set, "the widest the CPU path may use")
      ->check(cli::one_of({"AVX3", "AVX2", "SSE4", "SSSE3"}));
  app.add_flag("--json", options.json, "print a JSON document");
  app.add_flag("--growth", options.growth, "cost and memory to degree 4096 instead, without libsharp");
  if (const auto end = bench::read_command_line(app, argc, argv)) return *end;
  try {
    bench::set_up_openmp(argv);
    bench::use_instruction_set(options.instruction_set);
    return bench::Bench(options).run();
  } catch (const Error& error) {
    fmt::print(stderr, "transform_bench: {}\n", error.what());
    return exit_code(error.fault());
  } catch (const std::exception& error) {
    fmt::print(stderr, "transform_bench: {}\n", error.what());
    return 5;
  }
}
