// Where the fast sum of the verb `polyhedron` begins to pay.
#pragma once

namespace cowgpu::bench {

/// Times the direct and the fast sum of meshes of some thousand faces and less, and of many faces at few points; says beside
/// them which one plan::fast_sum_pays() takes, and what lists of pairs the tasks hold. The exit code.
int polyhedron_crossover(int runs, unsigned threads);

} // namespace cowgpu::bench
