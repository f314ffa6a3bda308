#include "host/requests/reconstruct.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/surface_file.hpp"
#include "host/report/document_parts.hpp"
#include "host/requests/limits.hpp"
#include "host/requests/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace cowgpu {
namespace {

// Passes on the wish to stop, and keeps quiet about the parts of an order, which are short.
class QuietMonitor final : public Monitor {
public:
  explicit QuietMonitor(const Monitor& outer) : outer_(outer) {}
  bool stopped() const override { return outer_.stopped(); }

private:
  const Monitor& outer_;
};

int resolution_of(const ReconstructRequest& request, int order) {
  return request.resolution > 0 ? request.resolution : default_resolution(order);
}

int largest_order(const ReconstructRequest& request) {
  return request.orders.empty() ? 0 : request.orders.back();
}

RebuiltOrder rebuild(const ReconstructRequest& request, const ReconstructReport& report, int order,
                     const OrderVisitor& visit, Backend& backend, Monitor& monitor) {
  const auto start = Clock::now();
  RebuiltOrder result;
  result.order = order;
  result.resolution = resolution_of(request, order);
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, result.resolution);
  const TriangleSurface surface = reconstruct(report.expansion, report.fields, order, grid, backend, monitor);
  result.vertices = surface.vertices.size();
  result.faces = surface.faces.size();
  result.measures = measure(report.expansion, report.fields, order, backend, monitor);
  check_stop(monitor);
  if (report.body)
    result.distance = surface_distance(surface.vertices, surface.faces, report.body->surface.vertices(),
                                       report.body->surface.faces(), report.samples, request.threads, monitor);
  if (visit) result.output = visit(report, order, surface);
  result.seconds = seconds_since(start);
  return result;
}

} // namespace

void check_reconstruct(const ReconstructRequest& request) {
  require_member("the fields are", request.fields, SurfaceFields::f);
  require_range("the resolution is", request.resolution, 0, largest_grid_degree);
  require_range("the samples are", request.samples, std::size_t(1), most_samples);
  if (std::adjacent_find(request.orders.begin(), request.orders.end(), std::greater<>()) != request.orders.end() ||
      (!request.orders.empty() && request.orders.front() < 0))
    throw Error(Fault::bad_argument,
                fmt::format("orders {}: they must ascend from 0 on", fmt::join(request.orders, ",")));
  check_surface_choice(request.source, largest_order(request));
  const int largest = request.orders.empty() ? 8 : request.orders.back();
  if (request.resolution > 0 && request.resolution < largest)
    throw Error(Fault::bad_argument, fmt::format("--resolution {} cannot show order {}; it must be at least the order",
                                                 request.resolution, largest));
}

ReconstructReport reconstruct(const ReconstructRequest& request, Backend& backend, Monitor& monitor,
                              const OrderVisitor& visit) {
  const auto start = Clock::now();
  check_reconstruct(request);
  SurfaceSource source = load_surface(request.source, largest_order(request), backend, monitor);
  std::vector<int> orders = request.orders;
  if (orders.empty())
    for (int order = 0; order <= std::min(8, source.expansion.coefficients.lmax); ++order) orders.push_back(order);
  check_memory(rebuild_memory(orders.back(), resolution_of(request, orders.back()), backend), backend,
               "lower --order or --resolution");

  ReconstructReport report;
  report.created = utc_now();
  report.input = request.source.input;
  report.from_file = is_result_file(request.source.input);
  report.device = backend.facts();
  report.name = source.name;
  report.recipe = source.recipe;
  report.map_method = source.map_method;
  report.mesh = source.mesh;
  report.mesh_hash = source.mesh_hash;
  report.expansion = std::move(source.expansion);
  report.fields = request.fields;
  report.body = std::move(source.body);
  report.samples = request.samples;
  report.notes = std::move(source.notes);
  report.source_seconds = seconds_since(start);
  QuietMonitor quiet(monitor);
  double done = 0, all = 0; // an order costs about its square, and 64 at least
  const auto cost = [](int order) { return std::pow(std::max(order, 64), 2); };
  for (const int order : orders) all += cost(order);
  for (const int order : orders) {
    check_stop(monitor);
    monitor.progress("orders rebuilt", done / all);
    done += cost(order);
    report.orders.push_back(rebuild(request, report, order, visit, backend, quiet));
  }
  report.total_seconds = seconds_since(start);
  return report;
}

} // namespace cowgpu
