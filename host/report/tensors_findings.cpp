#include "host/report/tensors_findings.hpp"

#include <fmt/format.h>

#include <string>

namespace cowgpu {

using namespace physics;

Findings findings(const TensorsResult& result) {
  Findings found(result.subject);
  const RigidBody& body = result.body;
  const bool complete = body.trace.has_value();
  const bool si = body.units.stated;
  const std::string length = si ? "m" : std::string(mesh_length_unit), mass = si ? "kg" : std::string(mesh_mass_unit),
                    unit = si ? "kg m^2" : "density * length^5, in the mesh's length unit";
  if (!complete)
    found.notes.push_back(
        "the file does not say the second moment, which no multipole holds: no inertia without it; the JSON "
        "of `cowgpu expand` holds it, and what `cowgpu convert` makes of that");
  if (!si)
    found.notes.push_back("lengths and densities are in the mesh's units; --length-unit or --length make them SI");
  if (result.principal.first_two_alike && result.principal.last_two_alike)
    found.notes.push_back("all three principal moments are equal: any axes would do");
  else if (result.principal.first_two_alike || result.principal.last_two_alike)
    found.notes.push_back(fmt::format("the {} two principal moments are equal: their axes are any two in their plane",
                                      result.principal.first_two_alike ? "first" : "last"));
  found.notes.push_back("principal axes by growing moment; the largest component of the first two is positive, and "
                        "the third is the first cross the second");
  found.rows = {{"origin", "origin", body.origin ? Value(*body.origin) : Value(), length},
                {"origin_kind", "kind of origin", body.origin_kind},
                {"mass", "mass", body.mass, mass},
                {"first_moment", "first moment", body.first_moment, si ? "kg m" : "density * length^4"},
                {"quadrupole", "quadrupole, integral of density (3 x_i x_j - r^2 delta_ij)", body.quadrupole, unit},
                {"inertia", "inertia, integral of density (r^2 delta_ij - x_i x_j)",
                 complete ? Value(body.inertia()) : Value(), unit},
                {"second_moment", "second moment, integral of density x_i x_j",
                 complete ? Value(body.second_moment()) : Value(), unit},
                {"principal_moments", "principal moments of inertia",
                 complete ? Value(*result.principal.moments) : Value(), unit},
                {"principal_quadrupole", "quadrupole along the principal axes", result.principal.quadrupole, unit},
                {"principal_axes", "principal axes, one a row", Eigen::Matrix3d(result.principal.axes.transpose())}};
  return found;
}

} // namespace cowgpu
