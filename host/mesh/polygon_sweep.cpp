#include "host/mesh/polygon_sweep.hpp"

#include "host/geometry/orientation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace cowgpu {
namespace {

constexpr std::uint32_t none = 0xffffffff;

/// The sweep line goes over the corners in order. Between two edges that it meets, the lower with the polygon above it, lies
/// a chain: the corners from the left end of the lower edge to that of the upper one whose surroundings to the right are not
/// cut yet. It bulges to the right (no corner of it sees two others), so that what a new corner sees of it hangs together.
/// An edge is named by the corner where it begins.
class Sweep {
public:
  Sweep(const FlatPolygon& polygon, std::vector<Face>& triangles)
      : polygon_(polygon), triangles_(triangles), active_(Below{this}), place_(polygon.size(), active_.end()),
        chains_(polygon.size()) {}

  std::optional<NotSimple> run() {
    std::vector<std::uint32_t> order(polygon_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) { return polygon_.before(i, j); });
    for (std::size_t i = 1; i < order.size(); ++i)
      if (polygon_.same_place(order[i - 1], order[i]))
        return NotSimple{true, {std::min(order[i - 1], order[i]), std::max(order[i - 1], order[i])}};
    const std::size_t first = triangles_.size();
    for (const std::uint32_t v : order) {
      corner(v);
      if (failed_) return failed_;
    }
    if (triangles_.size() - first != polygon_.size() - 2) fail(0, 0); // cannot be, as every meeting was found
    return failed_;
  }

private:
  struct Below {
    Sweep* sweep;
    bool operator()(std::uint32_t e, std::uint32_t f) const { return sweep->below(e, f); }
  };
  using Active = std::set<std::uint32_t, Below>;
  struct Node {
    std::uint32_t corner, below, above;
  };
  struct Chain {
    std::uint32_t bottom, top, last; ///< nodes; the last one that came is the rightmost
  };

  void fail(std::uint32_t e, std::uint32_t f) {
    if (!failed_) failed_ = NotSimple{false, {std::min(e, f), std::max(e, f)}};
  }

  bool runs_right(std::uint32_t e) const { return polygon_.before(e, polygon_.next(e)); }
  std::uint32_t left(std::uint32_t e) const { return runs_right(e) ? e : polygon_.next(e); }
  std::uint32_t right(std::uint32_t e) const { return runs_right(e) ? polygon_.next(e) : e; }

  /// Of two edges that the sweep line meets.
  bool below(std::uint32_t e, std::uint32_t f) {
    if (e == f) return false;
    const std::uint32_t a = left(e), b = left(f);
    if (a == b) return polygon_.turn(a, right(e), right(f)) > 0;
    if (polygon_.before(b, a)) {
      const int side = polygon_.turn(b, right(f), a);
      if (side == 0) fail(e, f);
      return side < 0;
    }
    const int side = polygon_.turn(a, right(e), b);
    if (side == 0) fail(e, f);
    return side > 0;
  }

  /// Whether two edges have more in common than a corner that both have.
  bool meet(std::uint32_t e, std::uint32_t f) const {
    const std::uint32_t a = e, b = polygon_.next(e), c = f, d = polygon_.next(f);
    if (b == c || a == d) { // neighbours: they may lie upon each other
      const std::uint32_t shared = b == c ? b : a, p = b == c ? a : b, q = b == c ? d : c;
      return polygon_.turn(shared, p, q) == 0 && polygon_.before(shared, p) == polygon_.before(shared, q);
    }
    const int c_side = polygon_.turn(a, b, c), d_side = polygon_.turn(a, b, d);
    if (c_side == 0 && d_side == 0) return polygon_.before(left(e), right(f)) && polygon_.before(left(f), right(e));
    return c_side * d_side <= 0 && polygon_.turn(c, d, a) * polygon_.turn(c, d, b) <= 0;
  }

  void compare(Active::iterator lower, Active::iterator upper) {
    if (meet(*lower, *upper)) fail(*lower, *upper);
  }

  void insert(std::uint32_t e) {
    const auto [at, is_new] = active_.insert(e);
    if (!is_new) return fail(*at, e);
    place_[e] = at;
    if (at != active_.begin()) compare(std::prev(at), at);
    if (std::next(at) != active_.end()) compare(at, std::next(at));
  }

  void erase(std::uint32_t e) {
    const auto at = place_[e], above = active_.erase(at);
    place_[e] = active_.end();
    if (above != active_.begin() && above != active_.end()) compare(std::prev(above), above);
  }

  /// The lower edge of the part of the polygon right below an edge that the line meets.
  std::uint32_t lower_edge_below(std::uint32_t e) {
    if (place_[e] != active_.begin())
      if (const std::uint32_t lower = *std::prev(place_[e]); runs_right(lower)) return lower;
    fail(e, e);
    return e;
  }

