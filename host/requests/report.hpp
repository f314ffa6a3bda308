// A result as a page: the body at every order with its distances from the true one, and what the applications found.
#pragma once

#include "host/backend.hpp"
#include "host/io/surface_file.hpp"
#include "host/mesh/raw_mesh.hpp"
#include "host/report/page.hpp"

#include <nlohmann/json.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// The largest order of a page, whose bodies have 66,000 vertices then: beyond, it would take seconds to open.
inline constexpr int largest_report_order = 128;
/// The order of a page that is not told another, where the expansion has so many.
inline constexpr int usual_report_order = 32;

struct ReportRequest {
  std::string result;          ///< the file of a result of `expand`
  std::optional<RawMesh> mesh; ///< the true body, to show beside and to take distances from; placed as the result was
  std::string values;          ///< the CSV file of values at the faces or vertices of that mesh, or ""
  std::vector<std::string> physics; ///< files of documents that `tensors`, `radiate` and the like make
  std::optional<int> order;         ///< the largest order of the body, up to largest_report_order
  std::vector<std::string> command; ///< the command line, for the page
};

/// The page's content. `document` points into the rest.
struct Report {
  Report() = default;
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;

  nlohmann::json result;
  std::vector<SurfaceFile> surfaces;
  RawMesh mesh;        ///< empty where none is known
  MeshValues values;   ///< on that mesh, where a file of them is named
  std::string warning; ///< that the mesh is another one than the result's, or empty; a note of the document too
  PageDocument document;
};

/// Reads the files, and measures how far the rebuilt bodies are from the mesh. Throws Error(cannot_read, file_format) for
/// files that are no such documents, bad_argument for an order beyond the expansions or
/// values without a mesh, and what DistanceField throws.
std::unique_ptr<Report> make_report(ReportRequest request, Backend& backend, Monitor& monitor);

} // namespace cowgpu
