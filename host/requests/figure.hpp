// A figure of "Higher multipoles of the cow", or one that it lacks, of any body.
#pragma once

#include "host/backend.hpp"
#include "host/figures/figures.hpp"
#include "host/requests/expand_surfaces.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

enum class FigureKind {
  spectra,     ///< power by degree, of expansions and of the mass
  orders,      ///< orders 0 to 7 of one map, and the body
  components,  ///< the components of f over one map, on the body and on the sphere
  definition,  ///< what f is, over one map
  inflation,   ///< level sets of the distance
  streamlines, ///< streamlines of its flow
  tipping,     ///< a ball and the body, and what tips them
  surface      ///< a quantity on the body, in colours
};

/// Whether a figure can be an SVG too: those of lines alone, and the quantity on a body, whose SVG has a picture inside.
bool can_be_svg(FigureKind kind);

struct FigureRequest {
  FigureKind kind = FigureKind::spectra;
  plot::PictureFormat format = plot::PictureFormat::png;
  RawMesh mesh;
  /// The expansions that are shown, of one map but for spectra. Its degree is also that of the mass.
  ExpansionChoice expansions;
  /// Of spectra, maps that cannot be made are left out.
  bool leave_out = false;
  /// Result files of the mesh instead of expansions: one for orders, any number for spectra.
  std::vector<std::string> results;
  View view = {28, 14};
  std::vector<View> views; ///< of `surface`, in place of `view`; nothing: from several sides
  /// Of `surface`: the CSV file of values at faces or vertices of the mesh; "": gravity at the faces of the body of density 1
  /// that does not spin, whose mesh `mesh_name` names as load_mesh() takes it.
  std::string values, mesh_name;
  unsigned threads = 0;          ///< of `surface`: threads of what is done on the host; 0: all
  std::string colour;            ///< of `surface`: the quantity that is shown; "": shown_column()'s choice
  Plane plane;                   ///< plane of streamlines
  std::size_t streamlines = 240; ///< how many
};

struct FigureResult {
  plot::Canvas page;
  std::vector<std::string> left_out; ///< sentences: which maps, and why
};

/// Throws Error(bad_argument) for a figure of one map with several, file_format for a result of another mesh, and what the
/// expansions and the figures (host/figures/figures.hpp) throw.
FigureResult make_figure(FigureRequest request, Backend& backend, Monitor& monitor);

} // namespace cowgpu
