#include "host/flow/streamlines.hpp"

#include "host/error.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/number.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace cowgpu {
namespace {

// The exact sign of a sum: a list of numbers that do not overlap grows by one term after the other, its last one decides
// (J. R. Shewchuk, Discrete Comput. Geom. 18 (1997) 305).
template <std::size_t n>
int sign_of_sum(const std::array<double, n>& terms) {
  std::array<double, n> parts{};
  std::size_t count = 0;
  for (const double term : terms) {
    double sum = term;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double total = sum + parts[i], of_part = total - sum;
      const double rest = (sum - (total - of_part)) + (parts[i] - of_part);
      sum = total;
      if (rest != 0) parts[kept++] = rest;
    }
    if (sum != 0) parts[kept++] = sum;
    count = kept;
  }
  return count == 0 ? 0 : parts[count - 1] > 0 ? 1 : -1;
}

/// A segment's first end, on the face's side that goes down through the plane.
struct Descent {
  std::uint32_t above, below, face;
  auto operator<=>(const Descent&) const = default;
};

class Cutter {
public:
  Cutter(std::span<const Vec3> vertices, std::span<const Face> faces, const Plane& plane)
      : vertices_(vertices), faces_(faces), plane_(plane), sides_(vertices.size()) {
    std::vector<bool> used(vertices.size());
    for (const Face& face : faces)
      for (const std::uint32_t v : face) used[v] = true;
    bool any_below = false;
    for (std::size_t v = 0; v < vertices.size(); ++v)
      if (used[v]) any_below |= (sides_[v] = plane.side(vertices[v])) < 0;
    least_above_ = any_below ? 0 : 1;
  }

  std::vector<CutLoop> run() {
    for (std::uint32_t f = 0; f < faces_.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = faces_[f][k], b = faces_[f][(k + 1) % 3];
        if (above(a) && !above(b)) descents_.push_back({a, b, f});
      }
    std::sort(descents_.begin(), descents_.end());
    gone_.resize(descents_.size());
    std::vector<CutLoop> loops;
    for (std::size_t first = 0; first < descents_.size(); ++first) {
      if (gone_[first]) continue;
      CutLoop loop = follow(first);
      if (loop.length > 0) loops.push_back(std::move(loop));
    }
    return loops;
  }

private:
  bool above(std::uint32_t v) const { return sides_[v] >= least_above_; }

  Vec3 crossing(std::uint32_t above, std::uint32_t below) const {
    const Vec3 &a = vertices_[above], &b = vertices_[below];
    if (sides_[above] == 0) return a;
    if (sides_[below] == 0) return b;
    const double from = plane_.height(a), to = plane_.height(b);
    // Both may round to 0 far from the origin.
    Vec3 p = from > to ? Vec3(a + from / (from - to) * (b - a)) : Vec3((a + b) / 2);
    p -= plane_.height(p) * plane_.normal.normalized();
    return p;
  }

  // A surface that is closed leaves as often as it enters: the way ends where it began.
  CutLoop follow(std::size_t first) {
    CutLoop loop;
    std::size_t at = first;
    do {
      gone_[at] = true;
      const Descent& from = descents_[at];
      const Face& face = faces_[from.face];
      std::size_t k = 0; // the side that comes up again
      while (above(face[k]) || !above(face[(k + 1) % 3])) ++k;
      const std::uint32_t up = face[(k + 1) % 3], low = face[k];
      const Vec3 start = crossing(from.above, from.below), end = crossing(up, low);
      if (start != end) {
        loop.points.push_back(start);
        loop.faces.push_back(from.face);
        loop.length += (end - start).norm();
      }
      const auto next = std::lower_bound(descents_.begin(), descents_.end(), Descent{up, low, 0});
      at = std::size_t(next - descents_.begin());
      if (up == descents_[first].above && low == descents_[first].below) break;
      while (at < descents_.size() && descents_[at].above == up && descents_[at].below == low && gone_[at]) ++at;
      if (at == descents_.size() || descents_[at].above != up || descents_[at].below != low)
        throw Error(Fault::mesh_open,
                    fmt::format("the edge from vertex {} to {} has faces on one side only: only closed "
                                "surfaces are cut into closed lines",
                                low, up));
    } while (true);
    return loop;
  }

  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
  const Plane plane_;
  std::vector<int> sides_;
  int least_above_ = 0;
  std::vector<Descent> descents_;
  std::vector<bool> gone_;
};

} // namespace

