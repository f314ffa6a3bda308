// What a verb of the engine did.
#pragma once

#include "host/kernel_time.hpp"

#include <cstdint>
#include <vector>

namespace cowgpu {

/// What a verb did, beside its result.
struct RunReport {
  double seconds = 0;              ///< wall time of the verb
  double setup_seconds = 0;        ///< the part of `seconds` for planning, pairing, sorting on the host
  double elements = 0;             ///< (l, m) entries evaluated, summed over pairs of triangles
  double full_elements = 0;        ///< the same without the cut-off
  std::uint64_t pairs = 0;         ///< pairs (and leftover single triangles) of the plan, or pairs of cells
  double multiply_adds = 0;        ///< of translations of expansions, in the fast sum of a polyhedron
  std::vector<KernelTime> kernels; ///< empty on the CPU path
};

} // namespace cowgpu
