// Where the fast sum of the verb `polyhedron` begins to pay, and what its tasks hold.
#pragma once

#include "host/mesh/raw_mesh.hpp"
#include "host/polyhedron.hpp"

namespace cowgpu::bench {

/// What the user asks of both.
struct CrossoverOptions {
  int runs = 3;
  unsigned threads = 0;
  bool guarantee = false, tensor = false;
};

/// Times the direct and the fast sum of meshes of some thousand faces and less, and of many faces at few points; says beside
/// them which one plan::fast_sum_pays() takes. The exit code.
int polyhedron_crossover(const CrossoverOptions& options);

/// How many bytes a worker's lists of pairs take, at some and at all of the mesh's centroids. The exit code.
int polyhedron_lists(const RawMesh& mesh, bool guarantee);

} // namespace cowgpu::bench
