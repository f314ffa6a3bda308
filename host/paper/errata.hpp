// What is wrong in "Higher multipoles of the cow", and the numbers that show it.
#pragma once

#include "host/mesh/body.hpp"
#include "host/physics/findings.hpp"

#include <span>
#include <string>
#include <vector>

namespace cowgpu::paper {

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

/// Numbers that show errata: as they are right ("ours"), and as the paper has them or what its formula gives; these follow from
/// the paper's own numbers and formulas.
std::vector<physics::Comparison> errata_numbers();

/// Those that take the paper's body, its benchmark: density 1, in the mesh's unit, about the centre of mass.
std::vector<physics::Comparison> errata_numbers(const Body& benchmark);

/// One of them.
physics::Comparison erratum_number(int erratum, std::string quantity, double right, double printed,
                                   double uncertainty = 0);

} // namespace cowgpu::paper
