#include "host/io/glb.hpp"

#include "host/error.hpp"
#include "host/io/tinygltf.hpp"
#include "host/mesh/geometry.hpp"
#include "host/version.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <limits>
#include <sstream>

namespace cowgpu {
namespace {

static_assert(std::endian::native == std::endian::little, "the writer copies memory");

constexpr std::uint64_t largest_file = 0xfff00000; // GLB counts bytes in 32 bits; the rest is for the JSON

/// Text with what is no UTF-8 replaced.
std::string mended(const std::string& text) {
  const nlohmann::json whole(text);
  return nlohmann::json::parse(whole.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)).get<std::string>();
}

std::uint64_t bytes_of(const GlbPart& part) {
  const TriangleSurface& surface = *part.surface;
  return surface.vertices.size() * (24 + 4 * surface.scalars.size()) + part.colours.size() * 8 +
         surface.faces.size() * sizeof(Face);
}

class Scene {
public:
  explicit Scene(const GlbAbout& about) {
    model_.asset.version = "2.0";
    model_.asset.generator = std::string("cowgpu ") + version;
    facts_["length_unit"] = tinygltf::Value(mended(about.length_unit));
    for (const auto& [key, text] : about.facts) facts_[mended(key)] = tinygltf::Value(mended(text));
    model_.buffers.resize(1);
    model_.scenes.resize(1);
    model_.defaultScene = 0;
  }

  void reserve(std::uint64_t bytes) { model_.buffers[0].data.reserve(bytes); }

  void add(const GlbPart& part) {
    const TriangleSurface& surface = *part.surface;
    const Box box = bounding_box(surface.vertices, surface.faces);
    const bool far_away = box.middle().norm() > 10 * (box.max - box.min).norm();
    const Vec3 shift = far_away ? box.middle() : Vec3::Zero();

    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = material(!part.colours.empty());
    primitive.indices = indices(surface);
    primitive.attributes["POSITION"] = vectors(surface, surface.vertices, shift, true);
    primitive.attributes["NORMAL"] =
        surface.normals.empty() ? vectors(surface, vertex_normals(surface.vertices, surface.faces), Vec3::Zero(), false)
                                : vectors(surface, surface.normals, Vec3::Zero(), false);
    if (!part.colours.empty()) primitive.attributes["COLOR_0"] = colours(part.colours);
    for (const VertexScalar& scalar : surface.scalars) {
      std::string attribute = "_" + scalar.name;
      for (char& c : attribute)
        if (c >= 'a' && c <= 'z') c = char(c - 'a' + 'A');
      primitive.attributes[attribute] = numbers(surface, scalar.values);
      facts_["unit_" + scalar.name] = tinygltf::Value(mended(scalar.unit.empty() ? "a pure number" : scalar.unit));
    }
    tinygltf::Mesh mesh;
    mesh.name = mended(surface.name);
    mesh.primitives.push_back(std::move(primitive));
    model_.meshes.push_back(std::move(mesh));

    tinygltf::Node node;
    node.name = mended(surface.name);
    node.mesh = int(model_.meshes.size()) - 1;
    const Vec3 place = part.translation + shift;
    if (!place.allFinite()) throw Error(Fault::mesh_range, fmt::format("{}: its place is not finite", surface.name));
    if (!place.isZero(0)) node.translation = {place.x(), place.y(), place.z()};
    tinygltf::Value::Object extras;
    for (const auto& [key, value] : part.numbers)
      if (std::isfinite(value)) extras[mended(key)] = tinygltf::Value(value);
    if (!extras.empty()) node.extras = tinygltf::Value(std::move(extras));
    model_.nodes.push_back(std::move(node));
    model_.scenes[0].nodes.push_back(int(model_.nodes.size()) - 1);
  }

  std::string bytes() {
    model_.asset.extras = tinygltf::Value(std::move(facts_));
    std::ostringstream stream;
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, stream, false, true))
      throw Error(Fault::cannot_write, "the GLB file cannot be put together");
    return std::move(stream).str();
  }

