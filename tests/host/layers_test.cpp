#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>

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
    {"host/cli",
     {"host/backend", "host", "host/mesh", "host/io", "host/spectrum", "host/physics", "host/report", "host/plot",
      "host/requests"}},
    // What is installed as <cowgpu/...>.
    {"host/include/cowgpu", {"cowgpu", "host/backend", "host", "host/mass", "host/mesh", "host/requests"}},
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
