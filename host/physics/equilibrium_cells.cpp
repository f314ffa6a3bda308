#include "host/physics/equilibrium_cells.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

namespace cowgpu::physics {
namespace {

constexpr double cut_from = 0.6; // of the longest side

using Place = std::array<std::int64_t, 3>;

template <class Visit>
void for_vertices(const Body& body, Visit&& visit) {
  for (const Vec3& v : body.surface.vertices()) visit(v);
  for (const Part& part : body.parts)
    for (const Vec3& v : part.surface.vertices()) visit(v);
}

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

} // namespace

SpinFrame::SpinFrame(const Body& body, const Spin& spin) : origin_(spin.through) {
  Eigen::Index least = 0;
  spin.axis.cwiseAbs().minCoeff(&least);
  const Vec3 x = (Vec3::Unit(least) - spin.axis[least] * spin.axis).normalized();
  axes_.col(0) = x;
  axes_.col(1) = spin.axis.cross(x);
  axes_.col(2) = spin.axis;
  Vec3 lowest = Vec3::Constant(std::numeric_limits<double>::infinity()), highest = -lowest;
  for_vertices(body, [&](const Vec3& v) {
    const Vec3 q = inward(v);
    lowest = lowest.cwiseMin(q);
    highest = highest.cwiseMax(q);
    reach = std::max(reach, std::hypot(q[0], q[1]));
  });
  low = lowest[2];
  high = highest[2];
  box_middle_ = (lowest + highest) / 2;
  box_half_ = (highest - lowest) / 2;
}

UndecidedPlace SpinFrame::place_of(const std::vector<Cell>& group) const {
  UndecidedPlace place;
  place.cells = group.size();
  Vec3 lowest = group.front().centre, highest = lowest;
  std::set<int> sectors;
  for (const Cell& cell : group) {
    lowest = lowest.cwiseMin(cell.centre - cell.half);
    highest = highest.cwiseMax(cell.centre + cell.half);
    sectors.insert(int(std::floor(std::atan2(cell.centre[1], cell.centre[0]) / std::numbers::pi * 18)));
  }
  const Vec3 middle = (lowest + highest) / 2;
  for (const Cell& cell : group)
    place.radius = std::max(place.radius, ((cell.centre - middle).cwiseAbs() + cell.half).norm());
  place.centre = outward(middle);
  // Sectors of ten degrees; a group about the axis itself has few cells in them.
  place.ring =
      sectors.size() >= 36 && group.size() >= 100 && std::none_of(group.begin(), group.end(), [&](const Cell& cell) {
        return std::hypot(cell.centre[0], cell.centre[1]) < place.radius / 10;
      });
  return place;
}

void cut(const Cell& cell, std::vector<Cell>& to) {
  const double longest = cell.half.maxCoeff();
  Vec3 half = cell.half;
  for (int c = 0; c < 3; ++c)
    if (half[c] > cut_from * longest) half[c] /= 2;
  const auto parts = [&](int c) { return half[c] < cell.half[c] ? 2 : 1; };
  for (int z = 0; z < parts(2); ++z)
    for (int y = 0; y < parts(1); ++y)
      for (int x = 0; x < parts(0); ++x) {
        Cell part{cell.centre, half};
        const std::array<int, 3> side = {x, y, z};
        for (int c = 0; c < 3; ++c)
          if (parts(c) == 2) part.centre[c] += (2 * side[std::size_t(c)] - 1) * half[c];
        to.push_back(part);
      }
}

std::vector<std::vector<Cell>> touching(const std::vector<Cell>& cells) {
  double side = 0;
  for (const Cell& cell : cells) side = std::max(side, 2 * cell.half.maxCoeff());
  std::vector<std::size_t> parent(cells.size());
  std::iota(parent.begin(), parent.end(), std::size_t(0));
  std::map<Place, std::size_t> first; // of the cells whose centres lie in a cube of that side
  const auto place_of = [&](const Cell& cell) {
    Place place{};
    for (int c = 0; c < 3; ++c) place[std::size_t(c)] = std::int64_t(std::floor(cell.centre[c] / side));
    return place;
  };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto [found, is_new] = first.try_emplace(place_of(cells[i]), i);
    if (!is_new) parent[root_of(parent, i)] = root_of(parent, found->second);
  }
  for (const auto& [place, i] : first)
    for (int k = 0; k < 27; ++k) {
      const auto found = first.find({place[0] + k % 3 - 1, place[1] + k / 3 % 3 - 1, place[2] + k / 9 - 1});
      if (found != first.end()) parent[root_of(parent, i)] = root_of(parent, found->second);
    }
  std::map<std::size_t, std::vector<Cell>> groups;
  for (std::size_t i = 0; i < cells.size(); ++i) groups[root_of(parent, i)].push_back(cells[i]);
  std::vector<std::vector<Cell>> found;
  for (auto& [root, group] : groups) found.push_back(std::move(group));
  return found;
}

bool holds(const std::vector<Cell>& group, const Vec3& place) {
  return std::any_of(group.begin(), group.end(), [&](const Cell& cell) {
    return ((place - cell.centre).cwiseAbs().array() <= cell.half.array() * (1 + 1e-9)).all();
  });
}

} // namespace cowgpu::physics
