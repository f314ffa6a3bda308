// What is found out about the benchmark body beside what "Higher multipoles of the cow" prints.
#pragma once

#include "host/physics/findings.hpp"
#include "host/report/radiation_findings.hpp"
#include "host/report/tensors_findings.hpp"
#include "host/report/tip_findings.hpp"

#include <vector>

namespace cowgpu {

/// In the paper's units: the mesh's, and density 1.
std::vector<physics::Comparison> beside_paper(const TensorsResult& found);

/// Of a mesh whose spin decays; empty for other results.
std::vector<physics::Comparison> beside_paper(const RadiationResult& found);

/// Forces of the body, of a ball like it, and of the benchmark on its hooves as modelled, which this stands up.
std::vector<physics::Comparison> beside_paper(const TipResult& found, const Monitor& monitor);

/// Factors of the potential's formula, which in the paper are others.
std::vector<physics::Comparison> potential_beside_paper();

} // namespace cowgpu
