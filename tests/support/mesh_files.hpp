// Meshes as the bytes of files, written as other programs write them.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <string>

namespace cowgpu::test {

/// Numbers of 17 digits.
std::string off_text(const RawMesh& mesh);
std::string obj_text(const RawMesh& mesh);
std::string ply_text(const RawMesh& mesh);
std::string stl_text(const RawMesh& mesh);

/// Coordinates of type double or float, indices of type int.
std::string ply_bytes(const RawMesh& mesh, bool doubles, bool big_endian);
/// Floats, normals of length zero.
std::string stl_bytes(const RawMesh& mesh, const std::string& header = "box");
/// By write_glb().
std::string glb_bytes(const RawMesh& mesh);

/// A GLB of this JSON and this binary chunk.
std::string glb_of(std::string json, std::string chunk);
/// A glTF 2.0 text of this binary data in a data: URI; `members` are the JSON's besides asset and buffers.
std::string gltf_of(const std::string& members, const std::string& data);
/// The bytes of numbers.
std::string bytes_of(const std::vector<float>& numbers);
std::string bytes_of(const std::vector<std::uint16_t>& numbers);

/// Every coordinate rounded to float.
RawMesh rounded_to_floats(RawMesh mesh);

} // namespace cowgpu::test
