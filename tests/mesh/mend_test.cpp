#include "host/mesh/mend.hpp"

#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/io/off.hpp"
#include "host/mesh/audit.hpp"
#include "host/mesh/builtin.hpp"
#include "host/mesh/weld.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <fstream>
#include <set>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;

namespace {

RawMesh refused(const std::string& file) {
  return load_mesh(std::string(COWGPU_CORPUS) + "/refused/" + file);
}

RawMesh mended(RawMesh mesh, const Mending& mending) {
  mend(mesh, mending, silent_monitor());
  return mesh;
}

Fault fault_of(const RawMesh& mesh, const Mending& mending) {
  try {
    mended(mesh, mending);
  } catch (const Error& error) {
    return error.fault();
  }
  return Fault::check_failed;
}

constexpr Mending oriented = {.weld = {}, .orient = true, .largest_shell = false};
constexpr Mending largest = {.weld = {}, .orient = false, .largest_shell = true};

Mending welded(double distance) {
  return {.weld = distance, .orient = false, .largest_shell = false};
}

double mended_volume(const RawMesh& mesh, const Mending& mending) {
  return volume(ClosedSurface::from(mended(mesh, mending)));
}

/// Every third face or so turned round.
RawMesh half_flipped(RawMesh mesh, std::uint32_t seed) {
  std::mt19937 random(seed);
  for (Face& f : mesh.faces)
    if (random() % 3 == 0) std::swap(f[0], f[2]);
  return mesh;
}

RawMesh moebius_strip(std::uint32_t n) {
  RawMesh mesh;
  mesh.name = "moebius";
  for (std::uint32_t i = 0; i < n; ++i) {
    const double t = 6.283185307179586 * i / n;
    const Vec3 out(std::cos(t), std::sin(t), 0), across = std::cos(t / 2) * out + Vec3(0, 0, std::sin(t / 2));
    mesh.vertices.push_back(2 * out - across / 2);
    mesh.vertices.push_back(2 * out + across / 2);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool last = i + 1 == n;
    const std::uint32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({c, b, d});
  }
  return mesh;
}

/// Every face with vertices of its own, up to `distance` from where they were.
RawMesh torn(const RawMesh& mesh, double distance, std::uint32_t seed) {
  std::mt19937 random(seed);
  RawMesh apart;
  apart.name = "torn";
  for (const Face& f : mesh.faces) {
    for (const std::uint32_t v : f) {
      const Vec3 shift = Vec3::NullaryExpr([&](int) { return double(random()) / 4294967296.0 - 0.5; });
      apart.vertices.push_back(mesh.vertices[v] + distance / std::sqrt(3.0) * shift);
    }
    const auto n = std::uint32_t(apart.vertices.size());
    apart.faces.push_back({n - 3, n - 2, n - 1});
  }
  return apart;
}

} // namespace

TEST_CASE("mending with --orient mends flipped faces, patches and bodies turned inside out", "[mend]") {
  for (const char* file : {"mesh-unbalanced--flipped-face.off", "mesh-unbalanced--flipped-patch.off",
                           "mesh-inside-out--all-flipped.off", "mesh-inside-out--all-flipped.stl"}) {
    INFO(file);
    const RawMesh before = refused(file);
    CHECK_THROWS_AS(ClosedSurface::from(before), Error);
    const RawMesh after = mended(before, oriented);
    CHECK(volume(ClosedSurface::from(after)) == bounding_box(after.vertices, after.faces).max.prod()); // of a box
    CHECK(after.vertices == before.vertices);
    REQUIRE_FALSE(after.notes.empty());
    CHECK_THAT(after.notes.back(), Contains("--orient") && Contains("flipped"));
  }
  CHECK_THAT(mended(refused("mesh-unbalanced--flipped-patch.off"), oriented).notes.back(), Contains("2 faces of 12"));
}

