// A number of the paper "Higher multipoles of the cow" beside ours.
#pragma once

#include "host/paper/printed.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu::reproduce {

enum class Verdict {
  not_computed, ///< what would give it failed
  agrees,       ///< ours rounds to the digits that the paper prints
  differs,      ///< it does not; `reason` says why
  not_compared, ///< another body than the paper's
};

/// "agrees", "differs", "not compared", "not computed".
std::string_view name(Verdict verdict);

struct Row {
  std::string table;                ///< "mass multipoles"
  std::string item;                 ///< "conj Q_2,2"
  std::string printed;              ///< as the paper has it: "0.0008 - 0.0002i"
  std::vector<double> paper;        ///< the same: a number, or real and imaginary part
  std::vector<double> ours;         ///< the same; empty where not computed
  std::optional<double> difference; ///< ours less the paper's; of complex numbers the modulus
  Verdict verdict = Verdict::not_computed;
  std::string reason;
  std::string source; ///< the file that ours is from
};

/// The unit of the last printed digit: 1e-8 of "-1.81e-06", 1 of "13652", 1e12 of "9e12". Throws Error(bad_argument) for a
/// text that is no decimal number.
double last_digit(std::string_view printed);

/// A row with difference and verdict: ours agrees where each part is within half a unit of the paper's last digit. The reason
/// is kept only where they differ. Throws Error(bad_argument) for what is printed in words.
Row compared(const paper::Printed& printed, std::vector<double> ours, std::string source);

} // namespace cowgpu::reproduce
