#include "host/report/flow_result.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

using nlohmann::ordered_json;

std::string point_text(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

ordered_json point_json(const Vec3& p) {
  return {p.x(), p.y(), p.z()};
}

ordered_json degree_rows_json(const std::vector<std::array<double, 6>>& degrees) {
  ordered_json rows = ordered_json::array();
  for (const auto& row : degrees) rows.push_back(row);
  return rows;
}

ordered_json sheets_json(const std::vector<SheetReport>& sheets) {
  ordered_json levels = ordered_json::array();
  for (const SheetReport& s : sheets)
    levels.push_back({{"triangles", s.faces},
                      {"flipped", s.flipped_faces},
                      {"flat", s.flat_faces},
                      {"most_sheets", s.most_sheets},
                      {"folded_points", s.folded_points},
                      {"degree", {s.least_degree, s.largest_degree}}});
  return levels;
}

ordered_json sutures_json(const LevelSetSutures& sutures) {
  const SutureReport& jumps = sutures.jumps;
  return {{"threshold", sutures.threshold},
          {"length", jumps.length},
          {"cells", jumps.cells},
          {"largest", jumps.largest},
          {"theta", jumps.theta},
          {"phi", jumps.phi},
          {"box", {point_json(jumps.low), point_json(jumps.high)}},
          {"slope_degrees", {sutures.slope_from, sutures.slope_to}},
          {"slopes", sutures.slopes}}; // the library writes NaN as null
}

ordered_json converged_json(const ConvergedTable& table) {
  const SphereCoefficients& a = table.expansion.coefficients;
  ordered_json rows = ordered_json::array();
  for (int l = 0; l <= a.lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      ordered_json row = {l, m};
      for (int f = 0; f < a.fields; ++f) {
        row.push_back(a.at(f, l, m).real());
        row.push_back(a.at(f, l, m).imag());
      }
      rows.push_back(std::move(row));
    }
  return {{"meaning", "sheets"},
          {"removed_means", {{"f_dtheta", table.expansion.mean_dtheta}, {"f_dphi", table.expansion.mean_dphi}}},
          {"uncertainty", degree_rows_json(table.uncertainty)},
          {"coefficients", rows}};
}

const char* meaning_text(const std::string& meaning) {
  if (meaning == "level-set") return "from each direction the level set d = T, from there the closest surface point";
  if (meaning == "sheets") return "all sheets of the flowed surface over a direction, each with its sign, extrapolated";
  return "the paper's recipe: the mesh's vertices in fixed steps, the closest point of what they span";
}

} // namespace

std::array<double, 6> largest_of(const std::vector<std::array<double, 6>>& rows, int last) {
  std::array<double, 6> most{};
  for (std::size_t l = 0; l < rows.size() && l <= std::size_t(last); ++l)
    for (std::size_t f = 0; f < most.size(); ++f) most[f] = std::max(most[f], rows[l][f]);
  return most;
}

std::string star_shape_text(const StarShapeTime& star) {
  std::string text =
      fmt::format("star-shaped about the origin from t* on, {:.9g} <= t* <= {:.9g}", star.lower, star.upper);
  if (star.lower > 0)
    text += fmt::format(" (witness at {}, inflated from {})", point_text(star.place), point_text(star.point));
  text += fmt::format(", from {} regions", star.regions);
  return star.given_up ? text + "; the search for closer bounds was given up" : text;
}

std::string star_shape_sentence(const StarShapeTime& star, double time) {
  if (time >= star.upper)
    return "the inflated body is star-shaped: every direction from the origin meets its surface once";
  if (time < star.lower)
    return fmt::format(
        "warning: T = {:.6g} is before t* = {:.6g}: the inflated body is not star-shaped, and some directions meet its "
        "surface more than once",
        time, star.lower);
  return "whether the inflated body is star-shaped at T is not decided: T lies between the bounds of t*";
}

ordered_json star_shape_json(const StarShapeTime& star) {
  return {{"lower", star.lower},
          {"upper", star.upper},
          {"given_up", star.given_up},
          {"point", point_json(star.point)},
          {"normal", point_json(star.normal)},
          {"place", point_json(star.place)},
          {"regions", star.regions},
          {"queries", star.queries}};
}

std::string flow_points_text(const FlowReport& points) {
  std::string text = fmt::format("{} points flowed, {} slid along the medial axis", points.points, points.slid);
  if (points.slid > 0)
    text += fmt::format(" (the first from t = {:.3g}, half of them by {:.3g}, between {} and {})", points.first_slide,
                        points.median_slide, point_text(points.slide_low), point_text(points.slide_high));
  text += fmt::format(", {} ended where the gradient is 0", points.stationary);
  if (points.inside > 0) text += fmt::format(", {} began inside the body", points.inside);
  if (points.unfinished > 0) text += fmt::format(", {} got stuck", points.unfinished);
  return text;
}

