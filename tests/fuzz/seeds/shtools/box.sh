# cowgpu 0.1.0
# lmax 3
# normalisation 4pi
# phase none
# kind potential
# origin (centre of mass) 0 0 0
# length_unit of the mesh
# mass_unit density times cubed length
# density 1
# mass 6
# gravitational_constant 1
# fields mass
# program cowgpu 0.1.0
# mesh builtin:box:1,2,3@0
# mesh_sha256 7157cc7fe20676cb07ae897619531900f04ac29652c14a4e145f5694bcbfeae1
1.8708286933869707e+00, 6.0000000000000000e+00, 0.0000000000000000e+00, 3
0, 0, 1, 0
1, 0, -5.82933712731297e-18, 0
1, 1, 0, 0
2, 0, 0.06921162787499349, 0
2, 1, -3.910438224130544e-19, 0
2, 2, -0.027664166758624407, 0
3, 0, 3.0529575585517845e-18, 0
3, 1, 0, -1.246364704137495e-18
3, 2, 1.9706756301581862e-18, 1.9355738817164528e-19
3, 3, 3.016968589015783e-19, -3.016968589015783e-19
