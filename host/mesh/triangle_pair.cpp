#include "host/mesh/triangle_pair.hpp"

#include "host/geometry/orientation.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>

namespace cowgpu {
namespace {

using Signs = std::array<int, 3>;

bool has(const Face& face, std::uint32_t vertex) {
  return face[0] == vertex || face[1] == vertex || face[2] == vertex;
}

int shared_vertices(const Face& f, const Face& g) {
  return int(has(g, f[0])) + int(has(g, f[1])) + int(has(g, f[2]));
}

/// Sides of the corners of `of` of the plane of `plane`. Shared corners lie in it: no arithmetic says so faster.
Signs sides(std::span<const Vec3> v, const Face& plane, const Face& of) {
  Signs s{};
  for (std::size_t k = 0; k < 3; ++k)
    s[k] = has(plane, of[k]) ? 0 : side_of_plane(v[plane[0]], v[plane[1]], v[plane[2]], v[of[k]]);
  return s;
}

/// Where the plane of one triangle cuts the other: on two of its edges, each from a corner of sign >= 0 to one of sign <= 0.
struct Cut {
  struct Edge {
    std::uint32_t high, low;
    int high_sign, low_sign;
  };
  Edge ends[2];
  bool point;    ///< both ends are one corner
  bool straddle; ///< corners lie on both sides of the plane
};

/// Of a triangle with corners on both sides or in the plane, not all three in it.
Cut cut_of(const Face& f, const Signs& s) {
  const auto count = [&](int sign) { return std::count(s.begin(), s.end(), sign); };
  const auto positive = count(1), negative = count(-1);
  // The corner that is alone: the other two lie on the other side or in the plane; or it alone lies in the plane.
  const int alone = positive == 1 ? 1 : negative == 1 ? -1 : 0;
  const auto k = std::size_t(std::find(s.begin(), s.end(), alone) - s.begin());
  const bool high = alone > 0 || (alone == 0 && negative == 2);
  Cut cut{};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t other = (k + 1 + i) % 3;
    cut.ends[i] = high ? Cut::Edge{f[k], f[other], s[k], s[other]} : Cut::Edge{f[other], f[k], s[other], s[k]};
  }
  cut.point = alone == 0;
  cut.straddle = positive > 0 && negative > 0;
  return cut;
}

/// The order of two ends on the common line, up to a sign that is the same for all ends of the two triangles.
int order(std::span<const Vec3> v, const Cut::Edge& e, const Cut::Edge& f) {
  if (e.high == f.high || e.high == f.low || e.low == f.high || e.low == f.low) return 0;
  return side_of_plane(v[e.high], v[e.low], v[f.high], v[f.low]);
}

/// Where an end lies, rounded. `plane` is the face that cuts.
Vec3 place(std::span<const Vec3> v, const Face& plane, const Cut::Edge& end) {
  const Vec3 &a = v[plane[0]], &high = v[end.high], &low = v[end.low];
  if (end.high_sign == 0) return high;
  if (end.low_sign == 0) return low;
  const Vec3 normal = (v[plane[1]] - a).cross(v[plane[2]] - a);
  const double above = std::abs(normal.dot(high - a)), below = std::abs(normal.dot(low - a));
  if (!(above + below > 0)) return high / 2 + low / 2;
  return high + above / (above + below) * (low - high);
}

/// The inner two of the four ends, along the line.
void set_places(TrianglePair& pair, std::span<const Vec3> v, const Face& f, const Face& g, const Cut& on_f,
                const Cut& on_g) {
  const Vec3& a = v[f[0]];
  const Vec3 along =
      (v[f[1]] - a).cross(v[f[2]] - a).normalized().cross((v[g[1]] - v[g[0]]).cross(v[g[2]] - v[g[0]]).normalized());
  std::array<Vec3, 4> ends = {place(v, g, on_f.ends[0]), place(v, g, on_f.ends[1]), place(v, f, on_g.ends[0]),
                              place(v, f, on_g.ends[1])};
  std::stable_sort(ends.begin(), ends.end(),
                   [&](const Vec3& p, const Vec3& q) { return along.dot(p - a) < along.dot(q - a); });
  pair.from = ends[1];
  pair.to = pair.segment ? ends[2] : ends[1];
}

/// In one plane, seen along `axis`: how the inner sides of an edge of `t` look at the corners of `u`. `turn` makes t
/// counter-clockwise.
struct Separation {
  bool weak = false;   ///< some edge has no corner of the other triangle on its inner side
  bool strict = false; ///< and none on its line
};
Separation separation(std::span<const Vec3> v, const Face& t, const Face& u, int axis) {
  const int turn = orientation_along(axis, v[t[0]], v[t[1]], v[t[2]]);
  Separation found;
  for (std::size_t k = 0; k < 3; ++k) {
    int largest = -1;
    for (const std::uint32_t corner : u)
      if (const std::uint32_t from = t[k], to = t[(k + 1) % 3]; corner == from || corner == to)
        largest = std::max(largest, 0);
      else
        largest = std::max(largest, turn * orientation_along(axis, v[from], v[to], v[corner]));
    found.weak |= largest <= 0;
    found.strict |= largest < 0;
  }
  return found;
}

/// Two triangles of one plane that share a vertex and no area: do edges from that vertex run the same way?
bool common_direction(std::span<const Vec3> v, const Face& f, const Face& g, int axis) {
  const std::uint32_t shared = has(g, f[0]) ? f[0] : has(g, f[1]) ? f[1] : f[2];
  const Vec3& o = v[shared];
  for (const std::uint32_t i : f)
    for (const std::uint32_t j : g) {
      if (i == shared || j == shared || orientation_along(axis, o, v[i], v[j]) != 0) continue;
      bool same = true;
      for (int k = 0; k < 3; ++k) same &= (v[i][k] > o[k]) == (v[j][k] > o[k]) && (v[i][k] < o[k]) == (v[j][k] < o[k]);
      if (same) return true;
    }
  return false;
}

TrianglePair meet_in_plane(std::span<const Vec3> v, const Face& f, const Face& g, int shared) {
  const int axis = axis_with_area(v[f[0]], v[f[1]], v[f[2]]);
  const Separation a = separation(v, f, g, axis), b = separation(v, g, f, axis);
  TrianglePair pair;
  if (!a.weak && !b.weak)
    pair.meeting = Meeting::overlapping;
  else if (shared == 0)
    pair.meeting = a.strict || b.strict ? Meeting::none : Meeting::touching;
  else
    pair.meeting = shared == 1 && common_direction(v, f, g, axis) ? Meeting::touching : Meeting::none;
  if (pair.meeting == Meeting::none) return pair;
  // The middle of what the boxes have in common.
  const auto low = [&](const Face& t) { return v[t[0]].cwiseMin(v[t[1]]).cwiseMin(v[t[2]]).eval(); };
  const auto high = [&](const Face& t) { return v[t[0]].cwiseMax(v[t[1]]).cwiseMax(v[t[2]]).eval(); };
  pair.from = pair.to = low(f).cwiseMax(low(g)) / 2 + high(f).cwiseMin(high(g)) / 2;
  return pair;
}

bool one_side(const Signs& s) {
  return s[0] != 0 && s[0] == s[1] && s[1] == s[2];
}

/// Only a shared corner lies in the plane, the others on one side of it.
bool only_shared_corner(const Signs& s, int shared) {
  return shared == 1 && std::count(s.begin(), s.end(), 0) == 1 && std::abs(s[0] + s[1] + s[2]) == 2;
}

} // namespace

