#include "host/mesh/builtin_cow.hpp"

#include "host/error.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

// Only the right half (z >= 0) is modelled: half rings lofted from rump to nose, and limbs grown out of chosen faces;
// then it is mirrored. No sine or cosine is taken, so that the vertices do not depend on the mathematical library.

namespace cowgpu {
namespace {

using Index = std::uint32_t;
using QuadFace = std::array<Index, 4>;
using Vec2 = Eigen::Vector2d; // x, y in the plane of symmetry

const Vec3 forward(1, 0, 0), up(0, 1, 0), right(0, 0, 1);

Vec3 in_plane(const Vec2& p, double z = 0) {
  return {p.x(), p.y(), z};
}

/// Quads on the side z >= 0. A vertex with z = 0 is its own mirror image.
struct HalfCage {
  std::vector<Vec3> vertices;
  std::vector<QuadFace> quads;

  Index add(const Vec3& p) {
    vertices.push_back(p);
    return static_cast<Index>(vertices.size() - 1);
  }
  std::size_t add(const QuadFace& q) {
    quads.push_back(q);
    return quads.size() - 1;
  }
  bool on_plane(Index v) const { return vertices[v].z() == 0; }
  Vec3 centre(std::size_t quad) const {
    Vec3 sum = Vec3::Zero();
    for (Index v : quads[quad]) sum += vertices[v];
    return sum / 4;
  }
  Vec3 normal(std::size_t quad) const {
    const auto& [a, b, c, d] = quads[quad];
    return (vertices[c] - vertices[a]).cross(vertices[d] - vertices[b]).normalized();
  }
};

/// Both halves as triangles. Quads are cut along the shorter diagonal, alike on both sides.
RawMesh mirrored(const HalfCage& half) {
  RawMesh mesh;
  constexpr Index unused = std::numeric_limits<Index>::max(); // left inside, where a limb straddles the plane
  std::vector<Index> own(half.vertices.size(), unused), image = own;
  for (const QuadFace& quad : half.quads)
    for (Index v : quad) {
      if (own[v] != unused) continue;
      const Vec3& p = half.vertices[v];
      own[v] = image[v] = static_cast<Index>(mesh.vertices.size());
      mesh.vertices.push_back(p);
      if (half.on_plane(v)) continue;
      image[v] = own[v] + 1;
      mesh.vertices.emplace_back(p.x(), p.y(), -p.z());
    }
  auto add = [&](Index a, Index b, Index c) {
    mesh.faces.push_back({own[a], own[b], own[c]});
    mesh.faces.push_back({image[c], image[b], image[a]});
  };
  for (const auto& [a, b, c, d] : half.quads) {
    const auto& p = half.vertices;
    if ((p[a] - p[c]).squaredNorm() <= (p[b] - p[d]).squaredNorm()) {
      add(a, b, c), add(a, c, d);
    } else {
      add(a, b, d), add(b, c, d);
    }
  }
  return mesh;
}

// ---- the trunk: half rings from the topline over the right side to the underline ----

/// Where the points of a half ring lie: share of the way down, and of the half width.
constexpr std::array<double, 6> ring_down = {0, 0.09, 0.34, 0.67, 0.91, 1};
constexpr std::array<double, 6> ring_out = {0, 0.64, 0.98, 1, 0.62, 0};
constexpr std::size_t ring_points = ring_down.size();

struct Ring {
  Vec2 top, bottom;
  double half_width;
  double top_width = 1; ///< the upper half against the lower: hips above 1, withers below
};

/// A grid of quads, rings along the cow, points round her. Quad (i, k) lies between rings i, i + 1 and points k, k + 1.
struct Loft {
  std::vector<std::array<Index, ring_points>> rings;
  std::vector<std::array<std::size_t, ring_points - 1>> quads;
};

Loft loft(HalfCage& cage, const std::vector<Ring>& rings) {
  Loft result;
  for (const Ring& ring : rings) {
    auto& points = result.rings.emplace_back();
    for (std::size_t k = 0; k < ring_points; ++k) {
      const Vec2 p = ring.top + ring_down[k] * (ring.bottom - ring.top);
      points[k] = cage.add(in_plane(p, ring.half_width * ring_out[k] * (k < 3 ? ring.top_width : 1)));
    }
  }
  for (std::size_t i = 0; i + 1 < rings.size(); ++i) {
    const auto &back = result.rings[i], &front = result.rings[i + 1];
    auto& strip = result.quads.emplace_back();
    for (std::size_t k = 0; k + 1 < ring_points; ++k)
      strip[k] = cage.add(QuadFace{back[k], back[k + 1], front[k + 1], front[k]});
  }
  return result;
}

/// Closes a loft's end by three quads, the topmost first, over two points of the plane of symmetry.
std::array<std::size_t, 3> cap(HalfCage& cage, const std::array<Index, ring_points>& ring, const Vec2& upper,
                               const Vec2& lower, bool at_front) {
  const Index u = cage.add(in_plane(upper)), l = cage.add(in_plane(lower));
  std::array<QuadFace, 3> quads = {
      {{ring[0], ring[1], ring[2], u}, {u, ring[2], ring[3], l}, {l, ring[3], ring[4], ring[5]}}};
  std::array<std::size_t, 3> result{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!at_front) std::reverse(quads[i].begin(), quads[i].end());
    result[i] = cage.add(quads[i]);
  }
  return result;
}

// ---- limbs: a patch of the cage, pushed outwards section by section ----

/// A cross-section: its centre, the direction of growth, and half its size along the limb's u and v.
struct Section {
  Vec3 at, along;
  double half_u, half_v;
};

class Limb {
public:
  /// A corner of the patch; u and v in [-1, 1], and u x v points against the growth.
  struct Corner {
    Index vertex;
    double u, v;
  };

