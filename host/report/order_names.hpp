// What multipoles are called.
#pragma once

#include <string>

namespace cowgpu {

/// The name of the multipole of degree l by the 2^l-pole rule: monopole, dipole, quadrupole, octupole, hexadecapole,
/// dotriacontapole ... With the customary Latin forms to l = 3; from there the numeral of 2^l, units before tens before
/// hundreds before thousands, by IUPAC's rules for numerical terms (Pure Appl. Chem. 58 (1986) 1693): 256 is
/// hexa-penta-conta-dicta. From l = 14 on, "2^14-pole". Throws Error(bad_argument) for l < 0.
std::string order_name(int l);

} // namespace cowgpu
