#include "host/reproduce/report.hpp"

#include "host/io/result_json.hpp"
#include "host/report/document_parts.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace cowgpu::reproduce {
namespace {

// One number or two.
Value value(const std::vector<double>& parts) {
  if (parts.empty()) return {};
  if (parts.size() == 1) return parts[0];
  return parts;
}

std::string shown(const std::vector<double>& parts) {
  if (parts.empty()) return "-";
  if (parts.size() == 1) return fmt::format("{:.7g}", parts[0]);
  return fmt::format("{:.6g} {} {:.6g}i", parts[0], parts[1] < 0 ? '-' : '+', std::abs(parts[1]));
}

// A cell of a table: bars and line ends would end it.
std::string cell(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '|') safe += '\\';
    safe += c == '\n' ? ' ' : c;
  }
  return safe;
}

// As a shell takes it.
std::string quoted(const std::vector<std::string>& words) {
  std::string line = "cowgpu";
  for (const std::string& word : words) {
    const bool plain =
        word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./:,@=+") ==
        std::string::npos;
    line += plain && !word.empty() ? " " + word : " '" + word + "'";
  }
  return line;
}

std::string heading(const Reproduction& all) {
  std::string text = "# Higher multipoles of the cow, reproduced\n\n";
  if (!all.papers_mesh)
    text += fmt::format(
        "# THIS IS NOT THE PAPER'S COW\n\n**{} Everything below is of `{}`, and nothing is compared.{}**\n\n",
        all.asked_for ? "Another body was asked for." : "The paper's mesh is not on this machine.", all.mesh,
        all.asked_for ? "" : " `cowgpu meshes` says where to get the paper's mesh.");
  const Tally counts = tally(all.rows);
  text += fmt::format(
      "Of {} numbers that the paper prints, {} agree to its printed digits, {} differ (each with the reason)",
      all.rows.size(), counts.agrees, counts.differs);
  if (counts.not_compared) text += fmt::format(", {} not compared", counts.not_compared);
  if (counts.not_computed) text += fmt::format(", **{} not computed**", counts.not_computed);
  text += ".\n\n";
  text += fmt::format("- mesh: {}, SHA-256 `{}`\n", cell(all.mesh), all.mesh_hash);
  if (all.device.is_object())
    text += fmt::format("- device: {} ({}), {}\n", all.device.value("name", "?"), all.device.value("type", "?"),
                        all.device.value("driver", "?"));
  text += fmt::format("- program: cowgpu {}; {}; {:.1f} s of stages\n\n", version, all.created, all.seconds);
  return text;
}

// Reasons repeat from row to row: a letter stands for each, explained below the table.
class Reasons {
public:
  std::string letter(const std::string& reason) {
    if (reason.empty()) return "";
    const auto found = std::find(known_.begin(), known_.end(), reason);
    const auto place = std::size_t(found - known_.begin());
    if (found == known_.end()) known_.push_back(reason);
    return fmt::format("({})", place + 1);
  }
  // All of them, and a new start.
  std::string explained() {
    std::string text;
    for (std::size_t i = 0; i < known_.size(); ++i) text += fmt::format("\n({}) {}.\n", i + 1, cell(known_[i]));
    known_.clear();
    return text;
  }

private:
  std::vector<std::string> known_;
};

void add_tables(const Reproduction& all, std::string& text) {
  std::string table;
  Reasons reasons;
  for (const Row& row : all.rows) {
    if (row.table != table) {
      table = row.table;
      text += reasons.explained();
      text += fmt::format("\n## {}{}\n\n| | paper | here | difference | verdict | why |\n|---|---|---|---|---|---|\n",
                          char(std::toupper(table[0])), table.substr(1));
    }
    text += fmt::format("| {} | {} | {} | {} | {} | {} |\n", cell(row.item), cell(row.printed), shown(row.ours),
                        row.difference ? fmt::format("{:+.2g}", *row.difference) : "-",
                        row.verdict == Verdict::agrees ? "agrees" : fmt::format("**{}**", name(row.verdict)),
                        reasons.letter(row.reason));
  }
  text += reasons.explained();
}

