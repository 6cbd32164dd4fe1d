#!/usr/bin/env bash
# Write the meshes of this folder with gmsh. Those here are of 4.15.2 (PyPI); 4.8.4 (Debian 12) writes the same cards, but for
# the rounding of some coordinates.
#
#    make_meshes.sh [GMSH]     GMSH defaults to gmsh
set -eu

gmsh=(${1:-gmsh})
cd "$(dirname "${BASH_SOURCE[0]}")"

# mesh NAME DRAWING OPTION...
mesh() {
   local name=$1 drawing=$2
   shift 2
   "${gmsh[@]}" "$drawing.geo" -2 -v 1 -format inp -o "$name.mesh" "$@"
}

mesh quads8 square -setnumber quads 1 -order 2 -setnumber Mesh.SecondOrderIncomplete 1
mesh quads9 square -setnumber quads 1 -order 2
mesh quads4 square -setnumber quads 1 -order 1
mesh triangles6 square -setnumber quads 0 -order 2
mesh triangles3 square -setnumber quads 0 -order 1
# Everything, with points and curves of no physical group, and node sets of all groups.
mesh everything square -setnumber quads 1 -order 2 -setnumber Mesh.SecondOrderIncomplete 1 \
   -setnumber Mesh.SaveAll 1 -setnumber Mesh.SaveGroupsOfNodes 1
mesh inner_line inner_line -order 2
