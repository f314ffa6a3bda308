#include "host/io/gltf.hpp"

#include "host/io/file.hpp"
#include "host/io/glb.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reader_checks.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

Outcome outcome(const std::string& bytes) {
  return outcome_of([&] { parse_gltf(bytes, "x.glb"); });
}

/// A tetrahedron of volume 1/6; `nodes` and what else is to be said besides its mesh 0.
std::string tetrahedron_of(const std::string& nodes, const std::string& primitive = R"("indices":1)") {
  const std::string data = bytes_of(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}) +
                           bytes_of(std::vector<std::uint16_t>{0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2});
  return gltf_of(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},)" + primitive +
                     R"(}]}],"bufferViews":[)"
                     R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],"accessors":[)"
                     R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":4},)"
                     R"({"bufferView":1,"componentType":5123,"type":"SCALAR","count":12}],)" +
                     nodes,
                 data);
}

const std::string one_node = R"("nodes":[{"mesh":0}])";

double volume_of(const std::string& bytes) {
  return volume(ClosedSurface::from(parse_gltf(bytes, "x.gltf")));
}

} // namespace

TEST_CASE("what write_glb() wrote is read back in order", "[gltf][readers]") {
  const RawMesh body = shuffled(icosphere(2), 2);
  const RawMesh mesh = parse_gltf(glb_bytes(body), "x.glb");
  CHECK(mesh.vertices == rounded_to_floats(body).vertices);
  CHECK(mesh.faces == body.faces);
  CHECK(mesh.face_lines.empty());
  CHECK(mesh.notes.empty());
  // Far from its origin the node moves it.
  const RawMesh far = translated(icosphere(2), {1e7, -3e7, 2e6});
  const RawMesh back = parse_gltf(glb_bytes(far), "x.glb");
  double worst = 0;
  for (std::size_t v = 0; v < far.vertices.size(); ++v)
    worst = std::max(worst, (back.vertices[v] - far.vertices[v]).norm());
  INFO(worst);
  CHECK(worst < 2e-7);
}

