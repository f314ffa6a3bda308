// What `expand` computes: a body's mass multipoles, and its surface over maps to the sphere.
#pragma once

#include "host/report/result.hpp"
#include "host/requests/expand_surfaces.hpp"

#include <cstdint>

namespace cowgpu {

struct ExpandRequest {
  ExpansionChoice expansions;
  bool estimate_aliasing = false;   ///< of the surface expansions, degree by degree; the paper's recipe always does
  double cut_off = default_cut_off; ///< as in MomentProblem
  Verify verify = Verify::sample;   ///< how the mass multipoles are checked
  std::uint64_t seed = 1;           ///< seed of the sample that Verify::sample draws
};

/// The mass and every map that can be made, to degree lmax.
ExpansionChoice all_expansions(int lmax);

/// Length of the result as JSON in bytes, to about ten per cent.
std::uint64_t json_bytes(const ExpansionChoice& choice);

/// What a request will take.
struct ExpandPlan {
  MemoryNeed memory;        ///< at most, beside the mesh and the program
  std::uint64_t pairs = 0;  ///< pairs of triangles whose moments are computed
  double elements = 0;      ///< entries of the recursion after the cut-off
  double full_elements = 0; ///< entries without a cut-off
};

/// Throws Error(bad_argument, too_large) for what expand() refuses as well.
ExpandPlan plan_expand(const ExpandRequest& request, const Body& body, const Backend& backend);

/// Computes what is asked for, about the body's origin; surfaces first, because maps are what may not be possible. The caller
/// fills in `command`, and the times of loading and opening; `notes` are put before those that expanding adds. The
/// result is given back even where a check failed: see require_sound().
///
/// Throws Error(bad_argument) for a map file without one map that it stands for, or a degree out of range; too_large with
/// what the machine lacks; what expand_surfaces() and Backend::moments() throw; interrupted.
ExpandResult expand(const ExpandRequest& request, Body body, Backend& backend, Monitor& monitor,
                    std::vector<std::string> notes = {});

/// Throws Error(check_failed) for a surface expansion that came out unfit for use, and for multipoles whose second path is
/// farther away than rounding explains.
void require_sound(const ExpandResult& result);

} // namespace cowgpu
