// A reader of ICGEM files for the tests, written from the format's description and sharing no code with the program.
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

} // namespace cowgpu::test
