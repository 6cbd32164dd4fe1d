!> The kinds of plane elements: how many nodes and sides they have, and the nodes of each side.
module element_kinds
   implicit none
   private
   public :: quad8, quad8_reduced, quad4, triangle6, triangle3, quad4_enhanced, kind_count, &
      element_node_count, element_corner_count, side_node_count, side_nodes, linear_kind, &
      plane_strain, plane_stress, axisymmetric, generalized_strain

   integer, parameter :: quad8 = 1           !! eight nodes, 3 x 3 points
   integer, parameter :: quad8_reduced = 2   !! eight nodes, 2 x 2 points
   integer, parameter :: quad4 = 3           !! four nodes, 2 x 2 points
   integer, parameter :: triangle6 = 4       !! six nodes, three points
   integer, parameter :: triangle3 = 5       !! three nodes
   integer, parameter :: quad4_enhanced = 6  !! four nodes, incompatible modes, 2 x 2 points
   integer, parameter :: kind_count = 6      !! number of kinds

   integer, parameter :: plane_strain = 1    !! eps_zz = 0
   integer, parameter :: plane_stress = 2    !! sigma_zz = 0
   integer, parameter :: axisymmetric = 3    !! x is the radius, y the axis
   integer, parameter :: generalized_strain = 4   !! eps_zz is linear in x and y

   !> Nodes of an element by its kind: corners anticlockwise, then the midside nodes of sides 1, 2,
   !> ...
   integer, parameter :: element_node_count(kind_count) = [8, 8, 4, 6, 3, 4]

   !> Corners, and so sides, of an element by its kind.
   integer, parameter :: element_corner_count(kind_count) = [4, 4, 4, 3, 3, 4]

   !> Nodes of a side by the kind of the element.
   integer, parameter :: side_node_count(kind_count) = [3, 3, 2, 3, 2, 2]

   !> The kind with the same corners and no midside nodes, by the kind.
   integer, parameter :: linear_kind(kind_count) = &
      [quad4, quad4, quad4, triangle3, triangle3, quad4_enhanced]

contains

   !> Local nodes of side S1, S2, ...: first corner, midside node if there is one, second corner;
   !> the body lies on their left.
   pure function side_nodes(kind, side) result(nodes)
      integer, intent(in) :: kind               !! kind of the element
      integer, intent(in) :: side               !! 1..element_corner_count(kind)
      integer :: nodes(side_node_count(kind))   !! positions in the element's nodes
      integer :: corners

      corners = element_corner_count(kind)
      nodes(1) = side
      nodes(size(nodes)) = mod(side, corners) + 1
      if (size(nodes) == 3) nodes(2) = corners + side
   end function side_nodes

end module element_kinds
