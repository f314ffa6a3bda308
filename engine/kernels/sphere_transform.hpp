// The stages ring_fourier and legendre one after the other, with the buffers between them. Rings go through in slabs of
// pairs whose buffers fit into one binding each.
#pragma once

#include "engine/gpu.hpp"
#include "engine/kernels/legendre.hpp"
#include "engine/kernels/ring_fourier.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace cowgpu::engine {

class HostBuffer;
class Job;

/// Fields that share the recurrence of a Legendre kernel at most.
inline constexpr std::uint32_t most_fields_together = 3;

struct SphereTransformShape {
  LegendreShape legendre;
  RingFourierShape fourier;
};

/// Software devices keep rings of up to 4096 points in private arrays, other devices go pass by pass.
SphereTransformShape sphere_transform_shape(const GpuFacts& facts, SphereTransformShape wanted = {});

/// Bytes on the device for transforms of so many fields together: an upper bound.
std::uint64_t sphere_transform_device_bytes(const SphereTransformShape& shape, const GpuFacts& facts, int lmax,
                                            int pairs, int points, int fields);

class SphereTransform {
public:
  /// `pairs` of rings, a multiple of 8, the same in both inputs. Throws Error(out_of_range, vulkan, device_lost).
  SphereTransform(Device& device, const SphereTransformShape& shape, const LegendreInput& legendre,
                  const RingFourierInput& fourier);
  ~SphereTransform();

  /// Fields to be transformed together where `fields` are left to do.
  std::uint32_t together(std::uint32_t fields) const;

  /// The series of order m, k and field f: four doubles at this index in the series, real and imaginary part of qe_k or
  /// re_k, then of qo_k or ro_k; the next k stands series_stride() doubles further.
  std::size_t series_index(int m, std::uint32_t f, std::uint32_t fields) const;
  std::size_t series_stride(std::uint32_t fields) const;
  /// Steps k the series of order m has room for; those beyond its last one are to be 0.
  std::size_t series_steps(int m) const;

  /// Values of the pairs of a slab: [field][north or south][pair][longitude].
  using Values = std::function<void(RingSlab, std::span<double>)>;
  /// `prepare` fills the series; `take` gets the values of slab after slab.
  void to_values(std::uint32_t fields, bool weighted, const std::function<void(std::span<double>)>& prepare,
                 const Values& take, const Hook& hook);
  /// `give` fills the values of slab after slab; `finish` gets the series.
  void to_series(std::uint32_t fields, bool weighted, const Values& give,
                 const std::function<void(std::span<const double>)>& finish, const Hook& hook);

private:
  std::vector<RingSlab> slabs(std::uint32_t fields) const;
  void allocate(std::uint32_t fields);

  Device& device_;
  SphereTransformShape shape_;
  std::uint32_t pairs_, points_;
  Legendre legendre_;
  RingFourier fourier_;
  std::unique_ptr<Job> job_;
  std::unique_ptr<HostBuffer> series_, values_;
  std::unique_ptr<Buffer> waves_;
};

} // namespace cowgpu::engine
