// Lists of orders on the command line.
#pragma once

#include <string>
#include <vector>

namespace cowgpu::cli {

/// Stands for the mesh itself in a list of orders.
inline constexpr int whole_mesh = -1;

/// Reads "0..7,16,32": whole numbers and ranges, of all `lists`, in the order typed, each once; with `mesh_too` also the
/// word "mesh". Throws Error(bad_argument) for what is none of these, falls, or is beyond largest_surface_degree.
std::vector<int> parse_orders(const std::vector<std::string>& lists, bool mesh_too = false);

} // namespace cowgpu::cli
