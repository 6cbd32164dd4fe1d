// A quarter of a roller (radius 20) on half of a block (20 by 20), in mm. To mesh it:
//    gmsh roller.geo -2 -format inp -o roller.gmsh
Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 1;   // quadrilaterals of 8 nodes, not of 9
Mesh.RecombinationAlgorithm = 1;
radius = 20;  near = 3;           // the faces are finer up to x = near

// The roller, of triangles. The last number of a point is the size of elements there.
Point(1) = {0, radius, 0, 4};
Point(2) = {0, 0, 0, 0.035};
Point(3) = {near, radius - Sqrt(radius^2 - near^2), 0, 0.4};
Point(4) = {radius, radius, 0, 4};
Line(1) = {1, 2};  Circle(2) = {2, 1, 3};  Circle(3) = {3, 1, 4};  Line(4) = {4, 1};
Curve Loop(1) = {1:4};  Plane Surface(1) = {1};
// The block, of quadrilaterals, with sizes of its own.
Point(11) = {0, 0, 0, 0.06};
Point(12) = {near, 0, 0, 0.5};
Point(13) = {radius, 0, 0, 5};
Point(14) = {radius, -20, 0, 5};
Point(15) = {0, -20, 0, 5};
Line(11) = {12, 11};  Line(12) = {13, 12};  Line(13) = {14, 13};  Line(14) = {15, 14};
Line(15) = {11, 15};
Curve Loop(2) = {11, 15, 14, 13, 12};  Plane Surface(2) = {2};
Recombine Surface {2};

Physical Surface("roller") = {1};
Physical Surface("block") = {2};
Physical Curve("roller face") = {2};
Physical Curve("block face") = {11, 12};
Physical Curve("top") = {4};
Physical Curve("bottom") = {14};
Physical Curve("axis") = {1, 15};
