// A unit square, in kinds of elements that differ by the options of make_meshes.sh.
Point(1) = {0, 0, 0};  Point(2) = {1, 0, 0};  Point(3) = {1, 1, 0};  Point(4) = {0, 1, 0};
Point(9) = {5, 5, 0};   // belongs to nothing
Line(1) = {1, 2};  Line(2) = {2, 3};  Line(3) = {3, 4};  Line(4) = {4, 1};
Curve Loop(1) = {1:4};  Plane Surface(1) = {1};
Transfinite Curve {1:4} = 3;
If (quads)
   Transfinite Surface {1};
   Recombine Surface {1};
EndIf
Physical Surface("block") = {1};
Physical Curve("bottom") = {1};
Physical Curve("left side") = {4};
Physical Curve("top side") = {3};
Physical Curve("around") = {1:4};
Physical Point("corner") = {1};
