// The verb `moments`: exact multipole moments of a body, ready to be computed.
#pragma once

#include "host/memory_need.hpp"
#include "host/moment_problem.hpp"
#include "host/monitor.hpp"
#include "host/multipoles.hpp"
#include "host/run_report.hpp"

namespace cowgpu {

/// The moments of the signed tetrahedra (origin, face) of a MomentProblem: the mathematics stands in host/plan/moments.hpp.
/// Nothing is looked at or allocated before run(); the problem's vertices and faces must live until then.
class PreparedMoments {
public:
  virtual ~PreparedMoments() = default;

  /// Upper bound of what run() allocates, its result included. It reads the sizes of the problem alone.
  virtual MemoryNeed memory() const = 0;

  /// Throws Error(bad_argument) for a problem out of range, too_large, device_failed, device_lost, interrupted. The same
  /// problem on the same device gives the same bits.
  virtual Multipoles run(Monitor& monitor, RunReport* report = nullptr) const = 0;
};

} // namespace cowgpu
