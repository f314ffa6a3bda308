// What the benchmarks share: statistics of times, checks, and the report as text or JSON.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace cowgpu::bench {

using Json = nlohmann::ordered_json;

/// NaN if there are none.
double median(std::vector<double> values);

/// Median of a[i] / b[i]: both sides of one round share what slowed the machine.
double median_ratio(const std::vector<double>& a, const std::vector<double>& b);

/// Processor seconds that all threads of this process have used so far.
double processor_seconds();

/// The mesh `name`; of an empty name the benchmark mesh, and `instead` where that is not there.
RawMesh benchmark_mesh(const std::string& name, const std::string& instead);

/// The widest instruction set the CPU path may use from now on: AVX3, AVX2, SSE4 or SSSE3; empty: the machine's.
void use_instruction_set(const std::string& name);

/// Prints as it goes, or gathers a document for the end.
class Report {
public:
  explicit Report(bool json) : json_(json) {}

protected:
  template <class... Args>
  void say(fmt::format_string<Args...> format, Args&&... args) {
    if (json_) return;
    fmt::print(format, std::forward<Args>(args)...);
    std::fflush(stdout);
  }

  /// Notes a check; prints it, and remembers a failure.
  bool check(const std::string& what, double error, double allowed);

  /// Prints the document, or that a check failed; the program's exit code.
  int finish();

  Json document_;
  bool passed_ = true;

private:
  bool json_;
};

} // namespace cowgpu::bench