TEST_CASE("glTF nodes place their meshes, one in another", "[gltf][readers]") {
  const RawMesh mesh =
      parse_gltf(tetrahedron_of(R"("nodes":[{"children":[1],"translation":[10,0,0]},)"
                                R"({"children":[2],"rotation":[0,0,0.7071067811865476,0.7071067811865476]},)"
                                R"({"mesh":0,"scale":[1,2,4],"translation":[0,0,5]}])"),
                 "x");
  const std::vector<Vec3> expected = {{10, 0, 5}, {10, 1, 5}, {8, 0, 5}, {10, 0, 9}};
  for (std::size_t v = 0; v < 4; ++v) CHECK((mesh.vertices[v] - expected[v]).norm() < 1e-14);
  CHECK(mesh.faces == std::vector<Face>{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
  const RawMesh by_matrix =
      parse_gltf(tetrahedron_of(R"("nodes":[{"mesh":0,"matrix":[0,1,0,0,-2,0,0,0,0,0,4,0,10,0,5,1]}])"), "x");
  CHECK(by_matrix.vertices == expected);
  for (const char* other : {R"("translation":[0,0,5])", R"("rotation":[0,0,0,1])", R"("scale":[1,1,1])"}) {
    const Outcome both = outcome(
        tetrahedron_of(fmt::format(R"("nodes":[{{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],{}}}])", other)));
    CHECK(both.fault == "file-syntax");
    CHECK(both.says("has a matrix and a " + std::string(other).substr(1, 5)));
  }
}

TEST_CASE("mirrored glTF nodes keep outward outward, also mirrored twice", "[gltf][readers]") {
  const std::string mirrored = tetrahedron_of(R"("nodes":[{"mesh":0,"scale":[1,-3,1]}])");
  CHECK(volume_of(mirrored) == Approx(0.5).epsilon(1e-15));
  CHECK(parse_gltf(mirrored, "x").notes ==
        std::vector<std::string>{"1 mirrored instance was turned, so that outward stays outward."});
  const std::string twice =
      tetrahedron_of(R"("nodes":[{"children":[1],"scale":[-1,1,1]},{"mesh":0,"scale":[1,-3,1]}])");
  CHECK(volume_of(twice) == Approx(0.5).epsilon(1e-15));
  CHECK(parse_gltf(twice, "x").notes.empty());
  CHECK(volume_of(tetrahedron_of(R"("nodes":[{"mesh":0,"scale":[-1,-1,-1]},{"mesh":0,"translation":[5,0,0]}])")) ==
        Approx(1.0 / 3).epsilon(1e-15));
}

TEST_CASE("of several glTF scenes the default one is read", "[gltf][readers]") {
  const std::string text =
      tetrahedron_of(R"("scene":1,"scenes":[{"nodes":[0]},{"nodes":[2,1]}],"nodes":[{},{"mesh":0},)"
                     R"({"mesh":0,"translation":[5,0,0]}])");
  const RawMesh mesh = parse_gltf(text, "x");
  CHECK(mesh.faces.size() == 8);
  CHECK(mesh.vertices[0] == Vec3(5, 0, 0));
  CHECK(mesh.notes == std::vector<std::string>{"Of 2 scenes number 1 was read."});
  CHECK(parse_gltf(replaced(text, R"("scene":1,)", ""), "x").faces.empty());
}

TEST_CASE("glTF vertices are welded only where the mesh is open as indexed", "[gltf][weld][readers]") {
  RawMesh soup; // no two faces share a vertex
  const RawMesh body = box({1, 2, 3});
  for (const Face& f : body.faces) {
    const auto base = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : f) soup.vertices.push_back(body.vertices[v]);
    soup.faces.push_back({base, base + 1, base + 2});
  }
  const RawMesh mesh = parse_gltf(glb_bytes(soup), "x.glb");
  CHECK(mesh.vertices.size() == 8);
  CHECK(mesh.faces.size() == 12);
  CHECK(mesh.notes.at(0).find("28 vertices were welded") != std::string::npos);
  CHECK(volume(ClosedSurface::from(mesh)) == 6);
  // Closed as it stands, with vertices at the same points: two boxes that touch along an edge stay apart ...
  const RawMesh touching = together(box({1, 2, 3}), box({1, 1, 3}, {1, 2, 0}));
  const RawMesh apart = parse_gltf(glb_bytes(touching), "x.glb");
  CHECK(apart.vertices.size() == 16);
  CHECK(apart.notes.empty());
  // ... and an open mesh beside a closed one, which it touches, is welded by itself.
  const std::vector<float> points = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<std::uint16_t> indices = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  std::vector<float> scattered;
  for (const std::size_t i : indices) scattered.insert(scattered.end(), &points[3 * i], &points[3 * i] + 3);
  const std::string beside = gltf_of(
      R"("nodes":[{"mesh":0},{"mesh":1,"translation":[1,0,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},)"
      R"("indices":1}]},{"primitives":[{"attributes":{"POSITION":2}}]}],"bufferViews":[{"buffer":0,"byteLength":48},)"
      R"({"buffer":0,"byteOffset":48,"byteLength":24},{"buffer":0,"byteOffset":72,"byteLength":144}],"accessors":[)"
      R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":4},)"
      R"({"bufferView":1,"componentType":5123,"type":"SCALAR","count":12},)"
      R"({"bufferView":2,"componentType":5126,"type":"VEC3","count":12}])",
      bytes_of(points) + bytes_of(indices) + bytes_of(scattered));
  const RawMesh both = parse_gltf(beside, "x");
  CHECK(both.vertices.size() == 8);
  CHECK(both.notes.at(0).find("8 vertices were welded") != std::string::npos);
  CHECK(volume(ClosedSurface::from(both)) == Approx(1.0 / 3).epsilon(1e-15));
}

TEST_CASE("glTF numbers that lead out of their place are refused", "[gltf][readers]") {
  struct Case {
    const char *what, *by, *fault, *says;
  };
  const Case cases[] = {
      {R"("count":4)", R"("count":5)", "file-syntax", "accessor 0"},
      {R"("count":4)", R"("count":18446744073709551615)", "file-syntax", "'count'"},
      {R"("count":4)", R"("count":-1)", "file-syntax", "'count'"},
      {R"("count":4)", R"("count":3.5)", "file-syntax", "'count'"},
      {R"("count":4)", R"("count":4,"byteOffset":9007199254740991)", "file-syntax", "do not fit"},
      {R"("count":12)", R"("count":12,"byteOffset":1)", "file-syntax", "accessor 1"},
      {R"("count":12)", R"("count":11)", "file-syntax", "not a whole number of triangles"},
      {R"("byteLength":48})", R"("byteLength":48,"byteStride":11})", "file-syntax", "byteStride 11"},
      {R"("byteLength":48})", R"("byteLength":48,"byteStride":13})", "file-syntax", "accessor 0"},
      {R"("byteLength":48})", R"("byteLength":73})", "file-syntax", "bufferView 0"},
      {R"("byteOffset":48)", R"("byteOffset":49)", "file-syntax", "bufferView 1"},
      {R"("byteOffset":48)", R"("byteOffset":9007199254740990)", "file-syntax", "bufferView 1"},
      {R"("buffer":0,"byteOffset")", R"("buffer":1,"byteOffset")", "file-syntax", "'buffers'"},
      {R"("bufferView":1)", R"("bufferView":2)", "file-syntax", "'bufferViews'"},
      {R"("byteLength":72)", R"("byteLength":73)", "file-truncated", "announces 73 bytes and has 72"},
      {R"("byteLength":72)", R"("byteLength":71)", "file-syntax", "bufferView 1"},
      {R"("mesh":0)", R"("mesh":1)", "file-syntax", "node 0: it names 1 of 'meshes'"},
      {R"("indices":1)", R"("indices":0)", "file-format", "SCALAR"},
      {R"("POSITION":0)", R"("POSITION":1)", "file-format", "VEC3"},
      {R"("POSITION":0)", R"("POSITION":"0")", "file-syntax", "'POSITION'"},
      {R"("indices":1)", R"("indices":1,"mode":7)", "file-format", "mode 7"},
      {"5123", "5122", "file-format", "5122"},
      {"5126", "5130", "file-format", "5130"},
      {R"("nodes":[{"mesh":0}])", R"("nodes":[{"mesh":0,"scale":[1,1]}])", "file-syntax", "'scale' must be 3 numbers"},
      {R"("nodes":[{"mesh":0}])", R"("nodes":{"mesh":0})", "file-syntax", "must be a list"},
      {R"("nodes":[{"mesh":0}])", R"("nodes":[0])", "file-syntax", "must be an object"},
      {R"("nodes":[{"mesh":0}])", R"("nodes":[{"mesh":0,"children":[-1]}],"scenes":[{"nodes":[0]}])", "file-syntax",
       "children"},
      {R"("nodes":[{"mesh":0}])", R"("nodes":[{"children":[1]},{"children":[0]}],"scenes":[{"nodes":[0]}])",
       "file-syntax", "ancestor"},
  };
  const std::string good = tetrahedron_of(one_node);
  REQUIRE(outcome(good).fault == "none");
  for (const Case& c : cases) {
    const Outcome found = outcome(replaced(good, c.what, c.by));
    INFO(c.by << ": " << found.fault << ": " << found.message);
    CHECK(found.fault == c.fault);
    CHECK(found.says(c.says));
    CHECK(found.message.starts_with("x.glb: "));
  }
}

TEST_CASE("a glTF index beyond its positions is refused, and one beyond another primitive's too", "[gltf][readers]") {
  const std::string data =
      bytes_of(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}) + bytes_of(std::vector<std::uint16_t>{0, 1, 3, 0});
  const std::string text =
      gltf_of(R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}},)"
              R"({"attributes":{"POSITION":1},"indices":2}]}],"bufferViews":[{"buffer":0,"byteLength":36},)"
              R"({"buffer":0,"byteOffset":36,"byteLength":8}],"accessors":[)"
              R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":3},)"
              R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":3},)"
              R"({"bufferView":1,"componentType":5123,"type":"SCALAR","count":3}])",
              data);
  CHECK(outcome(text).fault == "mesh-index-range");
  CHECK(outcome(text).says("mesh 0, primitive 1: index 2 names vertex 3"));
}

