#include "host/mass/error_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

constexpr double unit_roundoff = 0x1p-53;
constexpr double well_known = 1e-6; ///< part of the norm
constexpr double known = 0.5;

std::string degree_word(std::span<const int> degrees) {
  return degrees.size() == 1 ? "degree" : "degrees";
}

} // namespace

std::vector<double> error_estimate(const RoundingTerms& p) {
  std::vector<double> error;
  for (std::size_t l = 0; l < p.root.size(); ++l) {
    const double terms = (8 + double(l) + std::sqrt(p.triangles) / 4) * p.root[l];
    error.push_back(l == 0 ? 4 * unit_roundoff * p.norm[0] + 0x1p-98 * p.bound[0]
                           : 2 * unit_roundoff * std::hypot(terms, 6 * p.norm[l]) + p.left_out[l]);
  }
  return error;
}

std::vector<double> root_by_sample(std::span<const double> sample_root, std::span<const double> sample_bound,
                                   std::span<const double> bound) {
  std::vector<double> root(bound.begin(), bound.end());
  for (std::size_t l = 0; l < root.size(); ++l)
    if (sample_bound[l] > 0) root[l] *= std::min(1.0, 2 * sample_root[l] / sample_bound[l]);
  return root;
}

WorstDegree worst_known_degree(const ErrorEstimate& estimate) {
  WorstDegree worst;
  for (std::size_t l = 0; l < estimate.error.size(); ++l) {
    const double relative = estimate.error[l] / estimate.norm[l];
    if (relative < known && relative >= worst.relative) worst = {relative, int(l)};
  }
  return worst;
}

std::string degree_list(std::span<const int> degrees) {
  constexpr std::size_t most = 6;
  std::vector<std::string> pieces;
  for (std::size_t i = 0; i < degrees.size();) {
    if (pieces.size() == most) {
      pieces.push_back(fmt::format("{} more to {}", degrees.size() - i, degrees.back()));
      break;
    }
    std::size_t end = i + 1;
    const int step = end < degrees.size() ? degrees[end] - degrees[i] : 0;
    if (step <= 2)
      while (end < degrees.size() && degrees[end] - degrees[end - 1] == step) ++end;
    if (step == 1 && end - i >= 3) {
      pieces.push_back(fmt::format("{} to {}", degrees[i], degrees[end - 1]));
    } else if (step == 2 && end - i >= 5) {
      pieces.push_back(fmt::format("{}, {}, {} ... {}", degrees[i], degrees[i + 1], degrees[i + 2], degrees[end - 1]));
    } else {
      end = i + 1;
      pieces.push_back(std::to_string(degrees[i]));
    }
    i = end;
  }
  return fmt::format("{}", fmt::join(pieces, ", "));
}

std::vector<std::string> sentences(const ErrorEstimate& estimate) {
  std::vector<int> good, poor, lost;
  double good_worst = 0, poor_worst = 0, lost_worst = 0;
  int good_degree = 0, poor_degree = 0;
  for (std::size_t l = 0; l < estimate.error.size(); ++l) {
    const double error = estimate.error[l], norm = estimate.norm[l];
    if (error <= well_known * norm && norm > 0) {
      good.push_back(int(l));
      if (error >= good_worst * norm) {
        good_worst = error / norm;
        good_degree = int(l);
      }
    } else if (error < known * norm) {
      poor.push_back(int(l));
      if (error >= poor_worst * norm) {
        poor_worst = error / norm;
        poor_degree = int(l);
      }
    } else {
      lost.push_back(int(l));
      const double bound = estimate.bound[l];
      if (bound > 0) lost_worst = std::max(lost_worst, (error + norm) / bound);
    }
  }
  std::vector<std::string> text;
  const auto worst = [](const std::vector<int>& degrees, int degree) {
    return degrees.size() == 1 ? std::string() : fmt::format(" (worst: {})", degree);
  };
  if (!good.empty())
    text.push_back(fmt::format("{} {} known to {:.1e} of {} norm or better{}", degree_word(good), degree_list(good),
                               good_worst, good.size() == 1 ? "its" : "their", worst(good, good_degree)));
  if (!poor.empty())
    text.push_back(fmt::format("{} {} known to no better than 1e-6 of {} norm: to {:.0e}{}, by what cancels among the "
                               "shares of the triangles or the cut-off leaves out; trust no more of their digits",
                               degree_word(poor), degree_list(poor), poor.size() == 1 ? "its" : "their", poor_worst,
                               poor.size() == 1 ? "" : fmt::format(" (worst: {})", poor_degree)));
  if (!lost.empty())
    text.push_back(fmt::format("{} {} zero within {:.0e} of the bound: nothing above rounding is left of {}",
                               degree_word(lost), degree_list(lost), lost_worst, lost.size() == 1 ? "it" : "them"));
  return text;
}

} // namespace cowgpu
