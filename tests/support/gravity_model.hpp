// Readers of gravity models for the tests, written from the formats' descriptions and sharing no code with the program.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace cowgpu::test {

struct GravityModel {
  std::map<std::string, std::string> comments; ///< of lines "# word text" above begin_of_head
  std::map<std::string, std::string> head;     ///< keyword and first word behind it
  int lmax = 0;
  std::vector<std::vector<double>> c, s; ///< [l][m], fully normalised

  /// V = GM/r sum_l (R/r)^l sum_m P_lm(cos theta) (C_lm cos m phi + S_lm sin m phi) in the file's units, at a point about
  /// the origin.
  long double potential(long double x, long double y, long double z) const;
};

/// Throws std::runtime_error where the file is none of a static, fully normalised model with all its rows.
GravityModel read_gravity_model(const std::string& path);

/// The same of a gravity table of the PDS (SHADR) or of SHTOOLS: a first line of 4 to 8 values, then rows l, m, C, S and errors,
/// 4 pi normalised, C_00 = 1 and degree 1 zero where they are left out; lengths are `metres` long. Throws std::runtime_error.
GravityModel read_gravity_table(const std::string& path, double metres);

} // namespace cowgpu::test
