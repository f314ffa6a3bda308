// Parts that several documents share.
#pragma once

#include "host/device_facts.hpp"
#include "host/document.hpp"
#include "host/kernel_time.hpp"
#include "host/mesh/raw_mesh.hpp"

#include <span>
#include <string>
#include <vector>

namespace cowgpu {

/// Now, UTC, ISO 8601.
std::string utc_now();

/// The members that open a document: schema ("cowgpu.tensors.v1"), program, command as typed, and when it was created.
Object opening(const std::string& schema, const std::vector<std::string>& command,
               const std::string& created = utc_now());

/// The member `mesh`: name, hash, and how many vertices and faces.
Object members(const RawMesh& mesh);

/// The member `device`.
Object members(const DeviceFacts& device);

/// The member `kernels`.
List entries(const std::vector<KernelTime>& kernels);

/// Quantiles of a map's quality: the parts of the surface and the values there.
Object quantiles(std::span<const double> parts, std::span<const double> values);

} // namespace cowgpu
