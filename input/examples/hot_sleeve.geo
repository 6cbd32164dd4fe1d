// A quarter of a tube (radii 20 and 40) in a sleeve (40 and 60), in mm. To mesh it:
//    gmsh hot_sleeve.geo -2 -format inp -o hot_sleeve.gmsh
Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 1;   // quadrilaterals of 8 nodes, not of 9
around = 8;
through = 6;

Point(1) = {0, 0, 0};
// The tube.
Point(11) = {20, 0, 0};  Point(12) = {40, 0, 0};  Point(13) = {0, 40, 0};  Point(14) = {0, 20, 0};
Line(11) = {11, 12};  Circle(12) = {12, 1, 13};  Line(13) = {13, 14};  Circle(14) = {14, 1, 11};
Curve Loop(1) = {11:14};  Plane Surface(1) = {1};
// The sleeve has points and a curve of its own where it touches the tube: with a curve in common
// the two would be one body.
Point(21) = {40, 0, 0};  Point(22) = {60, 0, 0};  Point(23) = {0, 60, 0};  Point(24) = {0, 40, 0};
Line(21) = {21, 22};  Circle(22) = {22, 1, 23};  Line(23) = {23, 24};  Circle(24) = {24, 1, 21};
Curve Loop(2) = {21:24};  Plane Surface(2) = {2};

// As many nodes on one face as on the other, opposite each other.
Transfinite Curve {12, 14, 22, 24} = around + 1;
Transfinite Curve {11, 13, 21, 23} = through + 1;
Transfinite Surface {1, 2};
Recombine Surface {1, 2};

Physical Surface("tube") = {1};
Physical Surface("sleeve") = {2};
Physical Curve("tube face") = {12};
Physical Curve("sleeve face") = {24};
Physical Curve("bore") = {14};
Physical Curve("outside") = {22};
Physical Curve("x axis") = {11, 21};
Physical Curve("y axis") = {13, 23};
