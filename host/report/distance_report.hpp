// Distances from a surface, and how they are said (host/requests/distance.hpp).
#pragma once

#include "host/device_facts.hpp"
#include "host/io/distance_file.hpp"
#include "host/mesh/raw_mesh.hpp"
#include "host/report/result.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// Factor of the bounding box that a lattice of points fills.
inline constexpr double lattice_enlargement = 1.1;

struct DistanceResult {
  RawMesh mesh;
  std::vector<Vec3> queries;
  std::optional<PointLattice> lattice; ///< where the queries are one
  bool with_sign = true;
  ClosestPoints points; ///< one a query
  std::vector<std::string> notes;
  DeviceFacts device;
  ClosestReport report;
  /// Times of reading the mesh, opening the device and preparing it, and writing, to which the caller adds its own.
  double read_seconds = 0, setup_seconds = 0, write_seconds = 0;
  std::string input, output; ///< files of the points and of the distances, set by the caller; or empty

  /// For the file's writers; holds references to this.
  DistanceTable table() const { return {mesh.name, mesh.sha256, queries, points, lattice}; }
};

/// "10 x 4 x 6 points 0.1 apart, the bounding box enlarged by 1.1".
std::string lattice_text(const PointLattice& lattice);

/// After data/schemas/cowgpu.distance.v1.json.
Object document(const DistanceResult& result, const std::vector<std::string>& command);

/// Lines for the screen.
void write_distance(const DistanceResult& result, const Sink& sink);

} // namespace cowgpu
