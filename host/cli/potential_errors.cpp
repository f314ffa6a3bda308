#include "host/cli/potential_errors.hpp"

#include "host/cli/order_list.hpp"
#include "host/error.hpp"
#include "host/number.hpp"
#include "host/physics/potential.hpp"
#include "host/report/potential_plot.hpp"

#include <fmt/format.h>

#include <sstream>

namespace cowgpu::cli {

using namespace physics;

namespace {

std::vector<double> parse_distances(const std::string& text) {
  std::vector<double> distances;
  std::istringstream words(text + ",");
  for (std::string word; std::getline(words, word, ',');) {
    const auto value = read_number(word);
    if (!value || !(*value >= 1) || !(*value <= farthest_good))
      throw Error(Fault::bad_argument, fmt::format("--distances {}: \"{}\" is not a distance; distances are numbers "
                                                   "from 1 to {} between commas, in radii of "
                                                   "the sphere that holds the body",
                                                   text, word, farthest_good));
    distances.push_back(*value);
  }
  return distances;
}

void add_errors(const SeriesErrors& errors, Findings& found) {
  found.rows.push_back({"directions", "directions of root mean squares", double(errors.directions)});
  found.rows.push_back({"truth_from", "distance from which a series is truth", errors.truth_from, "radii"});
  found.rows.push_back({"truth_degree", "degree of that series", double(errors.truth_degree)});
  found.rows.push_back({"truth_error", "error of that series at that distance", errors.truth_error});
  Table table{
      "errors",
      "relative errors of the series, by distance in Brillouin radii and order",
      {{"distance"}, {"order"}, {"potential_max"}, {"potential_rms"}, {"acceleration_max"}, {"acceleration_rms"}},
      {}};
  for (const SeriesError& e : errors.rows)
    table.rows.push_back(
        {e.distance, double(e.order), e.potential_max, e.potential_rms, e.acceleration_max, e.acceleration_rms});
  Table good{"good_from",
             "from which distance on, in Brillouin radii, an order is right to 1e-3, 1e-6 and 1e-9 in every direction, "
             "potential and acceleration",
             {{"order"}, {"1e-3"}, {"1e-6"}, {"1e-9"}},
             {}};
  for (const GoodFrom& g : errors.good_from) {
    std::vector<Value> row = {double(g.order)};
    for (const auto& distance : g.distance) row.push_back(distance ? Value(*distance) : Value());
    good.rows.push_back(row);
  }
  found.tables = {std::move(table), std::move(good)};
}

} // namespace

Findings series_errors_found(const LoadedMass& loaded, const ErrorOptions& options, Backend& backend, unsigned threads,
                             Monitor& monitor) {
  const std::vector<int> orders = parse_orders(options.orders);
  for (const int order : orders)
    if (order > largest_potential_degree)
      throw Error(Fault::bad_argument, fmt::format("--orders: {} is beyond {}, the largest degree of a potential",
                                                   order, largest_potential_degree));
  const std::vector<double> distances = parse_distances(options.distances);
  const SeriesErrors errors = series_errors(*loaded.mesh, orders, distances, backend, threads, monitor);
  Findings found(subject(loaded));
  found.notes.push_back(fmt::format(
      "the truth is the exact potential of the polyhedron (Werner and Scheeres 1997), from {:.4g} radii on the series "
      "to degree {}",
      errors.truth_from, errors.truth_degree));
  found.notes.push_back("the largest errors are searched: on a grid that resolves the first degrees left out, at the "
                        "ends of the axes, over the outermost vertices, and uphill from the best of these; rounding, "
                        "about 1e-15, is not in them");
  found.rows = {
      {"origin", "origin", loaded.mesh->origin, std::string(loaded.mesh->units().stated ? "m" : mesh_length_unit)},
      {"brillouin_radius", "Brillouin radius", loaded.mesh->brillouin_radius,
       std::string(loaded.mesh->units().stated ? "m" : mesh_length_unit)}};
  add_errors(errors, found);
  for (const std::string& picture : options.plots)
    plot::write_plot(series_errors_plot(errors, fmt::format("How good the multipoles of {} are", found.input_name)),
                     picture);
  return found;
}

} // namespace cowgpu::cli
