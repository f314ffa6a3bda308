#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace fs = std::filesystem;

namespace {

// What each room may include, itself aside. A folder is a room; so is host/backend.hpp, the verbs, with what makes them out of
// others; the other headers directly in host/ are the nouns, "host".
const std::map<std::string, std::set<std::string>> allowed = {
    {"shaders", {}},
    {"engine", {}},
    {"engine/kernels", {"engine", "shaders"}},
    {"host", {}},
    {"host/backend", {"host"}},
    {"host/geometry", {"host"}},
    {"host/plan", {"host", "host/geometry"}},
    {"host/reference", {"host", "host/geometry"}},
    {"host/cpu", {"host/backend", "host", "host/geometry", "host/plan", "host/reference"}},
    {"host/gpu", {"host/backend", "host", "host/plan", "engine", "engine/kernels"}},
    {"host/mesh", {"host", "host/geometry"}},
    {"host/mass", {"host/backend", "host", "host/mesh", "host/plan"}},
    {"host/io", {"host", "host/map", "host/mesh", "host/spectrum", "host/flow"}},
    {"host/map", {"host/backend", "host", "host/geometry", "host/mesh"}},
    {"host/spectrum", {"host/backend", "host", "host/mesh", "host/map", "host/plan"}},
    {"host/flow", {"host/backend", "host", "host/geometry", "host/mesh", "host/map", "host/spectrum"}},
    {"host/physics", {"host/backend", "host", "host/mass", "host/mesh", "host/spectrum", "host/reference"}},
    {"host/paper", {"host", "host/mesh", "host/map", "host/spectrum", "host/physics", "host/reference"}},
    {"host/plot", {"host", "host/io"}},
    {"host/figures",
     {"host/backend", "host", "host/mesh", "host/map", "host/spectrum", "host/flow", "host/physics", "host/report",
      "host/plot"}},
    {"host/report",
     {"host", "host/mass", "host/mesh", "host/map", "host/io", "host/spectrum", "host/flow", "host/physics",
      "host/plot", "host/paper"}},
    {"host/requests",
     {"host/backend", "host", "host/mass", "host/mesh", "host/map", "host/io", "host/spectrum", "host/flow",
      "host/physics", "host/plan", "host/reference", "host/report", "host/figures", "host/reproduce", "host/paper"}},
    {"host/reproduce", {"host", "host/io", "host/report", "host/paper"}},
    {"host/cli", {"host/backend", "host", "host/io", "host/report", "host/requests"}},
    // What is installed as <cowgpu/...>.
    {"host/include/cowgpu", {"cowgpu", "host/backend", "host", "host/mass", "host/mesh", "host/requests"}},
};

// The headers directly in host/ are rooms as well: each may include those named behind it, which stand above it in this list,
// and those that are not in the list, which include none.
const std::vector<std::pair<std::string, std::set<std::string>>> nouns = {
    {"monitor", {"error"}},
    {"bounds", {"error"}},
    {"parallel", {"bounds", "signals"}},
    {"thread_pool", {"parallel", "signals"}},
    {"units", {"error", "number"}},
    {"run_report", {"kernel_time"}},
    {"document", {"types"}},
    {"sphere_grid", {"error", "parallel"}},
    {"sphere_directions", {"sphere_grid", "types"}},
    {"coefficient_set", {"convention", "sphere_coefficients", "types"}},
    {"moment_problem", {"types"}},
    {"multipoles", {"moment_problem", "sphere_coefficients", "types"}},
    {"moments", {"memory_need", "moment_problem", "monitor", "multipoles", "run_report"}},
    {"moment_terms", {"moment_problem", "monitor", "multipoles"}},
    {"sphere_transform",
     {"clock", "error", "kernel_time", "memory_need", "monitor", "sphere_coefficients", "sphere_grid"}},
    {"sphere_samples", {"memory_need", "monitor", "run_report", "types"}},
    {"distance_field", {"error", "kernel_time", "memory_need", "monitor", "types"}},
    {"flow", {"kernel_time", "memory_need", "monitor", "types"}},
    {"potential", {"memory_need", "monitor", "multipoles", "run_report", "types"}},
    {"polyhedron", {"memory_need", "monitor", "potential", "run_report", "types"}},
    {"render", {"error", "number", "types"}},
    {"mesh_values", {"error", "types"}},
};

// Headers of host/ that only some rooms may see.
const std::map<std::string, std::set<std::string>> seen_by = {
    {"counted", {"host/io", "host/mesh"}},
    {"flush_denormals", {"host/cpu", "host/gpu", "host/plan"}},
    {"moment_terms", {"host/cpu", "host/mass", "host/requests"}},
    {"signals", {"host", "host/io", "host/map", "host/cli"}},
    {"thread_pool", {"host", "host/cpu"}},
};

struct Include {
  std::string from, line, to;
};

std::vector<Include> project_includes(const fs::path& root) {
  std::vector<Include> found;
  for (const char* top : {"shaders", "engine", "host"})
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string suffix = entry.path().extension();
      if (suffix != ".hpp" && suffix != ".cpp" && suffix != ".h" && suffix != ".comp" && suffix != ".glsl") continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);)
        if (line.rfind("#include \"", 0) == 0 || line.rfind("#include <cowgpu/", 0) == 0) {
          const std::string path = line.substr(10, line.find_first_of("\">", 10) - 10);
          found.push_back({fs::relative(entry.path(), root), line, path});
        }
    }
  return found;
}

