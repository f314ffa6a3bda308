// Verifies the verb `flow`, then times its CPU path and its Vulkan path. How to read the output stands in bench/flow.md.
#include "bench/report.hpp"
#include "host/backend.hpp"
#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/spectrum/surface_distance.hpp"

#include "bench/command_line.hpp"
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <string>

namespace cowgpu::bench {
namespace {

struct Options {
  std::string mesh = "benchmark", instruction_set, device = "auto";
  std::size_t points = 525312, vulkan_points = 65536;
  double time = 0.2, tolerance = 1e-6;
  int runs = 3;
  unsigned threads = 0;
  bool json = false;
};

// One path at one number of points.
struct Way {
  std::string name, key;
  DistanceFlow* flow = nullptr;
  std::size_t points = 0;
  std::vector<double> wall, processor;
  FlowReport report;
};

class Bench : Report {
public:
  explicit Bench(const Options& options)
      : Report(options.json), options_(options), mesh_(ClosedSurface::from(load_mesh(options.mesh)).mesh()),
        cpu_(make_cpu_backend(options.threads)), cpu_flow_(cpu_->distance_flow(mesh_.vertices, mesh_.faces)) {
    const Box box = bounding_box(mesh_.vertices, mesh_.faces);
    diagonal_ = (box.max - box.min).norm();
  }

  int run() {
    open_gpu();
    const DeviceFacts& facts = cpu_->facts();
    const std::string date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
    document_ = {{"benchmark", "flow"},
                 {"date", date},
                 {"mesh", mesh_.name},
                 {"faces", mesh_.faces.size()},
                 {"time", options_.time},
                 {"tolerance", options_.tolerance},
                 {"runs", options_.runs},
                 {"device", facts.name},
                 {"driver", facts.driver},
                 {"threads", facts.threads},
                 {"vulkan_device", gpu_ ? gpu_->facts().name : ""},
                 {"vulkan_driver", gpu_ ? gpu_->facts().driver : ""}};
    say("Benchmark of the distance's flow, {}\n{}; {}; {} threads\n", date, facts.name, facts.driver, facts.threads);
    if (gpu_) say("Vulkan: {}; {}\n", gpu_->facts().name, gpu_->facts().driver);
    say("{}, {} triangles; forward to t = {}\n\n", mesh_.name, mesh_.faces.size(), options_.time);
    verify();
    time();
    return finish();
  }

private:
  // Where there is a Vulkan device it takes part.
  void open_gpu() {
    if (options_.device == "none") return;
    try {
      GpuOptions options;
      options.device = options_.device;
      gpu_ = make_gpu_backend(options);
      gpu_flow_ = gpu_->distance_flow(mesh_.vertices, mesh_.faces);
      gpu_flow_->prepare();
    } catch (const Error& error) {
      say("no Vulkan device: {}\n", error.what());
      gpu_.reset();
    }
  }

  FlowPoints flow(DistanceFlow& on, std::span<const Vec3> starts, std::span<const Vec3> normals, double tolerance,
                  FlowReport* report = nullptr) const {
    FlowOptions options;
    options.time = options_.time;
    options.tolerance = tolerance;
    Monitor silent;
    return on.flow(starts, normals, options, silent, report);
  }

