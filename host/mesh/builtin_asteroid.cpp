#include "host/mesh/builtin_asteroid.hpp"

#include <array>
#include <cmath>
#include <vector>

namespace cowgpu {
namespace {

/// In one order of sums; a library's own may depend on how it was compiled.
double dot(const Vec3& a, const Vec3& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

/// SplitMix64 (G. L. Steele, D. Lea and C. H. Flood, OOPSLA 2014).
class Random {
public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// In [0, 1), 53 bits.
  double uniform() {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return double((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
  }

  /// Of mean 0 and variance 1, nearly Gaussian.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

  /// A direction, all as likely as each other.
  Vec3 direction() {
    for (;;) {
      const Vec3 p(2 * uniform() - 1, 2 * uniform() - 1, 2 * uniform() - 1);
      const double square = dot(p, p);
      if (square > 0.01 && square <= 1) return p / std::sqrt(square);
    }
  }

private:
  std::uint64_t state_;
};

/// exp(x) for |x| up to some units, by its series; the library's depends on the library.
double exponential(double x) {
  double sum = 1, term = 1;
  for (int k = 1; k < 40; ++k) {
    term *= x / k;
    sum += term;
  }
  return sum;
}

/// A sum of real spherical harmonics whose coefficients are random, 4 pi normalised.
class RandomField {
public:
  /// Variance of degree l in all: proportional to 1 / l^2.8 from 2 to lmax, `deviation` squared together.
  RandomField(double deviation, Random& random) {
    std::array<double, lmax + 1> variance{};
    double sum = 0;
    for (int l = 2; l <= lmax; ++l)
      sum += variance[std::size_t(l)] = std::sqrt(std::sqrt(1.0 / l)) / (double(l) * l * l);
    for (int m = 0; m <= lmax; ++m)
      for (int l = m; l <= lmax; ++l) {
        const double size = deviation * std::sqrt(variance[std::size_t(l)] / (sum * (2 * l + 1)));
        Term term;
        term.cosine = size * random.normal();
        term.sine = size * random.normal();
        if (l > m) {
          const double above = double(l - 1) * (l - 1);
          term.a = std::sqrt((4.0 * l * l - 1) / (double(l) * l - double(m) * m));
          term.b = std::sqrt((above - double(m) * m) / (4 * above - 1));
        }
        terms_.push_back(term);
      }
  }

  double operator()(const Vec3& n) const {
    double sum = 0, diagonal = 1, c = 1, s = 0; // c + i s = (x + i y)^m
    auto term = terms_.begin();
    for (int m = 0; m <= lmax; ++m) {
      double before = 0, now = diagonal;
      for (int l = m; l <= lmax; ++l, ++term) {
        if (l > m) {
          const double next = term->a * (n.z() * now - term->b * before);
          before = now;
          now = next;
        }
        sum += now * (term->cosine * c + term->sine * s);
      }
      diagonal *= m == 0 ? std::sqrt(3.0) : std::sqrt((2.0 * m + 3) / (2 * m + 2));
      const double turned = c * n.x() - s * n.y();
      s = s * n.x() + c * n.y();
      c = turned;
    }
    return sum;
  }

private:
  static constexpr int lmax = 40;
  struct Term {
    double cosine = 0, sine = 0; ///< coefficients
    double a = 0, b = 0;         ///< P_l = a (z P_(l-1) - b P_(l-2))
  };
  std::vector<Term> terms_; ///< by m, then l
};

/// A bowl with a rim, in parts of its radius: -depth in the middle, rim at the edge, 0 from twice the radius on.
struct Crater {
  Vec3 centre;
  double radius = 0, depth = 0, rim = 0; ///< radius: of the unit sphere

  double height(const Vec3& n) const {
    const double t2 = (2 - 2 * dot(centre, n)) / (radius * radius);
    if (t2 >= 4) return 0;
    if (t2 < 1) return radius * (rim - (depth + rim) * (1 - t2) * (1 + t2 / 4));
    const double left = 2 - std::sqrt(t2);
    return radius * rim * left * left * left;
  }
};

/// The factor by which a surface is rough in each direction from its centre.
class Roughness {
public:
  Roughness(double deviation, int craters, double largest, Random& random) : field_(deviation, random) {
    // As many of at least the radius a as 1 / a^2, and half as deep when they are worn.
    for (int i = 0; i < craters; ++i) {
      Crater crater;
      crater.centre = random.direction();
      crater.radius = largest / std::sqrt(1 + i * (0.6 + 0.8 * random.uniform()));
      const double fresh = 0.35 + 0.65 * random.uniform();
      crater.depth = 0.3 * fresh;
      crater.rim = 0.07 * fresh;
      craters_.push_back(crater);
    }
  }

  double operator()(const Vec3& n) const {
    double factor = exponential(field_(n));
    for (const Crater& crater : craters_) factor *= 1 + crater.height(n);
    return factor;
  }

private:
  RandomField field_;
  std::vector<Crater> craters_;
};

struct Ellipsoid {
  Vec3 semi_axes, centre = Vec3::Zero();

  /// How far it is from the origin, which is inside, along a direction.
  double exit(const Vec3& n) const {
    const Vec3 u = n.cwiseQuotient(semi_axes), c = centre.cwiseQuotient(semi_axes);
    const double a = dot(u, u), b = dot(u, c);
    return (b + std::sqrt(b * b + a * (1 - dot(c, c)))) / a;
  }
};

/// A lobe with its own roughness.
struct Lobe {
  Ellipsoid ellipsoid;
  Roughness rough;

  /// By how much the point, r away from the origin, goes outwards, as a part of r: what a sphere about the lobe's centre would
  /// move there, but held back near the neck, where r is small.
  double rise(const Vec3& p, double r) const {
    const Vec3 d = p - ellipsoid.centre, u = d.cwiseQuotient(ellipsoid.semi_axes);
    const double parts = std::sqrt(dot(d, d)) / r, held = parts / std::sqrt(1 + parts * parts / 2.25);
    return held * (rough(u / std::sqrt(dot(u, u))) - 1);
  }
};

} // namespace

RawMesh asteroid(RawMesh sphere, std::uint64_t seed) {
  Random random(seed);
  const Ellipsoid base{Vec3(1.28, 1, 0.84)};
  const Roughness rough(0.1, 160, 0.42, random);
  for (Vec3& n : sphere.vertices) n *= base.exit(n) * rough(n);
  return sphere;
}

RawMesh contact_binary(RawMesh sphere, std::uint64_t seed) {
  Random random(seed);
  const std::array<Lobe, 2> lobes = {
      Lobe{{Vec3(0.8, 0.68, 0.6), Vec3(-0.72, 0, 0)}, Roughness(0.06, 110, 0.4, random)},
      Lobe{{Vec3(0.58, 0.53, 0.5), Vec3(0.52, 0.03, 0.02)}, Roughness(0.06, 80, 0.4, random)}};
  for (Vec3& n : sphere.vertices) {
    // The lobes' eighth powers: their sum's eighth root is the larger radius but near the neck, which it rounds.
    double powers = 0, rise = 0;
    for (const Lobe& lobe : lobes) {
      const double r = lobe.ellipsoid.exit(n), r2 = r * r, r4 = r2 * r2, r8 = r4 * r4;
      powers += r8;
      rise += r8 * lobe.rise(r * n, r);
    }
    n *= std::sqrt(std::sqrt(std::sqrt(powers))) * (1 + rise / powers);
  }
  return sphere;
}

} // namespace cowgpu
