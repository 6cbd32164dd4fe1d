// A square with a curve inside, along which elements meet, and one beside it, which no element has.
Point(1) = {0, 0, 0};  Point(2) = {1, 0, 0};  Point(3) = {1, 1, 0};  Point(4) = {0, 1, 0};
Point(5) = {0.3, 0.5, 0};  Point(6) = {0.7, 0.5, 0};  Point(7) = {2, 0, 0};  Point(8) = {2, 1, 0};
Line(1) = {1, 2};  Line(2) = {2, 3};  Line(3) = {3, 4};  Line(4) = {4, 1};  Line(5) = {5, 6};
Line(6) = {7, 8};
Curve Loop(1) = {1:4};  Plane Surface(1) = {1};  Curve {5} In Surface {1};
Transfinite Curve {1:6} = 2;
Physical Surface("block") = {1};
Physical Curve("top") = {3};
Physical Curve("inside") = {5};
Physical Curve("beside") = {6};
