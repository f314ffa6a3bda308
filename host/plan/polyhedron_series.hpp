// Polynomials of the closed forms: of w = z^2, lowest power first, interpolated at Chebyshev points. What they approximate is
// 2 atanh(z)/z for |z| <= 0.2005 and 2 atan(z)/z for |z| <= 0.2 and for |z| <= tan(pi/8); beside each its largest relative error.
#pragma once

#include <array>

namespace cowgpu::plan {

/// Right to the rounding of doubles.
struct FullSeries {
  static constexpr std::array atanh = {2.0,
                                       0.6666666666667569,
                                       0.39999999995294805,
                                       0.2857142950517728,
                                       0.22222131395718692,
                                       0.18186601178034084,
                                       0.15245895623917796,
                                       0.1539819284600443}; // 3e-17
  static constexpr std::array atan = {2.0,
                                      -0.6666666666666012,
                                      0.39999999996561564,
                                      -0.285714278818379,
                                      0.2222215418019332,
                                      -0.18178161340284663,
                                      0.15275101037288163,
                                      -0.11600898864526461}; // 2e-17
  static constexpr std::array folded_atan = {2.0,
                                             -0.6666666666666624,
                                             0.39999999999881297,
                                             -0.28571428558452994,
                                             0.22222221487476326,
                                             -0.18181793549820227,
                                             0.1538408943518799,
                                             -0.13325889526574225,
                                             0.11693652763669968,
                                             -0.10069731384388068,
                                             0.07591833927724048,
                                             -0.03559730388763467}; // 3e-18
};

/// Right to ten digits.
struct NineSeries {
  static constexpr std::array atanh = {2.000000000040641, 0.6666666161529816, 0.40001001650130097, 0.2850221280731686,
                                       0.24155447209212907}; // 2e-11
  static constexpr std::array atan = {1.9999999999665479, -0.6666666248232245, 0.39999160162624053, -0.285121780312691,
                                      0.2049956588829683}; // 2e-11
  static constexpr std::array folded_atan = {1.9999999999566707,  -0.6666666418907038, 0.39999767239044803,
                                             -0.2856316436380128, 0.22080814630975806, -0.16911455925416147,
                                             0.09412732214611083}; // 2e-11
};

/// Right to the rounding of single precision.
struct SingleSeries {
  static constexpr std::array atanh = {1.9999999951531957F, 0.6666705208447892F, 0.39952329076711196F,
                                       0.3044227402438554F}; // 2e-9
  static constexpr std::array atan = {1.9999999958334602F, -0.6666633300333649F, 0.3995806219700444F,
                                      -0.26870567804483597F}; // 2e-9
  static constexpr std::array folded_atan = {1.9999999987392865F, -0.6666661367657737F, 0.3999636017514989F,
                                             -0.284789558712663F, 0.21138841385633927F, -0.12050504590808067F}; // 6e-10
};

} // namespace cowgpu::plan
