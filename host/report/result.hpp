// Everything one `expand` found out, ready to be shown or written.
#pragma once

#include "host/device_facts.hpp"
#include "host/document.hpp"
#include "host/mass/verify.hpp"
#include "host/mesh/body.hpp"
#include "host/mesh/tensors.hpp"
#include "host/multipoles.hpp"
#include "host/report/surface_result.hpp"
#include "host/run_report.hpp"

#include <string>
#include <vector>

namespace cowgpu {

/// Seconds of the parts of a run.
struct Timings {
  double load = 0;    ///< reading and checking the mesh
  double device = 0;  ///< opening the device, beyond the time that loading took
  double moments = 0; ///< planning, computing, normalising
  double verify = 0;
  double surfaces = 0; ///< maps to the sphere and their expansions
  double total = 0;    ///< since the program started
};

/// Result of `expand`.
struct ExpandResult {
  std::vector<std::string> command; ///< as typed
  std::string created;              ///< UTC, ISO 8601
  Body body;
  DeviceFacts device;
  double cut_off = 0;
  Multipoles mass; ///< about body.origin
  Tensors tensors;
  RunReport run;
  Timings timings;
  Accuracy accuracy;
  std::vector<std::string> notes; ///< sentences: what was done to the mesh, why the CPU was used
  bool has_mass = true;           ///< false: no mass multipoles were asked for; mass, run and accuracy say nothing
  std::vector<SurfaceResult> surfaces;
};

/// One line: name, hash, triangles. It opens every result.
std::string mesh_line(const RawMesh& mesh);

/// The device in words; a software device is named as such.
std::string device_line(const DeviceFacts& device);

/// The result for people: what was computed, on what, how long, how accurate, the leading multipoles (raw Q_lm in mesh
/// units, not conjugated, in two columns like the paper's first table), volume, centre of mass, tensors.
void write_screen(const ExpandResult& result, const Sink& sink);

/// The result after data/schemas/cowgpu.result.v1.json. It refers to the coefficients of `result`, which must live as long.
Object document(const ExpandResult& result);

/// Bytes of the mass multipoles in that as JSON, to about ten per cent.
std::uint64_t json_bytes(int lmax);

/// The result as CSV: comment lines with conventions and provenance, a line of column names, then a row for each l and
/// m >= 0, by l, then m. Mass multipoles alone have the columns l,m,re,im of Q_lm / R^l, and `error_estimate` in the comments
/// is the estimated error of the norm of degrees 0, 1, ... in their units; with surfaces each expansion has
/// columns of its own, mass_re,mass_im and stretch_f_r_re,stretch_f_r_im ... stretch_z_im, and the comment lines say
/// origin, removed means and map of each.
void write_csv(const ExpandResult& result, const Sink& sink);

} // namespace cowgpu