  void corner(std::uint32_t v) {
    const std::uint32_t in = polygon_.previous(v), out = v; // edges
    const bool from_left = polygon_.before(in, v), to_right = polygon_.before(v, polygon_.next(v));
    if (from_left && to_right) {
      Chain chain = chains_[in];
      erase(in);
      insert(out);
      const std::uint32_t seen = cut_upwards(v, chain.bottom);
      chain.bottom = chain.last = node(v, none, seen);
      chains_[out] = chain;
    } else if (!from_left && !to_right) {
      const std::uint32_t lower = lower_edge_below(out);
      if (failed_) return;
      erase(out);
      insert(in);
      Chain& chain = chains_[lower];
      const std::uint32_t seen = cut_downwards(v, chain.top);
      chain.top = chain.last = node(v, seen, none);
    } else {
      const int turn = polygon_.turn(in, v, polygon_.next(v));
      if (turn == 0) return fail(in, out); // the boundary turns back on itself
      if (to_right)
        turn > 0 ? start(v, in, out) : split(v, in, out);
      else
        turn > 0 ? end(v, in, out) : merge(v, in, out);
    }
  }

  void start(std::uint32_t v, std::uint32_t in, std::uint32_t out) {
    insert(out);
    insert(in);
    const std::uint32_t only = node(v, none, none);
    chains_[out] = {only, only, only};
  }

  void split(std::uint32_t v, std::uint32_t in, std::uint32_t out) {
    insert(in);
    insert(out);
    if (failed_) return;
    const std::uint32_t lower = lower_edge_below(in);
    if (failed_) return;
    Chain below = chains_[lower], above = below;
    const std::uint32_t middle = below.last;
    std::uint32_t top_seen = cut_upwards(v, middle), bottom_seen = cut_downwards(v, middle);
    if (top_seen == middle && bottom_seen == middle) { // it belongs to both parts
      top_seen = node(nodes_[middle].corner, none, nodes_[middle].above);
      if (above.top == middle) above.top = top_seen;
    }
    below.top = below.last = node(v, bottom_seen, none);
    above.bottom = above.last = node(v, none, top_seen);
    chains_[lower] = below;
    chains_[out] = above;
  }

  void end(std::uint32_t v, std::uint32_t in, std::uint32_t out) {
    cut_upwards(v, chains_[in].bottom);
    erase(out);
    erase(in);
  }

  void merge(std::uint32_t v, std::uint32_t in, std::uint32_t out) {
    const std::uint32_t lower = lower_edge_below(out);
    if (failed_) return;
    const std::uint32_t below = cut_downwards(v, chains_[lower].top), above = cut_upwards(v, chains_[in].bottom);
    const std::uint32_t top = chains_[in].top, joint = node(v, below, above);
    chains_[lower] = {chains_[lower].bottom, top, joint};
    erase(out);
    erase(in);
  }

  std::uint32_t node(std::uint32_t v, std::uint32_t below, std::uint32_t above) {
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({v, below, above});
    if (below != none) nodes_[below].above = at;
    if (above != none) nodes_[above].below = at;
    return at;
  }

  /// Cuts off what v sees of a chain from a node upwards; the last node seen.
  std::uint32_t cut_upwards(std::uint32_t v, std::uint32_t n) {
    for (std::uint32_t above; (above = nodes_[n].above) != none; n = above) {
      if (polygon_.turn(nodes_[n].corner, v, nodes_[above].corner) <= 0) break;
      triangles_.push_back({nodes_[n].corner, v, nodes_[above].corner});
    }
    return n;
  }

  std::uint32_t cut_downwards(std::uint32_t v, std::uint32_t n) {
    for (std::uint32_t below; (below = nodes_[n].below) != none; n = below) {
      if (polygon_.turn(nodes_[below].corner, v, nodes_[n].corner) <= 0) break;
      triangles_.push_back({nodes_[below].corner, v, nodes_[n].corner});
    }
    return n;
  }

  const FlatPolygon& polygon_;
  std::vector<Face>& triangles_;
  Active active_;
  std::vector<Active::iterator> place_; ///< by edge
  std::vector<Chain> chains_;           ///< by lower edge
  std::vector<Node> nodes_;
  std::optional<NotSimple> failed_;
};

/// Triangles and what lies across their edges. Edge k of a triangle is opposite its corner k.
class Diagonals {
public:
  Diagonals(const FlatPolygon& polygon, std::span<const std::array<double, 2>> places, std::vector<Face>& triangles)
      : polygon_(polygon), places_(places), triangles_(triangles), across_(triangles.size(), {none, none, none}) {
    struct Side {
      std::uint32_t low, high, triangle;
      std::uint8_t edge;
    };
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (std::uint8_t k = 0; k < 3; ++k) {
        const std::uint32_t a = triangles[t][(k + 1) % 3], b = triangles[t][(k + 2) % 3];
        sides.push_back({std::min(a, b), std::max(a, b), t, k});
      }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    for (std::size_t i = 1; i < sides.size(); ++i)
      if (sides[i].low == sides[i - 1].low && sides[i].high == sides[i - 1].high) {
        across_[sides[i].triangle][sides[i].edge] = sides[i - 1].triangle;
        across_[sides[i - 1].triangle][sides[i - 1].edge] = sides[i].triangle;
        open_.push_back({sides[i].low, sides[i].high, sides[i].triangle});
      }
  }

