// What the numbers of a request are held to.
#pragma once

#include "host/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cowgpu {

/// Threads of the CPU path, at most.
inline constexpr unsigned most_threads = 4096;

/// Throws Error(bad_argument), "the fields are 70: 1 to 64 are possible", unless least <= value <= largest; NaN is not.
/// `what` is a subject with its verb: "the fields are".
template <class Number>
void require_range(const char* what, Number value, Number least, Number largest) {
  if (!(value >= least && value <= largest))
    throw Error(Fault::bad_argument, fmt::format("{} {}: {} to {} are possible", what, value, least, largest));
}

/// The same of a finite number above 0, "the time is -1 s: it must be above 0 and finite", and of one from 0 on.
inline void require_positive(const char* what, double value, const char* unit = "") {
  if (!(value > 0 && std::isfinite(value)))
    throw Error(Fault::bad_argument, fmt::format("{} {}{}: it must be above 0 and finite", what, value, unit));
}
inline void require_not_negative(const char* what, double value, const char* unit = "") {
  if (!(value >= 0 && std::isfinite(value)))
    throw Error(Fault::bad_argument, fmt::format("{} {}{}: it must be finite and not below 0", what, value, unit));
}

/// Throws Error(bad_argument) for a number that was made a value of an enumeration and is none: its members are 0 to `last`.
template <class Enum>
void require_member(const char* what, Enum value, Enum last) {
  if (const long long number = static_cast<long long>(value); number < 0 || number > static_cast<long long>(last))
    throw Error(Fault::bad_argument,
                fmt::format("{} number {} of its kind: there are 0 to {}", what, number, static_cast<long long>(last)));
}

} // namespace cowgpu
