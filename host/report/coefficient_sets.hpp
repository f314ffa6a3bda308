// The expansions in a result as coefficients that every file format takes.
#pragma once

#include "host/coefficient_set.hpp"
#include "host/report/result.hpp"

namespace cowgpu {

/// The mass multipoles, complex, orthonormal, with the Condon-Shortley phase.
CoefficientSet mass_set(const ExpandResult& result);

/// Integral of density r^2 about the origin: xx + yy + zz of the tensor that the JSON has, added in this order, so that every
/// file of one result says the same double.
double second_moment_of(const ExpandResult& result);

/// The six fields of a surface, in the same convention.
CoefficientSet surface_set(const ExpandResult& result, const SurfaceResult& surface);

/// The units of a body: m and kg where they are stated, else what stands for those of the mesh.
std::string length_unit(const Body& body);
std::string mass_unit(const Body& body);

/// Where all of them come from.
Provenance provenance_of(const ExpandResult& result);

} // namespace cowgpu
