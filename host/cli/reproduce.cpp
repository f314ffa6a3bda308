#include "host/cli/child.hpp"
#include "host/cli/commands.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/atomic_file.hpp"
#include "host/io/file.hpp"
#include "host/io/mesh_source.hpp"
#include "host/io/result_json.hpp"
#include "host/io/sha256.hpp"
#include "host/report/json_parts.hpp"
#include "host/report/page.hpp"
#include "host/reproduce/report.hpp"
#include "host/reproduce/tables.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>
#include <unistd.h>

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

// One run at a time in a folder.
class Lock {
public:
  explicit Lock(const fs::path& file) : fd_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666)) {
    if (fd_ < 0) throw Error(Fault::cannot_write, fmt::format("{}: {}", file.string(), std::strerror(errno)));
    if (flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
    close(fd_);
    throw Error(Fault::bad_argument, fmt::format("another `cowgpu reproduce` is running in {}; wait for it, or take "
                                                 "another folder",
                                                 file.parent_path().parent_path().string()));
  }
  ~Lock() { close(fd_); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

private:
  int fd_;
};

void make_folder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (!failed && !fs::is_directory(folder, failed)) failed = std::make_error_code(std::errc::not_a_directory);
  if (failed)
    throw Error(Fault::cannot_write, fmt::format("the folder {} cannot be made: {}; take another one with -o",
                                                 folder.string(), failed.message()));
}

// The stages run in the folder of the results, and find the same meshes there.
void pin_mesh_folder() {
  const char* folder = std::getenv("COWGPU_MESHES");
  if (!folder || !*folder) return;
  std::error_code failed;
  const fs::path absolute = fs::absolute(folder, failed);
  if (failed) throw Error(Fault::cannot_read, fmt::format("the folder COWGPU_MESHES={}: {}", folder, failed.message()));
  setenv("COWGPU_MESHES", absolute.c_str(), 1);
}

// What a stage said last, for one that failed.
std::string last_words(const fs::path& log) {
  std::string text = read_file(log);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::size_t line = text.rfind('\n');
  return line == std::string::npos ? text : text.substr(line + 1);
}

struct Run {
  const Options& options;
  ConsoleMonitor& monitor;
  std::string program; // its hash and the mesh's
  std::string mesh_hash;
  double all = 0, before = 0; // seconds that stages are expected to take
};

// Stages read the mesh for themselves: what they say they measured is compared with what was found at first.
std::string other_mesh(const Stage& stage, const Run& run) {
  std::vector<std::string> files = stage.files;
  files.push_back(stage.output);
  for (const std::string& file : files) {
    if (!file.ends_with(".json")) continue;
    const nlohmann::json document = result_json::parse(fs::path(run.options.folder) / file);
    for (const char* member : {"/mesh/sha256", "/input/sha256", "/sha256"}) {
      const nlohmann::json::json_pointer where(member);
      if (document.contains(where) && document.at(where) != run.mesh_hash)
        return fmt::format("the mesh is another one by now: {} is of sha256 {}, and this run of {}", file,
                           document.at(where).dump(), run.mesh_hash);
    }
  }
  return {};
}

Ran run_stage(const Stage& stage, State& state, Run& run) {
  const fs::path folder = run.options.folder;
  const std::string key = stage_key(stage, run.program);
  Ran ran{stage, 0, 0, false, {}};
  if (const auto done = run.options.fresh ? std::nullopt : state.finished(stage, key)) {
    ran.seconds = done->seconds;
    return ran;
  }
  ran.again = true;
  const std::string part = stage.output + ".part", log = "data/" + stage.name + ".log";
  const auto start = Clock::now();
  ran.exit_code = run_program(stage.arguments, folder, part, log, run.monitor, [&] {
    const double within = std::min(seconds_since(start), stage.seconds);
    run.monitor.progress("reproduce", (run.before + within) / run.all);
  });
  ran.seconds = seconds_since(start);
  if (ran.exit_code != 0) {
    ran.message = last_words(folder / log);
    return ran;
  }
  std::error_code failed;
  fs::rename(folder / part, folder / stage.output, failed);
  if (failed)
    throw Error(Fault::cannot_write,
                fmt::format("{} cannot be replaced: {}; move it away, or take another folder with -o",
                            (folder / stage.output).string(), failed.message()));
  if (const std::string other = other_mesh(stage, run); !other.empty()) {
    ran.exit_code = exit_code(Fault::cannot_read);
    ran.message = other;
    return ran;
  }
  state.finish(stage, key, ran.seconds);
  return ran;
}