std::string_view name(Meeting meeting) {
  constexpr std::string_view names[] = {"none", "touching", "crossing", "overlapping"};
  return names[std::size_t(meeting)];
}

int axis_with_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int axis = 0; axis < 3; ++axis)
    if (orientation_along(axis, a, b, c) != 0) return axis;
  return -1;
}

TrianglePair meet(std::span<const Vec3> v, const Face& f, const Face& g) {
  const int shared = shared_vertices(f, g);
  const Signs of_g = sides(v, f, g);
  if (one_side(of_g) || only_shared_corner(of_g, shared)) return {};
  if (of_g == Signs{}) return meet_in_plane(v, f, g, shared);
  if (shared >= 2) return {};
  const Signs of_f = sides(v, g, f);
  if (one_side(of_f) || only_shared_corner(of_f, shared)) return {};

  const Cut on_f = cut_of(f, of_f), on_g = cut_of(g, of_g);
  bool before = false, after = false, equal = false;
  for (const Cut::Edge& e : on_f.ends)
    for (const Cut::Edge& h : on_g.ends) {
      const int sign = order(v, e, h);
      before |= sign < 0;
      after |= sign > 0;
      equal |= sign == 0;
    }
  TrianglePair pair;
  if (before != after && !equal) return pair;
  pair.segment = before && after && !on_f.point && !on_g.point;
  if (shared == 1 && !pair.segment) return pair; // the shared corner
  pair.meeting = pair.segment && on_f.straddle && on_g.straddle ? Meeting::crossing : Meeting::touching;
  set_places(pair, v, f, g, on_f, on_g);
  return pair;
}

} // namespace cowgpu
