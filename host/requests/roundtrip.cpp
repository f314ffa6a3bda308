#include "host/requests/roundtrip.hpp"

#include "host/clock.hpp"
#include "host/report/document_parts.hpp"
#include "host/requests/limits.hpp"
#include "host/requests/memory.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace cowgpu {
namespace {

std::uint64_t peak_resident() {
  struct rusage usage {};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

TransformReport median(std::vector<TransformReport> reports) {
  const auto middle = reports.begin() + std::ptrdiff_t(reports.size() / 2);
  std::nth_element(reports.begin(), middle, reports.end(),
                   [](const TransformReport& a, const TransformReport& b) { return a.seconds < b.seconds; });
  return *middle;
}

} // namespace

RoundtripResult plan_roundtrip(const RoundtripRequest& request, const Backend& backend) {
  require_range("the fields are", request.fields, 1, most_fields);
  require_range("the timed runs are", request.runs, 1, most_runs);
  const auto start = Clock::now();
  RoundtripResult result;
  result.created = utc_now();
  result.request = request;
  result.device = backend.facts();
  result.grid = make_grid(request.grid, request.lmax);
  result.setup_seconds = seconds_since(start);
  result.memory = backend.sphere_transform(result.grid, request.lmax)->memory(request.fields);
  result.memory.host +=
      std::uint64_t(request.fields) * (8 * result.grid.points() + 32 * SphereCoefficients::count(request.lmax));
  check_memory(result.memory, backend, "lower --lmax or --fields");
  return result;
}

RoundtripResult roundtrip(const RoundtripRequest& request, Backend& backend, Monitor& monitor) {
  RoundtripResult result = plan_roundtrip(request, backend);
  const auto start = Clock::now();
  const auto transform = backend.sphere_transform(result.grid, request.lmax);
  transform->prepare();
  result.setup_seconds += seconds_since(start);
  const SphereCoefficients before = random_coefficients(request.lmax, request.fields, request.seed);
  SphereCoefficients after(request.lmax, request.fields);
  std::vector<double> values(std::size_t(request.fields) * result.grid.points());
  std::vector<TransformReport> syntheses, analyses;
  for (int i = 0; i <= request.runs; ++i) { // the first one warms up
    TransformReport synthesis, analysis;
    transform->synthesise(request.fields, before.values, values, monitor, &synthesis);
    transform->analyse(request.fields, values, after.values, monitor, &analysis);
    if (i == 0) continue;
    syntheses.push_back(std::move(synthesis));
    analyses.push_back(std::move(analysis));
  }
  result.synthesis = median(std::move(syntheses));
  result.analysis = median(std::move(analyses));
  result.error = compare(before, after);
  result.bound = round_trip_bound(request.lmax);
  result.peak_resident_bytes = peak_resident();
  return result;
}

} // namespace cowgpu
