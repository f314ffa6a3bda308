// `potential --errors`: how good the multipoles of a body are, and from where on.
#pragma once

#include "host/cli/physics.hpp"

#include <string>
#include <vector>

namespace cowgpu::cli {

/// As typed.
struct ErrorOptions {
  std::vector<std::string> orders;
  std::string distances;
  std::vector<std::string> plots;
};

/// Tables and pictures. Throws Error(bad_argument) for orders and distances that mean nothing; what series_errors() throws.
physics::Findings series_errors_found(const LoadedMass& loaded, const ErrorOptions& options, Backend& backend,
                                      unsigned threads, Monitor& monitor);

} // namespace cowgpu::cli
