// What the distance's flow adds to a map or an expansion, ready to be shown.
#pragma once

#include "host/document.hpp"
#include "host/flow/flow_map.hpp"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// A table of an expansion with what is not known of it, [degree][field].
struct ConvergedTable {
  SurfaceExpansion expansion;
  std::vector<std::array<double, 6>> uncertainty;
};

/// How a surface was expanded over the distance's flow (host/flow/flow_map.hpp).
struct FlowResult {
  std::string meaning;             ///< "level-set", "sheets" or "paper"
  double time = 0;                 ///< T, mesh length unit
  std::string time_choice;         ///< "auto" (the star-shape time), "given" or "paper"
  StarShapeTime star;              ///< about the expansion's origin
  double star_seconds = 0;         ///< time of the search, where it is no part of the expansion
  FlowReport points;               ///< flow of the mesh's vertices, or of the finest refinement's
  std::vector<SheetReport> sheets; ///< sheets of each refinement, the mesh itself first
  std::optional<LevelSetReport> level_set;
  std::optional<LevelSetSutures> sutures; ///< sutures of the level set's map
  /// [degree][field], the largest over m; empty where none is known (the paper's recipe).
  std::vector<std::array<double, 6>> uncertainty;
  std::string failure;                     ///< LevelSetExpansion::failure
  std::optional<ConvergedTable> converged; ///< the paper's recipe, converged: signed sheets at the same time
};

/// Whether the body inflated for `time` is star-shaped, in a sentence.
std::string star_shape_sentence(const StarShapeTime& star, double time);

/// The bounds of the least time and where their witness is, in a sentence.
std::string star_shape_text(const StarShapeTime& star);

Object members(const StarShapeTime& star);

/// What befell the points that flowed, in a sentence.
std::string flow_points_text(const FlowReport& points);

Object members(const FlowReport& points);

/// The member `flow` of an expansion.
Object members(const FlowResult& flow);

/// Lines for the screen.
void write_flow_screen(const FlowResult& flow, const Sink& sink);

/// The largest uncertainty among degrees 0 to `last`, by field.
std::array<double, 6> largest_of(const std::vector<std::array<double, 6>>& rows, int last);

} // namespace cowgpu
