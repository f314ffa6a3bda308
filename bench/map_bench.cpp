// Verifies maps to the sphere and surface expansions over them, then times them on both paths. How to read the output
// stands in bench/maps.md.
#include "bench/report.hpp"

#include "host/backend.hpp"
#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/document_json.hpp"
#include "host/io/mesh_source.hpp"
#include "host/map/harmonic.hpp"
#include "host/map/quality.hpp"
#include "host/map/stretch.hpp"
#include "host/mesh/subdivide.hpp"
#include "host/paper/recipe.hpp"
#include "host/paper/surface_tables.hpp"
#include "host/report/document_parts.hpp"
#include "host/spectrum/expand_surface.hpp"

#include "bench/command_line.hpp"

#include <algorithm>
#include <ctime>
#include <functional>
#include <memory>

namespace cowgpu::bench {
namespace {

struct Options {
  std::string mesh = "benchmark", device = "auto";
  std::vector<std::string> methods = {"harmonic", "stretch"};
  int split = 0, lmax = 512, runs = 7;
  unsigned threads = 0;
  bool json = false;
};

struct Path {
  std::string name;
  std::unique_ptr<Backend> backend;
};

struct Times {
  std::vector<double> wall, processor;
};

class Bench : Report {
public:
  explicit Bench(const Options& options) : Report(options.json), options_(options), surface_(load(options)) {}

  int run() {
    paths_.push_back({"CPU", make_cpu_backend(options_.threads)});
    if (options_.device != "none") {
      GpuOptions gpu;
      gpu.device = options_.device;
      try {
        paths_.push_back({"Vulkan", make_gpu_backend(gpu)});
      } catch (const Error& error) {
        say("Vulkan: none: {}\n", error.what());
      }
    }
    const std::size_t triangles = surface_.faces().size();
    say("Benchmark of maps and surface expansions, {}\n{}, split {} times: {} triangles\n", utc_now(), options_.mesh,
        options_.split, triangles);
    for (const Path& path : paths_) {
      const DeviceFacts& facts = path.backend->facts();
      say("{:<8} {}; {}; {}\n", path.name, facts.name, facts.driver, facts.api);
      document_["devices"].push_back(Json::parse(json_text(members(facts))));
    }
    document_["mesh"] = {{"name", options_.mesh}, {"split", options_.split}, {"triangles", triangles}};
    say("Times are medians of {} calls in milliseconds, with the shortest and the processor time of all threads.\n",
        options_.runs);
    if (options_.split == 0 && surface_.closed().mesh().sha256 == benchmark_sha256) check_paper();
    for (const std::string& method : options_.methods) compare(method);
    return finish();
  }

private:
  static ManifoldSurface load(const Options& options) {
    RawMesh mesh = load_mesh(options.mesh);
    for (int i = 0; i < options.split; ++i) mesh = split_midpoint(mesh);
    return ManifoldSurface::from(ClosedSurface::from(std::move(mesh)));
  }

  SphereMap map(const std::string& method) {
    Monitor& silent = silent_monitor();
    HarmonicOptions plain; // the disk's map: what its system costs
    plain.polish = false;
    return method == "stretch" ? stretch_map(surface_, {}, silent) : harmonic_map(surface_, plain, silent);
  }

  SurfaceExpansion expand(Path& path, const SphereMap& map, const ExpandSurfaceOptions& options,
                          ExpandSurfaceReport* report = nullptr) {
    return expand_surface(surface_.vertices(), surface_.faces(), map, options, *path.backend, silent_monitor(), report);
  }

  void check_paper() {
    ExpandSurfaceOptions options;
    options.lmax = 3;
    options.closest_point = true;
    options.signed_dphi = false;
    const SphereMap map = harmonic_map(surface_, paper::harmonic_map());
    say("\nthe paper's recipe\n");
    for (Path& path : paths_) {
      const auto misfits = paper_misfits(expand(path, map, options));
      const std::array allowed = {0.003, 0.001, 0.0015};
      for (std::size_t f = 0; f < 3; ++f)
        check(fmt::format("{}: misfit of {}", path.name, surface_field_names[f]), misfits[f], allowed[f]);
    }
  }

  void time(Times& times, const std::function<void()>& call) {
    const std::clock_t before = std::clock();
    const auto start = Clock::now();
    call();
    times.wall.push_back(seconds_since(start));
    times.processor.push_back(double(std::clock() - before) / CLOCKS_PER_SEC);
  }

