// What "Higher multipoles of the cow" asks for, as requests.
#pragma once

#include "host/paper/recipe.hpp"
#include "host/requests/expand_surfaces.hpp"
#include "host/requests/load_body.hpp"
#include "host/requests/radiate.hpp"

namespace cowgpu {

/// The paper's body: the mesh `benchmark` in its unit of 2.39 m, as dense as water.
BodyRequest paper_body();

/// Its radiation: it turns about y at 1 rad/s, from 12 million years after the Big Bang until now.
RadiateRequest paper_radiation();

/// Has the harmonic map and the flow of `choice` made and read as the paper's tables ask for, about the mesh's origin, with
/// aliasing estimated to say how far the paper is from converged values. Throws Error(bad_argument) where it asks for neither.
void take_paper_recipe(ExpansionChoice& choice);

} // namespace cowgpu
