// The verbs of the engine. One interface, two implementations: host/cpu and host/gpu.
#pragma once

#include "host/device_facts.hpp"
#include "host/distance_field.hpp"
#include "host/flow.hpp"
#include "host/image.hpp"
#include "host/moment_problem.hpp"
#include "host/monitor.hpp"
#include "host/multipoles.hpp"
#include "host/potential.hpp"
#include "host/render.hpp"
#include "host/run_report.hpp"
#include "host/sphere_samples.hpp"
#include "host/sphere_transform.hpp"
#include "host/types.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace cowgpu {

/// An engine: the CPU, or one Vulkan device.
class Backend {
public:
  virtual ~Backend() = default;
  virtual const DeviceFacts& facts() const = 0;

  /// Exact multipole moments of the signed tetrahedra (origin, face): the mathematics stands in host/plan/moments.hpp. Throws
  /// Error(bad_argument) for a problem out of range, too_large, device_failed, device_lost, interrupted. The same problem
  /// on the same device gives the same bits.
  virtual Multipoles moments(const MomentProblem& problem, Monitor& monitor, RunReport* report = nullptr) = 0;

  /// Upper bound of the memory moments() allocates, its result included.
  virtual MemoryNeed moments_memory(const MomentProblem& problem) const = 0;

  /// The verbs `analyse` and `synthesise` on a grid, to degree lmax <= grid.lmax: recurrence coefficients and start values
  /// are made here. Throws Error(bad_argument, too_large, device_failed, device_lost).
  virtual std::unique_ptr<SphereTransform> sphere_transform(const SphereGrid& grid, int lmax) = 0;

  /// Upper bound of the memory a transform of so many fields allocates, beside its input and output: O(lmax^2 + points).
  virtual MemoryNeed sphere_transform_memory(const SphereGrid& grid, int lmax, int fields) const = 0;

  /// For every point of the grid the triangle of a map to the sphere that the ray from the centre in its direction
  /// (SphereDirections) meets, and where: `positions` are unit vectors, one per vertex, to 1e-9. A triangle holds its edges
  /// and corners; signs are exact, so a closed mesh leaves no gap. Where several triangles hold a direction, the least
  /// (flipped, face index) has it, flipped meaning det(a, b, c) < 0; triangles with det 0 hold none (host/plan/sample.hpp).
  /// Every path gives the same faces; weights agree to 1e-15. Throws Error(map_failed) for a direction that no triangle
  /// holds, bad_argument, too_large, device_failed, device_lost, interrupted. Of the report, seconds, setup_seconds and
  /// kernels are set.
  virtual SphereSamples sample(std::span<const Vec3> positions, std::span<const Face> faces, const SphereGrid& grid,
                               Monitor& monitor, RunReport* report = nullptr) = 0;

  /// Upper bound of the memory sample() allocates for so many faces, its result included.
  virtual MemoryNeed sample_memory(std::uint64_t faces, const SphereGrid& grid) const = 0;

  /// The verb `closest` on a triangle surface, which is copied: trees are built here. Throws what check_distance_surface
  /// throws, too_large, device_failed, device_lost. Every path gives the same bits (host/gpu/closest.hpp).
  virtual std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices,
                                                        std::span<const Face> faces) = 0;

  /// Upper bound of the memory a field and a call of closest() with so many queries allocate, its result included.
  virtual MemoryNeed distance_field_memory(std::uint64_t vertices, std::uint64_t faces,
                                           std::uint64_t queries) const = 0;

  /// The verb `flow` off a closed triangle surface, which is copied. Throws what distance_field throws, and mesh_open. Every
  /// path gives the same bits (host/gpu/flow.hpp).
  virtual std::unique_ptr<DistanceFlow> distance_flow(std::span<const Vec3> vertices, std::span<const Face> faces) = 0;

  /// Upper bound of the memory a flow of so many starts allocates, its result included, streamlines not.
  virtual MemoryNeed distance_flow_memory(std::uint64_t vertices, std::uint64_t faces, std::uint64_t starts) const = 0;

  /// V(x) = integral of density(y) / |x - y| outside a body, its gradient and its second derivatives, from its moments: the
  /// mathematics stands in host/plan/potential.hpp. Throws Error(point_inside) for a point nearer to the moments' origin
  /// than R, bad_argument, too_large, device_failed, device_lost, interrupted. The same problem on the same device gives the
  /// same bits. Of the report, seconds, setup_seconds, elements, full_elements and kernels are set.
  virtual PotentialField potential(const PotentialProblem& problem, Monitor& monitor, RunReport* report = nullptr) = 0;

  /// Upper bound of the memory potential() allocates at so many points, its result included.
  virtual MemoryNeed potential_memory(std::uint64_t points, int lmax, Derivatives derivatives) const = 0;

  /// The scene as a picture: smooth or flat shading, light from the upper left, the light of sky and ground where the
  /// surroundings let it through, edges with 16 samples a pixel. Every path and any number of threads give the same
  /// picture, bit by bit where the device's division of doubles is IEEE 754's (host/plan/render.hpp). Throws what
  /// check(scene) throws, too_large, device_failed, device_lost, interrupted.
  virtual Image render(const RenderScene& scene, Monitor& monitor) = 0;

  /// Measured multiply-add peak of double precision, in flops per second (a multiply-add counts two).
  virtual double measured_peak() = 0;

  /// What the validation layers said so far; always empty unless GpuOptions::validation.
  virtual std::vector<std::string> validation_messages() const { return {}; }
};

/// The CPU path on `threads` threads (0: all).
std::unique_ptr<Backend> make_cpu_backend(unsigned threads = 0);

/// Options of the Vulkan path.
struct GpuOptions {
  std::string device = "auto"; ///< "auto", an index of list_gpus(), or a part of a device's name
  bool validation = false;     ///< core and synchronisation validation; messages are counted
  // The layout of the kernels; 0 and false leave the choice to the kind of device (shaders/moments.comp).
  std::uint32_t levels = 0;                              ///< degrees a sweep advances; a power of two, 2 to 16
  std::uint32_t workgroups = 0;                          ///< partial sums; a power of two, at most 64
  bool rows_in_buffer = false;                           ///< recursion rows in device memory
  std::uint64_t state_budget = std::uint64_t(512) << 20; ///< bytes of recursion rows kept on the device at once
  std::uint32_t iteration_budget = 60000;                ///< loop iterations one invocation may run in a dispatch
  // The same for transforms (shaders/legendre.h, shaders/ring_fourier.h).
  std::uint32_t transform_steps = 0;        ///< steps k unrolled; 8, 16, ... 64
  std::uint32_t transform_rings = 0;        ///< pairs of rings worked on together; 1, 2, 4 or 8
  std::uint32_t transform_pairs = 0;        ///< pairs of rings a workgroup works on; a multiple of transform_rings
  std::uint64_t transform_binding = 0;      ///< bytes a binding spans at most
  std::uint32_t private_ring_points = 4096; ///< longest ring transformed without buffers between the passes
};

/// The Vulkan path. Throws Error(no_loader, no_device, no_fp64, device_failed).
std::unique_ptr<Backend> make_gpu_backend(const GpuOptions& options);

/// The Vulkan devices of this machine, best first: discrete, integrated, virtual, software. Empty where there is no
/// loader or no device; `reason` then says why.
std::vector<DeviceFacts> list_gpus(std::string* reason = nullptr);

} // namespace cowgpu