  Limb(HalfCage& cage, std::vector<std::size_t> patch, std::vector<Corner> corners, const Vec3& u_axis)
      : cage_(cage), patch_(std::move(patch)), corners_(std::move(corners)), u_axis_(u_axis) {}

  /// Pushes the patch to a section and builds the walls. Where the section meets the plane of symmetry there is no
  /// wall: the mirror image of the limb goes on there.
  Limb& grow(const Section& section) {
    const Vec3 along = section.along.normalized();
    const Vec3 u = (u_axis_ - u_axis_.dot(along) * along).normalized();
    const Vec3 v = u.cross(along);
    std::vector<std::pair<Index, Index>> moved;
    for (Corner& corner : corners_) {
      const Vec3 offset = corner.u * section.half_u * u + corner.v * section.half_v * v;
      moved.emplace_back(corner.vertex, cage_.add(Vec3(section.at + offset)));
      corner.vertex = moved.back().second;
    }
    auto after = [&](Index old) {
      return std::find_if(moved.begin(), moved.end(), [&](const auto& m) { return m.first == old; })->second;
    };
    for (const auto& [a, b] : outline())
      if (!(cage_.on_plane(after(a)) && cage_.on_plane(after(b)))) cage_.add(QuadFace{a, b, after(b), after(a)});
    for (std::size_t q : patch_)
      for (Index& vertex : cage_.quads[q]) vertex = after(vertex);
    return *this;
  }

private:
  std::vector<std::pair<Index, Index>> outline() const {
    std::vector<std::pair<Index, Index>> sides, result;
    for (std::size_t q : patch_)
      for (std::size_t k = 0; k < 4; ++k) sides.emplace_back(cage_.quads[q][k], cage_.quads[q][(k + 1) % 4]);
    for (const auto& [a, b] : sides)
      if (std::find(sides.begin(), sides.end(), std::pair(b, a)) == sides.end()) result.emplace_back(a, b);
    return result;
  }

