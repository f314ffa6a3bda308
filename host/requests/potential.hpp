// The field outside a body, and how well its first multipoles know it.
#pragma once

#include "host/report/potential_findings.hpp"
#include "host/requests/load_body.hpp"
#include "host/requests/places.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace cowgpu {

struct PotentialRequest {
  BodyRequest body; ///< `charge`: volts instead of gravity's potential
  PlaceRequest places;
  int lmax = -1; ///< degree that the series goes to; below 0: 32, or what a file holds
  Derivatives derivatives = Derivatives::second;
  bool exact = false;        ///< the polyhedron's closed form everywhere, or where it is nearer to the truth its series
  bool inside_exact = false; ///< that inside the sphere that holds the body, where points are refused otherwise
  /// A/m times the density, in the body's axes: the induction B of the magnetised mesh too. Needs second derivatives, and no
  /// density for the mesh: it is 1, and parts may have others.
  std::optional<Vec3> magnetisation;
  std::uint64_t extra_bytes = 0;  ///< memory that the caller needs beside the result
  std::vector<std::string> notes; ///< sentences that come after those about the body
};

/// On `threads` threads (0: all) where the closed form is computed. Throws what load_mass(), moments(), find_places() and
/// Backend::potential() throw, Error(point_inside) for points where the series is not the potential, Error(file_format) where
/// the closed form of coefficients is asked for, and Error(too_large).
PotentialResult potential(const PotentialRequest& request, Backend& backend, unsigned threads, Monitor& monitor);

struct SeriesErrorsRequest {
  BodyRequest body; ///< a mesh
  std::vector<int> orders = {0, 1, 2, 4, 8, 16, 32};
  std::vector<double> distances = {1, 1.1, 1.5, 2, 3, 5, 10}; ///< in radii of the sphere that holds the body
};

/// Throws what load_mass() and physics::series_errors() throw, Error(file_format) for coefficients, Error(bad_argument) for
/// orders beyond the largest degree of a potential.
SeriesErrorsResult series_errors(const SeriesErrorsRequest& request, Backend& backend, unsigned threads,
                                 Monitor& monitor);

} // namespace cowgpu