  void verify() {
    const auto normals = vertex_normals(mesh_.vertices, mesh_.faces);
    const auto vertices = [&](double tolerance) { return flow(*cpu_flow_, mesh_.vertices, normals, tolerance); };
    const FlowPoints exact = vertices(1e-11);
    const auto deviations = [&](double tolerance) {
      const FlowPoints ends = vertices(tolerance);
      std::vector<double> apart;
      for (std::size_t v = 0; v < ends.positions.size(); ++v)
        apart.push_back((ends.positions[v] - exact.positions[v]).norm() / diagonal_);
      return apart;
    };
    const std::vector<double> tight = deviations(1e-9), usual = deviations(options_.tolerance);
    say("deviation of the vertices from tolerance 1e-11, of the diagonal, largest (median):\n");
    say("  tolerance {}: {:.1e} ({:.1e})\n", options_.tolerance, *std::max_element(usual.begin(), usual.end()),
        median(usual));
    document_["largest_deviation"] = *std::max_element(usual.begin(), usual.end());
    document_["median_deviation"] = median(usual);
    check("tolerance 1e-9", *std::max_element(tight.begin(), tight.end()), 1e-6);
    double ray = 0;
    std::size_t rays = 0;
    for (std::size_t v = 0; v < exact.flags.size(); ++v)
      if (exact.flags[v] == 0) {
        ++rays;
        ray = std::max(ray, std::abs(exact.distances[v] - options_.time));
      }
    check(fmt::format("d = t at the end of {} rays, of the diagonal", rays), ray / diagonal_, 1e-12);
    if (!gpu_flow_) return;
    const std::vector<Vec3> starts = area_samples(mesh_.vertices, mesh_.faces, 20000);
    const FlowPoints here = flow(*cpu_flow_, starts, {}, options_.tolerance),
                     there = flow(*gpu_flow_, starts, {}, options_.tolerance);
    std::size_t places = 0, flags = 0, bits = 0;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      places += !((here.positions[i] - there.positions[i]).norm() <= 1e-9 * diagonal_);
      bits += here.positions[i] != there.positions[i];
      flags += here.flags[i] != there.flags[i];
    }
    check("Vulkan from the CPU path: of 20000 points farther than 1e-9", double(places), 0);
    check("Vulkan from the CPU path: other flags", double(flags), 0);
    check("Vulkan from the CPU path: other bits", double(bits), 0);
  }

  void time() {
    const std::vector<Vec3> starts = area_samples(mesh_.vertices, mesh_.faces, options_.points);
    const std::size_t fewer = std::min(options_.points, options_.vulkan_points);
    const std::vector<Vec3> some = area_samples(mesh_.vertices, mesh_.faces, fewer);
    std::vector<Way> ways = {{"CPU", "cpu", cpu_flow_.get(), options_.points, {}, {}, {}}};
    if (gpu_flow_) {
      if (fewer < options_.points) ways.push_back({"CPU", "cpu_fewer", cpu_flow_.get(), fewer, {}, {}, {}});
      ways.push_back({"Vulkan", "vulkan", gpu_flow_.get(), fewer, {}, {}, {}});
    }
    for (int run = 0; run < options_.runs; ++run)
      for (Way& way : ways) {
        const auto start = Clock::now();
        const std::clock_t before = std::clock();
        (void)flow(*way.flow, way.points == starts.size() ? starts : some, {}, options_.tolerance, &way.report);
        way.wall.push_back(seconds_since(start));
        way.processor.push_back(double(std::clock() - before) / CLOCKS_PER_SEC);
      }
    say("\nfrom points on the surface, tolerance {}; medians of {} flows; the ways take turns\n", options_.tolerance,
        options_.runs);
    say("  {:<8}{:>9}{:>11}{:>16}{:>18}{:>15}{:>20}\n", "path", "points", "seconds", "processor time",
        "of it, us a point", "queries/point", "thousand queries/s");
    for (const Way& way : ways) report(way);
    if (ways.size() > 1) {
      const Way &here = ways[ways.size() - 2], &there = ways.back();
      const double ratio = median_ratio(there.wall, here.wall), work = median_ratio(there.processor, here.processor);
      say("  Vulkan over CPU at {} points: {:.2f} by the clock, {:.2f} by processor time\n", fewer, ratio, work);
      document_["vulkan_over_cpu"] = {{"wall", ratio}, {"processor", work}};
    }
  }

