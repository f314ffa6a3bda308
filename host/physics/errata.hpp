// What is wrong in "Higher multipoles of the cow", and the numbers that show it.
#pragma once

#include "host/mesh/body.hpp"

#include <span>
#include <string>
#include <vector>

namespace cowgpu::physics {

/// One mistake: in words, and by which command the right thing is had.
struct Erratum {
  int number;
  const char* printed; ///< what the paper says
  const char* right;
  const char* why;
  const char* shown_by; ///< a command; empty where words are enough
};

/// All of them, numbered from 1 without gaps.
std::span<const Erratum> errata();

/// A number that an erratum is about: as it is right, and as the paper has it or what its formula gives.
struct ErratumNumber {
  int erratum = 0;
  std::string quantity;
  double right = 0, printed = 0;
  double uncertainty = 0; ///< uncertainty of `right`, where it is more than rounding
};

/// Those that follow from the paper's own numbers and formulas.
std::vector<ErratumNumber> errata_numbers();

/// Those that take the paper's body, its benchmark: density 1, in the mesh's unit, about the centre of mass.
std::vector<ErratumNumber> errata_numbers(const Body& benchmark);

} // namespace cowgpu::physics
