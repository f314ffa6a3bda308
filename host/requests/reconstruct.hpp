// What `reconstruct` computes: the body again, at any order, from the coefficients of its surface.
#pragma once

#include "host/report/reconstruct_report.hpp"
#include "host/requests/surface_source.hpp"

#include <functional>
#include <string>
#include <vector>

namespace cowgpu {

struct ReconstructRequest {
  SurfaceChoice source;
  std::vector<int> orders; ///< ascending; empty: 0 to 8, as far as the expansion goes
  SurfaceFields fields = SurfaceFields::xyz;
  int resolution = 0; ///< degree of the Clenshaw-Curtis grid of vertices; 0: default_resolution() of each order
  std::size_t samples = 20000; ///< points of each surface that distances are taken from
  unsigned threads = 0;        ///< threads of the distances; 0: all
};

/// What is done with the body of one order before the next is rebuilt. All of `report` but its `orders` is known. Returns the
/// name of the file that the body went to, or "".
using OrderVisitor =
    std::function<std::string(const ReconstructReport& report, int order, const TriangleSurface& body)>;

/// Throws Error(bad_argument) for what reconstruct() refuses and no file need be read for.
void check_reconstruct(const ReconstructRequest& request);

/// Reads or makes the expansion, then rebuilds and measures each order; with its distance from the mesh where that is known.
/// The caller fills in `command`. Throws what load_surface(), reconstruct() and measure() of one order throw;
/// Error(bad_argument) for an order beyond the expansion or the resolution, too_large, interrupted.
ReconstructReport reconstruct(const ReconstructRequest& request, Backend& backend, Monitor& monitor,
                              const OrderVisitor& visit = {});

} // namespace cowgpu
