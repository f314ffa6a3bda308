#include "host/report/transform_report.hpp"

#include "host/io/coefficient_metadata.hpp"
#include "host/report/document_parts.hpp"

#include <fmt/format.h>

namespace cowgpu {
namespace {

std::string grid_text(const SphereGrid& grid) {
  return fmt::format("{}, {} rings of {} points, exact to degree {}", name(grid.kind), grid.rings, grid.ring_length,
                     grid.lmax);
}

std::string fields_text(std::size_t n) {
  return n == 1 ? "1 field" : fmt::format("{} fields", n);
}

} // namespace

void write_plan(const TransformPlan& plan, const Sink& sink) {
  sink(fmt::format("plan: {} of {} to degree {}, {} coefficients each\n", plan.direction,
                   fields_text(plan.names.size()), plan.lmax, SphereCoefficients::count(plan.lmax)));
  sink("grid: " + grid_text(plan.grid) + "\n");
  sink("device: " + device_line(plan.device) + "\n");
  sink(fmt::format("memory: at most {} MiB on the host and {} MiB on the device, files and all\n",
                   (plan.memory.host >> 20) + 1, (plan.memory.device + (1 << 20) - 1) >> 20));
}

void write_screen(const TransformRun& run, const Sink& sink) {
  const TransformPlan& plan = run.plan;
  for (const std::string& note : plan.notes) sink("note: " + note + "\n");
  sink(fmt::format("computed: {} of {} to degree {}, {} coefficients each, in {:.3f} s\n", plan.direction,
                   fields_text(plan.names.size()), plan.lmax, SphereCoefficients::count(plan.lmax),
                   run.report.seconds));
  sink("grid: " + grid_text(plan.grid) + "\n");
  sink(fmt::format("coefficients in the file: {}\n", convention_text(plan.convention)));
  sink("device: " + device_line(plan.device) + "\n");
  sink(fmt::format("time: read {:.3f} s, set-up {:.3f} s, transform {:.3f} s, write {:.3f} s\n", run.read_seconds,
                   run.setup_seconds, run.report.seconds, run.write_seconds));
}

Object document(const TransformRun& run) {
  const TransformPlan& plan = run.plan;
  Object all = opening("cowgpu.transform.v1", run.command, run.created);
  all.add({{"direction", plan.direction},
           {"input", run.input},
           {"output", run.output},
           {"grid", Object{{"kind", name(plan.grid.kind)},
                           {"rings", plan.grid.rings},
                           {"ring_length", plan.grid.ring_length},
                           {"lmax", plan.grid.lmax}}},
           {"lmax", plan.lmax},
           {"fields", plan.names},
           {"normalisation", name(plan.convention.normalisation)},
           {"phase", name(plan.convention.phase)},
           {"device", members(plan.device)},
           {"notes", plan.notes},
           {"timings", Object{{"read", run.read_seconds},
                              {"setup", run.setup_seconds},
                              {"transform", run.report.seconds},
                              {"write", run.write_seconds}}}});
  return all;
}

} // namespace cowgpu
