#include "host/report/errata_report.hpp"

#include "host/report/document_parts.hpp"

#include <fmt/format.h>

namespace cowgpu {

Object document(const ErrataResult& result, const std::vector<std::string>& command) {
  List list;
  for (const paper::Erratum& e : paper::errata()) {
    List numbers;
    for (const physics::Comparison& n : result.numbers)
      if (n.erratum == e.number)
        numbers.push_back(
            Object{{"quantity", n.quantity}, {"right", n.ours}, {"uncertainty", n.uncertainty}, {"paper", n.printed}});
    list.push_back(Object{{"number", e.number},
                          {"paper", e.printed},
                          {"right", e.right},
                          {"why", e.why},
                          {"shown_by", e.shown_by},
                          {"numbers", numbers}});
  }
  Object all = opening("cowgpu.errata.v1", command);
  all.add({{"notes", result.notes}, {"errata", list}});
  return all;
}

void write_errata(const ErrataResult& result, const Sink& sink) {
  sink("errata of Higher multipoles of the cow\n");
  for (const std::string& note : result.notes) sink("note: " + note + "\n");
  for (const paper::Erratum& e : paper::errata()) {
    sink(fmt::format("\n{:>2}. paper: {}\n    right: {}\n    why:   {}\n", e.number, e.printed, e.right, e.why));
    if (*e.shown_by) sink(fmt::format("    see:   {}\n", e.shown_by));
    for (const physics::Comparison& n : result.numbers)
      if (n.erratum == e.number)
        sink(fmt::format("    {:<55} {:>13.8g}  paper {:>12.6g}{}\n", n.quantity, n.ours, n.printed,
                         n.uncertainty > 0 ? fmt::format("  (+- {:.1g})", n.uncertainty) : ""));
  }
}

} // namespace cowgpu