TEST_CASE("mending with --orient turns as many faces as were turned and leaves good meshes alone", "[mend]") {
  for (const RawMesh& mesh : {builtin_mesh("cow@2"), torus(30, 20), two_shells(), shell_with_cavity()}) {
    RawMesh same = mesh, mixed = half_flipped(mesh, 4);
    std::size_t turned = 0;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) turned += mixed.faces[f] != mesh.faces[f];
    CHECK(orient(same, silent_monitor()).flipped == 0);
    CHECK(same.faces == mesh.faces);
    const Orienting done = orient(mixed, silent_monitor());
    CHECK(done.flipped == turned);
    CHECK(done.undecided == 0);
    CHECK(volume(ClosedSurface::from(mixed)) == volume(mesh.vertices, mesh.faces));
  }
}

TEST_CASE("mending with --orient keeps cavities inward, bodies in cavities outward, and shells that overlap outward",
          "[mend]") {
  const RawMesh body = box({9, 9, 9}), hole = box({6, 6, 6}, {1, 1, 1}), stone = box({2, 2, 2}, {2, 2, 2});
  const RawMesh nested = together(together(stone, hole), body); // all three outward
  RawMesh mesh = half_flipped(nested, 7);
  const Orienting done = orient(mesh, silent_monitor());
  CHECK(done.shells == 3);
  CHECK(done.cavities == 1);
  CHECK(volume(ClosedSurface::from(mesh)) == Approx(9 * 9 * 9 - 6 * 6 * 6 + 2 * 2 * 2).epsilon(1e-14));

  // The second begins inside the first and leaves it.
  RawMesh crossing = half_flipped(together(box({4, 4, 4}), box({1, 1, 9}, {1, 1, 1})), 8);
  CHECK(orient(crossing, silent_monitor()).cavities == 0);
  CHECK(volume(ClosedSurface::from(crossing)) == Approx(64 + 9).epsilon(1e-14));
  // A cavity that touches the body from inside, at a corner of its own.
  const RawMesh leaning = together(box({4, 4, 4}), tetrahedron({0, 2, 2}, {1, 1, 1}, {1, 3, 1}, {1, 2, 3}));
  RawMesh touching = half_flipped(leaning, 9);
  CHECK(orient(touching, silent_monitor()).cavities == 1);
  // Side by side, with a wall in common.
  RawMesh neighbours = half_flipped(together(box({1, 1, 1}), box({1, 1, 1}, {1, 0, 0})), 3);
  CHECK(orient(neighbours, silent_monitor()).cavities == 0);
  CHECK(volume(ClosedSurface::from(neighbours)) == Approx(2).epsilon(1e-14));
}

TEST_CASE("mending with --orient finds cavities that share walls with the body, and shells that lie at one place",
          "[mend]") {
  const RawMesh body = box({4, 4, 4});
  const auto oriented_volume = [](const RawMesh& mesh, std::size_t cavities) {
    RawMesh mixed = half_flipped(mesh, 5);
    const Orienting done = orient(mixed, silent_monitor());
    CHECK(done.cavities == cavities);
    CHECK(done.complete);
    return volume(mixed.vertices, mixed.faces);
  };
  // Cavities on one wall, a part of it and all of it, in an edge, in a corner, along five walls.
  CHECK(oriented_volume(together(body, box({2, 2, 2}, {0, 1, 1})), 1) == Approx(56).epsilon(1e-14));
  CHECK(oriented_volume(together(body, box({1, 4, 4}, {0, 0, 0})), 1) == Approx(48).epsilon(1e-14));
  CHECK(oriented_volume(together(body, box({2, 2, 2}, {0, 0, 1})), 1) == Approx(56).epsilon(1e-14));
  CHECK(oriented_volume(together(body, box({2, 2, 2}, {2, 2, 2})), 1) == Approx(56).epsilon(1e-14));
  CHECK(oriented_volume(together(box({2, 4, 4}), body), 1) == Approx(32).epsilon(1e-14));
  // Two boxes that overlap, with four of their walls in common planes, and faces that only touch elsewhere.
  CHECK(oriented_volume(together(body, box({4, 4, 4}, {2, 0, 0})), 0) == Approx(128).epsilon(1e-14));
  // A stone that fills its cavity, in either order; and one that fills it but for a wall.
  const RawMesh hole = box({2, 2, 2}, {1, 1, 1});
  CHECK(oriented_volume(together(together(body, hole), hole), 1) == Approx(64).epsilon(1e-14));
  CHECK(oriented_volume(together(together(hole, body), hole), 1) == Approx(64).epsilon(1e-14));
  CHECK(oriented_volume(together(together(body, hole), box({1, 2, 2}, {1, 1, 1})), 1) == Approx(60).epsilon(1e-14));
  // A box and itself: the second lies inside the first, and a note says that they coincide.
  CHECK(oriented_volume(together(body, flipped(body)), 1) == 0);
  CHECK_THAT(mended(together(body, flipped(body)), oriented).notes.back(),
             Contains("1 where an earlier one lies and taken as inside that"));
  // Turned, so that nothing is exact but what the corners say.
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  CHECK(oriented_volume(rotated(together(body, box({2, 2, 2}, {1, 1, 1})), turn), 1) == Approx(56).epsilon(1e-13));
}

