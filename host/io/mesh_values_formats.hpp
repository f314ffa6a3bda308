// The writers behind mesh_values_file.hpp.
#pragma once

#include "host/colour_scale.hpp"
#include "host/io/atomic_file.hpp"
#include "host/mesh_values.hpp"
#include "host/monitor.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu::mesh_values_file {

/// What a writer works on; the values are checked.
struct Job {
  const MeshValues& values;
  const std::string& colour; ///< name of the column to colour by, or empty
  AtomicFile& file;          ///< commit() is left to the caller
  const Monitor& monitor;
};

void write_vtp(const Job& job);
void write_ply(const Job& job);
void write_glb(const Job& job);
void write_netcdf(const Job& job);
void write_table(const Job& job); ///< CSV
void write_about(const MeshValues& values, const std::string& name,
                 AtomicFile& file); ///< the JSON beside the CSV `name`

/// The column that is shown, as numbers with their colours.
struct Shown {
  const ValueColumn* column = nullptr; ///< null where there is none
  std::vector<double> numbers;
  ColourRange range;

  Shown(const MeshValues& values, const std::string& colour);
  /// Red, green and blue of place i, sRGB, 0 to 255.
  std::array<std::uint8_t, 3> bytes(std::size_t i) const;
  /// A sentence: "colours: slope from 0 to 38.1 deg, viridis; ..."
  std::string sentence() const;
};

/// Lines about a file: program, title, unit and meaning of every column, facts and notes.
std::vector<std::string> sentences(const MeshValues& values);

/// Bytes on their way to a file, in pieces.
class Pieces {
public:
  explicit Pieces(const Job& job) : job_(job) { bytes_.reserve(most + 4096); }
  ~Pieces() = default;

  std::string& bytes() { return bytes_; }
  /// Writes when a piece is full; throws what the file throws, and interrupted.
  void more() {
    if (bytes_.size() >= most) end();
  }
  void end() {
    check_stop(job_.monitor);
    job_.file.write(bytes_);
    bytes_.clear();
  }
  template <class T>
  void add(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void add(const Vec3& v) {
    for (int c = 0; c < 3; ++c) add(v[c]);
  }

private:
  static constexpr std::size_t most = 1 << 16;
  const Job& job_;
  std::string bytes_;
};

} // namespace cowgpu::mesh_values_file
