// Verifies the verb `potential` against the reference in 80-bit arithmetic, then times both paths and the reference in one run.
#include "bench/report.hpp"
#include "host/backend.hpp"
#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/parallel.hpp"
#include "host/reference/potential.hpp"

#include "bench/command_line.hpp"
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

namespace cowgpu::bench {
namespace {

constexpr std::size_t verified = 32; // points held against the reference
constexpr double radius = 1, farthest = 2;

struct Options {
  std::vector<int> degrees = {8, 32, 128, 512};
  std::size_t points = 20000;
  int runs = 5;
  unsigned threads = 0;
  bool cpu_only = false, json = false;
};

// Moments of no body in particular, that fall like 1/l.
Multipoles moments(int lmax) {
  Multipoles q(lmax);
  q.reference_radius = radius;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int l = 0; l <= lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      const double re = uniform(random), im = uniform(random);
      q(l, m) = {re / (l + 1), m == 0 ? 0 : im / (l + 1)};
    }
  return q;
}

std::vector<Vec3> places(std::size_t count) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> far(radius, farthest);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(Vec3(normal(random), normal(random), normal(random)).normalized() * far(random));
  return points;
}

class Bench : Report {
public:
  explicit Bench(const Options& options) : Report(options.json), options_(options) {
    backends_.push_back(make_cpu_backend(options.threads));
    if (options.cpu_only) return;
    try {
      backends_.push_back(make_gpu_backend({}));
    } catch (const Error& error) {
      say("no Vulkan device: {}\n", error.what());
    }
  }

  int run() {
    document_ = {
        {"benchmark", "potential"}, {"points", options_.points}, {"runs", options_.runs}, {"results", Json::array()}};
    for (const auto& backend : backends_) say("{} ({})\n", backend->facts().name, backend->facts().driver);
    const std::vector<Vec3> points = places(options_.points);
    for (const int lmax : options_.degrees) {
      const Multipoles q = moments(lmax);
      const reference::ExteriorPotential<long double> reference(q);
      std::vector<reference::PotentialAt<long double>> truth;
      const std::size_t some = std::min(verified, points.size());
      const auto start = Clock::now();
      for (std::size_t i = 0; i < some; ++i) truth.push_back(reference(points[i].cast<long double>()));
      const double each = seconds_since(start) / double(std::max<std::size_t>(some, 1));
      std::vector<std::vector<double>> seconds(backends_.size());
      for (int run = 0; run < options_.runs; ++run)
        for (std::size_t b = 0; b < backends_.size(); ++b) {
          RunReport report;
          const PotentialField field = backends_[b]->potential({q, points, lmax}, silent_monitor(), &report);
          seconds[b].push_back(report.seconds);
          if (run == 0) verify(backends_[b]->facts().type, lmax, field, truth);
        }
      for (std::size_t b = 0; b < backends_.size(); ++b) {
        const double time = median(seconds[b]), a_point = time / double(points.size());
        say("degree {:>4}, {:<8} {:>9.2f} ms, {:>8.3f} us a point, reference on one thread {:>9.1f} us: {:.0f} times\n",
            lmax, backends_[b]->facts().type, 1e3 * time, 1e6 * a_point, 1e6 * each, each / a_point);
        document_["results"].push_back({{"degree", lmax},
                                        {"device", backends_[b]->facts().name},
                                        {"seconds", time},
                                        {"reference_seconds_a_point", each}});
      }
    }
    return finish();
  }

private:
  void verify(const std::string& path, int lmax, const PotentialField& field,
              const std::vector<reference::PotentialAt<long double>>& truth) {
    double error = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const auto gradient = truth[i].gradient.cast<double>().eval();
      const double apart = (field.gradient[i] - gradient).norm() / gradient.norm();
      if (!(apart <= error)) error = apart;
    }
    check(fmt::format("{}, degree {}: acceleration", path, lmax), error, 1e-11);
  }

  Options options_;
  std::vector<std::unique_ptr<Backend>> backends_;
};

} // namespace
} // namespace cowgpu::bench

int main(int argc, char** argv) {
  using namespace cowgpu;
  bench::Options options;
  cli::CommandLine app("potential_bench", "Verifies and times the verb potential");
  app.add_option("--degrees", options.degrees, "Degrees")
      ->delimiter(',')
      ->check(cli::in_range(0, largest_potential_degree));
  app.add_option("--points", options.points, "Points")->check(cli::in_range(1, 100000000));
  app.add_option("--runs", options.runs, "Runs; medians are shown")->check(cli::in_range(1, 1000));
  app.add_option("--threads", options.threads, "Of the CPU path; 0: all");
  app.add_flag("--cpu", options.cpu_only, "The CPU path alone");
  app.add_flag("--json", options.json, "As JSON");
  if (const auto end = bench::read_command_line(app, argc, argv)) return *end;
  try {
    return bench::Bench(options).run();
  } catch (const Error& error) {
    fmt::print(stderr, "potential_bench: {}\n", error.what());
    return 1;
  }
}
