#include "host/mesh/builtin.hpp"

#include "host/error.hpp"
#include "host/mesh/builtin_asteroid.hpp"
#include "host/mesh/builtin_cow.hpp"
#include "host/mesh/subdivide.hpp"
#include "host/number.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>

namespace cowgpu {
namespace {

constexpr double smallest_size = 1e-30, largest_size = 1e30, largest_ratio = 1e6;
constexpr std::uint32_t largest_seed = 0xffffffff;

using Sizes = std::vector<double>;

struct Kind {
  BuiltinBody help;
  std::size_t n_sizes;
  Sizes default_sizes; ///< empty where sizes must be given
  unsigned max_level, default_level;
  RawMesh (*make)(const Sizes& sizes, unsigned level);
  bool seeded = false; ///< the one size is a seed, a whole number
};

RawMesh split(RawMesh mesh, unsigned level) {
  for (unsigned i = 0; i < level; ++i) mesh = split_midpoint(mesh);
  return mesh;
}

RawMesh make_cow(const Sizes&, unsigned level) {
  RawMesh mesh = cow_cage();
  for (unsigned i = 0; i < level; ++i) mesh = loop_subdivide(mesh);
  return mesh;
}

/// The corners of an icosahedron: the cyclic permutations of (0, +-1, +-golden ratio), on the unit sphere.
RawMesh icosahedron() {
  const double golden = (1 + std::sqrt(5.0)) / 2, length = std::sqrt(1 + golden * golden);
  const double s = 1 / length, t = golden / length;
  RawMesh mesh;
  mesh.vertices = {{-s, t, 0},  {s, t, 0},  {-s, -t, 0}, {s, -t, 0}, {0, -s, t},  {0, s, t},
                   {0, -s, -t}, {0, s, -t}, {t, 0, -s},  {t, 0, s},  {-t, 0, -s}, {-t, 0, s}};
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return mesh;
}

RawMesh make_ellipsoid(const Sizes& semi_axes, unsigned level) {
  RawMesh mesh = icosahedron();
  for (unsigned i = 0; i < level; ++i) {
    mesh = split_midpoint(mesh);
    for (Vec3& v : mesh.vertices) v /= std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z());
  }
  const Vec3 scale(semi_axes[0], semi_axes[1], semi_axes[2]);
  for (Vec3& v : mesh.vertices) v = v.cwiseProduct(scale);
  return mesh;
}

RawMesh make_sphere(const Sizes& radius, unsigned level) {
  return make_ellipsoid({radius[0], radius[0], radius[0]}, level);
}

RawMesh make_asteroid(const Sizes& seed, unsigned level) {
  return asteroid(make_sphere({1}, level), std::uint64_t(seed[0]));
}

RawMesh make_binary(const Sizes& seed, unsigned level) {
  return contact_binary(make_sphere({1}, level), std::uint64_t(seed[0]));
}

RawMesh make_box(const Sizes& edges, unsigned level) {
  RawMesh mesh;
  for (int corner = 0; corner < 8; ++corner) // bit 0 is the side along x, bit 1 along y, bit 2 along z
    mesh.vertices.emplace_back((corner & 1 ? 0.5 : -0.5) * edges[0], (corner & 2 ? 0.5 : -0.5) * edges[1],
                               (corner & 4 ? 0.5 : -0.5) * edges[2]);
  const std::array<std::array<std::uint32_t, 4>, 6> sides = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& [a, b, c, d] : sides) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  }
  return split(std::move(mesh), level);
}

