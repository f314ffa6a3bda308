#include "tests/support/mapped_meshes.hpp"

#include "host/sphere_directions.hpp"
#include "tests/support/meshes.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace cowgpu::test {
namespace {

MappedMesh from(std::string name, const RawMesh& mesh) {
  MappedMesh map{std::move(name), mesh.vertices, mesh.faces};
  for (Vec3& p : map.positions) p.normalize();
  return map;
}

Vec3 random_vector(std::mt19937& random) {
  const auto uniform = [&] { return double(random()) / 2147483648.0 - 1; };
  for (;;) {
    const double x = uniform(), y = uniform(), z = uniform();
    const Vec3 v(x, y, z);
    if (v.norm() < 1 && v.norm() > 0.1) return v;
  }
}

} // namespace

MappedMesh identity_map(int level) {
  return from("identity " + std::to_string(level), icosphere(level));
}

MappedMesh rotated_map(int level, std::uint32_t seed) {
  std::mt19937 random(seed);
  const Vec3 axis = random_vector(random);
  return from("rotated " + std::to_string(level),
              rotated(icosphere(level), Eigen::AngleAxisd(3 * axis.norm(), axis.normalized()).toRotationMatrix()));
}

MappedMesh warped_map(int level, double size, std::uint32_t seed) {
  MappedMesh map = rotated_map(level, seed);
  map.name = "warped " + std::to_string(level) + " by " + std::to_string(size);
  std::mt19937 random(seed + 1);
  for (Vec3& p : map.positions) p = (p + size * random_vector(random)).normalized();
  return map;
}

MappedMesh crowded_map(int level, double power) {
  MappedMesh map = rotated_map(level, 3);
  map.name = "crowded " + std::to_string(level) + " by " + std::to_string(power);
  const Vec3 centre(0.36, -0.48, 0.8);
  const double reach = std::acos(-1.0) / 3;
  for (Vec3& p : map.positions) {
    const double angle = std::acos(std::clamp(p.dot(centre), -1.0, 1.0));
    if (angle >= reach || angle == 0) continue;
    const double to = reach * std::pow(angle / reach, power);
    p = (std::cos(to) * centre + std::sin(to) * (p - p.dot(centre) * centre).normalized()).normalized();
  }
  return map;
}

MappedMesh random_map(int level, std::uint32_t seed) {
  MappedMesh map = identity_map(level);
  map.name = "random " + std::to_string(level);
  std::mt19937 random(seed);
  for (Vec3& p : map.positions) p = random_vector(random).normalized();
  return map;
}

MappedMesh tetrahedron_map() {
  return from("tetrahedron",
              tetrahedron(Vec3(0.3, 0.1, 1), Vec3(1, 0.2, -0.4), Vec3(-0.5, 1, -0.3), Vec3(-0.4, -0.9, -0.5)));
}

MappedMesh octahedron_map() {
  return {"octahedron",
          {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
          {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2}, {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}}};
}

MappedMesh flat_triangle_map() {
  MappedMesh map = octahedron_map();
  map.name = "octahedron with a flat triangle";
  map.positions.push_back(Vec3(1, 1, 0).normalized());
  map.faces[0] = {0, 6, 2};
  map.faces.push_back({6, 1, 2});
  map.faces.push_back({0, 1, 6});
  return map;
}

MappedMesh grid_map(const SphereGrid& grid) {
  MappedMesh map;
  map.name = "grid " + std::string(name(grid.kind)) + " " + std::to_string(grid.lmax);
  const SphereDirections directions(grid);
  const auto n = std::uint32_t(grid.ring_length);
  std::uint32_t rings = 0;
  map.positions = {Vec3(0, 0, 1), Vec3(0, 0, -1)};
  for (int i = 0; i < grid.rings; ++i) {
    if (directions.sine[std::size_t(i)] == 0) continue;
    for (int j = 0; j < grid.ring_length; ++j) map.positions.push_back(directions(i, j));
    ++rings;
  }
  const auto at = [&](std::uint32_t ring, std::uint32_t j) { return 2 + ring * n + j % n; };
  for (std::uint32_t j = 0; j < n; ++j) {
    map.faces.push_back({0, at(0, j), at(0, j + 1)});
    map.faces.push_back({1, at(rings - 1, j + 1), at(rings - 1, j)});
    for (std::uint32_t i = 0; i + 1 < rings; ++i) {
      map.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      map.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return map;
}

} // namespace cowgpu::test
