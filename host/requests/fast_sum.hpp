// Which engine sums the polyhedra of a body.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"
#include "host/potential.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace cowgpu {

/// A device sums all faces at all points. Where a tolerance allows the fast sum (host/cpu/polyhedron_fast.hpp) and that takes
/// less time for one of the body's surfaces: a CPU backend on `threads` threads (0: all), in place of `asked`. Elsewhere, and
/// where `asked` is the CPU, none.
std::unique_ptr<Backend> fast_sum_backend(const Body& body, double tolerance, Derivatives derivatives,
                                          std::uint64_t points, const Backend& asked, unsigned threads);

/// A sentence that says so, for the notes of a result.
std::string fast_sum_note(const Backend& asked);

} // namespace cowgpu
