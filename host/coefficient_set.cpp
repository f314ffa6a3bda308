#include "host/coefficient_set.hpp"

namespace cowgpu {

std::string_view name(CoefficientKind kind) {
  switch (kind) {
  case CoefficientKind::field: return "field";
  case CoefficientKind::multipoles: return "multipoles";
  case CoefficientKind::potential: return "potential";
  }
  return "unknown";
}

std::optional<CoefficientKind> kind_named(std::string_view word) {
  for (const auto kind : {CoefficientKind::field, CoefficientKind::multipoles, CoefficientKind::potential})
    if (word == name(kind)) return kind;
  return {};
}

} // namespace cowgpu
