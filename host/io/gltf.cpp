#include "host/io/gltf.hpp"

#include "host/io/gltf_document.hpp"
#include "host/io/mesh_faces.hpp"
#include "host/io/sha256.hpp"
#include "host/mesh/topology.hpp"
#include "host/mesh/weld.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace cowgpu {
namespace {

using Json = nlohmann::json;

constexpr std::size_t deepest_node = 1000;
constexpr std::uint64_t spare_bytes = std::uint64_t{32} << 20; // bytes for the mesh, beyond 4 times the file
constexpr std::uint64_t most_primitives = 1000000;             // with their instances; each counts up to three times

enum Mode : std::uint64_t { points = 0, lines = 1, line_loop = 2, line_strip = 3, triangles = 4, strip = 5, fan = 6 };

/// x -> matrix x + shift.
struct NodePlacement {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  Vec3 shift = Vec3::Zero();
  bool moves() const { return matrix != Eigen::Matrix3d::Identity() || shift != Vec3::Zero(); }
  Vec3 operator()(const Vec3& x) const { return matrix * x + shift; }
  NodePlacement operator*(const NodePlacement& inner) const { return {matrix * inner.matrix, (*this)(inner.shift)}; }
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
    const auto places = roots();
    walk(places, [&](std::uint64_t mesh, const NodePlacement&, const std::string& what) { require_room(mesh, what); });
    walk(places, [&](std::uint64_t mesh, const NodePlacement& place, const std::string& what) {
      add_instance(mesh, place, what);
    });
    if (!closed_ && !seems_balanced(mesh_.faces)) weld(mesh_);
    notes();
    return std::move(mesh_);
  }

private:
  struct Step {
    std::uint64_t node;
    std::size_t depth;
    NodePlacement above;
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
  static std::string mesh_name(std::uint64_t mesh) { return fmt::format("mesh {}", mesh); }
  static std::string primitive_name(const std::string& mesh, std::size_t primitive) {
    return fmt::format("{}, primitive {}", mesh, primitive);
  }