  HalfCage& cage_;
  std::vector<std::size_t> patch_;
  std::vector<Corner> corners_;
  Vec3 u_axis_;
};

/// A limb out of one quad; u is the direction in which the quad's second side runs.
Limb limb_from_quad(HalfCage& cage, std::size_t quad, const Vec3& u_axis) {
  const auto& [a, b, c, d] = cage.quads[quad];
  return {cage, {quad}, {{a, -1, -1}, {b, -1, 1}, {c, 1, 1}, {d, 1, -1}}, u_axis};
}

/// A bump or a dent: the quad shrunk to a rim, then pushed along its normal.
void emboss(HalfCage& cage, std::size_t quad, const Vec3& at, double radius, double height) {
  const QuadFace corners = cage.quads[quad];
  const Vec3 normal = cage.normal(quad);
  const Vec3 u_axis = cage.vertices[corners[2]] - cage.vertices[corners[1]];
  limb_from_quad(cage, quad, u_axis)
      .grow({at, normal, radius, radius})
      .grow({at + height * normal, normal, 0.75 * radius, 0.75 * radius});
}

// ---- the parts of the cow ----

/// The rings by name, as the parts need them.
enum Station : std::size_t {
  rump,
  thigh_back,
  thigh_front,
  flank,
  barrel,
  arm_back,
  arm_front,
  brisket,
  neck,
  poll,
  ears_front,
  eyes_front,
  bridge,
  muzzle,
  nose
};

std::vector<Ring> trunk_rings(const CowLengths& l) {
  // Shares of the body's length (from the middle), height (from the lowest point of the belly) and half width.
  auto ring = [&](double top_x, double bottom_x, double top, double bottom, double width, double top_width = 1) {
    auto at = [&](double x, double y) { return Vec2(x * l.body_length, l.leg_length + y * l.body_height); };
    return Ring{at(top_x, top), at(bottom_x, bottom), width * l.body_width / 2, top_width};
  };
  return {
      ring(-0.510, -0.485, 0.930, 0.420, 0.54, 1.15), // rump
      ring(-0.425, -0.425, 1.000, 0.260, 0.80, 1.15), // thigh_back
      ring(-0.230, -0.240, 1.015, 0.160, 0.90, 1.05), // thigh_front
      ring(-0.120, -0.105, 0.990, 0.040, 1.00, 0.96), // flank
      ring(0.0600, 0.0450, 0.970, -0.11, 1.10, 0.90), // barrel
      ring(0.2400, 0.2250, 1.000, -0.05, 0.90, 0.80), // arm_back
      ring(0.3700, 0.4000, 1.020, 0.040, 0.78, 0.74), // arm_front
      ring(0.4400, 0.5000, 1.010, 0.210, 0.58, 0.76), // brisket
  };
}

/// The frame of the head: from the poll along the face, 35 degrees down.
struct Head {
  Vec2 origin, along, above;
  Vec2 at(double a, double h) const { return origin + a * along + h * above; }
};

Head head_frame(const CowLengths& l) {
  const Vec2 withers(0.44 * l.body_length, l.leg_length + 1.01 * l.body_height);
  const Vec2 along = Vec2(0.82, -0.57).normalized();
  return {withers + l.neck_length * Vec2(0.93, 0.36), along, Vec2(-along.y(), along.x())};
}

std::vector<Ring> head_rings(const CowLengths& l) {
  const Head head = head_frame(l);
  // Shares of the head's length (from the poll), height (from the line of the face) and half width.
  auto ring = [&](double top_a, double bottom_a, double top, double bottom, double width, double top_width = 1) {
    return Ring{head.at(top_a * l.head_length, top * l.head_height),
                head.at(bottom_a * l.head_length, bottom * l.head_height), width * l.head_width / 2, top_width};
  };
  return {
      ring(-0.03, 0.02, 0.00, -0.98, 0.92),       // poll
      ring(0.17, 0.24, 0.06, -1.04, 1.02, 1.00),  // ears_front
      ring(0.38, 0.42, 0.02, -1.00, 1.02, 1.02),  // eyes_front
      ring(0.62, 0.63, -0.10, -0.84, 0.74, 0.92), // bridge
      ring(0.84, 0.82, -0.10, -0.92, 0.98, 0.96), // muzzle
      ring(1.00, 0.95, -0.20, -0.90, 0.92, 0.92), // nose
  };
}

/// Between brisket and poll, thicker below than a straight loft: the dewlap.
Ring neck_ring(const Ring& from, const Ring& to, const CowLengths& l) {
  return {(from.top + to.top) / 2 + Vec2(0, 0.01 * l.body_height),
          (from.bottom + to.bottom) / 2 - Vec2(-0.02, 0.10) * l.body_height, 0.53 * (from.half_width + to.half_width),
          0.80};
}

void grow_tail(HalfCage& cage, std::size_t quad, const CowLengths& l) {
  const auto [below, below_out, above_out, above] = cage.quads[quad]; // the first and the last lie on the plane
  Limb tail(cage, {quad}, {{below, 0, 1}, {below_out, 1, 1}, {above_out, 1, -1}, {above, 0, -1}}, right);
  const Vec3 root = (cage.vertices[above] + cage.vertices[below]) / 2;
  // Shares of the tail's length: how far back, how far down, direction, half width, half thickness.
  auto knot = [&](double back, double down, const Vec3& along, double width, double thickness) {
    tail.grow({root + l.tail_length * (-back * forward - down * up), along, width * l.tail_length,
               thickness * l.tail_length});
  };
  knot(0.03, -0.04, Vec3(-1, 0.2, 0), 0.065, 0.080);
  knot(0.10, 0.00, Vec3(-1, -0.9, 0), 0.045, 0.050);
  knot(0.14, 0.14, Vec3(-0.1, -1, 0), 0.036, 0.034);
  knot(0.16, 0.52, Vec3(0, -1, 0), 0.032, 0.032);
  knot(0.17, 0.77, Vec3(0, -1, 0), 0.078, 0.078);
  knot(0.16, 0.92, Vec3(0.1, -1, 0), 0.056, 0.056);
  knot(0.15, 1.02, Vec3(0.1, -1, 0), 0.012, 0.012);
}

/// One joint of a leg: x from the leg's root and z in leg thicknesses, the height as a share of the leg's length.
struct Joint {
  double x, height, z, half_length, half_width;
};

void grow_leg(HalfCage& cage, std::size_t quad, const CowLengths& l, const std::vector<Joint>& joints) {
  Limb leg = limb_from_quad(cage, quad, forward);
  const double root_x = cage.centre(quad).x(), t = l.leg_thickness;
  for (const Joint& j : joints)
    leg.grow({Vec3(root_x + j.x * t, j.height * l.leg_length, j.z * t), -up, j.half_length * t, j.half_width * t});
}

void grow_legs(HalfCage& cage, const Loft& body, const CowLengths& l) {
  grow_leg(cage, body.quads[thigh_back][3], l,
           {
               {-0.10, 1.16, 1.95, 1.15, 0.72},   // thigh
               {-0.35, 0.86, 1.78, 0.78, 0.64},   // gaskin
               {-1.00, 0.62, 1.72, 0.64, 0.56},   // hock
               {-0.74, 0.20, 1.70, 0.46, 0.48},   // cannon
               {-0.36, -0.015, 1.70, 0.94, 0.90}, // hoof
           });
  grow_leg(cage, body.quads[arm_back][3], l,
           {
               {-0.10, 0.92, 1.66, 0.90, 0.72},  // upper arm
               {0.02, 0.60, 1.52, 0.62, 0.60},   // knee
               {-0.06, 0.20, 1.50, 0.46, 0.48},  // cannon
               {0.26, -0.015, 1.50, 0.94, 0.90}, // hoof
           });
}

void grow_udder(HalfCage& cage, const Loft& body, const CowLengths& l) {
  const std::size_t back = body.quads[thigh_back][4], front = body.quads[thigh_front][4];
  const auto& r0 = body.rings[thigh_back];
  const auto& r1 = body.rings[thigh_front];
  const auto& r2 = body.rings[flank];
  Limb udder(cage, {back, front},
             {{r0[4], -1, -1}, {r1[4], 0, -1}, {r2[4], 1, -1}, {r0[5], -1, 0}, {r1[5], 0, 0}, {r2[5], 1, 0}}, forward);
  const Vec3 root = cage.vertices[r1[5]] + 0.005 * l.body_length * forward;
  auto knot = [&](double down, double length, double width) {
    udder.grow({root - down * l.udder_depth * up, -up, length * l.udder_depth, width * l.udder_depth});
  };
  knot(0.30, 0.78, 0.56);
  knot(1.00, 0.84, 0.60);
  for (std::size_t quarter : {back, front}) {
    const Vec3 teat = cage.centre(quarter);
    const double half = 0.15 * l.udder_depth;
    limb_from_quad(cage, quarter, forward)
        .grow({teat, -up, half, half})
        .grow({teat - 0.45 * l.udder_depth * up, -up, 0.8 * half, 0.8 * half});
  }
}

void grow_horn(HalfCage& cage, std::size_t quad, const CowLengths& l) {
  Limb horn = limb_from_quad(cage, quad, forward);
  const Vec3 root = cage.centre(quad);
  // Shares of the horn's length: forwards, upwards, outwards, then the direction and the half thickness.
  auto knot = [&](double f, double u, double o, const Vec3& along, double thickness) {
    horn.grow({root + l.horn_length * (f * forward + u * up + o * right), along, thickness * l.horn_length,
               thickness * l.horn_length});
  };
  knot(-0.02, 0.18, 0.22, Vec3(0, 0.5, 1), 0.17);
  knot(0.04, 0.42, 0.55, Vec3(0.1, 0.9, 0.6), 0.13);
  knot(0.10, 0.78, 0.62, Vec3(0.1, 1, 0), 0.085);
  knot(0.14, 1.02, 0.56, Vec3(0.1, 1, -0.2), 0.03);
}

void grow_ear(HalfCage& cage, std::size_t quad, const CowLengths& l) {
  Limb ear = limb_from_quad(cage, quad, forward);
  const Vec3 root = cage.centre(quad);
  // Shares of the ear's length: outwards, half thickness (fore and aft), half height.
  auto knot = [&](double out, double thickness, double height) {
    ear.grow({root + l.ear_length * out * (right - 0.12 * up - 0.10 * forward), Vec3(-0.1, -0.12, 1),
              thickness * l.ear_length, height * l.ear_length});
  };
  knot(0.10, 0.14, 0.15);
  knot(0.45, 0.12, 0.32);
  knot(0.80, 0.10, 0.26);
  knot(1.02, 0.05, 0.07);
}

void carve_face(HalfCage& cage, const Loft& body, const CowLengths& l) {
  const std::size_t eye = body.quads[ears_front][1], nostril = body.quads[muzzle][1];
  emboss(cage, eye, cage.centre(eye) + 0.03 * l.head_length * forward, 0.14 * l.head_width, 0.10 * l.head_width);
  emboss(cage, nostril, cage.centre(nostril), 0.1 * l.head_width, -0.12 * l.head_width);
}

void check(const CowLengths& l) {
  for (double length :
       {l.body_length, l.body_height, l.body_width, l.leg_length, l.leg_thickness, l.neck_length, l.head_length,
        l.head_height, l.head_width, l.horn_length, l.ear_length, l.tail_length, l.udder_depth})
    if (!(length > 0 && std::isfinite(length)))
      throw Error(Fault::bad_argument, "A cow needs positive, finite lengths; got " + std::to_string(length) + ".");
}

} // namespace

