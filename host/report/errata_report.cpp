#include "host/report/errata_report.hpp"

#include "host/report/json_parts.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace cowgpu {

using nlohmann::ordered_json;

ordered_json errata_json(const ErrataResult& result, const std::vector<std::string>& command) {
  ordered_json list = ordered_json::array();
  for (const paper::Erratum& e : paper::errata()) {
    ordered_json numbers = ordered_json::array();
    for (const physics::Comparison& n : result.numbers)
      if (n.erratum == e.number)
        numbers.push_back(
            {{"quantity", n.quantity}, {"right", n.ours}, {"uncertainty", n.uncertainty}, {"paper", n.printed}});
    list.push_back({{"number", e.number},
                    {"paper", e.printed},
                    {"right", e.right},
                    {"why", e.why},
                    {"shown_by", e.shown_by},
                    {"numbers", numbers}});
  }
  return {{"schema", "cowgpu.errata.v1"}, {"program", program_json()}, {"command", command},
          {"created", utc_now()},         {"notes", result.notes},     {"errata", list}};
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