  /// Calls `visit` with every mesh that hangs on the nodes, in the file's order.
  template <class Visit>
  void walk(std::vector<Step> steps, Visit&& visit) {
    skinned_ = 0;
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
      const NodePlacement placement = step.above * placement_of(node, what);
      if (const Json* extensions = document_.member(node, "extensions");
          extensions && document_.member(*extensions, "EXT_mesh_gpu_instancing"))
        document_.fail(Fault::file_format, what,
                       "instances by EXT_mesh_gpu_instancing are not read. Export them as nodes.");
      if (document_.member(node, "mesh")) {
        const bool skinned = document_.member(node, "skin") != nullptr;
        skinned_ += skinned;
        visit(document_.whole(node, "mesh", what), skinned ? NodePlacement() : placement, what);
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

  NodePlacement placement_of(const Json& node, const std::string& what) const {
    NodePlacement placement;
    if (const auto m = document_.numbers(node, "matrix", 16, what)) {
      for (const char* other : {"rotation", "scale", "translation"})
        if (document_.member(node, other))
          document_.fail(Fault::file_syntax, what,
                         fmt::format("it has a matrix and a {}; glTF allows one or the other, and which counts is not "
                                     "known. Export the scene again, or leave one out.",
                                     other));
      if (std::abs((*m)[3]) + std::abs((*m)[7]) + std::abs((*m)[11]) + std::abs((*m)[15] - 1) > 1e-6)
        document_.fail(Fault::file_syntax, what, "its matrix is not affine: the last row must be 0 0 0 1.");
      for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
          placement.matrix(row, column) = (*m)[4 * std::size_t(column) + std::size_t(row)];
      placement.shift = {(*m)[12], (*m)[13], (*m)[14]};
      return placement;
    }
    if (const auto q = document_.numbers(node, "rotation", 4, what)) {
      const Eigen::Quaterniond rotation((*q)[3], (*q)[0], (*q)[1], (*q)[2]);
      if (!(std::abs(rotation.norm() - 1) < 1e-2))
        document_.fail(Fault::file_syntax, what, "its rotation is not a unit quaternion.");
      placement.matrix = rotation.normalized().toRotationMatrix();
    }
    if (const auto s = document_.numbers(node, "scale", 3, what)) placement.matrix *= vector(*s).asDiagonal();
    if (const auto t = document_.numbers(node, "translation", 3, what)) placement.shift = vector(*t);
    return placement;
  }

  void add_instance(std::uint64_t index, const NodePlacement& placement, const std::string& named_by) {
    const Json& object = document_.object("meshes", index, named_by);
    const std::string what = mesh_name(index);
    RawMesh part;
    const Size size = size_of(index, named_by);
    part.vertices.reserve(size.vertices);
    part.faces.reserve(size.faces);
    std::map<std::uint64_t, std::uint32_t> first_vertex; // first vertex of each accessor of positions
    const Json& primitives = document_.list(object, "primitives", what);
    for (std::size_t p = 0; p < primitives.size(); ++p)
      add_primitive(part, first_vertex, primitives[p], primitive_name(what, p));
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
    mesh_.vertices.reserve(total_.vertices); // once; what welding saves is never touched
    mesh_.faces.reserve(total_.faces);
    const auto base = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.insert(mesh_.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const Face& f : part.faces) mesh_.faces.push_back({f[0] + base, f[1] + base, f[2] + base});
  }

  struct Primitive {
    std::uint64_t mode = triangles, positions = 0;
    GltfNumbers points;
    std::optional<GltfNumbers> indices;
    std::size_t faces = 0;
    std::size_t short_faces = 0; ///< points or lines, which bound nothing
  };

  /// Nothing for a primitive without positions: there is nothing to be seen, says the specification.
  std::optional<Primitive> primitive_of(const Json& json, const std::string& what) {
    const Json* attributes = document_.member(json, "attributes");
    if (!attributes || !document_.member(*attributes, "POSITION")) return {};
    Primitive primitive;
    primitive.mode = document_.whole(json, "mode", what, triangles);
    if (primitive.mode > fan)
      document_.fail(Fault::file_format, what, fmt::format("there is no mode {}.", primitive.mode));
    targets_ = targets_ || document_.member(json, "targets");
    primitive.positions = document_.whole(*attributes, "POSITION", what);
    primitive.points = document_.accessor(primitive.positions, "VEC3", what);
    if (document_.member(json, "indices"))
      primitive.indices = document_.accessor(document_.whole(json, "indices", what), "SCALAR", what);
    const std::size_t corners = primitive.indices ? primitive.indices->count : primitive.points.count;
    if (primitive.mode < triangles) {
      primitive.short_faces = primitive.mode == lines                   ? corners / 2
                              : primitive.mode == line_strip && corners ? corners - 1
                                                                        : corners;
      return primitive;
    }
    if (primitive.mode == triangles && corners % 3 != 0)
      document_.fail(Fault::file_syntax, what, fmt::format("{} corners are not a whole number of triangles.", corners));
    primitive.faces = primitive.mode == triangles ? corners / 3 : corners < 3 ? 0 : corners - 2;
    return primitive;
  }

  void add_primitive(RawMesh& part, std::map<std::uint64_t, std::uint32_t>& first_vertex, const Json& json,
                     const std::string& what) {
    const auto primitive = primitive_of(json, what);
    if (!primitive) return;
    if (primitive->mode < triangles) {
      (primitive->mode == points ? points_ : lines_) += primitive->short_faces;
      return;
    }
    const GltfNumbers& points = primitive->points;
    const auto [place, is_new] =
        first_vertex.try_emplace(primitive->positions, static_cast<std::uint32_t>(part.vertices.size()));
    const std::uint32_t base = place->second;
    if (is_new) {
      document_.require_increasing(points, what);
      for (std::size_t v = 0; v < points.count; ++v)
        part.vertices.emplace_back(points.component(v, 0), points.component(v, 1), points.component(v, 2));
    }
    if (!primitive->indices) {
      add_faces(part, *primitive, [&](std::size_t i) { return std::uint32_t(base + i); });
      return;
    }
    const GltfNumbers& indices = *primitive->indices;
    document_.require_increasing(indices, what);
    add_faces(part, *primitive, [&](std::size_t i) {
      const std::uint32_t index = indices.index(i);
      if (index >= points.count)
        document_.fail(
            Fault::mesh_index_range, what,
            fmt::format("index {} names vertex {}, but there are {}, numbered from 0.", i, index, points.count));
      return base + index;
    });
  }

  /// The triangles, of whose corners `at` gives the vertices (glTF 2.0, 3.7.2.1).
  template <class At>
  void add_faces(RawMesh& part, const Primitive& primitive, At&& at) {
    const std::uint64_t mode = primitive.mode;
    for (std::size_t f = 0; f < primitive.faces; ++f) {
      if (mode == triangles)
        part.faces.push_back({at(3 * f), at(3 * f + 1), at(3 * f + 2)});
      else if (mode == strip) {
        const Face face = {at(f), at(f + 1 + f % 2), at(f + 2 - f % 2)};
        if (repeats_vertex(face))
          ++joins_;
        else
          part.faces.push_back(face);
      } else
        part.faces.push_back({at(f + 1), at(f + 2), at(0)});
    }
  }

  struct Size {
    std::uint64_t primitives = 0, vertices = 0, faces = 0;
  };

  Size size_of(std::uint64_t mesh, const std::string& named_by) {
    const auto known = sizes_.find(mesh);
    if (known != sizes_.end()) return known->second;
    const Json& object = document_.object("meshes", mesh, named_by);
    const std::string what = mesh_name(mesh);
    const Json& primitives = document_.list(object, "primitives", what);
    Size size{.primitives = primitives.size()};
    std::set<std::uint64_t> seen;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const auto primitive = primitive_of(primitives[p], primitive_name(what, p));
      if (!primitive || primitive->mode < triangles) continue;
      if (seen.insert(primitive->positions).second) size.vertices += primitive->points.count;
      size.faces += primitive->faces;
    }
    return sizes_[mesh] = size;
  }

  /// Adds up what the instances make, so that neither memory nor time is without bound.
  void require_room(std::uint64_t mesh, const std::string& named_by) {
    const Size size = size_of(mesh, named_by);
    total_.primitives += size.primitives;
    total_.vertices += size.vertices;
    total_.faces += size.faces;
    if (total_.vertices < 0xffffffff && total_.vertices * sizeof(Vec3) + total_.faces * sizeof(Face) <= most_bytes_ &&
        total_.primitives <= most_primitives)
      return;
    document_.fail(
        Fault::too_large, "the scene",
        fmt::format("its instances make {} vertices and {} triangles or more in {} primitives, over {} MiB or "
                    "{} primitives, the most for a file of this size. Export one instance, or the body as PLY.",
                    total_.vertices, total_.faces, total_.primitives, most_bytes_ >> 20, most_primitives));
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
    if (const std::string note = left_out_note(points_, lines_); !note.empty()) document_.notes.push_back(note);
    if (joins_ != 0)
      document_.notes.push_back(fmt::format("{} without area, which {} pieces of strips, {} left out.",
                                            joins_ == 1 ? "1 triangle" : fmt::format("{} triangles", joins_),
                                            joins_ == 1 ? "joins" : "join", joins_ == 1 ? "was" : "were"));
    if (targets_) document_.notes.push_back("Morph targets were ignored: shapes are the undeformed ones.");
    mesh_.notes = std::move(document_.notes);
  }

  GltfDocument document_;
  const std::uint64_t most_bytes_;
  RawMesh mesh_;
  std::map<std::uint64_t, Size> sizes_; // sizes of meshes
  Size total_;                          // size of all instances, before welding
  bool closed_ = true;                  // every instance by itself
  bool targets_ = false;
  std::size_t welded_ = 0, collapsed_ = 0, mirrored_ = 0, skinned_ = 0;
  std::uint64_t points_ = 0, lines_ = 0, joins_ = 0;
};

} // namespace

RawMesh parse_gltf(std::string_view bytes, const std::string& name) {
  RawMesh mesh = GltfReader(bytes, name).read();
  mesh.sha256 = sha256_hex(bytes);
  return mesh;
}

} // namespace cowgpu
