// SHA-256 (FIPS 180-4) of bytes and of meshes.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace cowgpu {

/// The SHA-256 of `bytes`: 64 lower-case hexadecimal digits, as sha256sum prints them. Throws nothing of its own.
std::string sha256_hex(std::span<const std::byte> bytes);
std::string sha256_hex(std::string_view bytes);

/// The SHA-256 of a mesh's geometry, for meshes that were never a file. Hashed are, without a gap or a count: x, y, z
/// of every vertex in order as little-endian IEEE 754 binary64 (bit for bit: -0 differs from 0), then the three indices
/// of every face in order as little-endian unsigned 32-bit integers. In numpy: sha256(V.astype('<f8').tobytes() +
/// F.astype('<u4').tobytes()). Name, notes and lines do not matter.
std::string sha256_of_geometry(const RawMesh& mesh);

} // namespace cowgpu