TEST_CASE("mending with --orient refuses one-sided shells and edges of more than two faces by name", "[mend]") {
  for (const std::uint32_t n : {5U, 8U}) CHECK(fault_of(moebius_strip(n), oriented) == Fault::mesh_unbalanced);
  CHECK(fault_of(refused("mesh-edge-manifold--edge-with-four-faces.off"), oriented) == Fault::mesh_edge_manifold);
  CHECK(fault_of(refused("mesh-edge-manifold--repeated-vertex.off"), oriented) == Fault::mesh_edge_manifold);
  CHECK(fault_of(refused("mesh-not-finite--nan.off"), oriented) == Fault::mesh_not_finite);
  // An open shell is made consistent; open it stays.
  const RawMesh open = mended(refused("mesh-open--missing-face.off"), oriented);
  CHECK_THAT(open.notes.back(), Contains("1 open"));
  CHECK_THROWS_AS(ClosedSurface::from(open), Error);
}

TEST_CASE("mending with --weld closes seams of doubled vertices and gaps", "[mend]") {
  CHECK(mended_volume(refused("mesh-open--seam-of-doubled-vertices.off"), welded(0)) == 30);
  CHECK(mended_volume(refused("mesh-open--gap-of-one-unit-in-the-last-place.stl"), welded(1e-6)) == Approx(6));
  CHECK_THROWS_AS(ClosedSurface::from(mended(refused("mesh-open--gap-of-one-unit-in-the-last-place.stl"), welded(0))),
                  Error);
  for (const RawMesh& mesh : {builtin_mesh("cow@1"), icosphere(3), box({2, 3, 5})}) {
    const double size = volume(mesh.vertices, mesh.faces), gap = 1e-6;
    const RawMesh apart = torn(mesh, gap, 3), together_again = mended(apart, welded(gap));
    CHECK(together_again.vertices.size() == mesh.vertices.size());
    CHECK(together_again.faces.size() == mesh.faces.size());
    CHECK(volume(ClosedSurface::from(together_again)) == Approx(size).epsilon(1e-4));
    // The first of each group keeps its place, and vertices their order.
    CHECK(together_again.vertices[0] == apart.vertices[0]);
    CHECK(together_again.faces[0] == Face{0, 1, 2});
  }
}