private:
  /// Number of the material, made when it is first asked for.
  int material(bool white) {
    const std::string name = white ? "matt white" : "matt";
    for (std::size_t i = 0; i < model_.materials.size(); ++i)
      if (model_.materials[i].name == name) return int(i);
    tinygltf::Material material;
    material.name = name;
    material.pbrMetallicRoughness.baseColorFactor = {0.61, 0.53, 0.43, 1};
    if (white) material.pbrMetallicRoughness.baseColorFactor = {1, 1, 1, 1};
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.roughnessFactor = 0.8;
    material.doubleSided = true;
    model_.materials.push_back(std::move(material));
    return int(model_.materials.size()) - 1;
  }

  /// A buffer view on bytes put at the end of the buffer; every view is a multiple of four bytes long.
  int view(const void* data, std::size_t bytes, int target) {
    auto& buffer = model_.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = buffer.size();
    view.byteLength = bytes;
    view.target = target;
    const auto* raw = static_cast<const unsigned char*>(data);
    buffer.insert(buffer.end(), raw, raw + bytes);
    model_.bufferViews.push_back(view);
    return int(model_.bufferViews.size()) - 1;
  }

  int accessor(int view, int type, int component, std::size_t count) {
    tinygltf::Accessor accessor;
    accessor.bufferView = view;
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = count;
    model_.accessors.push_back(std::move(accessor));
    return int(model_.accessors.size()) - 1;
  }

  int indices(const TriangleSurface& surface) {
    const std::size_t bytes = surface.faces.size() * sizeof(Face);
    const int faces = view(surface.faces.data(), bytes, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    return accessor(faces, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, 3 * surface.faces.size());
  }

  static float narrowed(const TriangleSurface& surface, double value) {
    if (!(std::abs(value) <= double(std::numeric_limits<float>::max())))
      throw Error(Fault::mesh_range,
                  fmt::format("{}: {} is too large for a GLB file, which holds floats; write PLY, or "
                              "choose another length unit",
                              surface.name, value));
    return float(value);
  }

  int vectors(const TriangleSurface& surface, std::span<const Vec3> values, const Vec3& shift, bool bounds) {
    std::vector<float> flat;
    flat.reserve(3 * values.size());
    std::vector<double> low(3, HUGE_VAL), high(3, -HUGE_VAL);
    for (const Vec3& value : values)
      for (int c = 0; c < 3; ++c) {
        flat.push_back(narrowed(surface, value[c] - shift[c]));
        low[std::size_t(c)] = std::min(low[std::size_t(c)], double(flat.back()));
        high[std::size_t(c)] = std::max(high[std::size_t(c)], double(flat.back()));
      }
    const int id = accessor(view(flat.data(), flat.size() * sizeof(float), TINYGLTF_TARGET_ARRAY_BUFFER),
                            TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT, values.size());
    if (bounds) {
      model_.accessors[std::size_t(id)].minValues = low;
      model_.accessors[std::size_t(id)].maxValues = high;
    }
    return id;
  }

  int numbers(const TriangleSurface& surface, std::span<const double> values) {
    std::vector<float> flat;
    flat.reserve(values.size());
    for (const double value : values) flat.push_back(narrowed(surface, value));
    return accessor(view(flat.data(), flat.size() * sizeof(float), TINYGLTF_TARGET_ARRAY_BUFFER), TINYGLTF_TYPE_SCALAR,
                    TINYGLTF_COMPONENT_TYPE_FLOAT, values.size());
  }

  int colours(std::span<const Colour> values) {
    std::vector<std::uint16_t> flat;
    flat.reserve(4 * values.size());
    for (const Colour& colour : values) {
      for (const float c : colour) flat.push_back(std::uint16_t(65535 * std::clamp(c, 0.0F, 1.0F) + 0.5F));
      flat.push_back(65535);
    }
    const int id = accessor(view(flat.data(), flat.size() * sizeof(std::uint16_t), TINYGLTF_TARGET_ARRAY_BUFFER),
                            TINYGLTF_TYPE_VEC4, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, values.size());
    model_.accessors[std::size_t(id)].normalized = true;
    return id;
  }

  tinygltf::Model model_;
  tinygltf::Value::Object facts_;
};

} // namespace

void write_glb(std::span<const GlbPart> parts, const GlbAbout& about, AtomicFile& file) {
  if (parts.empty()) throw Error(Fault::mesh_empty, "a GLB file needs at least one surface");
  std::uint64_t bytes = 0;
  for (const GlbPart& part : parts) {
    check(*part.surface);
    if (part.surface->faces.empty())
      throw Error(Fault::mesh_empty, fmt::format("{}: a surface without faces cannot be written", part.surface->name));
    if (!part.colours.empty() && part.colours.size() != part.surface->vertices.size())
      throw Error(Fault::bad_argument,
                  fmt::format("{}: {} colours for {} vertices; there must be one each", part.surface->name,
                              part.colours.size(), part.surface->vertices.size()));
    bytes += bytes_of(part);
  }
  if (bytes > largest_file)
    throw Error(Fault::too_large,
                fmt::format("the surfaces take {} MB and a GLB file holds 4294; write fewer in one file, "
                            "or PLY",
                            bytes / 1000000));
  Scene scene(about);
  scene.reserve(bytes);
  for (const GlbPart& part : parts) scene.add(part);
  file.write(scene.bytes());
}

} // namespace cowgpu