void add_errata(const Reproduction& all, std::string& text) {
  const auto list = all.errata.find("errata");
  if (list == all.errata.end() || !list->is_array()) return;
  text += "\n## Errata\n\n";
  for (const auto& entry : *list) {
    text += fmt::format("{}. *The paper:* {}. *Right:* {}. {}.\n", entry.value("number", 0), entry.value("paper", ""),
                        entry.value("right", ""), entry.value("why", ""));
    for (const auto& number : entry.value("numbers", nlohmann::json::array()))
      if (number.value("right", nlohmann::json()).is_number() && number.value("paper", nlohmann::json()).is_number())
        text += fmt::format("   - {}: {:.6g}, in the paper {:.6g}\n", number.value("quantity", ""),
                            number["right"].get<double>(), number["paper"].get<double>());
  }
}

void add_stages(const Reproduction& all, std::string& text) {
  text += "\n## Stages\n\nEach is a command that runs by itself, in this folder.\n\n| stage | seconds | exit | command "
          "|\n|---|---|---|---|\n";
  for (const Ran& ran : all.stages)
    text += fmt::format("| {} | {:.1f}{} | {} | `{}` |\n", ran.stage.what, ran.seconds, ran.again ? "" : " (earlier)",
                        ran.exit_code, cell(quoted(ran.stage.arguments)));
  for (const Ran& ran : all.stages)
    if (ran.exit_code != 0) text += fmt::format("\n**{} failed:** {}\n", ran.stage.name, cell(ran.message));
}

} // namespace

Tally tally(const std::vector<Row>& rows) {
  Tally counts;
  for (const Row& row : rows) {
    int& count = row.verdict == Verdict::agrees         ? counts.agrees
                 : row.verdict == Verdict::differs      ? counts.differs
                 : row.verdict == Verdict::not_compared ? counts.not_compared
                                                        : counts.not_computed;
    ++count;
  }
  return counts;
}

Object document(const Reproduction& all) {
  List rows, stages, figures, errata;
  for (const Row& row : all.rows)
    rows.push_back(Object{{"table", row.table},
                          {"item", row.item},
                          {"printed", row.printed},
                          {"paper", value(row.paper)},
                          {"ours", value(row.ours)},
                          {"difference", row.difference},
                          {"verdict", name(row.verdict)},
                          {"reason", row.reason},
                          {"source", row.source}});
  for (const Ran& ran : all.stages)
    stages.push_back(Object{{"name", ran.stage.name},
                            {"what", ran.stage.what},
                            {"command", ran.stage.arguments},
                            {"seconds", ran.seconds},
                            {"exit_code", ran.exit_code},
                            {"earlier_run", !ran.again},
                            {"message", ran.message}});
  for (const Figure& figure : all.figures)
    figures.push_back(Object{{"file", figure.file}, {"title", figure.title}, {"caption", figure.caption}});
  if (all.errata.is_object())
    for (const nlohmann::json& erratum : all.errata.value("errata", nlohmann::json::array()))
      errata.push_back(result_json::value(erratum));
  const Tally counts = tally(all.rows);
  Object document = opening("cowgpu.reproduce.v1", all.command, all.created);
  document.add({{"mesh", Object{{"name", all.mesh}, {"sha256", all.mesh_hash}, {"papers", all.papers_mesh}}},
                {"device", result_json::value(all.device)},
                {"seconds", all.seconds},
                {"counts", Object{{"agrees", counts.agrees},
                                  {"differs", counts.differs},
                                  {"not_compared", counts.not_compared},
                                  {"not_computed", counts.not_computed}}},
                {"rows", rows},
                {"figures", figures},
                {"errata", errata},
                {"stages", stages}});
  return document;
}

std::string reproduce_markdown(const Reproduction& all) {
  std::string text = heading(all);
  if (!all.figures.empty()) text += "## Figures\n";
  for (const Figure& figure : all.figures)
    text += fmt::format("\n![{}]({})\n\n*{}* {}\n", figure.title, figure.file, figure.title, figure.caption);
  add_tables(all, text);
  add_errata(all, text);
  add_stages(all, text);
  return text;
}

} // namespace cowgpu::reproduce