TEST_CASE("glTF points and lines are left out with their number", "[gltf][readers]") {
  const auto left_out = [](int mode) {
    const RawMesh mesh = parse_gltf(tetrahedron_of(one_node, fmt::format(R"("indices":1,"mode":{})", mode)), "x");
    CHECK(mesh.vertices.empty());
    CHECK(mesh.faces.empty());
    REQUIRE(mesh.notes.size() == 1);
    return mesh.notes[0];
  };
  CHECK(left_out(0) == "Left out, as they bound no volume: 12 points or faces of one corner.");
  CHECK(left_out(1) == "Left out, as they bound no volume: 6 lines or faces of two corners.");
  CHECK(left_out(2) == "Left out, as they bound no volume: 12 lines or faces of two corners.");
  CHECK(left_out(3) == "Left out, as they bound no volume: 11 lines or faces of two corners.");
  const RawMesh beside =
      parse_gltf(read_file(std::string(COWGPU_CORPUS) + "/accepted/lines-and-points-beside.gltf"), "x");
  CHECK(beside.vertices.size() == 8);
  CHECK(beside.notes == std::vector<std::string>{
                            "Left out, as they bound no volume: 14 lines or faces of two corners, 8 points or faces "
                            "of one corner."});
  const Outcome nothing =
      outcome_of([] { ClosedSurface::from(parse_gltf(tetrahedron_of(one_node, R"("indices":1,"mode":1)"), "x")); });
  CHECK(nothing.fault == "mesh-empty");
  CHECK(nothing.says("6 lines or faces of two corners"));
}

