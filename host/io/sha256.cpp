#include "host/io/sha256.hpp"

#include <sys/types.h>

#include <sha256.h>

#include <array>
#include <bit>

namespace cowgpu {
namespace {

static_assert(std::endian::native == std::endian::little, "sha256_of_geometry hashes memory as it lies");
static_assert(sizeof(Vec3) == 24 && sizeof(Face) == 12, "no gaps");

class Sha256 {
public:
  Sha256() { SHA256_Init(&context_); }

  void add(const void* data, std::size_t size) {
    if (size != 0) SHA256_Update(&context_, static_cast<const std::uint8_t*>(data), size);
  }

  std::string hex() {
    std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
    SHA256_Final(digest.data(), &context_);
    std::string text;
    text.reserve(2 * digest.size());
    for (const std::uint8_t byte : digest) {
      text += "0123456789abcdef"[byte >> 4];
      text += "0123456789abcdef"[byte & 15];
    }
    return text;
  }

private:
  SHA256_CTX context_{};
};

} // namespace

std::string sha256_hex(std::span<const std::byte> bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

std::string sha256_hex(std::string_view bytes) {
  return sha256_hex(std::as_bytes(std::span(bytes.data(), bytes.size())));
}

std::string sha256_of_geometry(const RawMesh& mesh) {
  Sha256 hash;
  hash.add(mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3));
  hash.add(mesh.faces.data(), mesh.faces.size() * sizeof(Face));
  return hash.hex();
}

} // namespace cowgpu