TEST_CASE("mending with --weld merges what every pair of vertices says must be merged", "[mend]") {
  std::mt19937 random(12);
  for (const double distance : {1e-3, 0.02, 0.06}) {
    RawMesh mesh;
    for (int i = 0; i < 700; ++i)
      mesh.vertices.push_back(Vec3::NullaryExpr([&](int) { return double(random()) / 4294967296.0 - 0.5; }));
    std::vector<std::size_t> group(mesh.vertices.size());
    for (std::size_t i = 0; i < group.size(); ++i) group[i] = i;
    for (bool changed = true; changed;) { // the least of each chain
      changed = false;
      for (std::size_t i = 0; i < group.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          if (group[i] != group[j] && (mesh.vertices[i] - mesh.vertices[j]).norm() <= distance)
            group[i] = group[j] = std::min(group[i], group[j]), changed = true;
    }
    std::vector<Vec3> expected;
    for (std::size_t i = 0; i < group.size(); ++i)
      if (group[i] == i) expected.push_back(mesh.vertices[i]);
    const std::size_t before = mesh.vertices.size();
    const Weld weld = weld_near_points(mesh, distance);
    CHECK(mesh.vertices == expected);
    CHECK(weld.merged == before - expected.size());
  }
}

TEST_CASE("mending with --weld leaves out faces that collapse and says so", "[mend]") {
  RawMesh mesh = box({1, 1, 1});
  mesh.vertices.push_back(mesh.vertices[mesh.faces[0][0]] + Vec3(1e-9, 0, 0));
  const auto extra = std::uint32_t(mesh.vertices.size() - 1);
  const Face f = mesh.faces[0];
  mesh.faces[0] = {extra, f[1], f[2]}; // a sliver of two faces closes the gap
  mesh.faces.push_back({f[0], f[1], extra});
  mesh.faces.push_back({f[0], extra, f[2]});
  const RawMesh after = mended(mesh, welded(1e-8));
  CHECK(after.faces.size() == 12);
  CHECK(volume(ClosedSurface::from(after)) == 1);
  CHECK_THAT(after.notes.back(), Contains("1 vertex") && Contains("2 faces collapsed"));
  for (const double bad : {-1.0, 0.11, double(INFINITY), double(NAN)})
    CHECK(fault_of(mesh, welded(bad)) == Fault::bad_argument);
}

TEST_CASE("mending with --largest-shell keeps one shell and says what it left out", "[mend]") {
  const RawMesh three = together(together(box({1, 1, 1}, {9, 0, 0}), box({2, 3, 5})), icosphere(1, 0.5));
  const RawMesh one = mended(three, largest);
  CHECK(one.vertices == box({2, 3, 5}).vertices);
  CHECK(one.faces == box({2, 3, 5}).faces);
  CHECK_THAT(one.notes.back(), Contains("2 of 3 shells") && Contains("92 faces") && Contains("volume 30"));
  CHECK_THAT(mended(box({1, 1, 1}), largest).notes.back(), Contains("nothing was left out"));
  CHECK(mended_volume(refused("mesh-inside-out--cavity-larger-than-the-body.off"), {{}, true, true}) == 36);
}

TEST_CASE("nothing is mended unasked", "[mend]") {
  const RawMesh mesh = half_flipped(two_shells(), 2), same = mended(mesh, {});
  CHECK(same.faces == mesh.faces);
  CHECK(same.vertices == mesh.vertices);
  CHECK(same.notes.empty());
}

TEST_CASE("welding, orienting and choosing work together", "[mend]") {
  RawMesh mesh = half_flipped(torn(together(icosphere(2), box({9, 9, 9}, {5, 5, 5})), 1e-7, 5), 6);
  mesh = mended(std::move(mesh), {1e-6, true, true});
  CHECK(mesh.notes.size() == 3);
  CHECK(mesh.faces.size() == 12);
  CHECK(volume(ClosedSurface::from(mesh)) == Approx(729).epsilon(1e-6));
}

TEST_CASE("inspect writes the mended mesh, which reads back bit for bit", "[mend][cli]") {
  const TemporaryFolder folder;
  const std::string bad = std::string(COWGPU_CORPUS) + "/refused/mesh-unbalanced--flipped-patch.off";
  for (const char* name : {"mended.ply", "mended.off"}) {
    const ProgramRun run = run_program({"inspect", bad, "--orient", "-o", folder / name});
    INFO(run.out << run.err);
    CHECK(run.exit_code == 0);
    CHECK_THAT(run.out, Contains("note: --orient: 2 faces of 12 flipped") && Contains("self-intersections       none"));
    const RawMesh read = load_mesh(folder / name), expected = mended(load_mesh(bad), oriented);
    CHECK(read.vertices == expected.vertices);
    CHECK(read.faces == expected.faces);
  }
  RawMesh odd = rotated(icosphere(2), Eigen::AngleAxisd(1, Vec3(1, 2, 3).normalized()).toRotationMatrix());
  odd.vertices[0] *= 1e-30;
  AtomicFile file(folder / "odd.off");
  write_off({"odd\nname", odd.vertices, odd.faces, {}, {}}, std::vector<std::string>{"two\nlines"}, file);
  file.commit();
  CHECK(load_mesh(folder / "odd.off").vertices == odd.vertices);
  CHECK(load_mesh(folder / "odd.off").faces == odd.faces);
  CHECK(run_program({"inspect", bad, "-o", folder / "mended.stl"}).exit_code == 2);
  CHECK(run_program({"inspect", bad, "--weld", "-1"}).exit_code == 2);
  CHECK(run_program({"inspect", folder / "mended.off", "-o", folder / "mended.off"}).exit_code == 2);
}

TEST_CASE("expand mends on demand and says so", "[mend][cli]") {
  const std::string bad = std::string(COWGPU_CORPUS) + "/refused/mesh-unbalanced--flipped-patch.off";
  CHECK(run_program({"expand", bad, "--lmax", "2", "--device", "cpu"}).exit_code == 3);
  const ProgramRun run = run_program({"expand", bad, "--orient", "--lmax", "2", "--device", "cpu"});
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("note: --orient: 2 faces of 12 flipped") && Contains("mass                       30"));
}

