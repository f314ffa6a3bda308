// The parts of a glTF 2.0 file that meshes are read from, each checked before it is believed
// (https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html).
#pragma once

#include "host/error.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// Numbers of an accessor as they lie in a buffer: `count` elements of the wanted number of components, all of them
/// within the buffer, and those that take the places of some of them (a sparse accessor).
struct GltfNumbers {
  const char* data = nullptr; ///< unaligned, little endian; null: all zero
  std::size_t count = 0;
  std::size_t stride = 0;  ///< bytes from one element to the next
  std::size_t element = 0; ///< bytes of one
  int component_type = 0;
  bool normalized = false; ///< integers that stand for numbers from 0 or -1 to 1

  struct Sparse {
    std::size_t count = 0;
    const char* indices = nullptr; ///< where to, increasing
    int index_type = 0;
    const char* values = nullptr; ///< one after another
  } sparse;

  /// Where element i lies, or null for zeros.
  const char* at(std::size_t i) const;
  /// Element i of whole numbers.
  std::uint32_t index(std::size_t i) const;
  /// Component c of element i, integers as they are or, where normalized, by glTF 2.0, 3.6.2.2.
  double component(std::size_t i, std::size_t c) const;
};

inline constexpr int gltf_byte = 5120, gltf_ubyte = 5121, gltf_short = 5122, gltf_ushort = 5123, gltf_uint = 5125,
                     gltf_float = 5126;

/// Every message begins with the file's name and says which object of the file ("accessor 3") is meant.
class GltfDocument {
public:
  /// Takes a .gltf text or a .glb container apart; the bytes must outlive the document. The JSON is limited in depth (100)
  /// and in the number of its values (2^18 and one for each 32 bytes of the file); names, extras, materials and the
  /// like are not kept. Throws Error with
  /// - file_format: no glTF, another version than 2, extensions required that are not known to leave shapes alone;
  /// - file_syntax: broken JSON or chunks, too deep or too large a JSON;
  /// - file_truncated: the container or the text ends early.
  GltfDocument(std::string_view bytes, const std::string& name);

  [[noreturn]] void fail(Fault fault, const std::string& what, const std::string& sentence) const;

  /// Member of an object, or null where it is missing.
  const nlohmann::json* member(const nlohmann::json& object, const char* key) const;
  /// A whole number below 2^53; throws file_syntax for anything else, or if it is missing without a default.
  std::uint64_t whole(const nlohmann::json& object, const char* key, const std::string& what,
                      std::optional<std::uint64_t> otherwise = {}) const;
  /// `size` finite numbers; nothing if the member is missing.
  std::optional<std::vector<double>> numbers(const nlohmann::json& object, const char* key, std::size_t size,
                                             const std::string& what) const;
  /// An array, empty if the member is missing.
  const nlohmann::json& list(const nlohmann::json& object, const char* key, const std::string& what) const;

  const nlohmann::json& root() const { return root_; }
  /// Object `index` of the array `key` of the file ("nodes"), which `what` ("scene 0") names.
  const nlohmann::json& object(const char* key, std::uint64_t index, const std::string& what) const;
  std::size_t count(const char* key) const { return list(root_, key, "the file").size(); }

  /// The accessor's numbers, in no time that grows with them: `type` is "SCALAR" for unsigned integers or "VEC3" for
  /// floats and, where the file names KHR_mesh_quantization, bytes and shorts with and without sign. Throws file_format for
  /// accessors with neither a bufferView nor sparse values, other types and components, buffers in other files;
  /// file_syntax and file_truncated where it leads out of its view, its view out of its buffer, or its buffer ends early.
  GltfNumbers accessor(std::uint64_t index, const char* type, const std::string& what);

  /// Looks at every index of a sparse accessor. Throws file_syntax unless they increase and name elements.
  void require_increasing(const GltfNumbers& numbers, const std::string& what) const;

  std::vector<std::string> notes; ///< sentences for the user

private:
  std::string_view container(std::string_view bytes);
  void parse(std::string_view text, std::size_t file_size);
  void require_known_extensions() const;
  std::string_view buffer(std::uint64_t index, const std::string& what);
  bool names_extension(std::string_view extension) const;
  const char* elements(const nlohmann::json& accessor, std::uint64_t count, std::size_t element, std::size_t* stride,
                       const std::string& self);

  const std::string name_;
  nlohmann::json root_;
  bool has_chunk_ = false;
  std::string_view chunk_;                          // the GLB's binary part
  std::vector<std::optional<std::string>> decoded_; // bytes of each buffer, once it is asked for
};

} // namespace cowgpu
