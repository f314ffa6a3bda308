#include "host/report/flow_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

std::string point_text(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

List entries(const std::vector<SheetReport>& sheets) {
  List levels;
  for (const SheetReport& s : sheets)
    levels.push_back(Object{{"triangles", s.faces},
                            {"flipped", s.flipped_faces},
                            {"flat", s.flat_faces},
                            {"most_sheets", s.most_sheets},
                            {"folded_points", s.folded_points},
                            {"degree", Numbers{s.least_degree, s.largest_degree}}});
  return levels;
}

Object members(const LevelSetSutures& sutures) {
  const SutureReport& jumps = sutures.jumps;
  return {{"threshold", sutures.threshold},
          {"length", jumps.length},
          {"cells", jumps.cells},
          {"largest", jumps.largest},
          {"theta", jumps.theta},
          {"phi", jumps.phi},
          {"box", List{jumps.low, jumps.high}},
          {"slope_degrees", List{sutures.slope_from, sutures.slope_to}},
          {"slopes", sutures.slopes}};
}

Object members(const LevelSetReport& level_set, const std::string& failure) {
  return {{"queries", level_set.queries},
          {"largest_residual", level_set.largest_residual},
          {"least_slope", level_set.least_slope},
          {"unsettled", level_set.unsettled},
          {"unsettled_angle", level_set.unsettled_angle},
          {"failure", known_text(failure)}};
}

Object members(const ConvergedTable& table) {
  const SphereCoefficients& a = table.expansion.coefficients;
  List rows;
  for (int l = 0; l <= a.lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      List row = {l, m};
      for (int f = 0; f < a.fields; ++f) {
        row.push_back(a.at(f, l, m).real());
        row.push_back(a.at(f, l, m).imag());
      }
      rows.push_back(std::move(row));
    }
  return {{"meaning", "sheets"},
          {"removed_means", Object{{"f_dtheta", table.expansion.mean_dtheta}, {"f_dphi", table.expansion.mean_dphi}}},
          {"uncertainty", table.uncertainty},
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

Object members(const StarShapeTime& star) {
  return {{"lower", star.lower},   {"upper", star.upper}, {"given_up", star.given_up}, {"point", star.point},
          {"normal", star.normal}, {"place", star.place}, {"regions", star.regions},   {"queries", star.queries}};
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

Object members(const FlowReport& points) {
  Object all = {{"points", points.points},   {"slid", points.slid},           {"stationary", points.stationary},
                {"inside", points.inside},   {"restarted", points.restarted}, {"unfinished", points.unfinished},
                {"queries", points.queries}, {"events", points.events},       {"steps", points.steps},
                {"seconds", points.seconds}};
  if (points.slid > 0)
    all.add({{"first_slide", points.first_slide},
             {"median_slide", points.median_slide},
             {"slide_box", List{points.slide_low, points.slide_high}}});
  return all;
}

Object members(const FlowResult& flow) {
  const Value star_shaped = flow.time >= flow.star.upper  ? Value(true)
                            : flow.time < flow.star.lower ? Value(false)
                                                          : Value();
  Object all = {{"meaning", flow.meaning},         {"time", flow.time},
                {"time_choice", flow.time_choice}, {"star_shape", members(flow.star)},
                {"star_shaped", star_shaped},      {"one_to_one", star_shaped},
                {"points", members(flow.points)},  {"sheets", entries(flow.sheets)},
                {"uncertainty", flow.uncertainty}};
  if (flow.level_set) all.add("level_set", members(*flow.level_set, flow.failure));
  if (flow.sutures) all.add("sutures", members(*flow.sutures));
  if (flow.converged) all.add("converged", members(*flow.converged));
  return all;
}

void write_flow_screen(const FlowResult& flow, const Sink& sink) {
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
