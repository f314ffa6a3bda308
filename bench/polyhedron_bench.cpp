// Verifies the verb `polyhedron` against the reference in 80-bit arithmetic, then times the direct sum of both paths and the
// reference in one run, and sets beside them the rates that others have published.
#include "bench/report.hpp"
#include "host/backend.hpp"
#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/mesh/builtin.hpp"
#include "host/reference/polyhedron.hpp"

#include "bench/command_line.hpp"
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace cowgpu::bench {
namespace {

constexpr std::size_t verified = 48; // points held against the reference

struct Options {
  std::string body = "cow@1";
  std::size_t points = 4096, device_points = 1024;
  int runs = 3, derivatives = 1;
  unsigned threads = 0;
  std::string instructions;
  bool cpu_only = false, json = false;
};

// ESA's polyhedral-gravity-model 3.3.1 (J. Schuhmacher et al., 2024), V, gradient and second derivatives of 5,520 faces at 1,000
// points outside, on a Zen 5 with AVX-512: millions of pairs of a face and a point a second, on one thread and on two.
struct Peer {
  const char* name;
  double one, two;
};
constexpr Peer peers[] = {{"ESA polyhedral-gravity-model 3.3.1 as shipped", 3.45, 6.80},
                          {"  with -march=native", 3.86, 7.71}};

// Centroids, as a map of the surface has them.
std::vector<Vec3> centroids(const RawMesh& mesh, std::size_t count) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Face& f = mesh.faces[i * 7919 % mesh.faces.size()];
    points.emplace_back((mesh.vertices[f[0]] + mesh.vertices[f[1]] + mesh.vertices[f[2]]) / 3);
  }
  return points;
}

class Bench : Report {
public:
  explicit Bench(const Options& options) : Report(options.json), options_(options) {
    use_instruction_set(options.instructions);
    backends_.push_back(make_cpu_backend(options.threads));
    if (options.cpu_only) return;
    try {
      backends_.push_back(make_gpu_backend({}));
    } catch (const Error& error) {
      say("no Vulkan device: {}\n", error.what());
    }
  }

  int run() {
    const RawMesh mesh = builtin_mesh(options_.body);
    PolyhedronProblem problem;
    problem.vertices = mesh.vertices;
    problem.faces = mesh.faces;
    problem.derivatives = Derivatives(options_.derivatives);
    document_ = {{"benchmark", "polyhedron"},
                 {"faces", mesh.faces.size()},
                 {"runs", options_.runs},
                 {"derivatives", options_.derivatives},
                 {"results", Json::array()}};
    say("{}: {} faces, derivatives {}\n", mesh.name, mesh.faces.size(), options_.derivatives);
    const reference::Polyhedron<long double> reference(mesh.vertices, mesh.faces);
    const std::vector<Vec3> some = centroids(mesh, verified);
    std::vector<reference::PolyhedronAt<long double>> truth;
    const auto start = Clock::now();
    for (const Vec3& p : some) truth.push_back(reference.at(p));
    say("{:<60} {:>9.2f} million face-points a second\n", "reference, 80 bit, one thread",
        double(verified) * double(mesh.faces.size()) / seconds_since(start) / 1e6);
    for (std::size_t b = 0; b < backends_.size(); ++b) {
      const std::vector<Vec3> points = centroids(mesh, b == 0 ? options_.points : options_.device_points);
      const auto prepared = backends_[b]->polyhedron(problem);
      verify(backends_[b]->facts().type, prepared->at(some, silent_monitor()), truth);
      std::vector<double> seconds, used;
      RunReport report;
      for (int run = 0; run < options_.runs; ++run) {
        const double before = processor_seconds();
        prepared->at(points, silent_monitor(), &report);
        used.push_back(processor_seconds() - before);
        seconds.push_back(report.seconds);
      }
      const double rate = report.elements / median(seconds) / 1e6;
      say("{:<60} {:>9.2f} million face-points a second, {:.2f} a second of a core\n", backends_[b]->facts().name, rate,
          report.elements / median(used) / 1e6);
      for (const Peer& peer : peers)
        say("  {:<58} {:>9.2f} published; {:.0f} times\n", peer.name, peer.two, rate / peer.two);
      document_["results"].push_back({{"device", backends_[b]->facts().name},
                                      {"points", points.size()},
                                      {"seconds", median(seconds)},
                                      {"core_seconds", median(used)},
                                      {"face_points_a_second", rate * 1e6}});
    }
    return finish();
  }

private:
  void verify(const std::string& path, const PolyhedronValues& found,
              const std::vector<reference::PolyhedronAt<long double>>& truth) {
    double value = 0, gradient = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const double apart = double(std::fabs(found.field.value[i] / truth[i].value - 1));
      if (!(apart <= value)) value = apart;
      if (found.field.gradient.empty()) continue;
      const double off =
          double((found.field.gradient[i].cast<long double>() - truth[i].gradient).norm() / truth[i].gradient.norm());
      if (!(off <= gradient)) gradient = off;
    }
    check(path + ": V", value, 1e-14);
    check(path + ": gradient", gradient, 1e-14);
  }

  Options options_;
  std::vector<std::unique_ptr<Backend>> backends_;
};

} // namespace
} // namespace cowgpu::bench

int main(int argc, char** argv) {
  using namespace cowgpu;
  bench::Options options;
  cli::CommandLine app("polyhedron_bench", "Verifies and times the direct sum of the verb polyhedron");
  app.add_option("--body", options.body, "A built-in body, as after builtin:");
  app.add_option("--points", options.points, "Points of the CPU path")->check(cli::in_range(1, 100000000));
  app.add_option("--device-points", options.device_points, "Points of the Vulkan path")
      ->check(cli::in_range(1, 100000000));
  app.add_option("--derivatives", options.derivatives, "0, 1 or 2")->check(cli::in_range(0, 2));
  app.add_option("--runs", options.runs, "Runs; medians are shown")->check(cli::in_range(1, 1000));
  app.add_option("--threads", options.threads, "Of the CPU path; 0: all");
  app.add_option("--instructions", options.instructions, "AVX3, AVX2, SSE4 or SSSE3");
  app.add_flag("--cpu", options.cpu_only, "The CPU path alone");
  app.add_flag("--json", options.json, "As JSON");
  if (const auto end = bench::read_command_line(app, argc, argv)) return *end;
  try {
    return bench::Bench(options).run();
  } catch (const Error& error) {
    fmt::print(stderr, "polyhedron_bench: {}\n", error.what());
    return 1;
  }
}