ordered_json flow_points_json(const FlowReport& points) {
  ordered_json json = {{"points", points.points},   {"slid", points.slid},           {"stationary", points.stationary},
                       {"inside", points.inside},   {"restarted", points.restarted}, {"unfinished", points.unfinished},
                       {"queries", points.queries}, {"events", points.events},       {"steps", points.steps},
                       {"seconds", points.seconds}};
  if (points.slid > 0) {
    json["first_slide"] = points.first_slide;
    json["median_slide"] = points.median_slide;
    json["slide_box"] = {point_json(points.slide_low), point_json(points.slide_high)};
  }
  return json;
}

ordered_json flow_json(const FlowResult& flow) {
  const ordered_json star_shaped = flow.time >= flow.star.upper  ? ordered_json(true)
                                   : flow.time < flow.star.lower ? ordered_json(false)
                                                                 : ordered_json();
  ordered_json json = {{"meaning", flow.meaning},
                       {"time", flow.time},
                       {"time_choice", flow.time_choice},
                       {"star_shape", star_shape_json(flow.star)},
                       {"star_shaped", star_shaped},
                       {"one_to_one", star_shaped},
                       {"points", flow_points_json(flow.points)},
                       {"sheets", sheets_json(flow.sheets)},
                       {"uncertainty", degree_rows_json(flow.uncertainty)}};
  if (flow.level_set)
    json["level_set"] = {{"queries", flow.level_set->queries},
                         {"largest_residual", flow.level_set->largest_residual},
                         {"least_slope", flow.level_set->least_slope},
                         {"unsettled", flow.level_set->unsettled},
                         {"unsettled_angle", flow.level_set->unsettled_angle},
                         {"failure", flow.failure.empty() ? ordered_json() : ordered_json(flow.failure)}};
  if (flow.sutures) json["sutures"] = sutures_json(*flow.sutures);
  if (flow.converged) json["converged"] = converged_json(*flow.converged);
  return json;
}

void write_flow_screen(const FlowResult& flow, const std::function<void(std::string_view)>& sink) {
  sink(fmt::format("  flow: {} at T = {:.9g} ({}): {}\n", flow.meaning, flow.time,
                   flow.time_choice == "auto" ? "the least time that is star-shaped" : flow.time_choice,
                   meaning_text(flow.meaning)));
  sink("  flow: " + star_shape_text(flow.star) + "\n");
  sink("  flow: " + star_shape_sentence(flow.star, flow.time) + "\n");
  if (flow.points.points > 0) sink("  flow: " + flow_points_text(flow.points) + "\n");
  for (std::size_t k = 0; k < flow.sheets.size(); ++k) {
    const SheetReport& s = flow.sheets[k];
    sink(fmt::format(
        "  flow: refinement {}: {} of {} triangles folded over, at most {} sheets, degree {:.6g} to {:.6g}\n", k,
        s.flipped_faces, s.faces, s.most_sheets, s.least_degree, s.largest_degree));
  }
  if (flow.level_set)
    sink(fmt::format(
        "  flow: level set met to {:.1e} with {} closest points; least slope along a ray {:.3g}{}\n",
        flow.level_set->largest_residual, flow.level_set->queries, flow.level_set->least_slope,
        flow.level_set->unsettled > 0 ? fmt::format("; {} directions not settled", flow.level_set->unsettled) : ""));
  if (!flow.sutures) return;
  const SutureReport& jumps = flow.sutures->jumps;
  if (jumps.pairs == 0) {
    sink(fmt::format("  flow: no sutures: F jumps nowhere by more than {:.3g}\n", flow.sutures->threshold));
    return;
  }
  sink(fmt::format(
      "  flow: sutures: F jumps by more than {:.3g} along {:.3g} rad, most by {:.4g} at theta {:.4f}, phi {:.4f}\n",
      flow.sutures->threshold, jumps.length, jumps.largest, jumps.theta, jumps.phi));
  if (flow.sutures->slope_to > 0)
    sink(fmt::format("  flow: power per coefficient falls like l^{:.2f} (f_r) and l^{:.2f} (x), l = {} to {}\n",
                     flow.sutures->slopes[0], flow.sutures->slopes[3], flow.sutures->slope_from,
                     flow.sutures->slope_to));
}

} // namespace cowgpu
