// How long the moments of a mesh take, and how it is said (host/requests/bench.hpp).
#pragma once

#include "host/device_facts.hpp"
#include "host/mesh/raw_mesh.hpp"
#include "host/report/result.hpp"

#include <string>
#include <vector>

namespace cowgpu {

/// A way to compute.
struct BenchPath {
  std::string name; ///< "CPU, one thread"
  DeviceFacts device;
  double peak = 0; ///< multiply-adds as measured, two flops each, per second
};

/// A path at a degree; times are medians.
struct BenchRow {
  int lmax = 0;
  std::size_t path = 0; ///< place among the paths
  double seconds = 0;
  double flops_per_second = 0;
  double elements = 0, full_elements = 0; ///< recursion entries computed, and without the cut-off
};

struct BenchResult {
  RawMesh mesh;
  int runs = 0;
  std::vector<std::string> notes; ///< set by the caller
  std::vector<BenchPath> paths;
  std::vector<BenchRow> rows; ///< by degree, then path
};

/// The document cowgpu.bench.v1.
Object document(const BenchResult& result);

/// A table for the screen.
void write_bench(const BenchResult& result, const Sink& sink);

} // namespace cowgpu