/// Every other corner of a cube; the cube's edge is the tetrahedron's over the root of two.
RawMesh make_tetrahedron(const Sizes& edge, unsigned level) {
  const double h = edge[0] / (2 * std::sqrt(2.0));
  RawMesh mesh;
  mesh.vertices = {{h, h, h}, {h, -h, -h}, {-h, h, -h}, {-h, -h, h}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  return split(std::move(mesh), level);
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> table = {
      {{"cow", "cow[@LEVEL]", "a cow, about one unit long; Loop subdivision level 0 to 8 (3)"}, 0, {}, 8, 3, make_cow},
      {{"sphere", "sphere[:R][@LEVEL]", "an icosphere of radius R (1), level 0 to 9 (4)"}, 1, {1}, 9, 4, make_sphere},
      {{"ellipsoid", "ellipsoid:A,B,C[@LEVEL]", "an icosphere scaled to the semi-axes A, B, C; level 0 to 9 (4)"},
       3,
       {},
       9,
       4,
       make_ellipsoid},
      {{"box", "box[:A,B,C][@LEVEL]", "a box of edges A, B, C (1,1,1); triangles split LEVEL times, 0 to 11 (0)"},
       3,
       {1, 1, 1},
       11,
       0,
       make_box},
      {{"tetrahedron", "tetrahedron[:S][@LEVEL]",
        "a regular tetrahedron of edge S (1); triangles split LEVEL times, 0 to 12 (0)"},
       1,
       {1},
       12,
       0,
       make_tetrahedron},
      {{"asteroid", "asteroid[:SEED][@LEVEL]",
        "a rough, cratered body about 2.5 units long, another one for each SEED (1); level 0 to 9 (5)"},
       1,
       {1},
       9,
       5,
       make_asteroid,
       true},
      {{"binary", "binary[:SEED][@LEVEL]",
        "two such bodies grown together, about 2.6 units long, by SEED (1); level 0 to 9 (5)"},
       1,
       {1},
       9,
       5,
       make_binary,
       true},
  };
  return table;
}

/// What every refusal starts and ends with.
class Refusal {
public:
  explicit Refusal(std::string_view spec) : spec_(spec) {}
  [[noreturn]] void operator()(const std::string& why, const std::string& allowed) const {
    throw Error(Fault::bad_argument, "Cannot make \"builtin:" + spec_ + "\": " + why + " " + allowed);
  }

private:
  std::string spec_;
};

std::string quoted(std::string_view text) {
  return '"' + std::string(text) + '"';
}

std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

const Kind& find_kind(std::string_view name, const Refusal& refuse) {
  std::string names;
  for (const Kind& kind : kinds()) {
    if (kind.help.name == name) return kind;
    names += (names.empty() ? "" : ", ") + kind.help.name;
  }
  refuse("there is no built-in body named " + quoted(name) + ".", "There are: " + names + ".");
}

Sizes read_sizes(std::string_view text, const Kind& kind, const Refusal& refuse) {
  const std::string use = "Write builtin:" + kind.help.usage + ".";
  if (kind.seeded) {
    const std::optional<std::uint32_t> seed = read_whole(text, std::uint32_t{0}, largest_seed);
    if (!seed) refuse("the seed " + quoted(text) + " is not a whole number from 0 to 4294967295.", use);
    return {double(*seed)};
  }
  if (kind.n_sizes == 0) refuse("a " + kind.help.name + " takes no sizes.", use);
  Sizes sizes;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    const std::string_view word = text.substr(0, comma);
    more = comma != std::string_view::npos;
    if (more) text.remove_prefix(comma + 1);
    const std::optional<double> size = read_number(word);
    if (!size || !(*size >= smallest_size && *size <= largest_size))
      refuse("the size " + quoted(word) + " is not a number from 1e-30 to 1e30.", use);
    sizes.push_back(*size);
  }
  if (sizes.size() != kind.n_sizes)
    refuse("it gives " + std::to_string(sizes.size()) + " sizes, and a body of this kind has " +
               std::to_string(kind.n_sizes) + ".",
           use);
  const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
  if (*most / *least > largest_ratio)
    refuse("its sizes differ by more than a factor of 1e6, which leaves nothing to compute with.",
           "Sizes may differ by at most that factor.");
  return sizes;
}

unsigned read_level(std::string_view text, const Kind& kind, const Refusal& refuse) {
  const std::optional<unsigned> level = read_whole(text, 0U, kind.max_level);
  if (!level)
    refuse("the level " + quoted(text) + " is out of range or no number; each level has four times the faces.",
           "The level of a " + kind.help.name + " is a whole number from 0 to " + std::to_string(kind.max_level) + ".");
  return *level;
}

} // namespace

const std::vector<BuiltinBody>& builtin_bodies() {
  static const std::vector<BuiltinBody> bodies = [] {
    std::vector<BuiltinBody> result;
    for (const Kind& kind : kinds()) result.push_back(kind.help);
    return result;
  }();
  return bodies;
}

RawMesh builtin_mesh(std::string_view spec) {
  const Refusal refuse(spec);
  std::string_view rest = spec;
  const std::size_t at = rest.find('@');
  std::optional<std::string_view> level_text, sizes_text;
  if (at != std::string_view::npos) {
    level_text = rest.substr(at + 1);
    rest = rest.substr(0, at);
  }
  const std::size_t colon = rest.find(':');
  if (colon != std::string_view::npos) {
    sizes_text = rest.substr(colon + 1);
    rest = rest.substr(0, colon);
  }

  const Kind& kind = find_kind(rest, refuse);
  const unsigned level = level_text ? read_level(*level_text, kind, refuse) : kind.default_level;
  const Sizes sizes = sizes_text ? read_sizes(*sizes_text, kind, refuse) : kind.default_sizes;
  if (sizes.size() != kind.n_sizes) refuse("this body has no default sizes.", "Write builtin:" + kind.help.usage + ".");

  const std::uint64_t faces = kind.make(sizes, 0).faces.size() << (2 * level);
  if (faces > builtin_face_limit)
    refuse("it would have " + std::to_string(faces) + " faces.",
           "At most " + std::to_string(builtin_face_limit) + " are allowed; choose a lower level.");

  RawMesh mesh = kind.make(sizes, level);
  mesh.name = "builtin:" + kind.help.name;
  for (std::size_t i = 0; i < sizes.size(); ++i) mesh.name += (i == 0 ? ":" : ",") + shortest(sizes[i]);
  mesh.name += "@" + std::to_string(level);
  return mesh;
}

} // namespace cowgpu