Documents documents(const Reproduction& all, const fs::path& folder) {
  Documents read;
  for (const Ran& ran : all.stages) {
    if (ran.exit_code != 0) continue;
    std::vector<std::string> files = ran.stage.files;
    files.push_back(ran.stage.output);
    for (const std::string& file : files)
      if (file.ends_with(".json")) read[fs::path(file).filename()] = result_json::parse(folder / file);
  }
  return read;
}

void write_whole(const fs::path& file, const std::string& text) {
  AtomicFile out(file);
  out.write(text);
  out.commit();
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

void check_names(const std::vector<std::string>& wanted, const std::vector<Stage>& stages) {
  std::string there;
  for (const Stage& stage : stages) there += (there.empty() ? "" : ", ") + stage.name;
  for (const std::string& name : wanted)
    if (std::none_of(stages.begin(), stages.end(), [&](const Stage& stage) { return stage.name == name; }))
      throw Error(Fault::bad_argument, fmt::format("--only {}: there is no such stage; there are {}", name, there));
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

void reproduce_all(const Options& options, Common& common) {
  Reproduction all;
  all.command = common.command;
  all.created = utc_now();
  pin_mesh_folder();
  const RawMesh mesh = find_mesh(options, all.mesh);
  all.mesh = mesh_word_anywhere(all.mesh); // stages run in another folder
  all.mesh_hash = mesh.sha256;
  all.papers_mesh = mesh.sha256 == benchmark_sha256;
  all.asked_for = !options.mesh.empty();
  const fs::path folder = options.folder;
  make_folder(folder / "data");
  make_folder(folder / "figures");
  const Lock lock(folder / "data" / ".lock");
  const Plan plan = reproduce::plan(all.mesh, all.papers_mesh, common.device, have_page());
  check_names(options.only, plan.stages);
  State state(folder);
  ConsoleMonitor monitor(common.style());
  Run run{options,       monitor, sha256_hex(std::string_view(read_file("/proc/self/exe"))) + all.mesh_hash,
          all.mesh_hash, 0,       0};
  // With --only the others are shown where they were done before.
  std::vector<Stage> stages;
  for (const Stage& stage : plan.stages) {
    const bool wanted =
        options.only.empty() || std::find(options.only.begin(), options.only.end(), stage.name) != options.only.end();
    if (wanted || (!options.fresh && state.finished(stage, stage_key(stage, run.program)))) stages.push_back(stage);
  }
  for (const Stage& stage : stages) run.all += stage.seconds;
  std::size_t number = 0;
  for (const Stage& stage : stages) {
    const Ran ran = run_stage(stage, state, run);
    run.before += stage.seconds;
    monitor.clear();
    if (!common.quiet)
      say(fmt::format("[{}/{}] {}: {}\n", ++number, stages.size(), stage.what,
                      ran.exit_code != 0 ? fmt::format("FAILED with exit code {}: {}", ran.exit_code, ran.message)
                      : ran.again        ? fmt::format("{:.1f} s", ran.seconds)
                                         : fmt::format("there already ({:.1f} s)", ran.seconds)));
    if (common.exit_code == 0) common.exit_code = ran.exit_code;
    all.seconds += ran.seconds;
    all.stages.push_back(ran);
  }
  const Documents found = documents(all, folder);
  all.rows = paper_rows(found);
  if (!all.papers_mesh) not_the_papers_body(all.rows, all.mesh);
  if (const auto mass = found.find("mass.json"); mass != found.end())
    all.device = mass->second.value("device", nlohmann::json());
  if (const auto errata = found.find("errata.json"); errata != found.end()) all.errata = errata->second;
  for (const Figure& figure : plan.figures)
    if (std::error_code none; fs::exists(folder / figure.file, none)) all.figures.push_back(figure);
  write_whole(folder / "reproduce.json", json_text(reproduce_json(all)) + "\n");
  write_whole(folder / "reproduce.md", reproduce_markdown(all));
  const Tally counts = tally(all.rows);
  write_stdout(fmt::format(
      "{} numbers of the paper: {} agree to its printed digits, {} differ, {} not compared, {} not "
      "computed\n{} figures, {:.1f} s\n{}\n{}\n",
      all.rows.size(), counts.agrees, counts.differs, counts.not_compared, counts.not_computed, all.figures.size(),
      all.seconds, (folder / "reproduce.md").string(), (folder / "reproduce.json").string()));
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
      reproduce_all(*options, common);
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