  void show(const std::string& method, const std::string& what, const Times& times) {
    const auto least = [](const std::vector<double>& v) { return 1e3 * *std::min_element(v.begin(), v.end()); };
    say("  {:<40} {:9.1f} ({:.1f}), processor {:.1f} ({:.1f})\n", what, 1e3 * median(times.wall), least(times.wall),
        1e3 * median(times.processor), least(times.processor));
    document_["times"].push_back({{"method", method},
                                  {"what", what},
                                  {"seconds", median(times.wall)},
                                  {"shortest", least(times.wall) / 1e3},
                                  {"processor", median(times.processor)}});
  }

  void compare(const std::string& method) {
    say("\n{}, lmax {}\n", method, options_.lmax);
    const SphereMap first = map(method);
    const MapQuality quality = judge(surface_, first, surface_grid_degree(options_.lmax) / 2);
    if (method == "stretch") check("flipped triangles", double(quality.flipped.size()), 0);
    check("distance of the degree from 1", std::abs(quality.degree - 1), 1e-10);
    say("  {} flipped triangles, {} of {} seen by the grid\n", quality.flipped.size(),
        quality.triangles - quality.unseen, quality.triangles);
    ExpandSurfaceOptions options;
    options.lmax = options_.lmax;
    const SurfaceExpansion truth = expand(paths_.front(), first, options); // warms up, too
    for (std::size_t p = 1; p < paths_.size(); ++p) {
      const SurfaceExpansion other = expand(paths_[p], first, options);
      double apart = 0;
      for (std::size_t i = 0; i < truth.coefficients.values.size(); ++i)
        apart = std::max(apart, std::abs(truth.coefficients.values[i] - other.coefficients.values[i]));
      check(paths_[p].name + " against CPU: largest difference of coefficients", apart, 1e-13);
    }
    if (!passed_) return;

    Times maps;
    std::vector<Times> sampling(paths_.size()), expansions(paths_.size());
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, surface_grid_degree(options_.lmax));
    for (int run = 0; run < options_.runs; ++run) {
      time(maps, [&] { (void)map(method); });
      for (std::size_t p = 0; p < paths_.size(); ++p) {
        time(sampling[p], [&] {
          (void)paths_[p].backend->sphere_sampler(grid)->sample(first.positions, surface_.faces(), silent_monitor());
        });
        time(expansions[p], [&] { (void)expand(paths_[p], first, options); });
      }
    }
    show(method, "map", maps);
    for (std::size_t p = 0; p < paths_.size(); ++p) {
      show(method, fmt::format("sampling, {} rings of {}, {}", grid.rings, grid.ring_length, paths_[p].name),
           sampling[p]);
      show(method, "expansion, " + paths_[p].name, expansions[p]);
    }
    if (paths_.size() > 1)
      say("  Vulkan over CPU: sampling {:.2f}, expansion {:.2f}\n", median_ratio(sampling[1].wall, sampling[0].wall),
          median_ratio(expansions[1].wall, expansions[0].wall));
  }

  Options options_;
  ManifoldSurface surface_;
  std::vector<Path> paths_;
};

} // namespace
} // namespace cowgpu::bench

int main(int argc, char** argv) {
  using namespace cowgpu;
  bench::Options options;
  cli::CommandLine app("map_bench", "Verifies and times maps to the sphere and the expansion of surfaces.");
  app.add_option("mesh", options.mesh, "as `cowgpu` takes it");
  app.add_option("--split", options.split, "cut every triangle into four so many times")->check(cli::in_range(0, 8));
  app.add_option("--methods", options.methods, "of harmonic, stretch")->check(cli::one_of({"harmonic", "stretch"}));
  app.add_option("--lmax", options.lmax, "degree of the expansion")->check(cli::in_range(0, largest_surface_degree));
  app.add_option("--runs", options.runs, "calls of each case")->check(cli::positive_number());
  app.add_option("--threads", options.threads, "of the CPU path; 0: all");
  app.add_option("--device", options.device, "Vulkan device: auto, none, an index, or a part of its name");
  app.add_flag("--json", options.json, "the figures as JSON");
  if (const auto end = bench::read_command_line(app, argc, argv)) return *end;
  try {
    return bench::Bench(options).run();
  } catch (const Error& error) {
    fmt::print(stderr, "map_bench: {}\n", error.what());
    return exit_code(error.fault());
  } catch (const std::exception& error) {
    fmt::print(stderr, "map_bench: {}\n", error.what());
    return 5;
  }
}