RawMesh cow_cage(const CowLengths& lengths) {
  check(lengths);
  HalfCage cage;
  std::vector<Ring> rings = trunk_rings(lengths);
  const std::vector<Ring> head = head_rings(lengths);
  rings.push_back(neck_ring(rings.back(), head.front(), lengths));
  rings.insert(rings.end(), head.begin(), head.end());

  const Loft body = loft(cage, rings);
  const Ring &back = rings.front(), &front = rings.back();
  const Vec2 bulge_back = Vec2(-0.02, 0) * lengths.body_length,
             bulge_front = 0.05 * lengths.head_length * head_frame(lengths).along;
  auto between = [](const Ring& ring, double down) { return Vec2(ring.top + down * (ring.bottom - ring.top)); };
  const auto rump_quads =
      cap(cage, body.rings.front(), between(back, 0.34) + bulge_back, between(back, 0.67) + bulge_back, false);
  cap(cage, body.rings.back(), between(front, 0.34) + bulge_front, between(front, 0.67) + bulge_front, true);

  grow_tail(cage, rump_quads[0], lengths);
  grow_legs(cage, body, lengths);
  grow_udder(cage, body, lengths);
  grow_horn(cage, body.quads[poll][1], lengths);
  grow_ear(cage, body.quads[poll][2], lengths);
  carve_face(cage, body, lengths);

  RawMesh mesh = mirrored(cage);
  mesh.name = "cow cage";
  return mesh;
}

} // namespace cowgpu