  void report(const Way& way) {
    const auto n = double(way.points);
    const double wall = median(way.wall), processor = median(way.processor), queries = double(way.report.queries);
    say("  {:<8}{:>9}{:>11.2f}{:>16.2f}{:>18.1f}{:>15.1f}{:>20.0f}\n", way.name, way.points, wall, processor,
        1e6 * processor / n, queries / n, queries / wall / 1e3);
    say("          {:.1f} % slid, {} stationary, {} from inside, {} restarted, {} unfinished; {:.1f} events and {:.1f} "
        "steps a point\n",
        100 * double(way.report.slid) / n, way.report.stationary, way.report.inside, way.report.restarted,
        way.report.unfinished, double(way.report.events) / n, double(way.report.steps) / n);
    Json& entry = document_["ways"][way.key];
    entry = {{"points", way.points},
             {"seconds", wall},
             {"processor_seconds", processor},
             {"microseconds_a_point", 1e6 * processor / n},
             {"queries_a_point", queries / n},
             {"slid", way.report.slid},
             {"unfinished", way.report.unfinished}};
    if (way.report.passes == 0) return;
    double device = 0;
    for (const KernelTime& kernel : way.report.kernels) {
      device += kernel.seconds;
      entry["kernels"][kernel.kernel] = kernel.seconds;
      say("          {}: {:.2f} s on the device, {:.0f} % of the last flow\n", kernel.kernel, kernel.seconds,
          100 * kernel.seconds / way.report.seconds);
    }
    const auto answered = double(way.report.device_queries);
    say("          {} passes of {:.0f} queries; on the device {:.2f} s, {:.0f} % of the last flow; {:.2f} % of the "
        "queries "
        "answered by the host, {:.1f} % of the answers taken on by it\n",
        way.report.passes, answered / double(way.report.passes), device, 100 * device / way.report.seconds,
        100 * (1 - answered / queries), 100 * (1 - double(way.report.device_moves) / queries));
    entry["passes"] = way.report.passes;
    entry["device_seconds"] = device;
    entry["device_share"] = device / way.report.seconds;
    entry["device_queries"] = way.report.device_queries;
    entry["device_moves"] = way.report.device_moves;
  }

  Options options_;
  RawMesh mesh_;
  double diagonal_ = 0;
  std::unique_ptr<Backend> cpu_, gpu_;
  std::unique_ptr<DistanceFlow> cpu_flow_, gpu_flow_;
};

} // namespace
} // namespace cowgpu::bench

int main(int argc, char** argv) {
  using namespace cowgpu;
  bench::Options options;
  cli::CommandLine app("flow_bench", "Verifies and times the distance's flow.");
  app.add_option("mesh", options.mesh, "a closed mesh: OFF, benchmark or builtin:...")->capture_default_str();
  app.add_option("--points", options.points, "on the CPU path")->check(cli::positive_number())->capture_default_str();
  app.add_option("--vulkan-points", options.vulkan_points, "on the Vulkan path, and on the CPU beside it")
      ->check(cli::positive_number())
      ->capture_default_str();
  app.add_option("--time", options.time, "to flow for")->check(cli::positive_number())->capture_default_str();
  app.add_option("--tolerance", options.tolerance, "error per time on the medial axis")->capture_default_str();
  app.add_option("--runs", options.runs, "flows of each way")->check(cli::positive_number())->capture_default_str();
  app.add_option("--threads", options.threads, "of the CPU path; 0: all");
  app.add_option("--device", options.device, "Vulkan device: auto, an index, a part of its name, or none")
      ->capture_default_str();
  app.add_option("--instruction-set", options.instruction_set, "the widest to use: AVX3, AVX2, SSE4, SSSE3")
      ->check(cli::one_of({"AVX3", "AVX2", "SSE4", "SSSE3"}));
  app.add_flag("--json", options.json, "a JSON document in place of the text");
  if (const auto end = bench::read_command_line(app, argc, argv)) return *end;
  try {
    bench::use_instruction_set(options.instruction_set);
    return bench::Bench(options).run();
  } catch (const Error& error) {
    fmt::print(stderr, "flow_bench: {}\n", error.what());
    return exit_code(error.fault());
  } catch (const std::exception& error) {
    fmt::print(stderr, "flow_bench: {}\n", error.what());
    return 5;
  }
}
