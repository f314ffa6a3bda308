// One call that holds every path of the stage `sample` against the reference.
#pragma once

#include "host/backend.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/mapped_meshes.hpp"

namespace cowgpu::test {

/// Without anybody watching.
SphereSamples sample(Backend& backend, const MappedMesh& map, const SphereGrid& grid, RunReport* report = nullptr);

/// Asks that faces and counts are the reference's on every path, weights within `figure` of it, and that all paths have
/// the same bits; or that every path refuses a map that leaves a direction open. Returns whether none is open.
bool compare_samples(Paths& paths, const MappedMesh& map, const SphereGrid& grid, double figure);

} // namespace cowgpu::test
