// What a refused mesh is told about its cure, and a body about what its surface winds round.
#include "host/io/mesh_format.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/mend.hpp"
#include "host/mesh/mend_hint.hpp"
#include "host/mesh/placement.hpp"
#include "host/mesh/winding_notes.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reader_checks.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

/// Every face with vertices of its own, moved by up to `shift`.
RawMesh loosened(const RawMesh& mesh, double shift) {
  RawMesh loose;
  for (const Face& f : mesh.faces) {
    const auto base = static_cast<std::uint32_t>(loose.vertices.size());
    for (std::size_t k = 0; k < 3; ++k)
      loose.vertices.push_back(mesh.vertices[f[k]] + Vec3::Constant(shift * double((base + k) % 5) / 5));
    loose.faces.push_back({base, base + 1, base + 2});
  }
  return loose;
}

RawMesh with_flipped_face(RawMesh mesh) {
  std::swap(mesh.faces[3][0], mesh.faces[3][1]);
  return mesh;
}

std::vector<std::string> notes_of(const RawMesh& mesh) {
  return winding_notes(ClosedSurface::from(mesh), silent_monitor());
}

bool says(const std::vector<std::string>& notes, const std::string& words) {
  return std::any_of(notes.begin(), notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

} // namespace

TEST_CASE("a refused mesh names the option that mends it, and it does", "[mend][hint]") {
  struct Case {
    RawMesh mesh;
    const char* options;
    Mending mending;
  };
  const RawMesh body = box({2, 1, 3});
  const Case cases[] = {{flipped(body), "--orient", {{}, true, false}},
                        {with_flipped_face(body), "--orient", {{}, true, false}},
                        {loosened(body, 0), "--weld 0", {0.0, false, false}},
                        {loosened(body, 1e-7), "--weld 1e-6", {1e-6, false, false}},
                        {loosened(with_flipped_face(body), 1e-7), "--weld 1e-6 --orient", {1e-6, true, false}},
                        {loosened(body, 2e-5), "--weld 1e-4", {1e-4, false, false}},
                        {loosened(scaled(body, Vec3::Constant(100)), 5e-5), "--weld 1e-4", {1e-4, false, false}},
                        {together(body, flipped(translated(body, {5, 0, 0}))), "--orient", {{}, true, false}},
                        {together(body, flipped(body)), "--largest-shell", {{}, false, true}}};
  for (const Case& c : cases) {
    const Outcome refused = outcome_of([&] { ClosedSurface::from(c.mesh); });
    INFO(refused.message);
    CHECK(refused.fault.starts_with("mesh-"));
    CHECK(refused.says(std::string(" With ") + c.options + " it is closed and oriented and has the volume "));
    RawMesh mended = c.mesh;
    mend(mended, c.mending, silent_monitor());
    CHECK(outcome_of([&] { ClosedSurface::from(mended); }).fault == "none");
    CHECK(notes_of(mended).empty()); // nothing of the volume is counted twice
  }
  // Two bodies that overlap, one of them turned: whatever is done, a part is counted twice, and that is said.
  const std::string hint = mend_hint(with_flipped_face(together(body, translated(body, {1, 0, 0}))));
  CHECK(hint.find("--orient") != std::string::npos);
  CHECK(hint.find("has the volume 12, 3 of it counted twice or subtracted") != std::string::npos);
}

TEST_CASE("what no option mends is told none", "[mend][hint]") {
  RawMesh open = box({2, 1, 3});
  open.faces.pop_back();
  CHECK(mend_hint(open).empty());
  const RawMesh body = box({1, 1, 1});
  CHECK(mend_hint(together(body, open)).empty());
  RawMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.faces = {{0, 1, 2}, {0, 2, 1}};
  CHECK(mend_hint(flat).empty());
  flat.vertices[0].x() = NAN;
  CHECK(mend_hint(flat).empty());
}

TEST_CASE("duplicate faces are called that", "[mend][hint]") {
  RawMesh mesh = box({2, 1, 3});
  mesh.faces.push_back({mesh.faces[4][1], mesh.faces[4][2], mesh.faces[4][0]});
  const Outcome refused = outcome_of([&] { ClosedSurface::from(mesh); });
  CHECK(refused.fault == "mesh-unbalanced");
  CHECK(refused.says("duplicate faces, of the same corners: face 12 repeats face 4."));
  CHECK(repeated_faces(box({2, 1, 3})).empty());
  for (int i = 0; i < 8; ++i) mesh.faces.push_back(mesh.faces[4]);
  CHECK(repeated_faces(mesh).ends_with("; and 4 more"));
}

TEST_CASE("the tolerance that mends a mesh is in the unit of its file", "[mend][hint]") {
  RawMesh mesh = loosened(box({2, 1, 3}), 1e-7);
  Placement millimetres;
  millimetres.units.metre = 1e-3;
  const Outcome refused = outcome_of([&] { place(mesh, millimetres); });
  CHECK(refused.fault == "mesh-open");
  CHECK(refused.says("--weld 1e-6 "));
}

TEST_CASE("a body is told which of its volume is counted twice or subtracted", "[winding_notes]") {
  const RawMesh body = box({2, 1, 3});
  for (const RawMesh& sound : {body, two_shells(), shell_with_cavity(), together(body, box({1, 1, 1}, {2, 0, 0}))})
    CHECK(notes_of(sound).empty());
  const auto inverted = notes_of(together(body, flipped(box({1, 1, 0.75}, {10, 0, 0}))));
  REQUIRE(inverted.size() == 1);
  CHECK(says(inverted, "1 shell lies outside of all others and looks inwards: its volume of 0.75 (14.3 %) is "
                       "subtracted; --orient gives the volume 6.75."));
  // Once it was used --orient is not named again.
  RawMesh used = together(body, flipped(box({1, 1, 0.75}, {10, 0, 0})));
  used.notes = {"--orient: 0 faces of 24 flipped; 2 shells."};
  CHECK(says(notes_of(used), "is subtracted; --largest-shell gives the volume 6."));
  const auto twice = notes_of(together(body, body));
  REQUIRE(twice.size() == 1);
  CHECK(says(twice, "6 (50 %) is counted twice"));
  CHECK(says(notes_of(together(body, box({2, 1, 3}, {1, 0, 0}))), "3 (25 %) is counted twice"));
  CHECK(says(notes_of(together(body, box({1, 0.5, 1}, {0.5, 0.25, 1}))), "0.5 (7.69 %) is counted twice"));
  // A shell that looks inwards in a cavity, and one that passes through the body's surface.
  CHECK(says(notes_of(together(shell_with_cavity(), flipped(box({0.1, 0.1, 0.1}, {-0.05, -0.05, -0.05})))),
             "looks inwards"));
  const RawMesh hollow = together(box({9, 9, 9}), flipped(box({6, 6, 6}, {1, 1, 1})));
  CHECK(says(notes_of(together(hollow, flipped(box({2, 2, 2}, {2, 2, 2})))),
             "1 shell lies in a cavity and looks inwards: its volume of 8 (1.58 %) is subtracted; --orient gives the "
             "volume 521."));
  CHECK(says(notes_of(together(body, flipped(box({1, 0.5, 1}, {1.5, 0.25, 1})))), "0.25 ("));
  for (const RawMesh& many : {body, two_shells()}) {
    RawMesh built_in = together(many, many);
    built_in.name = "builtin:box:2,1,3";
    CHECK(notes_of(built_in).empty());
  }
}

TEST_CASE("of meshes of many faces whole shells are looked at, and what is not is said", "[winding_notes]") {
  const RawMesh large = icosphere(5, 2); // 20480 faces
  REQUIRE(large.faces.size() > most_measured_faces);
  const auto one = notes_of(large);
  REQUIRE(one.size() == 1);
  CHECK(says(one, "was not looked at; `cowgpu inspect` looks"));
  CHECK(says(notes_of(together(large, flipped(box({1, 1, 1}, {10, 0, 0})))), "1 (3.08 %) is subtracted; --orient"));
  const auto nested = notes_of(together(large, together(box({1, 1, 1}), box({1, 1, 1}, {8, 0, 0}))));
  CHECK(nested.size() == 2);
  CHECK(says(nested, "is counted twice or more often: 1 shell lies inside others"));
  CHECK(says(notes_of(together(large, large)), "(50 %) is counted twice"));
  CHECK(notes_of(together(large, flipped(box({1, 1, 1})))).size() == 1);
}

TEST_CASE("every command that takes a body says what its surface counts twice", "[winding_notes][cli]") {
  const std::string file = (std::filesystem::temp_directory_path() / "cowgpu-winding-notes-test.off").string();
  std::ofstream(file) << off_text(together(box({2, 1, 3}), box({2, 1, 3}, {1, 0, 0})));
  for (const auto& arguments :
       {std::vector<std::string>{"expand", file, "--lmax", "2", "--device", "cpu"},
        {"tensors", file},
        {"validate", file, "--lmax", "2", "--device", "cpu"},
        {"inflate", file, "--levels", "0.5", "--cells", "8", "--device", "cpu"},
        {"distance", file, "--grid", "3", "--device", "cpu"},
        {"streamlines", file, "--count", "4", "--device", "cpu"},
        {"render", file, "--width", "8", "--height", "8", "--device", "cpu", "-o", file + ".png"},
        {"potential", file, "--at", "9,9,9", "--device", "cpu"}}) {
    const ProgramRun run = run_program(arguments);
    INFO(arguments[0] << run.out << run.err);
    CHECK(run.exit_code == 0);
    CHECK((run.out + run.err).find("3 (25 %) is counted twice") != std::string::npos);
  }
  std::filesystem::remove(file);
  std::filesystem::remove(file + ".png");
}

TEST_CASE("map says what the surface of a body counts twice", "[winding_notes][cli]") {
  // One shell that passes through itself: the corner of a box drawn out through the opposite wall.
  const std::string file = (std::filesystem::temp_directory_path() / "cowgpu-winding-notes-map.off").string();
  RawMesh mesh = icosphere(2);
  const auto far = std::max_element(mesh.vertices.begin(), mesh.vertices.end(),
                                    [](const Vec3& a, const Vec3& b) { return a.x() < b.x(); });
  *far = Vec3(-3, 0, 0);
  std::ofstream(file) << off_text(mesh);
  const ProgramRun run = run_program({"map", file, "--lmax", "8"});
  INFO(run.out << run.err);
  CHECK(run.exit_code == 0);
  CHECK(run.out.find("inside out, and subtracted") != std::string::npos);
  std::filesystem::remove(file);
}
