#include "host/spectrum/difference.hpp"

#include "host/error.hpp"
#include "host/spectrum/convert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cowgpu {
namespace {

double quotient(double difference, double norm) {
  if (norm > 0) return difference / norm;
  return difference > 0 ? std::numeric_limits<double>::infinity() : 0;
}

void check_origins(const CoefficientSet& a, const CoefficientSet& b) {
  if (!a.origin || !b.origin) return;
  const double apart = (*a.origin - *b.origin).norm(), scale = a.reference_radius.value_or(a.origin->norm());
  if (apart > 1e-12 * std::max(scale, a.origin->norm()))
    throw Error(
        Fault::bad_argument,
        fmt::format("the coefficients are about the points ({:.9g}, {:.9g}, {:.9g}) and ({:.9g}, {:.9g}, "
                    "{:.9g}), {:.3g} apart, and cannot be compared; translation is not offered: expand the body "
                    "again with --origin",
                    a.origin->x(), a.origin->y(), a.origin->z(), b.origin->x(), b.origin->y(), b.origin->z(), apart));
}

class Unlike {
public:
  explicit Unlike(std::vector<std::string>& sentences) : sentences_(sentences) {}
  template <class Value>
  void operator()(const char* what, const Value& a, const Value& b) {
    if (a != b) sentences_.push_back(fmt::format("{}: {} and {}", what, shown(a), shown(b)));
  }

private:
  static std::string shown(const std::string& text) { return text.empty() ? "not known" : text; }
  static std::string shown(std::string_view text) { return std::string(text); }
  static std::string shown(int number) { return std::to_string(number); }
  static std::string shown(const std::optional<double>& number) {
    return number ? fmt::format("{}", *number) : "not known";
  }
  std::vector<std::string>& sentences_;
};

std::vector<std::string> unlike(const CoefficientSet& a, const CoefficientSet& b) {
  std::vector<std::string> sentences;
  Unlike compare(sentences);
  compare("largest degree", a.lmax, b.lmax);
  compare("kind", name(a.kind), name(b.kind));
  compare("form", name(a.form), name(b.form));
  compare("normalisation", name(a.convention.normalisation), name(b.convention.normalisation));
  compare("phase", name(a.convention.phase), name(b.convention.phase));
  compare("reference radius", a.reference_radius, b.reference_radius);
  compare("Brillouin radius", a.brillouin_radius, b.brillouin_radius);
  compare("length unit", a.length_unit, b.length_unit);
  compare("mass unit", a.mass_unit, b.mass_unit);
  compare("density", a.density, b.density);
  if (a.kind == CoefficientKind::potential && b.kind == a.kind) compare("GM", a.gm, b.gm);
  if (a.origin.has_value() != b.origin.has_value())
    sentences.push_back(fmt::format("origin: only the {} says one", a.origin ? "first" : "second"));
  compare("mesh", a.provenance.mesh, b.provenance.mesh);
  compare("sha256 of the mesh", a.provenance.mesh_sha256, b.provenance.mesh_sha256);
  for (int f = 0; f < a.fields; ++f) compare("name", a.names[std::size_t(f)], b.names[std::size_t(f)]);
  return sentences;
}

FieldDifference compare_field(const CoefficientSet& a, const CoefficientSet& b, int f, int lmax) {
  FieldDifference field;
  const std::string& word = a.names[std::size_t(f)];
  field.name = !word.empty() ? word : a.fields == 1 ? "field" : fmt::format("field_{}", f + 1);
  for (int l = 0; l <= lmax; ++l) {
    double norm = 0, apart = 0, largest = -1;
    int worst = 0;
    for (int m = 0; m <= l; ++m) { // hypot: squares leave the range of a double before the numbers do
      const std::size_t i = a.index(f, l, m), j = b.index(f, l, m);
      const double here = std::hypot(a.first[i] - b.first[j], a.second[i] - b.second[j]);
      norm = std::hypot(norm, a.first[i], a.second[i]);
      apart = std::hypot(apart, here);
      if (here > largest) {
        largest = here;
        worst = m;
      }
    }
    field.norm.push_back(norm);
    field.difference.push_back(apart);
    field.worst_order.push_back(worst);
    field.total_norm = std::hypot(field.total_norm, norm);
    field.total = std::hypot(field.total, apart);
  }
  for (int l = 0; l <= lmax; ++l) {
    double scale = 0;
    for (int k = std::max(0, l - 2); k <= std::min(lmax, l + 2); ++k)
      scale = std::max(scale, field.norm[std::size_t(k)]);
    const double here = quotient(field.difference[std::size_t(l)], scale);
    if (here <= field.worst) continue;
    field.worst = here;
    field.worst_degree = l;
  }
  return field;
}

} // namespace

double FieldDifference::relative(std::size_t l) const {
  return quotient(difference[l], norm[l]);
}

double FieldDifference::total_relative() const {
  return quotient(total, total_norm);
}

double CoefficientDifference::worst() const {
  double largest = 0;
  for (const FieldDifference& field : fields) largest = std::max(largest, field.worst);
  return largest;
}

CoefficientDifference difference(const CoefficientSet& a, const CoefficientSet& b, Convention convention) {
  if (a.fields != b.fields)
    throw Error(Fault::bad_argument,
                fmt::format("{} fields in the first file and {} in the second; choose one with --field or --of",
                            a.fields, b.fields));
  check_origins(a, b);
  CoefficientDifference result;
  result.convention = convention;
  result.kind = a.kind;
  result.lmax = std::min(a.lmax, b.lmax);
  result.reference_radius = a.reference_radius.value_or(0);
  result.unlike = unlike(a, b);
  ConversionTarget target;
  target.form = Form::real;
  target.normalisation = convention.normalisation;
  target.phase = convention.phase;
  target.lmax = result.lmax;
  const CoefficientSet left = converted(a, target);
  target.kind = a.kind;
  if (a.kind != CoefficientKind::field) target.reference_radius = a.reference_radius;
  const CoefficientSet right = converted(b, target);
  for (int f = 0; f < a.fields; ++f) result.fields.push_back(compare_field(left, right, f, result.lmax));
  return result;
}

} // namespace cowgpu
