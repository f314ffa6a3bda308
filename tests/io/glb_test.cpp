#include "host/io/glb.hpp"

#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/io/tinygltf.hpp"
#include "host/report/order_names.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <cstring>

using namespace cowgpu;

namespace {

std::string written(const std::vector<GlbPart>& parts, const GlbAbout& about = {}) {
  const test::TemporaryFolder folder;
  AtomicFile file(folder / "x.glb");
  write_glb(parts, about, file);
  file.commit();
  return read_file(folder / "x.glb");
}

tinygltf::Model parsed(const std::string& bytes) {
  tinygltf::Model model;
  std::string error, warning;
  const bool loaded = tinygltf::TinyGLTF().LoadBinaryFromMemory(
      &model, &error, &warning, reinterpret_cast<const unsigned char*>(bytes.data()), unsigned(bytes.size()));
  INFO(error << warning);
  REQUIRE(loaded);
  CHECK(error.empty());
  CHECK(warning.empty());
  return model;
}

TriangleSurface surface_of(const RawMesh& mesh, const std::string& name) {
  return {name, mesh.vertices, mesh.faces, vertex_normals(mesh.vertices, mesh.faces), {}};
}

/// Values of an accessor, after checking that they lie within its view and the buffer.
template <class T>
std::vector<T> values(const tinygltf::Model& model, int id, int type, int component, int target) {
  const tinygltf::Accessor& accessor = model.accessors.at(std::size_t(id));
  const tinygltf::BufferView& view = model.bufferViews.at(std::size_t(accessor.bufferView));
  CHECK(accessor.type == type);
  CHECK(accessor.componentType == component);
  CHECK(view.target == target);
  CHECK(view.byteOffset % 4 == 0);
  const std::size_t count = accessor.count * std::size_t(tinygltf::GetNumComponentsInType(std::uint32_t(type)));
  REQUIRE(accessor.byteOffset + count * sizeof(T) == view.byteLength);
  const auto& data = model.buffers.at(std::size_t(view.buffer)).data;
  REQUIRE(view.byteOffset + view.byteLength <= data.size());
  std::vector<T> result(count);
  std::memcpy(result.data(), data.data() + view.byteOffset, count * sizeof(T));
  return result;
}

constexpr int vertex_data = TINYGLTF_TARGET_ARRAY_BUFFER, indices = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;

std::vector<float> vectors(const tinygltf::Model& model, int id) {
  return values<float>(model, id, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT, vertex_data);
}

/// Everything that holds for a file of ours.
void check_part(const tinygltf::Model& model, std::size_t node, const GlbPart& part) {
  const TriangleSurface& surface = *part.surface;
  const tinygltf::Node& placed = model.nodes.at(node);
  CHECK(placed.name == surface.name);
  const tinygltf::Mesh& mesh = model.meshes.at(std::size_t(placed.mesh));
  CHECK(mesh.name == surface.name);
  REQUIRE(mesh.primitives.size() == 1);
  const tinygltf::Primitive& primitive = mesh.primitives[0];
  CHECK(primitive.mode == TINYGLTF_MODE_TRIANGLES);

  const auto faces = values<std::uint32_t>(model, primitive.indices, TINYGLTF_TYPE_SCALAR,
                                           TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, indices);
  REQUIRE(faces.size() == 3 * surface.faces.size());
  CHECK(std::memcmp(faces.data(), surface.faces.data(), faces.size() * 4) == 0);
  CHECK(*std::max_element(faces.begin(), faces.end()) < surface.vertices.size());

  const int position_id = primitive.attributes.at("POSITION");
  const auto positions = vectors(model, position_id), normals = vectors(model, primitive.attributes.at("NORMAL"));
  REQUIRE(positions.size() == 3 * surface.vertices.size());
  REQUIRE(normals.size() == positions.size());
  Vec3 shift = -part.translation;
  if (!placed.translation.empty()) shift += Vec3(placed.translation[0], placed.translation[1], placed.translation[2]);
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, worst = 0, length = 0;
  double size = 0;
  for (const Vec3& v : surface.vertices) size = std::max(size, (v - surface.vertices[0]).norm());
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    Vec3 n;
    for (std::size_t c = 0; c < 3; ++c) {
      const double p = double(positions[3 * v + c]);
      REQUIRE(std::isfinite(p));
      low[c] = std::min(low[c], p);
      high[c] = std::max(high[c], p);
      worst = std::max(worst, std::abs(p + shift[int(c)] - surface.vertices[v][int(c)]));
      n[int(c)] = double(normals[3 * v + c]);
    }
    length = std::max(length, std::abs(n.norm() - 1));
  }
  CHECK(worst <= 6e-7 * size);
  CHECK(length < 2e-7);
  const tinygltf::Accessor& accessor = model.accessors[std::size_t(position_id)];
  REQUIRE(accessor.minValues.size() == 3);
  REQUIRE(accessor.maxValues.size() == 3);
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(accessor.minValues[c] == low[c]);
    CHECK(accessor.maxValues[c] == high[c]);
  }
}

} // namespace

