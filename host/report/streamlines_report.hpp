// Streamlines off a cut of a body, and how they are said (host/requests/streamlines.hpp).
#pragma once

#include "host/device_facts.hpp"
#include "host/io/streamline_file.hpp"
#include "host/report/result.hpp"

#include <string>
#include <vector>

namespace cowgpu {

struct StreamlinesResult {
  RawMesh mesh;
  StreamlineTable table;
  DeviceFacts device;
  std::vector<std::string> notes; ///< on the mesh, and what the caller adds
  double read_seconds = 0;        ///< time of checking and cutting the mesh, and what the caller adds for reading it
  double flow_seconds = 0;
};

/// After data/schemas/cowgpu.streamlines.v1.json.
Object document(const StreamlinesResult& result, const std::vector<std::string>& command);

/// Lines for the screen; `plane` is what the user calls the plane.
void write_streamlines(const StreamlinesResult& result, const std::string& plane, const Sink& sink);

} // namespace cowgpu
