#include "host/requests/transform.hpp"

#include "host/bounds.hpp"
#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/report/document_parts.hpp"
#include "host/requests/memory.hpp"
#include "host/spectrum/convert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

namespace cowgpu {
namespace {

// Input, result, the same as real coefficients, the file's image.
MemoryNeed affordable(const TransformPlan& plan, const Backend& backend) {
  const int fields = int(plan.names.size());
  MemoryNeed need = backend.sphere_transform(plan.grid, plan.lmax)->memory(fields);
  const auto n = std::uint64_t(fields), degrees = std::uint64_t(plan.lmax) + 1;
  need.host += n * (16 * plan.grid.points() + 32 * SphereCoefficients::count(plan.lmax) + 8 * degrees * degrees);
  check_memory(need, backend, "lower --lmax or transform fewer fields at once");
  return need;
}

// Data near the end of double's range overflow in sums.
[[noreturn]] void refuse_overflow(const std::string& name, const TransformRun& run) {
  throw Error(Fault::file_format, fmt::format("{}: the {} of these values overflows double precision; scale them down",
                                              name, run.plan.direction));
}

// The coefficients up to degree lmax, or with zeros above.
SphereCoefficients resized(const SphereCoefficients& a, int lmax) {
  SphereCoefficients b(lmax, a.fields);
  for (int f = 0; f < a.fields; ++f)
    for (int m = 0; m <= std::min(a.lmax, lmax); ++m)
      for (int l = m; l <= std::min(a.lmax, lmax); ++l) b.at(f, l, m) = a.at(f, l, m);
  return b;
}

template <class Request>
TransformRun planned_run(const Request& request, const Backend& backend) {
  TransformRun run;
  run.created = utc_now();
  run.input = request.name;
  run.plan = plan_transform(request, backend);
  return run;
}

} // namespace

TransformPlan plan_transform(const AnalyseRequest& request, const Backend& backend) {
  const GridFile& in = request.input;
  if (in.fields() == 0 || in.values.size() != std::size_t(in.fields()) * in.grid.points() || in.grid.rings == 0)
    throw Error(Fault::bad_argument,
                fmt::format("{}: {} fields on {} rings of {} points have not {} values: a grid is "
                            "asked for with its values, field by field",
                            request.name, in.fields(), in.grid.rings, in.grid.ring_length, in.values.size()));
  require_member("the normalisation is", request.convention.normalisation, Normalisation::unnormalised);
  require_member("the phase is", request.convention.phase, Phase::none);
  TransformPlan plan{"analysis",      in.grid,  request.lmax < 0 ? in.lmax : request.lmax,
                     in.names,        in.notes, request.convention,
                     backend.facts(), {}};
  if (plan.lmax > in.grid.lmax)
    throw Error(Fault::bad_argument,
                fmt::format("--lmax {}: the {} rings of {} points of {} give back degrees up to {} "
                            "only; lower --lmax or bring a finer grid",
                            plan.lmax, in.grid.rings, in.grid.ring_length, request.name, in.grid.lmax));
  plan.memory = affordable(plan, backend);
  return plan;
}

TransformPlan plan_transform(const SynthesiseRequest& request, const Backend& backend) {
  const CoefficientSet& in = request.input;
  const int held = in.lmax, degree = request.lmax < 0 ? held : request.lmax;
  TransformPlan plan{"synthesis",
                     make_grid(request.grid, degree),
                     std::min(degree, held),
                     field_names(in.names, in.fields, "value"),
                     in.notes,
                     in.convention,
                     backend.facts(),
                     {}};
  if (plan.lmax < held) plan.notes.push_back(fmt::format("degrees {} to {} were left out", plan.lmax + 1, held));
  plan.memory = affordable(plan, backend);
  return plan;
}

AnalyseResult analyse(const AnalyseRequest& request, Backend& backend, Monitor& monitor) {
  const auto start = Clock::now();
  const GridFile& in = request.input;
  AnalyseResult result;
  TransformRun& run = result.run = planned_run(request, backend);
  const auto transform = backend.sphere_transform(run.plan.grid, run.plan.lmax);
  transform->prepare();
  run.setup_seconds = seconds_since(start);
  SphereCoefficients found(run.plan.lmax, in.fields());
  transform->analyse(in.fields(), in.values, found.values, monitor, &run.report);
  for (const std::complex<double>& a : found.values)
    if (!std::isfinite(a.real()) || !std::isfinite(a.imag())) refuse_overflow(request.name, run);
  result.coefficients = set_of(found, request.convention);
  if (in.names != field_names({}, in.fields(), "value")) result.coefficients.names = in.names;
  return result;
}

SynthesiseResult synthesise(const SynthesiseRequest& request, Backend& backend, Monitor& monitor) {
  const auto start = Clock::now();
  const SphereCoefficients in = field_coefficients(request.input, request.name);
  SynthesiseResult result;
  TransformRun& run = result.run = planned_run(request, backend);
  GridFile& out = result.grid;
  out.grid = run.plan.grid;
  out.lmax = request.lmax < 0 ? in.lmax : request.lmax;
  out.convention = request.input.convention;
  out.names = run.plan.names;
  const auto transform = backend.sphere_transform(out.grid, run.plan.lmax);
  transform->prepare();
  run.setup_seconds = seconds_since(start);
  out.values.resize(std::size_t(in.fields) * out.grid.points());
  const SphereCoefficients low = run.plan.lmax < in.lmax ? resized(in, run.plan.lmax) : SphereCoefficients();
  transform->synthesise(in.fields, run.plan.lmax < in.lmax ? low.values : in.values, out.values, monitor, &run.report);
  if (!std::all_of(out.values.begin(), out.values.end(), [](double v) { return std::isfinite(v); }))
    refuse_overflow(request.name, run);
  return result;
}

} // namespace cowgpu
