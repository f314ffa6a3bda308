#include "tests/support/level_set_reference.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>

namespace cowgpu::test {
namespace {

// Where a parameter pair leads: the place on the level set, its unit normal, F, and the area a unit of parameters has.
struct Patch {
  Vec3 place, normal, foot;
  double area;
};
using Piece = std::function<Patch(double, double)>; // of the unit square

class Sum {
public:
  Sum(const Vec3& origin, int lmax, double tolerance)
      : origin_(origin), lmax_(lmax), tolerance_(tolerance),
        all(std::size_t((lmax + 1) * (lmax + 2) / 2), std::array<std::complex<double>, 6>{}) {}

  void add(const Piece& piece) { refine(piece, 0, 0, 1, rule(piece, 0, 0, 1), 0); }

private:
  using Values = LevelSetCoefficients;

  // Gauss's rule of 5 x 5 points on a square of the parameters.
  Values rule(const Piece& piece, double u, double v, double side) const {
    static const double nodes[] = {0, 0.5384693101056831, -0.5384693101056831, 0.9061798459386640, -0.9061798459386640};
    static const double weights[] = {128. / 225, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891,
                                     0.2369268850561891};
    Values values(all.size(), std::array<std::complex<double>, 6>{});
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) {
        const Patch at = piece(u + side * (1 + nodes[i]) / 2, v + side * (1 + nodes[j]) / 2);
        const Vec3 p = at.place - origin_, f = at.foot - origin_;
        const double r = p.norm();
        const double solid = weights[i] * weights[j] * side * side / 4 * at.area * at.normal.dot(p) / (r * r * r);
        const double theta = std::atan2(std::hypot(p.x(), p.y()), p.z()), phi = std::atan2(p.y(), p.x());
        double dtheta = 0, dphi = 0;
        if (at.place != at.foot) {
          dtheta = std::atan2(std::hypot(f.x(), f.y()), f.z()) - theta;
          dphi = std::remainder(std::atan2(f.y(), f.x()) - phi, 2 * std::numbers::pi);
        }
        const double fields[] = {f.norm(), dtheta, dphi, f.x(), f.y(), f.z()};
        for (int l = 0; l <= lmax_; ++l)
          for (int m = 0; m <= l; ++m) {
            const auto y = std::polar(std::sph_legendre(unsigned(l), unsigned(m), theta), -m * phi) * solid;
            for (std::size_t k = 0; k < 6; ++k) values[std::size_t(l * (l + 1) / 2 + m)][k] += fields[k] * y;
          }
      }
    return values;
  }

  void refine(const Piece& piece, double u, double v, double side, const Values& whole, int depth) {
    std::vector<Values> quarters;
    const double half = side / 2;
    for (int q = 0; q < 4; ++q) quarters.push_back(rule(piece, u + (q & 1) * half, v + (q >> 1) * half, half));
    double off = 0;
    for (std::size_t i = 0; i < whole.size(); ++i)
      for (std::size_t k = 0; k < 6; ++k)
        off = std::max(
            off, std::abs(whole[i][k] - quarters[0][i][k] - quarters[1][i][k] - quarters[2][i][k] - quarters[3][i][k]));
    for (int q = 0; q < 4; ++q)
      if (depth < 2 || (off > tolerance_ * side && depth < 40))
        refine(piece, u + (q & 1) * half, v + (q >> 1) * half, half, quarters[std::size_t(q)], depth + 1);
      else
        for (std::size_t i = 0; i < whole.size(); ++i)
          for (std::size_t k = 0; k < 6; ++k) all[i][k] += quarters[std::size_t(q)][i][k];
  }

  Vec3 origin_;
  int lmax_;
  double tolerance_;

public:
  Values all;
};

Vec3 normal_of(const RawMesh& mesh, const Face& f) {
  return (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]).normalized();
}

// The point of an arc between unit vectors, and the arc's angle.
Vec3 on_arc(const Vec3& a, const Vec3& b, double part) {
  const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
  return angle < 1e-12 ? a : Vec3((std::sin((1 - part) * angle) * a + std::sin(part * angle) * b) / std::sin(angle));
}

} // namespace

LevelSetCoefficients level_set_coefficients(const RawMesh& mesh, const Vec3& origin, double level, int lmax,
                                            double tolerance) {
  double size = 0;
  for (const Vec3& v : mesh.vertices) size = std::max(size, (v - origin).norm());
  Sum sum(origin, lmax, tolerance * size);
  std::map<std::array<std::uint32_t, 2>, std::size_t> face_of; // of half-edges
  for (std::size_t i = 0; i < mesh.faces.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) face_of[{mesh.faces[i][k], mesh.faces[i][(k + 1) % 3]}] = i;
  for (const Face& f : mesh.faces) {
    const Vec3 a = mesh.vertices[f[0]], b = mesh.vertices[f[1]] - a, c = mesh.vertices[f[2]] - a,
               n = normal_of(mesh, f);
    const double twice = b.cross(c).norm();
    sum.add([=](double u, double v) { // the square onto the triangle, its side u = 0 to the corner a
      const Vec3 q = a + u * ((1 - v) * b + v * c);
      return Patch{q + level * n, n, q, u * twice};
    });
  }
  // Positions were taken from the origin: what is seen edge-on from it is the origin itself.
  const double whole = std::sqrt(4 * std::numbers::pi);
  const auto from_zero = [&](LevelSetCoefficients a) {
    for (std::size_t c = 0; c < 3; ++c) a[0][3 + c] += whole * origin[Eigen::Index(c)];
    return a;
  };
  if (level == 0) return from_zero(sum.all);
  for (const auto& [ends, face] : face_of) {
    if (ends[0] > ends[1]) continue;
    const Vec3 a = mesh.vertices[ends[0]], b = mesh.vertices[ends[1]];
    const Vec3 n = normal_of(mesh, mesh.faces[face]), m = normal_of(mesh, mesh.faces[face_of.at({ends[1], ends[0]})]);
    const double angle = std::atan2(n.cross(m).norm(), n.dot(m));
    if (angle < 1e-9) continue;
    sum.add([=](double u, double v) {
      const Vec3 q = a + u * (b - a), at = on_arc(n, m, v);
      return Patch{q + level * at, at, q, (b - a).norm() * level * angle};
    });
  }
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    std::vector<Vec3> round; // normals of the fan, in order
    const auto start = face_of.lower_bound({v, 0});
    if (start == face_of.end() || start->first[0] != v) continue;
    std::size_t face = start->second;
    do {
      round.push_back(normal_of(mesh, mesh.faces[face]));
      const Face& f = mesh.faces[face];
      const auto k = std::size_t(std::find(f.begin(), f.end(), v) - f.begin());
      face = face_of.at({v, f[(k + 2) % 3]});
    } while (face != start->second);
    const Vec3 q = mesh.vertices[v];
    for (std::size_t i = 1; i + 1 < round.size(); ++i) {
      const Vec3 a = round[0], b = round[i], c = round[i + 1];
      const double triple = a.dot(b.cross(c));
      if (std::abs(triple) < 1e-12) continue;
      sum.add([=](double s, double t) { // the flat triangle seen from the centre
        const Vec3 w = (1 - s) * a + s * ((1 - t) * b + t * c);
        const double r = w.norm();
        return Patch{q + level * w / r, w / r, q, level * level * s * triple / (r * r * r)};
      });
    }
  }
  return from_zero(sum.all);
}

} // namespace cowgpu::test