  void settle() {
    for (std::size_t left = 64 * triangles_.size(); !open_.empty() && left != 0;) {
      const Open edge = open_.back();
      open_.pop_back();
      for (unsigned k = 0; k < 3; ++k)
        if (triangles_[edge.triangle][k] != edge.a && triangles_[edge.triangle][k] != edge.b) {
          const std::uint32_t one = triangles_[edge.triangle][(k + 1) % 3],
                              two = triangles_[edge.triangle][(k + 2) % 3];
          if (std::min(one, two) == edge.a && std::max(one, two) == edge.b) left -= flip(edge.triangle, k);
        }
    }
  }

private:
  struct Open {
    std::uint32_t a, b, triangle; ///< a diagonal, and a triangle that had it
  };

  /// Flips the edge if it is a diagonal that is not Delaunay.
  bool flip(std::uint32_t t, unsigned k) {
    const std::uint32_t u = across_[t][k];
    if (u == none) return false;
    const std::uint32_t c = triangles_[t][k], a = triangles_[t][(k + 1) % 3], b = triangles_[t][(k + 2) % 3];
    unsigned m = 0;
    while (across_[u][m] != t || triangles_[u][m] == a || triangles_[u][m] == b) ++m;
    const std::uint32_t d = triangles_[u][m];
    if (!inside(c, a, b, d) || polygon_.turn(c, a, d) <= 0 || polygon_.turn(d, b, c) <= 0) return false;
    // t becomes (c, a, d) and u (d, b, c).
    const std::uint32_t bc = across_[t][(k + 1) % 3], ca = across_[t][(k + 2) % 3];
    const std::uint32_t ad = across_[u][(m + 1) % 3], db = across_[u][(m + 2) % 3];
    triangles_[t] = {c, a, d};
    across_[t] = {ad, u, ca};
    triangles_[u] = {d, b, c};
    across_[u] = {bc, t, db};
    replace(ad, u, t);
    replace(bc, t, u);
    for (const auto [p, q, triangle] : {Open{c, a, t}, Open{a, d, t}, Open{d, b, u}, Open{b, c, u}})
      open_.push_back({std::min(p, q), std::max(p, q), triangle});
    return true;
  }

  void replace(std::uint32_t t, std::uint32_t old, std::uint32_t by) {
    if (t != none) *std::find(across_[t].begin(), across_[t].end(), old) = by;
  }

  /// Whether d lies in the circle through c, a, b by more than rounding: the angles at c and d add to more than 180 degrees.
  bool inside(std::uint32_t c, std::uint32_t a, std::uint32_t b, std::uint32_t d) const {
    const auto [sine, cosine] = angle(a, c, b);
    const auto [other_sine, other_cosine] = angle(b, d, a);
    const double one = sine * other_cosine, two = cosine * other_sine;
    const double size = std::hypot(sine, cosine) * std::hypot(other_sine, other_cosine);
    return one + two < -1e-12 * size;
  }

  /// Sine and cosine of the angle from p to q about o, times both lengths.
  std::array<double, 2> angle(std::uint32_t p, std::uint32_t o, std::uint32_t q) const {
    const double px = places_[p][0] - places_[o][0], py = places_[p][1] - places_[o][1];
    const double qx = places_[q][0] - places_[o][0], qy = places_[q][1] - places_[o][1];
    return {std::abs(px * qy - py * qx), px * qx + py * qy};
  }

  const FlatPolygon& polygon_;
  std::span<const std::array<double, 2>> places_;
  std::vector<Face>& triangles_;
  std::vector<std::array<std::uint32_t, 3>> across_;
  std::vector<Open> open_;
};

} // namespace

bool FlatPolygon::before(std::uint32_t i, std::uint32_t j) const {
  const Vec3 &p = point(i), &q = point(j);
  return p[first_] != q[first_] ? p[first_] < q[first_] : p[second_] < q[second_];
}

bool FlatPolygon::same_place(std::uint32_t i, std::uint32_t j) const {
  const Vec3 &p = point(i), &q = point(j);
  return p[first_] == q[first_] && p[second_] == q[second_];
}

int FlatPolygon::turn(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
  const auto flat = [&](const Vec3& p) { return Vec3(p[first_], p[second_], 1); };
  return orientation(flat(point(i)), flat(point(j)), flat(point(k)));
}

std::optional<NotSimple> sweep(const FlatPolygon& polygon, std::vector<Face>& triangles) {
  return Sweep(polygon, triangles).run();
}

int sense_of(const FlatPolygon& polygon) {
  std::uint32_t first = 0;
  for (std::uint32_t i = 1; i < polygon.size(); ++i)
    if (polygon.before(i, first)) first = i;
  return polygon.turn(polygon.previous(first), first, polygon.next(first));
}

void flip_towards_delaunay(const FlatPolygon& polygon, std::span<const std::array<double, 2>> places,
                           std::vector<Face>& triangles) {
  Diagonals(polygon, places, triangles).settle();
}

} // namespace cowgpu
