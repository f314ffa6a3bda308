// Lists of orders on the command line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cowgpu::cli {

/// Stands for the body itself in a list of orders.
inline constexpr int whole_mesh = -1;

/// Reads "0..7,16,32": whole numbers and ranges, of all `lists`, in the order typed, each once; with `whole` also
/// that word ("mesh", "full") for the body itself. Throws Error(bad_argument) for what is none of these, falls, or is beyond largest_surface_degree.
std::vector<int> parse_orders(const std::vector<std::string>& lists, std::string_view whole = {});

} // namespace cowgpu::cli