TEST_CASE("a GLB file of several surfaces parses back with every accessor in range", "[glb]") {
  std::vector<TriangleSurface> surfaces;
  for (int l = 0; l < 8; ++l) surfaces.push_back(surface_of(test::icosphere(l % 3, 1 + 0.1 * l), order_name(l)));
  surfaces[3].normals.clear(); // made by the writer
  surfaces[4].scalars.push_back({"area_distortion", "log10", std::vector<double>(surfaces[4].vertices.size(), -0.5)});
  std::vector<GlbPart> parts;
  for (std::size_t l = 0; l < 8; ++l)
    parts.push_back({&surfaces[l], Vec3(2.5 * double(l), 0, 0), {{"order", double(l)}, {"volume", 0.1}}});
  GlbAbout about;
  about.length_unit = "metre";
  about.facts = {{"mesh", "cow"}, {"not UTF-8", "caf\xe9"}};
  const std::string bytes = written(parts, about);
  CHECK(bytes.substr(0, 4) == "glTF");
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 8, 4);
  CHECK(length == bytes.size());
  const tinygltf::Model model = parsed(bytes);
  CHECK(model.asset.version == "2.0");
  CHECK(model.asset.generator.starts_with("cowgpu "));
  CHECK(model.asset.extras.Get("length_unit").Get<std::string>() == "metre");
  CHECK(model.asset.extras.Get("mesh").Get<std::string>() == "cow");
  CHECK(model.asset.extras.Get("unit_area_distortion").Get<std::string>() == "log10");
  REQUIRE(model.buffers.size() == 1);
  REQUIRE(model.scenes.size() == 1);
  REQUIRE(model.nodes.size() == 8);
  CHECK(model.scenes[0].nodes == std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7});
  for (std::size_t l = 0; l < 8; ++l) {
    INFO(l);
    check_part(model, l, parts[l]);
    CHECK(model.nodes[l].extras.Get("order").GetNumberAsDouble() == double(l));
  }
  const auto scalars = values<float>(model, model.meshes[4].primitives[0].attributes.at("_AREA_DISTORTION"),
                                     TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_FLOAT, vertex_data);
  CHECK(scalars == std::vector<float>(surfaces[4].vertices.size(), -0.5F));
  CHECK(written(parts, about) == bytes);
}

TEST_CASE("a surface far from its origin keeps its shape in a GLB file", "[glb]") {
  const TriangleSurface far_away = surface_of(test::translated(test::icosphere(2), {1e7, -3e7, 2e6}), "far");
  GlbPart part;
  part.surface = &far_away;
  check_part(parsed(written({part})), 0, part);
}

TEST_CASE("what a GLB file cannot hold is refused", "[glb]") {
  const auto fault_of = [](const std::vector<GlbPart>& parts) {
    try {
      written(parts);
    } catch (const Error& error) {
      return std::string(name(error.fault()));
    }
    return std::string("none");
  };
  TriangleSurface box = surface_of(test::box({1, 1, 1}), "box");
  CHECK(fault_of({}) == "mesh-empty");
  CHECK(fault_of({{&box}}) == "none");
  TriangleSurface empty = box;
  empty.faces.clear();
  CHECK(fault_of({{&box}, {&empty}}) == "mesh-empty");
  TriangleSurface huge = surface_of(test::box({1e39, 1, 1}), "huge");
  CHECK(fault_of({{&huge}}) == "mesh-range");
  TriangleSurface bad = box;
  bad.vertices[1].x() = HUGE_VAL;
  CHECK(fault_of({{&bad}}) == "mesh-not-finite");
}

TEST_CASE("orders are called by the 2^l-pole rule", "[order-names]") {
  const std::vector<std::string> names = {"monopole",     "dipole",          "quadrupole",         "octupole",
                                          "hexadecapole", "dotriacontapole", "tetrahexacontapole", "octacosahectapole"};
  for (std::size_t l = 0; l < names.size(); ++l) CHECK(order_name(int(l)) == names[l]);
  // Read the numerals back: the parts of a name from l = 4 on add up to 2^l.
  const std::vector<std::pair<std::string, int>> numerals = {
      {"hecta", 100},     {"dicta", 200},     {"pentacta", 500},  {"kilia", 1000},   {"dilia", 2000},
      {"tetralia", 4000}, {"octalia", 8000},  {"hexadeca", 16},   {"dodeca", 12},    {"cosa", 20},
      {"triaconta", 30},  {"tetraconta", 40}, {"pentaconta", 50}, {"hexaconta", 60}, {"nonaconta", 90},
      {"do", 2},          {"tetra", 4},       {"hexa", 6},        {"octa", 8}};
  for (int l = 4; l <= 13; ++l) {
    std::string rest = order_name(l);
    REQUIRE(rest.ends_with("pole"));
    rest.resize(rest.size() - 4);
    int sum = 0;
    while (!rest.empty()) {
      std::pair<std::string, int> best; // the longest numeral the rest begins with
      for (const auto& numeral : numerals)
        if (rest.starts_with(numeral.first) && numeral.first.size() > best.first.size()) best = numeral;
      INFO(order_name(l) << " at " << rest);
      REQUIRE(!best.first.empty());
      sum += best.second;
      rest.erase(0, best.first.size());
    }
    INFO(order_name(l));
    CHECK(sum == 1 << l);
  }
  CHECK(order_name(14) == "2^14-pole");
  CHECK(order_name(512) == "2^512-pole");
  CHECK_THROWS_AS(order_name(-1), Error);
}
