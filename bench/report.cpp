#include "bench/report.hpp"

#include "host/error.hpp"
#include "host/io/mesh_source.hpp"

#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <map>

namespace cowgpu::bench {

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

double median_ratio(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) ratios.push_back(a[i] / b[i]);
  return median(std::move(ratios));
}

double processor_seconds() {
  return double(std::clock()) / CLOCKS_PER_SEC;
}

RawMesh benchmark_mesh(const std::string& name, const std::string& instead) {
  if (!name.empty()) return load_mesh(name);
  try {
    return load_mesh("benchmark");
  } catch (const Error& error) {
    if (error.fault() != Fault::mesh_missing) throw;
    return load_mesh(instead);
  }
}

// Highway's better targets have the lower bits.
void use_instruction_set(const std::string& name) {
  static const std::map<std::string, std::int64_t> sets = {
      {"AVX3", HWY_AVX3}, {"AVX2", HWY_AVX2}, {"SSE4", HWY_SSE4}, {"SSSE3", HWY_SSSE3}};
  if (!name.empty()) hwy::DisableTargets(sets.at(name) - 1);
}

bool Report::check(const std::string& what, double error, double allowed) {
  const bool good = error <= allowed; // NaN fails
  passed_ = passed_ && good;
  say("  {:<58} {:8.1e}  (allowed {:.0e}){}\n", what, error, allowed, good ? "" : "  FAILED");
  document_["checks"].push_back({{"what", what}, {"error", error}, {"allowed", allowed}, {"passed", good}});
  return good;
}

int Report::finish() {
  document_["passed"] = passed_;
  if (json_)
    fmt::print("{}\n", document_.dump(2));
  else if (!passed_)
    fmt::print("\nA verification FAILED.\n");
  return passed_ ? 0 : 1;
}

} // namespace cowgpu::bench
