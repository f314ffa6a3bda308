// Errors of the host side: a closed vocabulary, each entry with a stable name and an exit code.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace cowgpu {

/// Everything that can go wrong, as a caller may want to tell it apart.
enum class Fault {
  bad_argument,         ///< a command-line word that means nothing, or a value out of range
  file_syntax,          ///< a file that breaks its format's grammar
  file_truncated,       ///< a file that ends before what its header announces
  file_format,          ///< a file of no format known here
  mesh_missing,         ///< a named mesh that is not on this machine
  page_missing,         ///< the page of reports, which is not built on this machine
  mesh_empty,           ///< no face, or no vertex
  mesh_not_finite,      ///< NaN or infinity among the coordinates
  mesh_index_range,     ///< a face names a vertex that does not exist
  mesh_open,            ///< an edge with a face on one side only
  mesh_unbalanced,      ///< an edge run through more often in one direction than in the other
  mesh_inside_out,      ///< negative volume: the faces look inwards
  mesh_no_volume,       ///< volume zero, or not to be told from zero
  mesh_edge_manifold,   ///< an edge with more than two faces
  mesh_vertex_manifold, ///< a vertex whose faces form more than one fan
  map_topology,         ///< a surface that is not one sphere: several shells, or holes through it
  map_failed,           ///< a map to the sphere that could not be made: a singular system, a vertex without a place
  mesh_range,           ///< coordinates too large or too small to compute with in double precision
  point_inside,         ///< a place inside the sphere that holds a body, where its series is not its potential
  point_singular,       ///< a place where a field is infinite: on an edge of a polyhedron
  cannot_stand,         ///< a body that does not rest on what it touches the ground with
  too_large,            ///< more memory than this machine has, or than a device offers
  no_loader,            ///< no Vulkan loader on this machine
  no_device,            ///< no Vulkan device, or none of that name
  no_fp64,              ///< a device without double precision
  device_failed,        ///< a Vulkan call failed
  device_lost,          ///< the device was lost; nothing more can be computed on it
  cannot_read,          ///< a file that cannot be opened or read
  cannot_write,         ///< a file that cannot be written
  check_failed,         ///< a numeric check out of bounds
  interrupted,          ///< the user asked to stop
};

/// The stable name of a fault ("mesh-open"), as printed and as tests look for it.
std::string_view name(Fault fault);

/// The exit code of the program for a fault: 1 check failed, 2 usage, 3 bad input, 4 device, 5 input/output,
/// 130 interrupted.
int exit_code(Fault fault);

/// An error is a fault and one or more sentences: what, where, why, what to try.
class Error : public std::runtime_error {
public:
  Error(Fault fault, const std::string& sentence) : std::runtime_error(sentence), fault_(fault) {}
  Fault fault() const { return fault_; }

private:
  Fault fault_;
};

} // namespace cowgpu
