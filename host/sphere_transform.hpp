// The verbs `analyse` and `synthesise`: between fields on a grid and their spherical-harmonic coefficients.
#pragma once

#include "host/kernel_time.hpp"
#include "host/memory_need.hpp"
#include "host/monitor.hpp"
#include "host/sphere_coefficients.hpp"
#include "host/sphere_grid.hpp"

#include <complex>
#include <span>

namespace cowgpu {

/// Most fields one call transforms together.
inline constexpr int most_fields = 64;

/// What a call took, beside its result.
struct TransformReport {
  double seconds = 0;              ///< wall time of the call
  double legendre_seconds = 0;     ///< the part of `seconds` in the Legendre stage (on Vulkan: its kernels)
  double fourier_seconds = 0;      ///< the part of `seconds` in the ring transforms with folding
  double legendre_flops = 0;       ///< done by the Legendre stage; a multiply-add counts two
  double fourier_flops = 0;        ///< 5 n log2 n a pair of rings (one complex transform)
  std::vector<KernelTime> kernels; ///< empty on the CPU path
};

/// Transforms between real fields on `grid` and their coefficients to degree lmax <= grid.lmax, prepared once for many
/// calls: recurrence coefficients and start values are made by prepare(), or by the first call. Layouts: SphereCoefficients (fields, then m, then l) and [field][ring][longitude]. Several fields of one call
/// share the Legendre recursion. Rings are transformed in pairs, north and south of the equator (Ishioka, J. Meteor. Soc.
/// Japan 96 (2018) 241; host/plan/legendre.hpp).
///
/// With S the synthesis, W the quadrature weights weight_i 2 pi / ring_length and the inner products
///   <a, b> = sum over l and m = -l ... l of conj(a_lm) b_lm  and  <f, g> = sum over the points of f g,
/// analysis is A = S* W and its adjoint A* = W S.
///
/// Complex fields are pairs of real ones (host/spectrum/complex_fields.hpp). Values that are not finite, or whose sums
/// overflow, spread as IEEE arithmetic has it; nothing is thrown for them. `fields` is 0 to most_fields.
///
/// Keeps what it needs of its backend alive. Not for several threads at once. All throw Error(bad_argument) for spans of the
/// wrong size, Error(interrupted), and on Vulkan Error(device_failed, device_lost). The same input on the same device gives
/// the same bits.
class SphereTransform {
public:
  virtual ~SphereTransform() = default;

  const SphereGrid& grid() const { return grid_; }
  int lmax() const { return lmax_; }

  /// Upper bound of what a transform of so many fields allocates, tables included, beside its input and output: O(lmax^2 +
  /// points). It reads the numbers of the grid, not its rings.
  virtual MemoryNeed memory(int fields) const = 0;
  /// Makes the tables unless they are there.
  virtual void prepare() = 0;

  /// f = S a. Imaginary parts of a_l0 are ignored.
  void synthesise(int fields, std::span<const std::complex<double>> coefficients, std::span<double> values,
                  Monitor& monitor, TransformReport* report = nullptr);
  /// a = S* W f: the coefficients of f, exact for fields of degree at most lmax.
  void analyse(int fields, std::span<const double> values, std::span<std::complex<double>> coefficients,
               Monitor& monitor, TransformReport* report = nullptr);
  /// S*, a sum over the points without weights.
  void synthesise_adjoint(int fields, std::span<const double> values, std::span<std::complex<double>> coefficients,
                          Monitor& monitor, TransformReport* report = nullptr);
  /// A* = W S.
  void analyse_adjoint(int fields, std::span<const std::complex<double>> coefficients, std::span<double> values,
                       Monitor& monitor, TransformReport* report = nullptr);

protected:
  /// Throws Error(bad_argument) unless 0 <= lmax <= grid.lmax.
  SphereTransform(SphereGrid grid, int lmax);

  /// What rings are multiplied by: 1, or weight_i 2 pi / ring_length.
  enum class RingFactor { one, weight };

  /// What a path does: the grid's rings as if they began at longitude 0; SphereGrid::shift is seen to here, by exp(i m phi).
  virtual void to_grid(int fields, std::span<const std::complex<double>> coefficients, std::span<double> values,
                       RingFactor factor, Monitor& monitor, TransformReport& report) = 0;
  virtual void from_grid(int fields, std::span<const double> values, std::span<std::complex<double>> coefficients,
                         RingFactor factor, Monitor& monitor, TransformReport& report) = 0;

private:
  void check(int fields, std::size_t coefficients, std::size_t values) const;
  void to_rings(int fields, std::span<const std::complex<double>> coefficients, std::span<double> values,
                RingFactor factor, Monitor& monitor, TransformReport& report);
  void from_rings(int fields, std::span<const double> values, std::span<std::complex<double>> coefficients,
                  RingFactor factor, Monitor& monitor, TransformReport& report);
  template <class Work>
  void timed(int fields, std::size_t coefficients, std::size_t values, TransformReport* report, const Work& work);
  SphereGrid grid_;
  int lmax_;
};

} // namespace cowgpu
