// What is wrong in "Higher multipoles of the cow", with both numbers (host/requests/errata.hpp).
#pragma once

#include "host/paper/errata.hpp"
#include "host/report/result.hpp"

#include <string>
#include <vector>

namespace cowgpu {

struct ErrataResult {
  std::vector<physics::Comparison> numbers; ///< by erratum
  std::vector<std::string> notes;           ///< set by the caller
};

/// Every erratum with its numbers, after data/schemas/cowgpu.errata.v1.json.
Object document(const ErrataResult& result, const std::vector<std::string>& command);

/// The same for the screen.
void write_errata(const ErrataResult& result, const Sink& sink);

} // namespace cowgpu
