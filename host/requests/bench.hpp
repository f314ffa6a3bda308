// How long the moments of a mesh take on the CPU and on a device, verified first.
#pragma once

#include "host/backend.hpp"
#include "host/report/bench_report.hpp"

namespace cowgpu {

struct BenchRequest {
  RawMesh mesh;
  std::vector<int> lmax = {64, 128, 512}; ///< degrees
  double cut_off = default_cut_off;       ///< as in MomentProblem
  int runs = 5;                           ///< timed runs of each, 1 at least
  unsigned threads = 0;                   ///< threads of the CPU path that uses more than one; 0: all
};

/// Times the CPU path on one and on more threads and, unless it is null or a CPU path, `device`; paths in turn. Throws
/// Error(check_failed) where a path fails its check against a sample of the reference, and nothing is timed then;
/// what ClosedSurface::from() and the backends throw.
BenchResult bench_moments(BenchRequest request, Backend* device, Monitor& monitor);

} // namespace cowgpu
