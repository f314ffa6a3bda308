#include "host/error.hpp"

namespace cowgpu {

std::string_view name(Fault fault) {
  switch (fault) {
  case Fault::bad_argument: return "bad-argument";
  case Fault::file_syntax: return "file-syntax";
  case Fault::file_truncated: return "file-truncated";
  case Fault::file_format: return "file-format";
  case Fault::mesh_missing: return "mesh-missing";
  case Fault::page_missing: return "page-missing";
  case Fault::mesh_empty: return "mesh-empty";
  case Fault::mesh_not_finite: return "mesh-not-finite";
  case Fault::mesh_index_range: return "mesh-index-range";
  case Fault::mesh_open: return "mesh-open";
  case Fault::mesh_unbalanced: return "mesh-unbalanced";
  case Fault::mesh_inside_out: return "mesh-inside-out";
  case Fault::mesh_no_volume: return "mesh-no-volume";
  case Fault::mesh_edge_manifold: return "mesh-edge-manifold";
  case Fault::mesh_vertex_manifold: return "mesh-vertex-manifold";
  case Fault::map_topology: return "map-topology";
  case Fault::map_failed: return "map-failed";
  case Fault::mesh_range: return "mesh-range";
  case Fault::point_inside: return "point-inside";
  case Fault::point_singular: return "point-singular";
  case Fault::cannot_stand: return "cannot-stand";
  case Fault::too_large: return "too-large";
  case Fault::no_loader: return "no-loader";
  case Fault::no_device: return "no-device";
  case Fault::no_fp64: return "no-fp64";
  case Fault::device_failed: return "device-failed";
  case Fault::device_lost: return "device-lost";
  case Fault::cannot_read: return "cannot-read";
  case Fault::cannot_write: return "cannot-write";
  case Fault::check_failed: return "check-failed";
  case Fault::interrupted: return "interrupted";
  }
  return "unknown";
}

int exit_code(Fault fault) {
  switch (fault) {
  case Fault::check_failed: return 1;
  case Fault::bad_argument: return 2;
  case Fault::no_loader:
  case Fault::no_device:
  case Fault::no_fp64:
  case Fault::device_failed:
  case Fault::device_lost: return 4;
  case Fault::page_missing:
  case Fault::cannot_read:
  case Fault::cannot_write: return 5;
  case Fault::interrupted: return 130;
  default: return 3;
  }
}

} // namespace cowgpu