// The room of a file or of what a line includes.
std::string room(const fs::path& path) {
  return path == "host/backend.hpp" ? "host/backend" : path.parent_path().string();
}

} // namespace

TEST_CASE("includes point one way between the rooms", "[layers]") {
  const auto includes = project_includes(COWGPU_SOURCE);
  REQUIRE(includes.size() > 50);
  std::map<std::string, std::set<std::string>> used;
  for (const Include& include : includes) {
    const std::string from = room(include.from), to = room(include.to);
    INFO(include.from << ": " << include.line);
    REQUIRE(allowed.count(from) == 1);
    CHECK((from == to || allowed.at(from).count(to) == 1));
    used[from].insert(to);
  }
  for (const auto& [from, rooms] : allowed)
    for (const std::string& to : rooms) {
      INFO(from << " may include " << to << ", and does not: take it off the list");
      CHECK(used[from].count(to) == 1);
    }
}

TEST_CASE("includes point one way between the headers of host too", "[layers]") {
  std::map<std::string, std::set<std::string>> may_include;
  for (const auto& [header, others] : nouns) {
    INFO(header);
    for (const std::string& other : others)
      CHECK((may_include.count(other) == 1 ||
             std::none_of(nouns.begin(), nouns.end(), [&](const auto& noun) { return noun.first == other; })));
    may_include.emplace(header, others);
  }
  std::size_t between = 0;
  for (const Include& include : project_includes(COWGPU_SOURCE)) {
    if (room(include.to) != "host") continue;
    INFO(include.from << ": " << include.line);
    const std::string to = fs::path(include.to).stem();
    if (const auto rooms = seen_by.find(to); rooms != seen_by.end())
      CHECK(rooms->second.count(room(include.from)) == 1);
    const std::string from = fs::path(include.from).stem();
    if (room(include.from) != "host" || from == to) continue;
    ++between;
    CHECK((may_include.count(from) == 1 && may_include.at(from).count(to) == 1));
  }
  CHECK(between > 20);
}

TEST_CASE("only the engine names Vulkan", "[layers]") {
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(COWGPU_SOURCE) / "host")) {
    const std::string suffix = entry.path().extension();
    if (suffix != ".hpp" && suffix != ".cpp") continue;
    ++files;
    std::ifstream file(entry.path());
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    INFO(entry.path());
    CHECK(text.find("Vk") == std::string::npos);
    CHECK(text.find("volk") == std::string::npos);
  }
  CHECK(files > 20);
}

TEST_CASE("numbers that people write are read in one place, in every option too", "[layers]") {
  std::size_t files = 0;
  for (const char* top : {"host", "bench"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(COWGPU_SOURCE) / top)) {
      const std::string suffix = entry.path().extension();
      if (suffix != ".hpp" && suffix != ".cpp") continue;
      ++files;
      std::ifstream file(entry.path());
      const std::string text((std::istreambuf_iterator<char>(file)), {}), name = entry.path().filename();
      INFO(entry.path());
      // They take nan, inf, 0x10, blanks, what is behind the number, and some the locale's comma.
      for (const char* call : {"std::stod", "std::stof", "std::stoi", "std::stol", "std::stoul", "strtod(", "strtold(",
                               "strtol(", "strtoul(", "strtoll(", "strtoull(", "atof(", "atoi(", "sscanf("})
        CHECK(text.find(call) == std::string::npos);
      if (name != "cli11.hpp") CHECK(text.find("#include <CLI/") == std::string::npos);
      if (entry.path().parent_path().filename() == "cli") CHECK(text.find("from_chars") == std::string::npos);
    }
  CHECK(files > 20);
}
