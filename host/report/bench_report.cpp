#include "host/report/bench_report.hpp"

#include <fmt/format.h>

namespace cowgpu {

Object document(const BenchResult& result) {
  List devices, rows;
  for (const BenchPath& path : result.paths)
    devices.push_back(Object{{"path", path.name}, {"device", device_line(path.device)}, {"peak", path.peak}});
  for (const BenchRow& row : result.rows)
    rows.push_back(Object{{"lmax", row.lmax},
                          {"path", result.paths[row.path].name},
                          {"seconds", row.seconds},
                          {"flops_per_second", row.flops_per_second},
                          {"of_peak", row.flops_per_second / result.paths[row.path].peak},
                          {"elements", row.elements},
                          {"full_elements", row.full_elements}});
  return {{"schema", "cowgpu.bench.v1"},
          {"mesh", mesh_line(result.mesh)},
          {"runs", result.runs},
          {"devices", devices},
          {"rows", rows}};
}

void write_bench(const BenchResult& result, const Sink& sink) {
  sink(mesh_line(result.mesh) + "\n");
  for (const std::string& note : result.notes) sink("note: " + note + "\n");
  for (const BenchPath& path : result.paths)
    sink(fmt::format("{}: {}; multiply-add peak {:.1f} GFlop/s\n", path.name, device_line(path.device),
                     path.peak * 1e-9));
  sink(fmt::format("median of {} runs after one to warm up, paths in turn; verified before\n\n", result.runs));
  sink(fmt::format("  {:>5}  {:<18} {:>10} {:>10} {:>10} {:>8}\n", "lmax", "path", "seconds", "GFlop/s", "of peak",
                   "ratio"));
  double base = 0; // the first path's
  for (const BenchRow& row : result.rows) {
    const BenchPath& path = result.paths[row.path];
    if (row.path == 0) base = row.seconds;
    sink(fmt::format("  {:>5}  {:<18} {:>10.4f} {:>10.1f} {:>8.0f} % {:>8.2f}\n", row.lmax, path.name, row.seconds,
                     row.flops_per_second * 1e-9, 100 * row.flops_per_second / path.peak, base / row.seconds));
  }
}

} // namespace cowgpu
