// Files that stand in the place of others, for every kind of input.
#include "host/io/foreign_file.hpp"

#include "tests/support/reader_checks.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

Outcome outcome(const std::string& bytes, const std::string& name = "x") {
  return outcome_of([&] { refuse_foreign_file(bytes, name); });
}

const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:abc\nsize 9\n";

} // namespace

TEST_CASE("pointers, archives, pages and other text than ASCII are refused by name", "[foreign][readers]") {
  using std::string_literals::operator""s;
  struct Case {
    std::string bytes;
    const char* says;
  };
  const std::string zip = "PK\x03\x04"s + std::string(22, '\0') + "\x05\0\0\0"s + "a.obj"s;
  const Case cases[] = {{pointer, "Git LFS pointer"},
                        {"../../.git/annex/objects/aB/SHA256", "git annex get"},
                        {zip, "ZIP archive (its first entry is a.obj)"},
                        {zip + "3D/3dmodel.model", "3MF"},
                        {"\x1f\x8b\x08\0"s, "gunzip"},
                        {"BZh91AY", "bunzip2"},
                        {"\xfd"
                         "7zXZ\0"s,
                         "unxz"},
                        {"\x28\xb5\x2f\xfd"s, "Zstandard"},
                        {"7z\xbc\xaf\x27\x1c"s, "7-Zip"},
                        {std::string(257, 'a') + "ustar\0"s, "tar"},
                        {"%PDF-1.4", "PDF"},
                        {"\n <!doctype HTML>\n", "web page"},
                        {"<html>", "web page"},
                        {"\xff\xfeO\0"s, "UTF-16"}};
  for (const Case& c : cases) {
    const Outcome found = outcome(c.bytes);
    INFO(found.message);
    CHECK(found.fault == "file-format");
    CHECK(found.says(c.says));
    CHECK(found.message.starts_with("x:1: "));
  }
  CHECK(outcome("PK\x03\x04", "body.3MF").says("3MF"));
  for (const std::string& good :
       {"OFF\n"s, "ply\n"s, "solid ustar\n"s, "CDF\x01"s, "\x89HDF\r\n\x1a\n"s, "{}"s, ""s, "# PK\n"s, "B"s})
    CHECK(outcome(good).fault == "none");
}

TEST_CASE("a Git LFS pointer is named by the readers of meshes, coefficients, points and maps",
          "[foreign][readers][cli]") {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "cowgpu-foreign-file-test";
  std::filesystem::create_directories(folder);
  const auto file = [&](const char* name) {
    std::ofstream(folder / name) << pointer;
    return (folder / name).string();
  };
  for (const auto& arguments :
       {std::vector<std::string>{"inspect", file("x.off")},
        {"inspect", file("x")},
        {"spectrum", file("x.csv")},
        {"spectrum", file("x.json")},
        {"spectrum", file("x.nc")},
        {"spectrum", file("x.gfc")},
        {"spectrum", file("x.sh")},
        {"distance", "builtin:box:1,1,1", file("points.csv")},
        {"expand", "builtin:cow", "--of", "harmonic", "--map", file("map.ply"), "--lmax", "3", "--device", "cpu"}}) {
    const ProgramRun run = run_program(arguments);
    INFO(arguments[0] << " " << run.err);
    CHECK(run.exit_code == 3);
    CHECK(run.err.find("Git LFS pointer") != std::string::npos);
  }
  std::filesystem::remove_all(folder);
}
