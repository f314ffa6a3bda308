// How far the numbers of requests go. The functions that take the requests refuse what is beyond, whoever asks.
#pragma once

#include "host/bounds.hpp"
#include "host/moment_problem.hpp"
#include "host/potential.hpp"
#include "host/render.hpp"
#include "host/spectrum/expand_surface.hpp"
#include "host/sphere_grid.hpp"
#include "host/sphere_transform.hpp"

#include <cstddef>

namespace cowgpu {

// Beside largest_degree, largest_surface_degree, largest_grid_degree, largest_potential_degree, largest_picture, most_fields
// and most_threads, which the headers above say.
inline constexpr double largest_cut_off = 1e-3;                                ///< of moments
inline constexpr int most_runs = 1000;                                         ///< of what is timed
inline constexpr int least_flow_grid = 64, most_refinements = 5;               ///< of an expansion over the flow
inline constexpr double least_tolerance = 1e-12, largest_tolerance = 1e-2;     ///< of the flow
inline constexpr int least_cells = 4, most_cells = 1024;                       ///< of level surfaces
inline constexpr std::size_t least_lattice = 2, most_lattice = 4096;           ///< points along a side
inline constexpr int most_along_plane = 8192, most_along_grid = 1024;          ///< points along a side
inline constexpr std::size_t most_samples = 100'000'000;                       ///< points of a surface
inline constexpr unsigned most_sweeps = 1'000'000, most_relabellings = 10'000; ///< of stretch maps
inline constexpr std::size_t most_streamlines = 1'000'000;
inline constexpr double least_force = 1e-30, largest_force = 1e30; ///< of pushes, N
inline constexpr double shortest_push = 1e-15, longest_push = 1e9; ///< s
inline constexpr int least_figure_degree = 8;
inline constexpr std::size_t most_figure_lines = 100'000;

} // namespace cowgpu
