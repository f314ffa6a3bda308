// The built-in cow: a cage of a few hundred triangles, made by hand, which Loop subdivision turns into a smooth cow.
#pragma once

#include "host/mesh/raw_mesh.hpp"

namespace cowgpu {

/// The measures of the cage; with the defaults the cow is about one unit long. The smooth cow is a little slimmer.
struct CowLengths {
  double body_length = 0.66;    ///< rump to brisket
  double body_height = 0.37;    ///< topline to the deepest point of the belly
  double body_width = 0.35;     ///< width of the barrel, where it is widest
  double leg_length = 0.225;    ///< ground to the deepest point of the belly
  double leg_thickness = 0.058; ///< thickness of the cannon bone
  double neck_length = 0.16;    ///< withers to poll
  double head_length = 0.29;    ///< poll to nose
  double head_height = 0.185;   ///< forehead to jaw
  double head_width = 0.165;    ///< across the eyes
  double horn_length = 0.14;    ///< one horn, along its curve
  double ear_length = 0.14;     ///< one ear
  double tail_length = 0.46;    ///< root to the tip of the tuft
  double udder_depth = 0.095;   ///< below the belly
};

/// The cage. Cow coordinates: x forward, y up, z = x cross y to the cow's right; the ground is y = 0, the middle of the
/// trunk x = 0, the plane of symmetry z = 0. Closed, 2-manifold, genus 0, counter-clockwise seen from outside, exactly
/// symmetric under z -> -z. With the default lengths neither the cage nor the smooth cow (levels 1 to 5) intersects
/// itself. The name is "cow cage". Throws bad_argument if a length is not positive and finite.
RawMesh cow_cage(const CowLengths& lengths = {});

} // namespace cowgpu
