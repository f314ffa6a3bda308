// The library's component `moments`: closed meshes from arrays, bodies, their exact multipole moments on the CPU or a GPU, and
// how well these are known. It needs none of what reads files, maps surfaces or draws.
#pragma once

#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/mass/verify.hpp"
#include "host/mesh/body.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/mesh/mend.hpp"
#include "host/mesh/tensors.hpp"
#include "host/monitor.hpp"
#include "host/multipoles.hpp"