Vec3 Plane::v() const {
  const Vec3 n = normal.normalized();
  const Vec3 up = std::hypot(n.x(), n.y()) > 1e-9 ? Vec3::UnitZ() : Vec3::UnitY();
  return (up - up.dot(n) * n).normalized();
}

Vec3 Plane::u() const {
  return v().cross(normal.normalized()).normalized();
}

int Plane::side(const Vec3& x) const {
  std::array<double, 7> terms{};
  for (int c = 0; c < 3; ++c) {
    const double product = normal[c] * x[c];
    terms[std::size_t(2 * c)] = product;
    terms[std::size_t(2 * c + 1)] = std::fma(normal[c], x[c], -product);
  }
  terms[6] = -offset;
  return sign_of_sum(terms);
}

Plane parse_plane(const std::string& text) {
  if (text == "yz") return {Vec3::UnitX(), 0};
  if (text == "xy") return {Vec3::UnitZ(), 0};
  if (text == "xz") return {-Vec3::UnitY(), 0};
  const auto numbers = read_numbers<4>(text);
  if (!numbers)
    throw Error(Fault::bad_argument,
                fmt::format("--plane {}: it must be yz, xy, xz, or four numbers NX,NY,NZ,D for the points with "
                            "NX x + NY y + NZ z = D",
                            text));
  const auto [x, y, z, d] = *numbers;
  const Plane plane{{x, y, z}, d};
  const double length = plane.normal.norm();
  if (!(length > 1e-100 && length < 1e100))
    throw Error(Fault::bad_argument, fmt::format("--plane {}: a normal of length {} gives no plane", text, length));
  return plane;
}

std::vector<CutLoop> cut_by_plane(std::span<const Vec3> vertices, std::span<const Face> faces, const Plane& plane) {
  return Cutter(vertices, faces, plane).run();
}

StreamlineStarts starts_along(std::span<const CutLoop> loops, std::size_t count, std::span<const Vec3> vertices,
                              std::span<const Face> faces) {
  double whole = 0, before = 0;
  for (const CutLoop& loop : loops) whole += loop.length;
  const auto share = [&](double length) { return std::size_t(std::llround(double(count) * (length / whole))); };
  StreamlineStarts starts;
  for (std::uint32_t i = 0; i < loops.size(); ++i) {
    const CutLoop& loop = loops[i];
    const std::size_t first = share(before), own = share(i + 1 == loops.size() ? whole : before + loop.length) - first;
    before += loop.length;
    double passed = 0; // length of the segments before this one
    std::size_t placed = 0;
    for (std::size_t s = 0; s < loop.points.size(); ++s) {
      const Vec3 &a = loop.points[s], &b = loop.points[(s + 1) % loop.points.size()];
      const double length = (b - a).norm();
      const bool last = s + 1 == loop.points.size();
      for (; placed < own; ++placed) {
        const double at = (double(placed) + 0.5) * loop.length / double(own) - passed;
        if (at >= length && !last) break;
        const Face& f = faces[loop.faces[s]];
        starts.places.push_back(a + std::min(1.0, at / length) * (b - a));
        starts.normals.push_back(
            (vertices[f[1]] - vertices[f[0]]).cross(vertices[f[2]] - vertices[f[0]]).stableNormalized());
        starts.loops.push_back(i);
      }
      passed += length;
    }
  }
  return starts;
}

StreamlineStarts starts_near(const Plane& plane, double within, std::span<const Vec3> vertices,
                             std::span<const Face> faces) {
  std::vector<bool> used(vertices.size());
  for (const Face& face : faces)
    for (const std::uint32_t v : face) used[v] = true;
  const std::vector<Vec3> normals = vertex_normals(vertices, faces);
  StreamlineStarts starts;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    if (used[v] && std::abs(plane.height(vertices[v])) <= within) {
      starts.places.push_back(vertices[v]);
      starts.normals.push_back(normals[v]);
    }
  return starts;
}

Streamlines streamlines(std::span<const Vec3> vertices, std::span<const Face> faces, const StreamlineStarts& starts,
                        const Vec3& origin, FlowOptions options, DistanceFlow& flow, Backend& backend,
                        Monitor& monitor) {
  options.streamlines = true;
  Streamlines found;
  found.lines = flow.flow(starts.places, starts.normals, options, monitor, &found.report);
  found.distances = backend.distance_field(vertices, faces)->closest(found.lines.path, {}, monitor).distance;
  for (const Vec3& end : found.lines.positions) found.directions.push_back((end - origin).stableNormalized());
  return found;
}

} // namespace cowgpu