TEST_CASE("every command that measures or maps a surface mends on demand", "[mend][cli]") {
  const TemporaryFolder folder;
  const std::string bad = std::string(COWGPU_CORPUS) + "/refused/mesh-unbalanced--flipped-patch.off";
  const std::vector<std::vector<std::string>> commands = {{"map", bad, "--lmax", "8"},
                                                          {"distance", bad, "--grid", "4", "--device", "cpu"},
                                                          {"inflate", bad, "--star", "--device", "cpu"},
                                                          {"streamlines", bad, "--count", "4", "--device", "cpu"}};
  for (std::vector<std::string> command : commands) {
    INFO(command[0]);
    CHECK(run_program(command).exit_code == 3);
    command.emplace_back("--orient");
    const ProgramRun run = run_program(command);
    CHECK(run.exit_code == 0);
    CHECK_THAT(run.out, Contains("--orient: 2 faces of 12 flipped"));
  }
}

TEST_CASE("inspect names faces that intersect and says how much is overlapped", "[cli][self-intersections]") {
  const std::string corpus = std::string(COWGPU_CORPUS) + "/accepted/";
  const ProgramRun run = run_program({"inspect", corpus + "overlapping-shells.off"});
  CHECK_THAT(run.out, Contains("14 pairs of faces cross, 0 overlap, 0 touch") && Contains("crossing: face ") &&
                          Contains("13.33 % of the volume") &&
                          Contains("inscribed radius         1.11803398874989 about the centre of mass"));
  const ProgramRun turned = run_program({"inspect", corpus + "self-intersecting.off"});
  CHECK_THAT(turned.out, Contains("volume inside out        0.0277778"));
  const ProgramRun open = run_program({"inspect", std::string(COWGPU_CORPUS) + "/refused/mesh-open--fin.off"});
  CHECK_THAT(open.out, Contains("self-intersections") && !Contains("overlapped volume"));
  CHECK(run_program({"inspect", std::string(COWGPU_CORPUS) + "/refused/mesh-not-finite--nan.off"}).exit_code == 0);
}
