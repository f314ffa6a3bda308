#include "host/report/roundtrip_report.hpp"

#include "host/report/document_parts.hpp"

#include <fmt/format.h>

namespace cowgpu {
namespace {

Object members(const TransformReport& report) {
  return {{"legendre_seconds", report.legendre_seconds},
          {"fourier_seconds", report.fourier_seconds},
          {"legendre_flops", report.legendre_flops},
          {"fourier_flops", report.fourier_flops},
          {"kernels", entries(report.kernels)}};
}

std::string memory_text(const MemoryNeed& need) {
  return fmt::format("at most {} MiB on the host and {} MiB on the device", (need.host >> 20) + 1,
                     (need.device + (1 << 20) - 1) >> 20);
}

void write_head(const RoundtripResult& o, const Sink& sink) {
  sink(fmt::format("round trip: {} of random coefficients to degree {} (uniform in [-0.5, 0.5], seed {})\n",
                   o.request.fields == 1 ? "1 field" : fmt::format("{} fields", o.request.fields), o.request.lmax,
                   o.request.seed));
  sink(fmt::format("grid: {}, {} rings of {} points\n", name(o.grid.kind), o.grid.rings, o.grid.ring_length));
  for (const std::string& note : o.notes) sink("note: " + note + "\n");
  sink("device: " + device_line(o.device) + "\n");
}

} // namespace

void write_screen(const RoundtripResult& o, const Sink& sink) {
  write_head(o, sink);
  sink(fmt::format("  {:<18} {:.2e}  largest error over largest coefficient (bound {:.1e}: {})\n", "max_error",
                   o.error.max, o.bound, o.passed() ? "passed" : "FAILED"));
  sink(fmt::format("  {:<18} {:.2e}  root mean square, relative\n", "rms_error", o.error.rms));
  const auto seconds = [&](const char* what, double value, const char* remark) {
    sink(fmt::format("  {:<18} {:.6f} s{}\n", what, value, remark));
  };
  seconds("set-up", o.setup_seconds, "  nodes, weights, recurrences");
  seconds("synthesis", o.synthesis.seconds,
          o.request.runs == 1 ? "  after one to warm up" : "  median after one to warm up");
  seconds("analysis", o.analysis.seconds, "");
  sink(fmt::format("  {:<18} {}; peak of the process {} MiB\n", "memory", memory_text(o.memory),
                   o.peak_resident_bytes >> 20));
}

void write_plan(const RoundtripResult& o, const Sink& sink) {
  write_head(o, sink);
  sink("memory: " + memory_text(o.memory) + "\n");
}

Object document(const RoundtripResult& o) {
  Object all = opening("cowgpu.roundtrip.v1", o.command, o.created);
  all.add({{"device", members(o.device)},
           {"notes", o.notes},
           {"grid", Object{{"kind", name(o.grid.kind)}, {"rings", o.grid.rings}, {"ring_length", o.grid.ring_length}}},
           {"lmax", o.request.lmax},
           {"fields", o.request.fields},
           {"seed", o.request.seed},
           {"runs", o.request.runs},
           {"max_error", o.error.max},
           {"rms_error", o.error.rms},
           {"bound", o.bound},
           {"passed", o.passed()},
           {"setup_seconds", o.setup_seconds},
           {"synthesis_seconds", o.synthesis.seconds},
           {"analysis_seconds", o.analysis.seconds},
           {"synthesis", members(o.synthesis)},
           {"analysis", members(o.analysis)},
           {"memory", Object{{"host_bytes", o.memory.host},
                             {"device_bytes", o.memory.device},
                             {"peak_resident_bytes", o.peak_resident_bytes}}}});
  return all;
}

} // namespace cowgpu
