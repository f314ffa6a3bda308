#include "host/requests/reproduce.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/atomic_file.hpp"
#include "host/io/document_json.hpp"
#include "host/io/file.hpp"
#include "host/io/mesh_source.hpp"
#include "host/io/result_json.hpp"
#include "host/report/document_parts.hpp"
#include "host/reproduce/tables.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace cowgpu {
namespace {

namespace fs = std::filesystem;
using namespace reproduce;

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

// What a stage said last, for one that failed.
std::string last_words(const fs::path& log) {
  std::string text = read_file(log);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::size_t line = text.rfind('\n');
  return line == std::string::npos ? text : text.substr(line + 1);
}

// Seconds that all stages and those before this one are expected to take.
struct Seconds {
  double all = 0, before = 0;
};

std::string program_of(const ReproduceRequest& request) {
  return request.program + request.mesh_sha256;
}

// Stages read the mesh for themselves: what they say they measured is compared with what was found at first.
std::string other_mesh(const Stage& stage, const ReproduceRequest& request) {
  std::vector<std::string> files = stage.files;
  files.push_back(stage.output);
  for (const std::string& file : files) {
    if (!file.ends_with(".json")) continue;
    const nlohmann::json document = result_json::parse(fs::path(request.folder) / file);
    for (const char* member : {"/mesh/sha256", "/input/sha256", "/sha256"}) {
      const nlohmann::json::json_pointer where(member);
      if (document.contains(where) && document.at(where) != request.mesh_sha256)
        return fmt::format("the mesh is another one by now: {} is of sha256 {}, and this run of {}", file,
                           document.at(where).dump(), request.mesh_sha256);
    }
  }
  return {};
}

Ran run_stage(const Stage& stage, const ReproduceRequest& request, const Seconds& expected, State& state,
              Monitor& monitor) {
  const fs::path folder = request.folder;
  const std::string key = stage_key(stage, program_of(request));
  Ran ran{stage, 0, 0, false, {}};
  if (const auto done = request.fresh ? std::nullopt : state.finished(stage, key)) {
    ran.seconds = done->seconds;
    return ran;
  }
  ran.again = true;
  const std::string part = stage.output + ".part", log = "data/" + stage.name + ".log";
  const auto start = Clock::now();
  ran.exit_code = request.run(stage.arguments, folder, part, log, [&] {
    const double within = std::min(seconds_since(start), stage.seconds);
    monitor.progress("reproduce", (expected.before + within) / expected.all);
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
  if (const std::string other = other_mesh(stage, request); !other.empty()) {
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

void check_names(const std::vector<std::string>& wanted, const std::vector<Stage>& stages) {
  std::string there;
  for (const Stage& stage : stages) there += (there.empty() ? "" : ", ") + stage.name;
  for (const std::string& name : wanted)
    if (std::none_of(stages.begin(), stages.end(), [&](const Stage& stage) { return stage.name == name; }))
      throw Error(Fault::bad_argument, fmt::format("--only {}: there is no such stage; there are {}", name, there));
}

// The stages to run. With `only` the others are among them where they were done before, which shows them.
std::vector<Stage> stages_of(const ReproduceRequest& request, const Plan& plan, const State& state) {
  std::vector<Stage> stages;
  for (const Stage& stage : plan.stages) {
    const auto& only = request.only;
    const bool wanted = only.empty() || std::find(only.begin(), only.end(), stage.name) != only.end();
    if (wanted || (!request.fresh && state.finished(stage, stage_key(stage, program_of(request)))))
      stages.push_back(stage);
  }
  return stages;
}

} // namespace

Reproduction reproduce_paper(const ReproduceRequest& request, Monitor& monitor) {
  Reproduction all;
  all.command = request.command;
  all.created = utc_now();
  all.mesh = request.mesh;
  all.mesh_hash = request.mesh_sha256;
  all.papers_mesh = request.mesh_sha256 == benchmark_sha256;
  all.asked_for = request.asked_for;
  const fs::path& folder = request.folder;
  make_folder(folder / "data");
  make_folder(folder / "figures");
  const Lock lock(folder / "data" / ".lock");
  const Plan plan = reproduce::plan(request.mesh, all.papers_mesh, request.device, request.page);
  check_names(request.only, plan.stages);
  State state(folder);
  const std::vector<Stage> stages = stages_of(request, plan, state);
  Seconds expected;
  for (const Stage& stage : stages) expected.all += stage.seconds;
  for (const Stage& stage : stages) {
    all.stages.push_back(run_stage(stage, request, expected, state, monitor));
    expected.before += stage.seconds;
    all.seconds += all.stages.back().seconds;
    if (request.done) request.done(all.stages.back(), all.stages.size(), stages.size());
  }
  const Documents found = documents(all, folder);
  all.rows = paper_rows(found);
  if (!all.papers_mesh) not_the_papers_body(all.rows, all.mesh);
  if (const auto mass = found.find("mass.json"); mass != found.end())
    all.device = mass->second.value("device", nlohmann::json());
  if (const auto errata = found.find("errata.json"); errata != found.end()) all.errata = errata->second;
  for (const Figure& figure : plan.figures)
    if (std::error_code none; fs::exists(folder / figure.file, none)) all.figures.push_back(figure);
  write_whole(folder / "reproduce.json", json_text(document(all)));
  write_whole(folder / "reproduce.md", reproduce_markdown(all));
  return all;
}

} // namespace cowgpu
