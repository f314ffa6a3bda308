#include "host/paper/errata.hpp"

#include <array>

namespace cowgpu::paper {
namespace {

constexpr std::array list = {
    Erratum{1, "the rotating quadrupole's square is 9e12 kg^2 m^4", "9.04e6 kg^2 m^4",
            "1.4866e-3 times (13652 kg)^2 (2.39 m)^4; the power that is printed follows from this",
            "cowgpu radiate --recipe paper"},
    Erratum{
        2, "power = 3 G/(8 pi c^5) sum |Q'''_2m|^2", "8 pi G/(75 c^5) sum |Q'''_2m|^2",
        "sum_m |Q_2m|^2 = 5/(24 pi) Q_ij Q_ij for Q_2m as the paper defines it, and the Cartesian G/(45 c^5) is right; "
        "the printed factor gives 2.807 times too little",
        "cowgpu radiate --recipe paper"},
    Erratum{3, "each degree of the potential has the factor [4 pi/(2l+1)]^(1/2)", "4 pi/(2l+1)",
            "Q_00 = M/sqrt(4 pi), and a monopole must pull as its mass does, V = M/r", "cowgpu potential"},
    Erratum{4, "Y_lm has (2l+1)! under its root, and exp(i m theta)", "2l+1, and exp(i m phi)",
            "only so are they of norm 1, and functions of both angles", "cowgpu transform"},
    Erratum{5, "the table of mass moments has the phases of conj Q_lm", "Q_lm, the integral of density r^l Y_lm",
            "by the text's definition Im Q_22 has the sign of Q_xy, which is above 0; the table integrates conj Y_lm",
            "cowgpu tensors --recipe paper"},
    Erratum{6, "hexapentacontadictapole stands for l = 256", "l = 8",
            "the name says 256 = 2^8; the paper's own captions have the 64-pole at l = 6 and the 128-pole at l = 7",
            "cowgpu reconstruct"},
    Erratum{7, "omega now is 1 Hz less 1.1432e-32",
            "less 1.1206e-32 with the paper's tensors, 1.1098e-32 with exact ones",
            "the printed digits are those of a timescale rounded to 1.9e49 s and years of 365 days; tensors are from a "
            "coarse "
            "sampling",
            "cowgpu radiate --recipe paper"},
    Erratum{8, "f_dphi is a signed difference of azimuths", "its absolute value",
            "with |dphi| the harmonic table is met to 0.1 % of its norm and the flow's to 6 %; signed differences miss "
            "both by more than their norm",
            "cowgpu expand --of harmonic --recipe paper"},
    Erratum{9, "taking the mean of f_dtheta away rotates the coordinates", "it rotates nothing",
            "a rotation leaves the mean of theta over the sphere alone, pi/2; only the mean of f_dphi is one, about z",
            ""},
    Erratum{10, "the harmonic table goes 'through the quadrupole'",
            "through the octupole, l = 3; angles are in radians", "its rows say so",
            "cowgpu expand --of harmonic --recipe paper"},
    Erratum{
        11,
        "tipping: the normal force lacks the push's z component, the ground is met at p_T, the far side is at theta + "
        "pi, "
        "torque is taken about the barycentre with lever ||(p - b) x y||",
        "its y component; p; (pi - theta, phi + pi); about the pivot, or with friction's torque, with lever p_z - b_z",
        "y is up; theta + pi is not a colatitude; the fore-aft part of p - b gives no torque about x, about which the "
        "cow "
        "tips",
        "cowgpu tip"},
    Erratum{12, "star-shaped: the segment from the origin to x lies in the cow C", "in the image phi(C)",
            "the cow is what is not star-shaped; its inflated image is to be", "cowgpu inflate"},
    Erratum{13, "the centrifugal distortion of a spinning body feeds the dipole most",
            "the monopole and the quadrupole", "its potential omega^2 r^2 sin^2(theta)/2 has degrees 0 and 2 only", ""},
    Erratum{14, "volume 0.054, mass 740 kg, Q_00 0.0152", "0.05348, 730 kg, 0.0151",
            "exact moments of the mesh, the mass with the paper's 2.39 m (see 18)", "cowgpu tensors --recipe paper"},
    Erratum{
        15, "the flow along the distance's gradient maps the cow to a large sphere one to one",
        "curves merge where the nearest point jumps, and stay merged",
        "there is no inverse there, and what large times tend to has another monopole than the table, which comes "
        "nearest to t = 0.2: that time is not told, nor is the harmonic map's disk scale, 10; at t = 0.2 itself the "
        "monopole of the table is that of the mesh's vertices in coarse steps, and refining the mesh gives another",
        "cowgpu expand --of flow --recipe paper"},
    Erratum{16, "the harmonic map of the triangulated cow is bijective", "68 of its triangles are inverted",
            "that holds where no cotangent weight is negative, and on this mesh 1351 of 8280 are",
            "cowgpu map --method harmonic --recipe paper"},
    Erratum{17, "the inflated cow of the table is star-shaped, its projection smooth and one to one",
            "only after t = 0.242", "the table comes nearest to t = 0.2, where the projection still folds",
            "cowgpu inflate"},
    Erratum{
        18, "the unit of length is 2.39 m", "2.5 m/1.044392 = 2.39374 m",
        "1.044392 is the mesh's own length, of which the paper prints 1.044; three digits are few: at fixed density "
        "the power grows like the tenth power of the unit, and is 1.57 % more",
        "cowgpu radiate --recipe paper"},
};

} // namespace

std::span<const Erratum> errata() {
  return list;
}

} // namespace cowgpu::paper
