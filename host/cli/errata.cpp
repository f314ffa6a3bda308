#include "host/requests/errata.hpp"
#include "host/cli/commands.hpp"

#include "host/error.hpp"
#include "host/io/document_json.hpp"
#include "host/io/mesh_source.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

void run(bool json, const Common& common) {
  std::optional<RawMesh> benchmark;
  std::vector<std::string> notes;
  try {
    benchmark = load_mesh("benchmark");
  } catch (const Error& error) {
    if (error.fault() != Fault::mesh_missing) throw;
    notes.push_back(fmt::format("numbers of the paper's mesh are left out: {}", error.what()));
  }
  ConsoleMonitor monitor(ProgressStyle::none);
  ErrataResult result = find_errata(std::move(benchmark), monitor);
  result.notes = std::move(notes);
  if (json)
    write_json(document(result, common.command), write_stdout);
  else
    write_errata(result, write_stdout);
}

} // namespace

void add_errata(Command& app, Common& common) {
  Command* command = app.add_subcommand("errata", "What is wrong in Higher multipoles of the cow, with both numbers");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "As JSON (data/schemas/cowgpu.errata.v1.json)");
  command->callback([json, &common] { run(*json, common); });
}

} // namespace cowgpu::cli
