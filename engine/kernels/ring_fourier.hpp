// The kernels ring_fourier and ring_fourier_pass: between the values of pairs of rings and their waves E and O of each
// order. The passes are described in shaders/ring_fourier.h.
#pragma once

#include "engine/gpu.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace cowgpu::engine {

class Buffer;
class Job;

/// Pairs of rings first ... first + count - 1, as many as fit into one binding.
struct RingSlab {
  std::uint32_t first = 0, count = 0;
};

struct RingFourierShape {
  std::uint32_t lanes = 0; ///< pairs of rings a workgroup: the subgroup's size
  std::uint32_t private_points =
      0; ///< longest ring transformed in private arrays; 0: none, pass by pass through buffers
  std::uint32_t iteration_budget = 60000;
};

struct RingFourierInput {
  int points = 1;                 ///< points of a ring
  int orders = 1;                 ///< m = 0 ... orders - 1, 2 orders - 1 <= points
  std::span<const double> x;      ///< cos theta of each pair
  std::span<const double> weight; ///< weight of each pair
};

/// Radices of the passes for rings of so many points, the fast ones first.
std::vector<std::uint32_t> ring_radices(std::uint32_t points);

/// Whether such rings go pass by pass through two buffers of 16 bytes a point.
bool rings_through_buffers(const RingFourierShape& shape, std::uint32_t points);

/// With north and south ring as sums over m of N_m exp(i m phi) and S_m exp(i m phi):
///   to_waves:  E_m = f (N_m + S_m), O_m = f x (N_m - S_m), as sums over the points (not divided by their number);
///   to_values: N_m = f (E_m + x O_m), S_m = f (E_m - x O_m);
/// f is the weight, or 1. Values: [field][north or south][pair of the slab][longitude]. Waves: [pair of the slab][field]
/// [column][E or O] complex, column = m; other columns are left alone.
class RingFourier {
public:
  RingFourier(Device& device, const RingFourierShape& shape, const RingFourierInput& input);
  ~RingFourier();

  struct Work {
    const Buffer* values = nullptr;
    const Buffer* waves = nullptr;
    RingSlab slab;
    std::uint32_t fields = 1;
    std::uint32_t columns = 1;
    bool weighted = false;
  };
  /// Record into `job`. Throw Error(out_of_range) where a range or the loops are too long for the device.
  void to_waves(Job& job, const Work& work);
  void to_values(Job& job, const Work& work);

  /// After the job ran: throws Error(cut_short) if the device ended a loop early.
  void check_counts();

private:
  void whole_rings(Job& job, const Work& work, bool to_waves);
  void pass_by_pass(Job& job, const Work& work, bool to_waves);

  Device& device_;
  RingFourierShape shape_;
  std::uint32_t points_, orders_;
  std::vector<std::uint32_t> radices_;
  bool through_buffers_;
  std::unique_ptr<Buffer> twiddles_, rings_, counts_, first_, second_;
  std::uint32_t counted_ = 0, expected_ = 0; // workgroups of the last dispatch, iterations of each
};

} // namespace cowgpu::engine
