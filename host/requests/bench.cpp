#include "host/requests/bench.hpp"

#include "host/error.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/mass/verify.hpp"
#include "host/mesh/body.hpp"
#include "host/requests/limits.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

// Multiply-adds of one recursion entry of a pair, counted as two flops each (bench/moments.md).
constexpr double flops_per_element = 60;

struct Path {
  const char* name;
  Backend* backend;
  std::vector<double> seconds;
  RunReport report;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void time(const MomentProblem& problem, int runs, std::vector<Path>& paths, Monitor& monitor) {
  for (Path& path : paths) {
    path.backend->moments(problem)->run(monitor); // warms up
    path.seconds.clear();
  }
  // Any of the paths will do as a measure of the others; the sample has the reference too.
  for (Path& path : paths) {
    const Accuracy accuracy = verify_moments(problem, *path.backend, Verify::sample, 1, monitor);
    if (!accuracy.passed())
      throw Error(Fault::check_failed,
                  fmt::format("{} is off by {:.1e} times what rounding explains: nothing was timed", path.name,
                              accuracy.worst()->errors.ratio));
  }
  for (int i = 0; i < runs; ++i)
    for (Path& path : paths) {
      path.backend->moments(problem)->run(monitor, &path.report);
      path.seconds.push_back(path.report.seconds);
    }
}

} // namespace

BenchResult bench_moments(BenchRequest request, Backend* device, Monitor& monitor) {
  for (const int lmax : request.lmax) require_range("the degree is", lmax, 0, largest_degree);
  require_range("the cut-off is", request.cut_off, 0.0, largest_cut_off);
  require_range("the timed runs are", request.runs, 1, most_runs);
  const Body body = make_body(ClosedSurface::from(std::move(request.mesh)), {}, 1);
  const auto one = make_cpu_backend(1), all = make_cpu_backend(request.threads);
  std::vector<Path> paths = {{"CPU, one thread", one.get(), {}, {}}, {"CPU, all threads", all.get(), {}, {}}};
  if (device && device->facts().type != "cpu") paths.push_back({"Vulkan", device, {}, {}});
  BenchResult result;
  result.mesh = body.surface.mesh();
  result.runs = request.runs;
  for (const Path& path : paths)
    result.paths.push_back({path.name, path.backend->facts(), path.backend->measured_peak()});
  for (const int lmax : request.lmax) {
    time(mass_problems(body, lmax, request.cut_off).front(), request.runs, paths, monitor);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const RunReport& report = paths[i].report;
      const double seconds = median(paths[i].seconds);
      result.rows.push_back(
          {lmax, i, seconds, report.elements * flops_per_element / seconds, report.elements, report.full_elements});
    }
  }
  return result;
}

} // namespace cowgpu
