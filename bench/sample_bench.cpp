// Verifies the verb `sample` against the exact reference and its paths against each other, then times it. Figures: bench/maps.md.
#include "host/backend.hpp"
#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/reference/sample.hpp"
#include "tests/support/mapped_meshes.hpp"

#include "bench/command_line.hpp"
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <memory>

namespace cowgpu::bench {
namespace {

// Exact for determinants of vectors whose components are 0 or 2^-100 to 2.
using Exact =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<512, boost::multiprecision::digit_base_2>,
                                  boost::multiprecision::et_off>;

struct Options {
  int lmax = 1024, runs = 9;
  unsigned threads = 0;
  std::string device = "auto";
  std::vector<std::string> maps;
};

struct Path {
  std::string name;
  std::unique_ptr<Backend> backend;
  std::vector<double> wall, setup, cpu;
  std::vector<KernelTime> kernels;
};

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v.empty() ? 0 : v[v.size() / 2];
}

class Bench {
public:
  explicit Bench(const Options& options) : options_(options) {}

  int run() {
    paths_.push_back({"CPU", make_cpu_backend(options_.threads), {}, {}, {}, {}});
    if (options_.device != "none") {
      GpuOptions gpu;
      gpu.device = options_.device;
      try {
        paths_.push_back({"Vulkan", make_gpu_backend(gpu), {}, {}, {}, {}});
      } catch (const Error& error) {
        fmt::print("Vulkan: none: {}\n", error.what());
      }
    }
    fmt::print("Benchmark of sampling, {:%Y-%m-%dT%H:%M:%SZ}\n", fmt::gmtime(std::time(nullptr)));
    for (const Path& path : paths_) {
      const DeviceFacts& facts = path.backend->facts();
      fmt::print("{:<8} {}; {}; {}{}\n", path.name, facts.name, facts.driver, facts.api,
                 facts.type == "cpu" ? fmt::format("; {} threads", facts.threads) : "");
    }
    fmt::print("Times are medians (and the shortest) of {} calls in milliseconds; the paths take turns.\n",
               options_.runs);
    // As many triangles as the benchmark mesh has, nearly: even, folded, and most of them in a few cells.
    compare(test::warped_map(4, 0.005, 1));
    compare(test::warped_map(4, 0.1, 1));
    compare(test::crowded_map(4, 12));
    for (const std::string& file : options_.maps) {
      const RawMesh mesh = load_mesh(file);
      compare({file, mesh.vertices, mesh.faces});
    }
    if (!passed_) fmt::print("\nA verification FAILED.\n");
    return passed_ ? 0 : 1;
  }

private:
  void check(const std::string& what, std::size_t wrong, std::size_t of) {
    fmt::print("  {:<58} {} of {}{}\n", what, wrong, of, wrong ? "  FAILED" : "");
    passed_ = passed_ && wrong == 0;
  }

  SphereSamples sample(Path& path, const test::MappedMesh& map, const SphereGrid& grid, bool timed) {
    Monitor silent;
    RunReport report;
    const std::clock_t before = std::clock();
    SphereSamples result = path.backend->sphere_sampler(grid)->sample(map.positions, map.faces, silent, &report);
    if (timed) {
      path.cpu.push_back(double(std::clock() - before) / CLOCKS_PER_SEC);
      path.wall.push_back(report.seconds);
      path.setup.push_back(report.setup_seconds);
      path.kernels = report.kernels;
    }
    return result;
  }

  bool verify(const test::MappedMesh& map, const SphereGrid& grid) {
    const SphereGrid coarse = make_grid(GridKind::clenshaw_curtis, 23);
    const SphereDirections directions(coarse);
    const reference::Sampler<Exact> reference(map.positions, map.faces);
    std::vector<std::uint32_t> truth;
    for (int i = 0; i < coarse.rings; ++i)
      for (int j = 0; j < coarse.ring_length; ++j) truth.push_back(reference(directions(i, j)).face);
    const bool before = passed_;
    SphereSamples first;
    for (Path& path : paths_) {
      const SphereSamples found = sample(path, map, coarse, false);
      std::size_t wrong = 0;
      for (std::size_t p = 0; p < truth.size(); ++p) wrong += found.faces[p] != truth[p];
      check(path.name + ": other faces than the exact reference", wrong, truth.size());
      const SphereSamples fine = sample(path, map, grid, false);
      if (&path == &paths_.front()) {
        first = fine;
        fmt::print("  {} of {} triangles hit, {} flipped, {} flat; {} points folded, {} on edges\n", fine.faces_hit,
                   map.faces.size(), fine.flipped_faces, fine.flat_faces, fine.folded_points, fine.edge_points);
        continue;
      }
      wrong = 0;
      std::size_t moved = 0;
      for (std::size_t p = 0; p < fine.points(); ++p) {
        wrong += fine.faces[p] != first.faces[p];
        moved += fine.weights[p] != first.weights[p];
      }
      check(path.name + ": other faces than the CPU", wrong, fine.points());
      check(path.name + ": other weights than the CPU", moved, fine.points());
    }
    return passed_ == before;
  }

  void compare(const test::MappedMesh& map) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, options_.lmax);
    fmt::print("\n{}, {} triangles, {} rings of {}\n", map.name, map.faces.size(), grid.rings, grid.ring_length);
    if (!verify(map, grid)) return;
    for (Path& path : paths_) path.wall.clear(), path.setup.clear(), path.cpu.clear();
    for (int run = 0; run < options_.runs; ++run)
      for (Path& path : paths_) (void)sample(path, map, grid, true);
    for (const Path& path : paths_) {
      const auto least = [](const std::vector<double>& v) { return 1e3 * *std::min_element(v.begin(), v.end()); };
      fmt::print("  {:<8} {:>8.1f} ({:.1f}), set-up {:.1f} ({:.1f}), processor time {:.1f} ({:.1f})", path.name,
                 1e3 * median(path.wall), least(path.wall), 1e3 * median(path.setup), least(path.setup),
                 1e3 * median(path.cpu), least(path.cpu));
      for (const KernelTime& k : path.kernels) fmt::print(", {} {:.1f}", k.kernel, 1e3 * k.seconds);
      fmt::print("\n");
    }
  }

  Options options_;
  std::vector<Path> paths_;
  bool passed_ = true;
};

} // namespace
} // namespace cowgpu::bench

int main(int argc, char** argv) {
  using namespace cowgpu;
  bench::Options options;
  cli::CommandLine app("sample_bench", "Verifies and times the sampling of maps to the sphere.");
  app.add_option("--lmax", options.lmax, "degree of the Gauss-Legendre grid")->check(cli::non_negative_number());
  app.add_option("--runs", options.runs, "calls of each case")->check(cli::positive_number());
  app.add_option("--threads", options.threads, "of the CPU path; 0: all");
  app.add_option("--device", options.device, "Vulkan device: auto, none, an index, or a part of its name");
  app.add_option("--map", options.maps, "mesh files whose vertices lie on the unit sphere, beside the built-in maps");
  if (const auto end = bench::read_command_line(app, argc, argv)) return *end;
  try {
    return bench::Bench(options).run();
  } catch (const Error& error) {
    fmt::print(stderr, "sample_bench: {}\n", error.what());
    return exit_code(error.fault());
  } catch (const std::exception& error) {
    fmt::print(stderr, "sample_bench: {}\n", error.what());
    return 5;
  }
}
