// Helpers of the tests of grid and coefficient files.
#pragma once

#include "host/error.hpp"

#include <cstdint>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

namespace cowgpu::test {

inline std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

inline void write_text(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// "fault-name: sentence" of what `work` throws, or "none".
template <class Work>
std::string fault_of(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return std::string(name(error.fault())) + ": " + error.what();
  }
  return "none";
}

/// `text` with the first `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("nothing to replace: " + from);
  return text.replace(at, from.size(), to);
}

/// A damaged copy: cut off somewhere, or a few bits of its first 8 KiB (the structure) or of all of it turned.
inline std::string damaged(std::string bytes, std::uint32_t seed) {
  std::mt19937 random(seed);
  if (seed % 3 == 0) return bytes.substr(0, random() % bytes.size());
  const std::size_t span = seed % 2 ? std::min<std::size_t>(bytes.size(), 8192) : bytes.size();
  for (std::uint32_t i = 0; i <= random() % 8; ++i) bytes[random() % span] ^= char(1 << (random() % 8));
  return bytes;
}

} // namespace cowgpu::test
