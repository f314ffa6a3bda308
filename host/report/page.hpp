// A result as one HTML file that needs nothing else: the page of host/report/page with the data inside.
#pragma once

#include "host/io/atomic_file.hpp"
#include "host/mesh_values.hpp"
#include "host/spectrum/reconstruct.hpp"
#include "host/types.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace cowgpu {

/// Distances of the vertices of one order from the true body, a byte each: 255 sqrt(distance / largest), rounded, so that
/// the error is at most largest (2 sqrt(distance / largest) + 1/510) / 510.
struct PageDistances {
  double largest = 0, rms = 0; ///< over the vertices, in the mesh's length unit; rms weighs them by area on the sphere
  std::vector<std::uint8_t> roots;
};

/// Of distances that are finite and not negative, one for each vertex of triangulation(grid).
PageDistances page_distances(const SphereGrid& grid, std::span<const double> distances);

/// An expansion that the page rebuilds.
struct PageSurface {
  std::string name; ///< in the result: "stretch"
  const SurfaceExpansion* expansion = nullptr;
  int order = 0;                                       ///< the largest that is shown
  std::array<std::vector<PageDistances>, 2> distances; ///< by SurfaceFields, then order; empty where no mesh is known
};

/// What the page shows.
struct PageDocument {
  const nlohmann::json* result = nullptr; ///< cowgpu.result.v1
  SphereGrid grid;                        ///< Clenshaw-Curtis: where the surfaces' vertices lie
  std::vector<PageSurface> surfaces;
  std::string mesh_name;          ///< name of the true body's mesh; empty where it is not known
  std::span<const Vec3> vertices; ///< vertices of the true body, where it is shown
  std::span<const Face> faces;
  const MeshValues* values = nullptr;          ///< values at the faces or vertices of that mesh, or null
  std::vector<nlohmann::ordered_json> physics; ///< documents of `cowgpu tensors`, `radiate` ...
  std::vector<std::string> notes;
  std::vector<std::string> command;
};

/// The degree of the grid a page shows surfaces to this order on: a wavelength has four points, and 128 degrees suffice.
int page_resolution(int order);

/// Where the page without data, report.html, is looked for: the folder in COWGPU_PAGE alone where that is set, else beside an
/// installed program (share/cowgpu/page), then beside a built one (page/).
std::vector<std::filesystem::path> page_folders();

/// The page without data. Throws Error(page_missing) with where it was looked for and how it is built, cannot_read, and
/// file_format for a file without a place for data.
std::string read_page();

/// The data as JSON, safe inside a <script> element: no '<', '>' or '&' is in it. Lists of numbers are base64 of
/// little-endian doubles (coefficients by field, m, l; re, im), floats (vertices, values), 32-bit integers (faces) and bytes
/// (distances). Results with an expansion `mass` have its multipoles to the largest order beside the surfaces. Throws
/// Error(file_format) for members a result must have.
std::string page_data(const PageDocument& document);

/// `page` with title and data put in; the caller commits. Throws Error(cannot_write).
void write_page(const std::string& page, const PageDocument& document, AtomicFile& file);

} // namespace cowgpu
