#include "host/io/gltf.hpp"

#include "host/io/gltf_document.hpp"
#include "host/io/sha256.hpp"
#include "host/mesh/weld.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>

namespace cowgpu {
namespace {

static_assert(std::endian::native == std::endian::little, "the reader copies memory");

using Json = nlohmann::json;

constexpr std::size_t deepest_node = 1000;
constexpr std::uint64_t spare_bytes = std::uint64_t{32} << 20; // of the mesh, beyond 4 times the file

enum Mode : std::uint64_t { triangles = 4, strip = 5, fan = 6 };

/// x -> matrix x + shift.
struct Placement {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  Vec3 shift = Vec3::Zero();
  bool moves() const { return matrix != Eigen::Matrix3d::Identity() || shift != Vec3::Zero(); }
  Vec3 operator()(const Vec3& x) const { return matrix * x + shift; }
  Placement operator*(const Placement& inner) const { return {matrix * inner.matrix, (*this)(inner.shift)}; }
};

Vec3 vector(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

class GltfReader {
public:
  GltfReader(std::string_view bytes, const std::string& name)
      : document_(bytes, name), most_bytes_(spare_bytes + 4 * bytes.size()) {
    mesh_.name = name;
  }

  RawMesh read() {
    walk(roots());
    if (!closed_ && !seems_balanced(mesh_.faces)) weld(mesh_);
    notes();
    return std::move(mesh_);
  }

private:
  struct Step {
    std::uint64_t node;
    std::size_t depth;
    Placement above;
    std::string named_by;
  };

  /// The nodes of the scene.
  std::vector<Step> roots() {
    std::vector<Step> steps;
    const auto add = [&](const Json& node, const std::string& what) {
      if (!node.is_number_unsigned())
        document_.fail(Fault::file_syntax, what, "its nodes must be whole numbers from 0.");
      steps.push_back({node.get<std::uint64_t>(), 0, {}, what});
    };
    if (const std::size_t scenes = document_.count("scenes"); scenes != 0) {
      const std::uint64_t scene = document_.whole(document_.root(), "scene", "the file", 0);
      const std::string what = fmt::format("scene {}", scene);
      const Json& object = document_.object("scenes", scene, "the file");
      for (const Json& node : document_.list(object, "nodes", what)) add(node, what);
      if (scenes > 1) document_.notes.push_back(fmt::format("Of {} scenes number {} was read.", scenes, scene));
      return steps;
    }
    std::vector<bool> is_child(document_.count("nodes"));
    for (std::size_t n = 0; n < is_child.size(); ++n)
      for (const Json& child : document_.list(document_.object("nodes", n, "the file"), "children", node_name(n)))
        if (child.is_number_unsigned() && child.get<std::uint64_t>() < is_child.size())
          is_child[child.get<std::uint64_t>()] = true;
    for (std::size_t n = 0; n < is_child.size(); ++n)
      if (!is_child[n]) steps.push_back({n, 0, {}, "the file"});
    return steps;
  }

  static std::string node_name(std::uint64_t node) { return fmt::format("node {}", node); }

  void walk(std::vector<Step> steps) {
    std::reverse(steps.begin(), steps.end()); // the last one is taken first
    std::vector<bool> seen(document_.count("nodes"));
    while (!steps.empty()) {
      const Step step = std::move(steps.back());
      steps.pop_back();
      const Json& node = document_.object("nodes", step.node, step.named_by);
      const std::string what = node_name(step.node);
      if (seen[step.node]) document_.fail(Fault::file_syntax, what, "it has two parents, or is its own ancestor.");
      seen[step.node] = true;
      if (step.depth > deepest_node)
        document_.fail(Fault::file_syntax, what, fmt::format("it lies more than {} nodes deep.", deepest_node));
      const Placement placement = step.above * placement_of(node, what);
      if (const Json* extensions = document_.member(node, "extensions");
          extensions && document_.member(*extensions, "EXT_mesh_gpu_instancing"))
        document_.fail(Fault::file_format, what,
                       "instances by EXT_mesh_gpu_instancing are not read. Export them as nodes.");
      if (document_.member(node, "mesh")) {
        const bool skinned = document_.member(node, "skin") != nullptr;
        skinned_ += skinned;
        add_instance(document_.whole(node, "mesh", what), skinned ? Placement() : placement, what);
      }
      const std::size_t first = steps.size();
      for (const Json& child : document_.list(node, "children", what)) {
        if (!child.is_number_unsigned())
          document_.fail(Fault::file_syntax, what, "its children must be whole numbers from 0.");
        steps.push_back({child.get<std::uint64_t>(), step.depth + 1, placement, what});
      }
      std::reverse(steps.begin() + static_cast<std::ptrdiff_t>(first), steps.end());
    }
  }

  Placement placement_of(const Json& node, const std::string& what) const {
    Placement placement;
    if (const auto m = document_.numbers(node, "matrix", 16, what)) {
      if (std::abs((*m)[3]) + std::abs((*m)[7]) + std::abs((*m)[11]) + std::abs((*m)[15] - 1) > 1e-6)
        document_.fail(Fault::file_syntax, what, "its matrix is not affine: the last row must be 0 0 0 1.");
      for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) placement.matrix(row, column) = (*m)[std::size_t(4 * column + row)];
      placement.shift = {(*m)[12], (*m)[13], (*m)[14]};
      return placement;
    }
    if (const auto q = document_.numbers(node, "rotation", 4, what)) {
      const Eigen::Quaterniond rotation((*q)[3], (*q)[0], (*q)[1], (*q)[2]);
      if (!(std::abs(rotation.norm() - 1) < 1e-2))
        document_.fail(Fault::file_syntax, what, "its rotation is no unit quaternion.");
      placement.matrix = rotation.normalized().toRotationMatrix();
    }
    if (const auto s = document_.numbers(node, "scale", 3, what)) placement.matrix *= vector(*s).asDiagonal();
    if (const auto t = document_.numbers(node, "translation", 3, what)) placement.shift = vector(*t);
    return placement;
  }

  void add_instance(std::uint64_t index, const Placement& placement, const std::string& named_by) {
    const Json& object = document_.object("meshes", index, named_by);
    const std::string what = fmt::format("mesh {}", index);
    RawMesh part;
    std::map<std::uint64_t, std::uint32_t> first_vertex; // of each accessor of positions
    const Json& primitives = document_.list(object, "primitives", what);
    for (std::size_t p = 0; p < primitives.size(); ++p)
      add_primitive(part, first_vertex, primitives[p], fmt::format("{}, primitive {}", what, p));
    if (placement.moves())
      for (Vec3& v : part.vertices) v = placement(v);
    if (placement.matrix.determinant() < 0) {
      ++mirrored_;
      for (Face& f : part.faces) std::swap(f[1], f[2]);
    }
    if (!seems_balanced(part.faces)) {
      weld(part);
      closed_ = closed_ && seems_balanced(part.faces);
    }
    if (mesh_.vertices.empty()) {
      mesh_.vertices = std::move(part.vertices);
      mesh_.faces = std::move(part.faces);
      return;
    }
    const auto base = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.insert(mesh_.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const Face& f : part.faces) mesh_.faces.push_back({f[0] + base, f[1] + base, f[2] + base});
  }

  void add_primitive(RawMesh& part, std::map<std::uint64_t, std::uint32_t>& first_vertex, const Json& primitive,
                     const std::string& what) {
    const Json* attributes = document_.member(primitive, "attributes");
    if (!attributes || !document_.member(*attributes, "POSITION")) return; // nothing to be seen, says the specification
    const std::uint64_t mode = document_.whole(primitive, "mode", what, triangles);
    if (mode != triangles && mode != strip && mode != fan)
      document_.fail(Fault::file_format, what,
                     mode < triangles ? "points and lines bound no volume and are not read. Export triangles only."
                                      : fmt::format("there is no mode {}.", mode));
    targets_ = targets_ || document_.member(primitive, "targets");
    const std::uint64_t positions = document_.whole(*attributes, "POSITION", what);
    const GltfNumbers points = document_.accessor(positions, "VEC3", what);
    const auto [place, is_new] = first_vertex.try_emplace(positions, static_cast<std::uint32_t>(part.vertices.size()));
    const std::uint32_t base = place->second;
    if (is_new) {
      require_room(part, points.count, 0);
      part.vertices.reserve(part.vertices.size() + points.count);
      for (std::size_t v = 0; v < points.count; ++v) {
        float xyz[3];
        std::memcpy(xyz, points.data + v * points.stride, sizeof xyz);
        part.vertices.emplace_back(double(xyz[0]), double(xyz[1]), double(xyz[2]));
      }
    }
    if (!document_.member(primitive, "indices")) {
      add_faces(part, mode, points.count, what, [&](std::size_t i) { return std::uint32_t(base + i); });
      return;
    }
    const GltfNumbers indices = document_.accessor(document_.whole(primitive, "indices", what), "SCALAR", what);
    add_faces(part, mode, indices.count, what, [&](std::size_t i) {
      std::uint32_t index = 0; // little endian: a shorter number fills its lower bytes
      std::memcpy(&index, indices.data + i * indices.stride,
                  indices.component_type == gltf_ubyte    ? 1
                  : indices.component_type == gltf_ushort ? 2
                                                          : 4);
      if (index >= points.count)
        document_.fail(
            Fault::mesh_index_range, what,
            fmt::format("index {} names vertex {}, but there are {}, numbered from 0.", i, index, points.count));
      return base + index;
    });
  }

  /// Triangles of `count` corners, whose vertices `at` gives (glTF 2.0, 3.7.2.1).
  template <class At>
  void add_faces(RawMesh& part, std::uint64_t mode, std::size_t count, const std::string& what, At&& at) {
    if (mode == triangles && count % 3 != 0)
      document_.fail(Fault::file_syntax, what, fmt::format("{} corners make no whole number of triangles.", count));
    const std::size_t faces = mode == triangles ? count / 3 : count < 3 ? 0 : count - 2;
    require_room(part, 0, faces);
    part.faces.reserve(part.faces.size() + faces);
    for (std::size_t f = 0; f < faces; ++f) {
      if (mode == triangles)
        part.faces.push_back({at(3 * f), at(3 * f + 1), at(3 * f + 2)});
      else if (mode == strip)
        part.faces.push_back({at(f), at(f + 1 + f % 2), at(f + 2 - f % 2)});
      else
        part.faces.push_back({at(f + 1), at(f + 2), at(0)});
    }
  }

  void require_room(const RawMesh& part, std::uint64_t vertices, std::uint64_t faces) {
    const std::uint64_t all_vertices = mesh_.vertices.size() + part.vertices.size() + vertices;
    const std::uint64_t all_faces = mesh_.faces.size() + part.faces.size() + faces;
    if (all_vertices >= 0xffffffff || all_vertices * sizeof(Vec3) + all_faces * sizeof(Face) > most_bytes_)
      document_.fail(
          Fault::too_large, "the scene",
          fmt::format("its instances make more than {} vertices and {} triangles, over {} MiB for a file of this "
                      "size. Export one instance, or the body as PLY.",
                      mesh_.vertices.size() + part.vertices.size(), mesh_.faces.size() + part.faces.size(),
                      most_bytes_ >> 20));
  }

  void weld(RawMesh& mesh) {
    const Weld done = weld_equal_points(mesh);
    welded_ += done.merged;
    collapsed_ += done.collapsed;
  }

  void notes() {
    if (welded_ != 0)
      document_.notes.push_back(
          fmt::format("As indexed the mesh is not closed, as happens at seams of normals and texture: {} "
                      "vertices were welded to others at exactly the same point{}.",
                      welded_,
                      collapsed_ == 0 ? std::string()
                                      : fmt::format(" and {} faces without area left "
                                                    "out",
                                                    collapsed_)));
    if (mirrored_ != 0)
      document_.notes.push_back(fmt::format("{} mirrored {} turned, so that outward stays outward.", mirrored_,
                                            mirrored_ == 1 ? "instance was" : "instances were"));
    if (skinned_ != 0)
      document_.notes.push_back(fmt::format("{} skinned {} as it was bound, without its skeleton.", skinned_,
                                            skinned_ == 1 ? "mesh was read" : "meshes were read, each"));
    if (targets_) document_.notes.push_back("Morph targets were ignored: shapes are the undeformed ones.");
    mesh_.notes = std::move(document_.notes);
  }

  GltfDocument document_;
  const std::uint64_t most_bytes_;
  RawMesh mesh_;
  bool closed_ = true; // every instance by itself
  bool targets_ = false;
  std::size_t welded_ = 0, collapsed_ = 0, mirrored_ = 0, skinned_ = 0;
};

} // namespace

RawMesh parse_gltf(std::string_view bytes, const std::string& name) {
  RawMesh mesh = GltfReader(bytes, name).read();
  mesh.sha256 = sha256_hex(bytes);
  return mesh;
}

} // namespace cowgpu
