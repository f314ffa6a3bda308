// What an application of the multipoles found, on the screen and as a document.
#pragma once

#include "host/physics/findings.hpp"
#include "host/report/result.hpp"

#include <string>
#include <vector>

namespace cowgpu {

/// The document `schema` ("cowgpu.tensors.v1"): program, command, created, input, notes, each row and each table as a member,
/// `units` and, where there are any, `paper`.
Object document(const physics::Findings& findings, const std::string& schema, const std::vector<std::string>& command);

/// Title, notes, a line or three for each row, tables with aligned columns, and one of the paper's numbers.
void write_findings(const physics::Findings& findings, const Sink& sink);

} // namespace cowgpu
