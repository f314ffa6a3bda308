#!/usr/bin/env bash
# scripts/record.sh PROGRAM FOLDER: what every command gives, recorded, so that two builds can be compared.
# Runs PROGRAM almost two hundred times, all subcommands among them, on small bodies that are built in and on small files
# that it writes itself. Each command gets a folder FOLDER/NNN-NAME with `command`, `exit_code`, `stdout`, `stderr` and the
# files that the command wrote. scripts/record_compare.py compares two such folders. FOLDER must be new or empty.
#
# Every command runs in its own folder, under the name `cowgpu`, and names its inputs by relative paths, so that results
# which tell their command are the same wherever the program and FOLDER are. Most commands run on the CPU path; those of
# $vulkan on Mesa's software device, and where it is missing their refusals are what is recorded. So it is with the mesh
# `benchmark`, whose folder COWGPU_MESHES may name: two records that are to be compared need the same. Reports get a page
# without a script, so that their data are recorded and the bundled page is not needed.
set -euo pipefail

if (($# != 2)); then
  echo "usage: scripts/record.sh PROGRAM FOLDER" >&2
  exit 2
fi
program=$(readlink -f -- "$1")
if [[ ! -x $program || -d $program ]]; then
  echo "record.sh: $1 is not a program that can be run; build it, and name build/release/cowgpu" >&2
  exit 3
fi
mkdir -p -- "$2"
folder=$(readlink -f -- "$2")
if [[ -n $(ls -A -- "$folder") ]]; then
  echo "record.sh: $2 is not empty, and old results would stand among the new; name another folder" >&2
  exit 2
fi
export LC_ALL=C TZ=UTC COWGPU_PAGE=$folder/inputs/page
unset COLUMNS

longest=300 # seconds that a command may take before it is ended, with exit code 124
count=0
started=$SECONDS
declare -A place

# record_from INPUT NAME ARGUMENT...: runs one command with the file INPUT as standard input.
record_from() {
  local input=$1 name=$2 number here code=0
  shift 2
  if [[ -n ${place[$name]:-} ]]; then
    echo "record.sh: two commands are called $name" >&2
    exit 70
  fi
  count=$((count + 1))
  printf -v number '%03d' "$count"
  place[$name]=$number-$name
  here=$folder/$number-$name
  mkdir -- "$here"
  printf '%s\n' "cowgpu $*" >"$here/command"
  # The program must see `cowgpu` as its own name, whatever path it has.
  # shellcheck disable=SC2016
  (cd -- "$here" && exec timeout --kill-after=10 "$longest" bash -c 'program=$1; shift; exec -a cowgpu "$program" "$@"' \
    record "$program" "$@" <"$input" >stdout 2>stderr) || code=$?
  printf '%s\n' "$code" >"$here/exit_code"
}

record() { record_from /dev/null "$@"; }

# of NAME: the folder of an earlier command, as a path from another one.
of() { printf '../%s' "${place[$1]:?no command is called $1 yet}"; }

# --- Files that commands read -----------------------------------------------------------------------------------------

files=$folder/inputs
mkdir -p -- "$COWGPU_PAGE"
in=../inputs

# write FILE: a file of $files from standard input.
write() { cat >"$files/$1"; }

write cube.off <<'END'
OFF
8 6 0
0 0 0
1 0 0
1 1 0
0 1 0
0 0 2
1 0 2
1 1 2
0 1 2
4 0 3 2 1
4 4 5 6 7
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
END
write inside_out.off <<'END'
OFF
4 4 0
0 0 0
1 0 0
0 1 0
0 0 1
3 0 1 2
3 0 3 1
3 0 2 3
3 1 3 2
END
write open.off <<'END'
OFF
4 3 0
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
END
write bad_index.off <<'END'
OFF
4 4 0
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 9
END
write tetrahedron.obj <<'END'
# a tetrahedron with normals, texture and a material that are left aside
mtllib none.mtl
v 0 0 0
v 1 0 0
v 0 1.5 0
v 0 0 2
vt 0 0
vn 0 0 1
f 1/1/1 3/1/1 2/1/1
f 1 2 4
f 1 4 3
f -3 -2 -1
END
write two_shells.ply <<'END'
ply
format ascii 1.0
element vertex 8
property float x
property float y
property float z
element face 8
property list uchar int vertex_indices
end_header
0 0 0
4 0 0
0 4 0
0 0 4
0.5 0.5 0.5
1 0.5 0.5
0.5 1 0.5
0.5 0.5 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
3 4 5 6
3 4 7 5
3 4 6 7
3 5 7 6
END
# Corners that lie a billionth apart: open, unless welded.
write seam.stl <<'END'
solid seam
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 0 1 0
vertex 1 0 0
endloop
endfacet
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 1.000000001 0 0
vertex 0 0 1
endloop
endfacet
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 0 0 1
vertex 0 1 0
endloop
endfacet
facet normal 0 0 0
outer loop
vertex 1 0 0
vertex 0 1 0
vertex 0 0 1
endloop
endfacet
endsolid seam
END
echo 'A letter about a cow, and not a mesh.' | write prose.txt
printf '1f8b0800' | write prose.off
write points.csv <<'END'
x,y,z
0,0,0
0.1,0.2,0.3
3,0,0
0,-2.5,0
1,1,1
0.25,0.25,2
END
printf 'x,y,z\n3,0,0\n0.5,0.5,1.25\n1e6,2e6,0\n' | write outside.csv
printf 'x,y,z\n0,0,0\n1,2,three\n' | write bad_points.csv
printf 'time,force\n0,0\n0.05,4000\n0.2,4000\n0.3,0\n' | write push.csv
printf 'time,force\n0,0\n0.2,-5\n' | write bad_push.csv
# The Moon's lowest degrees in the layout of the Planetary Data System.
write moon.tab <<'END'
 0.1738000000000000E+04, 0.4902800222E+04, 0.1000000000E-03,    3,    3,    1, 0.0, 0.0
 1, 0, 0.0, 0.0, 1e-12, 1e-12
 1, 1, 0.0, 0.0, 1e-12, 1e-12
 2, 0, -9.088e-05, 0.0, 1e-12, 1e-12
 2, 1, -2e-10, 1.4e-09, 1e-12, 1e-12
 2, 2, 3.467e-05, -1.4e-09, 1e-12, 1e-12
 3, 0, -3.197e-06, 0.0, 1e-12, 1e-12
 3, 1, 2.636e-05, 5.454e-06, 1e-12, 1e-12
 3, 2, 1.418e-05, 4.877e-06, 1e-12, 1e-12
 3, 3, 1.228e-05, -1.774e-06, 1e-12, 1e-12
END
write bad.gfc <<'END'
product_type gravity_field
modelname a file cut short
earth_gravity_constant 3.986004415E+14
radius 6378136.3
max_degree 2
END
write field.csv <<'END'
# normalisation orthonormal
# phase cs
# form real
# lmax 2
l,m,C,S
0,0,1.5,0
1,0,0.25,0
1,1,-0.125,0.5
2,0,0.0625,0
2,1,0.375,-0.25
2,2,0.75,0.0625
END

write page/report.html <<'END'
<!DOCTYPE html>
<title><!--cowgpu:title--></title>
<script type="application/json">{"cowgpu":"data"}</script>
END
write two.csv <<'END'
# normalisation orthonormal
# phase cs
l,m,height_C,height_S,slope_C,slope_S
0,0,1.5,0,0.5,0
1,0,0.25,0,-0.5,0
1,1,-0.125,0.5,0.25,0.125
END

cpu=(--device cpu)
vulkan=(--device llvmpipe)
units=(--length 2.5m --density 1g/cm3)

# --- The program itself -----------------------------------------------------------------------------------------------

record version --version
record help --help
record man man
record completion completion
record help-expand expand --help
record help-transform transform --help
record devices devices
record devices-json devices --json
record meshes meshes
record meshes-json meshes --json
record meshes-add meshes add $in/cube.off

# --- Moments ----------------------------------------------------------------------------------------------------------

record expand expand --lmax 8 "${vulkan[@]}"
record expand-json expand builtin:cow@1 --lmax 12 --json "${cpu[@]}"
record expand-vulkan expand builtin:cow@1 --lmax 12 -o vulkan.json -o vulkan.csv "${vulkan[@]}"
record expand-files expand builtin:cow@1 --lmax 6 -o m.json -o m.csv -o m.gfc -o m.sh -o m.nc "${cpu[@]}"
record expand-units expand builtin:ellipsoid:3,2,1@3 "${units[@]}" --lmax 6 -o u.json -o u.csv -o u.gfc -o u.sh \
  -o u.nc "${cpu[@]}"
record expand-parts expand $in/cube.off --part $in/tetrahedron.obj=-400 --part builtin:sphere@2=200kg/m3 --length-unit 2.3m \
  --density 1000kg/m3 --axes x,-z,y --rotate 30,20,10 --lmax 5 -o p.json "${cpu[@]}"
record expand-far expand builtin:box:1,2,3 --origin 100,0,0 --lmax 4 "${cpu[@]}"
record expand-mesh-origin expand $in/tetrahedron.obj --origin mesh --lmax 3 --verify full "${cpu[@]}"
record expand-unverified expand builtin:tetrahedron --lmax 2 --verify none --quiet "${cpu[@]}"
record expand-cut-off expand builtin:cow@1 --lmax 24 --cut-off 1e-6 "${cpu[@]}"
record expand-symmetric expand builtin:tetrahedron --lmax 4 "${cpu[@]}"
record expand-plan expand builtin:cow@2 --lmax 64 --of all --dry-run "${cpu[@]}"
record expand-shells expand $in/two_shells.ply --lmax 3 "${cpu[@]}"
record expand-largest expand $in/two_shells.ply --largest-shell --lmax 3 "${cpu[@]}"
record expand-oriented expand $in/inside_out.off --orient --lmax 3 "${cpu[@]}"
record expand-welded expand $in/seam.stl --weld 1e-6 --lmax 3 "${cpu[@]}"
record_from "$files/cube.off" expand-stdin expand - --lmax 3 "${cpu[@]}"
record expand-progress expand builtin:sphere@1 --lmax 2 --threads 1 --progress none "${cpu[@]}"
record validate validate builtin:cow@0 --lmax 8 "${cpu[@]}"
record validate-vulkan validate builtin:tetrahedron --lmax 6 --origin 3,0,0 "${vulkan[@]}"
record validate-cut-off validate builtin:cow@0 --lmax 8 --cut-off 1e-4 "${cpu[@]}"
record bench bench builtin:cow@0 --lmax 2,4 --runs 1 "${cpu[@]}"
record bench-json bench builtin:cow@0 --lmax 2 --runs 1 --json "${cpu[@]}"

# --- Maps, surfaces, bodies rebuilt -----------------------------------------------------------------------------------

record map map builtin:cow@1 --lmax 16 -o map.ply "${cpu[@]}"
record map-json map builtin:cow@1 --lmax 16 --converge --relabellings 1 --json -o map.glb "${cpu[@]}"
record map-harmonic map builtin:cow@1 --method harmonic --lmax 16 --json -o map.ply "${cpu[@]}"
record map-disk map builtin:cow@1 --method harmonic --no-polish --pole 5 --weights mean-value --lmax 16 "${cpu[@]}"
record map-smooth map builtin:ellipsoid:1,1,1.5@2 --method smooth --lmax 16 "${cpu[@]}"
record map-flow map builtin:cow@0 --method flow --time 0.2 --lmax 16 --json "${cpu[@]}"
record map-paper map benchmark --recipe paper --lmax 16 "${cpu[@]}"
record surfaces expand builtin:cow@1 --of mass,harmonic,stretch --lmax 12 -o s.json -o s.csv "${cpu[@]}"
record surfaces-json expand builtin:cow@1 --of stretch --lmax 8 --aliasing --json "${vulkan[@]}"
record surface-smooth expand builtin:ellipsoid:1,1,1.5@2 --of smooth --lmax 6 -o f.nc "${cpu[@]}"
record surface-of-map expand builtin:cow@1 --of stretch --map "$(of map)/map.ply" --lmax 8 "${cpu[@]}"
record surface-paper expand benchmark --of harmonic --recipe paper --lmax 3 "${cpu[@]}"
record flow-star expand builtin:ellipsoid:3,2,1@2 --of flow --lmax 4 -o flow.json "${cpu[@]}"
record flow-level expand builtin:cow@0 --of flow --flow-grid 64 --lmax 3 "${cpu[@]}"
record flow-signed expand builtin:cow@0 --of flow --sheets signed --time 0.1 --refinements 1 --lmax 3 --json "${cpu[@]}"
record flow-vulkan expand builtin:cow@0 --of flow --sheets signed --time 0.1 --refinements 1 --lmax 3 "${vulkan[@]}"
record reconstruct reconstruct builtin:cow@1 --order 0..2,4 --lmax 8 --resolution 12 --samples 500 -o 'cow-{}.glb' "${cpu[@]}"
record reconstruct-file reconstruct "$(of surfaces)/s.json" --of harmonic --fields f --mesh builtin:cow@1 --order 3 \
  --resolution 12 --samples 500 --json -o cow.ply "${cpu[@]}"
record reconstruct-folder reconstruct "$(of surfaces)/s.json" --order 1,2 --resolution 8 --format ply -o bodies "${cpu[@]}"
record render render builtin:cow@1 --view 28,14 --view top --width 60 --height 50 -o cow.png "${cpu[@]}"
record render-orders render "$(of surfaces)/s.json" --mesh builtin:cow@1 --order 0..2,mesh --width 40 --height 40 \
  --transparent --flat -o orders.png "${vulkan[@]}"

# --- Meshes, distances, flow ------------------------------------------------------------------------------------------

record inspect inspect builtin:cow@1
record inspect-json inspect $in/cube.off --json -o cube.ply
record inspect-two inspect $in/two_shells.ply -o shells.off
record inspect-open inspect $in/open.off
record inspect-seam inspect $in/seam.stl --weld 1e-6 --orient -o seam.ply
record inspect-obj inspect $in/tetrahedron.obj --json
record inspect-glb inspect "$(of reconstruct)/cow-2.glb"
record distance distance $in/cube.off $in/points.csv -o d.csv "${cpu[@]}"
record distance-grid distance builtin:cow@0 --grid 6 -o d.nc --json "${cpu[@]}"
record distance-vulkan distance builtin:cow@0 --grid 6 -o d.csv "${vulkan[@]}"
record distance-unsigned distance $in/open.off $in/points.csv --unsigned -o - "${cpu[@]}"
record_from "$files/points.csv" distance-stdin distance $in/cube.off - "${cpu[@]}"
record distance-plan distance builtin:cow@0 --grid 40 --dry-run "${cpu[@]}"
record inflate inflate builtin:cow@0 "${cpu[@]}"
record inflate-levels inflate builtin:cow@0 --levels 0.05,0.1 --cells 16 -o 'cow-{}.ply' --picture levels.png --width 60 \
  --height 50 --json "${cpu[@]}"
record inflate-star inflate builtin:cow@0 --star --levels star --cells 12 --origin mesh -o star.glb "${cpu[@]}"
record inflate-convex inflate builtin:box:1,2,3 --levels star "${cpu[@]}"
record streamlines streamlines builtin:cow@0 --plane xy --count 7 --time 0.3 -o lines.csv "${cpu[@]}"
record streamlines-json streamlines builtin:box:1,2,3 --plane 0,0,1,0.25 --spacing 1 --time 0.3 --json "${cpu[@]}"
record streamlines-file streamlines builtin:cow@0 --plane xy --vertices 0.02 --time 0.3 -o lines.json "${vulkan[@]}"

# --- Transforms and files of coefficients -----------------------------------------------------------------------------

record synthesise transform synthesise $in/field.csv grid.csv --grid gl --lmax 4 "${cpu[@]}"
record synthesise-nc transform synthesise "$(of expand-files)/m.csv" grid.nc --grid dh --lmax 8 --json "${cpu[@]}"
record synthesise-cc transform synthesise $in/field.csv grid.csv --grid cc --lmax 3 "${vulkan[@]}"
record synthesise-plan transform synthesise $in/field.csv grid.nc --grid f1 --lmax 90 --dry-run "${cpu[@]}"
record analyse transform analyse "$(of synthesise)/grid.csv" back.csv "${cpu[@]}"
record analyse-nc transform analyse "$(of synthesise-nc)/grid.nc" back.nc --lmax 6 --normalisation 4pi --phase none --json \
  "${cpu[@]}"
record roundtrip transform roundtrip --lmax 31 --fields 2 --grid dh1 --runs 1 --seed 7 "${cpu[@]}"
record roundtrip-json transform roundtrip --lmax 15 --runs 1 --json "${vulkan[@]}"
record roundtrip-plan transform roundtrip --lmax 63 --dry-run "${cpu[@]}"
record spectrum spectrum $in/field.csv
record spectrum-nc spectrum "$(of analyse-nc)/back.nc"
record spectrum-json spectrum "$(of expand-units)/u.gfc" --json
record spectrum-cross spectrum $in/two.csv --cross
record spectrum-surface spectrum "$(of surface-smooth)/f.nc"
record spectrum-moon spectrum $in/moon.tab --length-unit km
record convert-gfc convert "$(of expand-units)/u.json" c.gfc
record convert-sh convert "$(of expand-units)/u.gfc" c.sh --normalisation schmidt --reference-radius 2 --rotate 30,20,10
record convert-complex convert "$(of expand-files)/m.csv" c.csv --form complex --normalisation 4pi
record convert-json convert "$(of expand-files)/m.nc" c.json --kind multipoles --lmax 4
record convert-nc convert "$(of expand-units)/u.sh" c.nc --rotate 1,0,0 --angle-unit radians
record convert-field convert "$(of surfaces)/s.json" f.csv --of stretch --field f_r
record convert-moon convert $in/moon.tab moon.json --length-unit km --brillouin-radius 1740km
record convert-si convert "$(of expand-files)/m.json" si.gfc --si
record convert-back convert "$(of convert-sh)/c.sh" back.csv --normalisation unnormalised --phase cs
record diff diff "$(of expand-units)/u.json" "$(of convert-gfc)/c.gfc"
record diff-json diff "$(of expand-json)/stdout" "$(of expand-vulkan)/vulkan.csv" --json
record diff-beyond diff "$(of expand-units)/u.gfc" "$(of convert-sh)/c.sh" --tolerance 1e-12

# --- Physics ----------------------------------------------------------------------------------------------------------

record potential potential builtin:ellipsoid:3,2,1@3 "${units[@]}" --at 3,0,0 --derivatives 2 "${cpu[@]}"
record potential-sphere potential builtin:cow@1 --sphere 1.5R --resolution 5 --order 6 -o s.nc --json "${cpu[@]}"
record potential-plane potential builtin:cow@1 --plane z,0,2R,5 --inside exact --order 6 -o p.csv "${cpu[@]}"
record potential-vulkan potential builtin:cow@1 --sphere 1.5R --resolution 5 --order 6 -o s.csv "${vulkan[@]}"
record potential-exact potential $in/cube.off --at $in/outside.csv --exact --derivatives 2 "${cpu[@]}"
record potential-corner potential $in/cube.off --at $in/points.csv --exact --derivatives 2 "${cpu[@]}"
record potential-charge potential builtin:box:1,2,3 --length-unit m --density 1C/m3 --charge --at 3,4,5 "${cpu[@]}"
record potential-file potential "$(of expand-units)/u.gfc" --sphere 1.2R --resolution 4 --order 4 "${cpu[@]}"
record potential-moon potential $in/moon.tab --length-unit km --sphere 1700km --resolution 3 "${cpu[@]}"
record potential-errors potential builtin:cow@0 --errors --orders 0,2,4 --distances 1.5,4 --plot e.svg --plot e.png "${cpu[@]}"
record potential-paper potential builtin:cow@0 --recipe paper --at 30,0,0 "${cpu[@]}"
record surface surface builtin:cow@1 "${units[@]}" --period 2h -o s.csv -o s.vtp -o s.nc "${cpu[@]}"
record surface-vertices surface builtin:cow@1 --omega 0.5 --at vertices --tolerance 1e-6 --guarantee --json -o s.ply -o s.glb \
  "${cpu[@]}"
record surface-points surface $in/cube.off --at $in/points.csv --tolerance 0 --part $in/tetrahedron.obj=-0.5 -o p.csv "${cpu[@]}"
record surface-height surface builtin:ellipsoid:3,2,1@2 --height 2 --mass 5 "${cpu[@]}"
record surface-vulkan surface builtin:cow@0 "${units[@]}" --json "${vulkan[@]}"
record surface-plan surface builtin:cow@2 --dry-run "${cpu[@]}"
record equilibria equilibria builtin:ellipsoid:3,2,1@2 "${units[@]}" --period 2h --json "${cpu[@]}"
record equilibria-box equilibria builtin:box:3,2,1 --omega 0.8 --surface E2 --surface-cells 12 -o z.ply "${cpu[@]}"
record equilibria-ring equilibria builtin:sphere:1@1 --omega 0.8 --spin z --smallest 0.03 --cells 60000 "${cpu[@]}"
record potential-magnet potential builtin:box:2,2,2 --magnetisation 0,0,1e6 --exact --at $in/outside.csv "${cpu[@]}"
record potential-grid potential builtin:box:1,2,3 --exact --grid 2R,4 -o g.nc "${cpu[@]}"
record tensors tensors builtin:cow@1
record tensors-json tensors $in/cube.off --part $in/tetrahedron.obj=-0.5 "${units[@]}" --json
record tensors-file tensors "$(of expand-units)/u.json" --inertia
record tensors-gfc tensors "$(of expand-units)/u.gfc"
record tensors-paper tensors --recipe paper --json
record radiate radiate builtin:ellipsoid:3,2,1@3 "${units[@]}" --axis y --omega 1Hz --octupole
record radiate-json radiate builtin:cow@1 "${units[@]}" --axis 1,2,2 --period 1s --json
record radiate-file radiate "$(of expand-units)/u.json" --axis z --omega 3rpm
record radiate-paper radiate --recipe paper
record tides tides builtin:cow@1 "${units[@]}" --orbit 6771km --attitude z:30 --order 4
record tides-json tides "$(of expand-units)/u.json" --orbit 1.1R_earth --mass 6e24kg --love 0.1 --quality 10 --spin 1rad/s \
  --json
record drop drop builtin:cow@1 "${units[@]}" --height 10m --attitude upside-down --order 4
record drop-json drop builtin:cow@1 "${units[@]}" --height 10m --attitude on-side --spin x,10rpm --order 2 --json
record tip tip builtin:cow@1 "${units[@]}" --friction 0.6 --push 5000N:0.1s --punch 5000N --punch-duration 20ms "${cpu[@]}"
record tip-orders tip builtin:cow@1 "${units[@]}" --order 0,2,full --lmax 8 --resolution 16 --json "${cpu[@]}"
record tip-push tip $in/cube.off "${units[@]}" --axes x,z,-y --push $in/push.csv --side left --plot p.svg --as-modelled \
  "${cpu[@]}"
record tip-weight tip builtin:box:1,2,3 "${cpu[@]}"
record tip-paper tip --recipe paper --plot boundary.png --json "${cpu[@]}"
record errata errata
record errata-json errata --json

# --- Figures, pages, the paper ----------------------------------------------------------------------------------------

record figure-spectra figure spectra builtin:cow@1 --result "$(of surfaces)/s.json" -o spectra.svg "${cpu[@]}"
record figure-definition figure definition builtin:cow@1 -o definition.svg "${cpu[@]}"
record figure-streamlines figure streamlines builtin:cow@0 --count 20 -o streamlines.svg "${cpu[@]}"
record figure-tipping figure tipping builtin:cow@1 -o tipping.png "${cpu[@]}"
record figure-components figure components builtin:cow@1 --of stretch --lmax 8 -o components.png "${cpu[@]}"
record report report "$(of surfaces)/s.json" --mesh builtin:cow@1 --physics "$(of radiate-json)/stdout" \
  --physics "$(of tides-json)/stdout" --order 4 -o cow.html "${cpu[@]}"
record reproduce reproduce --mesh builtin:cow@1 --only inspect,tensors,tides -o out "${cpu[@]}"
record reproduce-paper reproduce --only mass,radiate,errata -o out "${cpu[@]}"

# --- Refusals ---------------------------------------------------------------------------------------------------------

record refused-command frobnicate
record refused-nothing
record refused-option expand --lmaks 8
record refused-degree expand --lmax 4097
record refused-number expand --lmax 0x10
record refused-line-end expand $'two\nlines.off'
record refused-absent expand absent.off "${cpu[@]}"
record refused-prose expand $in/prose.txt "${cpu[@]}"
record refused-off expand $in/prose.off "${cpu[@]}"
record refused-index expand $in/bad_index.off "${cpu[@]}"
record refused-open expand $in/open.off "${cpu[@]}"
record refused-inside-out expand $in/inside_out.off "${cpu[@]}"
record refused-seam expand $in/seam.stl "${cpu[@]}"
record refused-builtin expand builtin:horse "${cpu[@]}"
record refused-suffix expand --lmax 2 -o moments.xyz "${cpu[@]}"
record refused-expansion expand --of mass,spin --lmax 2 "${cpu[@]}"
record refused-flow expand --time 0.2 --lmax 2 "${cpu[@]}"
record refused-device expand --lmax 2 --device none-of-this-name
record refused-folder expand --lmax 2 -o no/such/folder/m.json "${cpu[@]}"
record refused-axes expand $in/cube.off --axes x,y,-z --lmax 2 "${cpu[@]}"
record refused-unit expand $in/cube.off --length-unit 3parsnips --lmax 2 "${cpu[@]}"
record refused-density expand $in/cube.off --density 1g/cm3 --lmax 2 "${cpu[@]}"
record refused-map map $in/two_shells.ply "${cpu[@]}"
record refused-map-option map builtin:cow@0 --method stretch --pole 3 "${cpu[@]}"
record refused-order reconstruct "$(of surfaces)/s.json" --order 40 "${cpu[@]}"
record refused-order-word reconstruct builtin:cow@0 --order 7..0 "${cpu[@]}"
record refused-view render builtin:cow@0 --view behind -o cow.png "${cpu[@]}"
record refused-points distance $in/cube.off $in/bad_points.csv "${cpu[@]}"
record refused-places distance $in/cube.off "${cpu[@]}"
record refused-level inflate builtin:cow@0 --levels 0.1,-1 "${cpu[@]}"
record refused-plane streamlines builtin:cow@0 --plane zx "${cpu[@]}"
record refused-grid transform synthesise $in/field.csv grid.txt "${cpu[@]}"
record refused-gfc spectrum $in/bad.gfc
record refused-convention convert "$(of expand-units)/u.json" c.gfc --form complex
record refused-inside potential builtin:cow@0 --at 0,0,0 "${cpu[@]}"
record refused-exact potential "$(of expand-units)/u.gfc" --at 9,0,0 --exact "${cpu[@]}"
record refused-ball surface builtin:sphere "${units[@]}" --period 5h "${cpu[@]}"
record refused-tolerance surface builtin:box --tolerance 1e-15 "${cpu[@]}"
record refused-inertia tensors $in/moon.tab --length-unit km --inertia
record refused-rate radiate builtin:cow@0 --omega fast
record refused-orbit tides builtin:cow@0 --orbit 6771km
record refused-height drop builtin:cow@0 "${units[@]}" --height 10
record refused-push tip builtin:box:1,2,3 "${units[@]}" --push $in/bad_push.csv "${cpu[@]}"
record refused-figure figure portrait builtin:cow@0 -o cow.png "${cpu[@]}"
record refused-svg figure components builtin:cow@0 -o cow.svg "${cpu[@]}"
record refused-report report "$(of expand-units)/u.gfc" -o cow.html "${cpu[@]}"
record refused-stage reproduce --only moonshine -o out "${cpu[@]}"
record refused-overwrite inspect "$(of inspect-two)/shells.off" -o "$(of inspect-two)/shells.off"

echo "$count commands in $((SECONDS - started)) s, recorded in $2"
