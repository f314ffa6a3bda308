#include "host/requests/meshes.hpp"
#include "host/cli/commands.hpp"
#include "host/error.hpp"
#include "host/io/document_json.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

void write_document() {
  List named, made;
  for (const auto& [e, path] : named_meshes())
    named.push_back(Object{{"name", e.name},
                           {"path", path ? Value(path->string()) : Value()},
                           {"file", e.file},
                           {"sha256", e.sha256},
                           {"vertices", e.vertices},
                           {"triangles", e.triangles},
                           {"what", e.what},
                           {"source", e.source},
                           {"licence", e.licence},
                           {"scale", e.scale},
                           {"axes", e.axes}});
  for (const std::string& usage : builtin_usages()) made.push_back(usage);
  write_json({{"schema", "cowgpu.meshes.v1"}, {"named", named}, {"builtin", made}}, write_stdout);
}

void write_text() {
  write_stdout("built in, no file needed:\n");
  for (const std::string& usage : builtin_usages()) write_stdout("  " + usage + "\n");
  std::string there, missing;
  for (const auto& [e, path] : named_meshes()) {
    std::string& text = path ? there : missing;
    text += fmt::format("  {:<18} {} triangles: {}\n", e.name, e.triangles, e.what);
    text += fmt::format("  {:<18} {}; axes: {}; licence: {}\n", "", e.scale, e.axes, e.licence);
    if (path)
      text += fmt::format("  {:<18} {}\n", "", path->string());
    else
      text += fmt::format("  {:<18} from: {}\n  {:<18} sha256 {}\n", "", e.source, "", e.sha256);
  }
  if (!there.empty()) write_stdout("\non this machine:\n" + there);
  if (!missing.empty()) write_stdout("\nmissing (get the file, then: cowgpu meshes add FILE):\n" + missing);
}

void add(const std::vector<std::string>& files) {
  std::string unknown;
  Fault fault = Fault::file_format;
  std::size_t failed = 0;
  for (const std::string& file : files) {
    try {
      const CatalogueEntry& entry = add_mesh(file);
      write_stdout(
          fmt::format("{} is {}: copied to {}\n", file, entry.name, (own_mesh_folder() / entry.file).string()));
    } catch (const Error& error) { // the others are wanted all the same
      ++failed;
      fault = error.fault();
      if (failed <= 3) unknown += (unknown.empty() ? "" : "\n  ") + std::string(error.what());
    }
  }
  if (failed > 3) unknown += fmt::format("\n  and {} more", failed - 3);
  if (failed > 0) throw Error(fault, unknown);
}

} // namespace

void add_meshes(Command& app) {
  Command* command = app.add_subcommand("meshes", "Named bodies: which there are, where from, and which are here");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "As JSON (data/schemas/cowgpu.meshes.v1.json)");
  Command* below = command->add_subcommand("add", "Check a mesh of the catalogue and put it where its name finds it");
  const auto files = std::make_shared<std::vector<std::string>>();
  below->add_option("file", *files, "Files whose SHA-256 the catalogue has")->required()->type_name("FILE");
  below->callback([files] { add(*files); });
  command->callback([command, json] {
    if (command->subcommand_given()) return;
    if (*json)
      write_document();
    else
      write_text();
  });
}

} // namespace cowgpu::cli