TEST_CASE("a sparse glTF accessor of a billion elements and no data takes no memory", "[alone][gltf][readers]") {
  const std::string text = replaced(replaced(tetrahedron_of(one_node), R"({"bufferView":0,"componentType":5126)",
                                             R"({"sparse":{"count":0,"indices":{"bufferView":1,"componentType":5123},)"
                                             R"("values":{"bufferView":0}},"componentType":5126)"),
                                    R"("count":4)", R"("count":1000000000)");
  CHECK(outcome(text).fault == "too-large");
  CHECK(outcome(replaced(text, "1000000000", "9000000000")).says("no 'bufferView'"));
  if (memory_is_measurable()) CHECK(peak_growth([&] { outcome(text); }) < std::size_t{8} << 20);
}

TEST_CASE("glTF scenes that would grow beyond all bounds are refused", "[alone][gltf][readers]") {
  std::vector<float> numbers(27000);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = float(i);
  const std::string points = bytes_of(numbers);
  std::string nodes = R"("nodes":[{"mesh":0})";
  for (int i = 0; i < 1000; ++i) nodes += R"(,{"mesh":0})";
  const std::string instances =
      gltf_of(nodes + R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"bufferViews":[)"
                      R"({"buffer":0,"byteLength":108000}],"accessors":[)"
                      R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":9000}])",
              points);
  std::string values = R"({"asset":{"version":"2.0"},"meshes":[)";
  for (int i = 0; i < 300000; ++i) values += "{},";
  values += "0]}";
  const std::string ignored = R"({"asset":{"version":"2.0"},"extras":[)" +
                              std::string(2000000, '[').replace(0, 2000000, 1999998, '0').append("]]]}");
  for (const std::string* bytes : std::initializer_list<const std::string*>{&instances, &values, &ignored}) {
    const std::size_t growth = peak_growth([&] { outcome(*bytes); });
    INFO(growth);
    if (memory_is_measurable()) CHECK(growth < std::size_t{64} << 20);
  }
  CHECK(outcome(instances).fault == "too-large");
  CHECK(outcome(instances).says("instances"));
  CHECK(outcome(values).fault == "too-large");
}

TEST_CASE("deep JSON does not end the program", "[gltf][readers]") {
  const std::string deep(1000000, '[');
  CHECK(outcome(R"({"asset":{"version":"2.0"},"extras":)" + deep).says("nested more than 100 deep"));
  CHECK(outcome(R"({"asset":)" + deep).fault == "file-syntax");
}

TEST_CASE("glTF files with bytes changed are read or refused by name", "[gltf][readers]") {
  const auto read = [](std::string_view bytes) { parse_gltf(bytes, "x.glb"); };
  check_mutations(tetrahedron_of(one_node), 5000, read);
  const std::string glb = glb_bytes(tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  check_mutations(glb, 5000, read);
  check_prefixes(glb, read);
}
