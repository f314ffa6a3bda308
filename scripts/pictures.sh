#!/usr/bin/env bash
# Draws the pictures of data/pictures that show the benchmark cow; needs the built program and the benchmark mesh
# (data/meshes/README.md).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
pictures=$root/data/pictures

render() { "$root/cowgpu" render benchmark --view 28,14 --device cpu "$@"; }

render --of harmonic --order 0..7,mesh --width 270 --height 203 -o "$pictures/harmonic_orders.png"
render --of stretch --order 0..7,mesh --width 270 --height 203 -o "$pictures/stretch_orders.png"
render --of stretch --order 32,mesh --width 450 --height 338 -o "$pictures/stretch_order_32.png"
"$root/cowgpu" figure components benchmark --of harmonic --recipe paper -o "$pictures/components.png"
"$root/cowgpu" figure tipping benchmark -o "$pictures/tipping.png"
