#include "host/requests/reproduce.hpp"
#include "host/cli/child.hpp"
#include "host/cli/commands.hpp"

#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/io/mesh_source.hpp"
#include "host/io/sha256.hpp"
#include "host/report/page.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

namespace cowgpu::cli {
namespace {

namespace fs = std::filesystem;
using namespace reproduce;

constexpr const char* stand_in = "builtin:cow";

struct Options {
  std::string folder, mesh;
  std::vector<std::string> only;
  bool fresh = false;
};

// The stages run in the folder of the results, and find the same meshes there.
void pin_mesh_folder() {
  const char* folder = std::getenv("COWGPU_MESHES");
  if (!folder || !*folder) return;
  std::error_code failed;
  const fs::path absolute = fs::absolute(folder, failed);
  if (failed) throw Error(Fault::cannot_read, fmt::format("the folder COWGPU_MESHES={}: {}", folder, failed.message()));
  setenv("COWGPU_MESHES", absolute.c_str(), 1);
}

// Whether the page of reports was built, by node and npm.
bool have_page() {
  try {
    (void)read_page();
    return true;
  } catch (const Error& error) {
    say(fmt::format("cowgpu: no report.html will be made: {}\n", error.what()));
    return false;
  }
}

// The mesh to take, and its name.
RawMesh find_mesh(const Options& options, std::string& name) {
  name = options.mesh.empty() ? "benchmark" : options.mesh;
  if (mesh_kind(name) == MeshKind::standard_input)
    throw Error(Fault::bad_argument,
                "--mesh -: every stage reads the mesh for itself, and standard input is read once; "
                "write the mesh to a file and name that");
  try {
    return load_mesh(name);
  } catch (const Error& error) {
    if (error.fault() != Fault::mesh_missing || !options.mesh.empty()) throw;
    say(fmt::format("cowgpu: {}\ncowgpu: THE PAPER'S COW IS NOT HERE: everything is done with {} instead, and nothing "
                    "is compared\n",
                    error.what(), stand_in));
  }
  name = stand_in;
  return load_mesh(name);
}

void say_done(const Ran& ran, std::size_t number, std::size_t count) {
  say(fmt::format("[{}/{}] {}: {}\n", number, count, ran.stage.what,
                  ran.exit_code != 0 ? fmt::format("FAILED with exit code {}: {}", ran.exit_code, ran.message)
                  : ran.again        ? fmt::format("{:.1f} s", ran.seconds)
                                     : fmt::format("there already ({:.1f} s)", ran.seconds)));
}

void run(const Options& options, Common& common) {
  pin_mesh_folder();
  ReproduceRequest request;
  request.mesh_sha256 = find_mesh(options, request.mesh).sha256;
  request.mesh = mesh_word_anywhere(request.mesh); // stages run in another folder
  request.asked_for = !options.mesh.empty();
  request.folder = options.folder;
  request.device = common.device;
  request.only = options.only;
  request.fresh = options.fresh;
  request.page = have_page();
  request.command = common.command;
  request.program = sha256_hex(std::string_view(read_file("/proc/self/exe")));
  ConsoleMonitor monitor(common.style());
  request.run = [&](const auto& arguments, const auto& folder, const auto& output, const auto& errors,
                    const auto& waiting) { return run_program(arguments, folder, output, errors, monitor, waiting); };
  request.done = [&](const Ran& ran, std::size_t number, std::size_t count) {
    monitor.clear();
    if (!common.quiet) say_done(ran, number, count);
    if (common.exit_code == 0) common.exit_code = ran.exit_code;
  };
  const Reproduction all = reproduce_paper(request, monitor);
  const Tally counts = tally(all.rows);
  write_stdout(fmt::format(
      "{} numbers of the paper: {} agree to its printed digits, {} differ, {} not compared, {} not "
      "computed\n{} figures, {:.1f} s\n{}\n{}\n",
      all.rows.size(), counts.agrees, counts.differs, counts.not_compared, counts.not_computed, all.figures.size(),
      all.seconds, (request.folder / "reproduce.md").string(), (request.folder / "reproduce.json").string()));
}

} // namespace

void add_reproduce(Command& app, Common& common) {
  Command* command = app.add_subcommand(
      "reproduce", "Every table, number and figure of \"Higher multipoles of the cow\", beside what the paper prints");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("-o,--output", options->folder,
                   "Folder for reproduce.md, reproduce.json, figures/ and data/; a run "
                   "that was stopped goes on where it was")
      ->required()
      ->check(not_empty())
      ->type_name("DIR");
  command->add_option("--mesh", options->mesh, "Another body instead of the paper's cow: nothing is compared then")
      ->check(not_empty())
      ->type_name("MESH");
  command->add_option("--only", options->only, "Just these stages (names as in reproduce.json), separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAMES");
  command->add_flag("--fresh", options->fresh, "Do everything again");
  add_common_options(*command, common);
  command->footer("Example: cowgpu reproduce -o out");
  command->callback([=, &common] {
    try {
      run(*options, common);
    } catch (const Error& error) {
      if (error.fault() != Fault::interrupted) throw;
      throw Error(Fault::interrupted,
                  fmt::format("interrupted: the stages that ended are kept in {}, and the same command "
                              "goes on from there",
                              options->folder));
    }
  });
}

} // namespace cowgpu::cli
