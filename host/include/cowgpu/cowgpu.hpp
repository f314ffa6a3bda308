// The whole library: what each command of the program does as a function of a request, `expand(ExpandRequest)`, beside the parts
// that these are made of. Errors are thrown as cowgpu::Error (host/error.hpp).
#pragma once

#include <cowgpu/moments.hpp>

#include "host/requests/convert.hpp"
#include "host/requests/diff.hpp"
#include "host/requests/drop.hpp"
#include "host/requests/expand.hpp"
#include "host/requests/expand_flow.hpp"
#include "host/requests/expand_surfaces.hpp"
#include "host/requests/inspect.hpp"
#include "host/requests/load_body.hpp"
#include "host/requests/memory.hpp"
#include "host/requests/places.hpp"
#include "host/requests/potential.hpp"
#include "host/requests/radiate.hpp"
#include "host/requests/reconstruct.hpp"
#include "host/requests/roundtrip.hpp"
#include "host/requests/spectrum.hpp"
#include "host/requests/surface_source.hpp"
#include "host/requests/tensors.hpp"
#include "host/requests/tides.hpp"
#include "host/requests/tip.hpp"
#include "host/requests/transform.hpp"
