!> Division of every element into four of its kind: where the new nodes are, and values there by the
!> shape functions.
module mesh_division
   use element_kinds, only: element_corner_count, element_node_count, kind_count, quad4, &
      quad8, quad8_reduced, side_node_count, side_nodes, triangle6
   use kinds, only: dp
   use mesh, only: mesh_type
   implicit none
   private
   public :: division_type, divide, side_node, inner_node, child_element
   public :: refined_values, refined_members, restricted_values

   !> New nodes inside an element by its kind.
   integer, parameter :: inner_count(kind_count) = [5, 5, 1, 3, 0]

   !> Shape functions of a three-node side at xi = -1/2; reversed at xi = 1/2.
   real(dp), parameter :: quarter_weights(3) = [0.375_dp, 0.75_dp, -0.125_dp]

   !> Shape functions of eight nodes at the centre and half way from it to the midside nodes of
   !> sides 1..4.
   real(dp), parameter :: quad8_weights(8, 5) = reshape( &
      [-0.25_dp, -0.25_dp, -0.25_dp, -0.25_dp, 0.5_dp, 0.5_dp, 0.5_dp, 0.5_dp, &
      -0.1875_dp, -0.1875_dp, -0.1875_dp, -0.1875_dp, 0.75_dp, 0.375_dp, 0.25_dp, 0.375_dp, &
      -0.1875_dp, -0.1875_dp, -0.1875_dp, -0.1875_dp, 0.375_dp, 0.75_dp, 0.375_dp, 0.25_dp, &
      -0.1875_dp, -0.1875_dp, -0.1875_dp, -0.1875_dp, 0.25_dp, 0.375_dp, 0.75_dp, 0.375_dp, &
      -0.1875_dp, -0.1875_dp, -0.1875_dp, -0.1875_dp, 0.375_dp, 0.25_dp, 0.375_dp, 0.75_dp], &
      [8, 5])

   !> Shape functions of six nodes half way between the midside nodes of the sides at corners 1..3.
   real(dp), parameter :: triangle6_weights(6, 3) = reshape( &
      [0.0_dp, -0.125_dp, -0.125_dp, 0.5_dp, 0.25_dp, 0.5_dp, &
      -0.125_dp, 0.0_dp, -0.125_dp, 0.5_dp, 0.5_dp, 0.25_dp, &
      -0.125_dp, -0.125_dp, 0.0_dp, 0.25_dp, 0.5_dp, 0.5_dp], [6, 3])

   !> Where the new nodes are: behind the old ones those of each side, then those in each element.
   !> A side of three nodes gets two new ones, a side of two its midpoint.
   type :: division_type
      integer :: nodes = 0                          !! old nodes
      integer :: elements = 0                       !! old elements
      integer :: sides = 0                          !! distinct sides of elements
      integer :: nodes_after = 0                    !! old and new nodes
      integer, allocatable :: ends(:, :)            !! (3, sides) corner, midside node or 0, corner
      integer, allocatable :: side_start(:)         !! (sides) index before the first new node on it
      integer, allocatable :: element_sides(:, :)   !! (4, elements) sides, zero beyond the kind's
      integer, allocatable :: inner_start(:)        !! (elements) index before the first node inside
   end type division_type

contains

   !> Divides a conforming mesh; its sides are numbered in the order of the elements. Sides are the
   !> same if all their nodes are: two faces of a crack may share both ends.
   pure function divide(mesh) result(division)
      type(mesh_type), intent(in) :: mesh           !! elements of any kinds
      type(division_type) :: division               !! the division
      integer :: latest(size(mesh%node_number))     ! side found last at a node as its lower corner
      integer :: before(4*size(mesh%element_number))! side found before that one there
      integer :: e, f, ends(3), low, side

      division%nodes = size(mesh%node_number)
      division%elements = size(mesh%element_number)
      allocate(division%ends(3, 4*division%elements), source=0)
      allocate(division%element_sides(4, division%elements), source=0)
      latest = 0
      do e = 1, division%elements
         do f = 1, element_corner_count(mesh%element_kind(e))
            ends = side_ends(mesh, e, f)
            low = min(ends(1), ends(3))
            side = latest(low)
            do while (side > 0)
               if (is_side(division%ends(:, side), ends)) exit
               side = before(side)
            end do
            if (side == 0) then
               division%sides = division%sides + 1
               side = division%sides
               division%ends(:, side) = ends
               before(side) = latest(low)
               latest(low) = side
            end if
            division%element_sides(f, e) = side
         end do
      end do
      call number_nodes(mesh%element_kind, division)
   end function divide

   !> First corner, midside node or 0, second corner of a side.
   pure function side_ends(mesh, element, side) result(ends)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element, side
      integer :: ends(3)

      associate (kind => mesh%element_kind(element))
         associate (local => side_nodes(kind, side))
            ends = 0
            ends([1, 3]) = mesh%element_nodes(local([1, side_node_count(kind)]), element)
            if (side_node_count(kind) == 3) ends(2) = mesh%element_nodes(local(2), element)
         end associate
      end associate
   end function side_ends

   pure logical function is_side(one, other)
      integer, intent(in) :: one(3), other(3)

      is_side = all(one == other) .or. all(one == other(3:1:-1))
   end function is_side

   pure subroutine number_nodes(kinds, division)
      integer, intent(in) :: kinds(:)
      type(division_type), intent(inout) :: division
      integer :: e, last, s

      last = division%nodes
      allocate(division%side_start(division%sides), division%inner_start(division%elements))
      do s = 1, division%sides
         division%side_start(s) = last
         last = last + merge(2, 1, division%ends(2, s) > 0)
      end do
      do e = 1, division%elements
         division%inner_start(e) = last
         last = last + inner_count(kinds(e))
      end do
      division%nodes_after = last
   end subroutine number_nodes

   !> Index of the new node on a side of an element: next to one of the side's corners where it has
   !> three nodes, at its middle where it has two.
   pure integer function side_node(division, element, side, corner)
      type(division_type), intent(in) :: division
      integer, intent(in) :: element                !! the element
      integer, intent(in) :: side                   !! 1..element_corner_count
      integer, intent(in) :: corner                 !! node at the corner

      associate (s => division%element_sides(side, element))
         side_node = division%side_start(s) + 1
         if (division%ends(2, s) > 0 .and. division%ends(1, s) /= corner) side_node = side_node + 1
      end associate
   end function side_node

   !> Index of a new node inside an element: of a quadrilateral 1 at the centre, 1 + f half way to
   !> side f; of a triangle with six nodes i half way between the midside nodes near corner i.
   pure integer function inner_node(division, element, position)
      type(division_type), intent(in) :: division
      integer, intent(in) :: element                !! the element
      integer, intent(in) :: position               !! 1..inner_count

      inner_node = division%inner_start(element) + position
   end function inner_node

   !> Shape functions of an element's nodes at a new node inside it.
   pure function inner_weights(kind, position) result(weights)
      integer, intent(in) :: kind
      integer, intent(in) :: position
      real(dp) :: weights(element_node_count(kind))

      select case (kind)
      case (quad8, quad8_reduced)
         weights = quad8_weights(:, position)
      case (quad4)
         weights = 0.25_dp
      case (triangle6)
         weights = triangle6_weights(:, position)
      case default
         weights = 0.0_dp
      end select
   end function inner_weights

   !> Index of a child of an element: the first takes its parent's place.
   pure integer function child_element(elements, parent, child)
      integer, intent(in) :: elements   !! number of elements before
      integer, intent(in) :: parent     !! the element
      integer, intent(in) :: child      !! the child at that corner; 4 of a triangle: in the middle

      child_element = elements + 3*(parent - 1) + child - 1
      if (child == 1) child_element = parent
   end function child_element

   !> Values at the old nodes and, by the shape functions, at the new ones.
   pure function refined_values(division, mesh, values) result(refined)
      type(division_type), intent(in) :: division
      type(mesh_type), intent(in) :: mesh              !! the mesh before
      real(dp), intent(in) :: values(:)                !! (nodes) values before
      real(dp) :: refined(division%nodes_after)        !! values
      integer :: e, i, s, corners(2)

      refined(:division%nodes) = values
      do s = 1, division%sides
         i = division%side_start(s)
         if (division%ends(2, s) == 0) then
            corners = division%ends([1, 3], s)
            refined(i + 1) = 0.5_dp*sum(values(corners))
         else
            refined(i + 1) = dot_product(quarter_weights, values(division%ends(:, s)))
            refined(i + 2) = dot_product(quarter_weights, values(division%ends(3:1:-1, s)))
         end if
      end do
      do e = 1, division%elements
         associate (kind => mesh%element_kind(e))
            do i = 1, inner_count(kind)
               refined(inner_node(division, e, i)) = dot_product(inner_weights(kind, i), &
                  values(mesh%element_nodes(:element_node_count(kind), e)))
            end do
         end associate
      end do
   end function refined_values

   !> The transpose of refined_values: what acts at the new nodes, shared by the old ones as the
   !> shape functions are.
   pure function restricted_values(division, mesh, values) result(restricted)
      type(division_type), intent(in) :: division
      type(mesh_type), intent(in) :: mesh              !! the mesh before
      real(dp), intent(in) :: values(:)                !! (nodes after) values such as forces
      real(dp) :: restricted(division%nodes)           !! values at the old nodes
      integer :: e, i, s

      restricted = values(:division%nodes)
      do s = 1, division%sides
         i = division%side_start(s)
         associate (ends => division%ends(:, s))
            if (ends(2) == 0) then
               restricted(ends([1, 3])) = restricted(ends([1, 3])) + 0.5_dp*values(i + 1)
            else
               restricted(ends) = restricted(ends) + quarter_weights*values(i + 1) + &
                  quarter_weights(3:1:-1)*values(i + 2)
            end if
         end associate
      end do
      do e = 1, division%elements
         associate (kind => mesh%element_kind(e), &
            nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
            do i = 1, inner_count(kind)
               restricted(nodes) = restricted(nodes) + &
                  inner_weights(kind, i)*values(inner_node(division, e, i))
            end do
         end associate
      end do
   end function restricted_values

   !> Members of a set of nodes, old and new: a new node belongs to it if all nodes of the side, or
   !> of the element, that it lies on do.
   pure function refined_members(division, mesh, member) result(refined)
      type(division_type), intent(in) :: division
      type(mesh_type), intent(in) :: mesh              !! the mesh before
      logical, intent(in) :: member(:)                 !! (nodes) whether a node is in the set
      logical :: refined(division%nodes_after)         !! alike
      integer :: e, s

      refined = .false.
      refined(:division%nodes) = member
      do s = 1, division%sides
         associate (start => division%side_start(s))
            if (division%ends(2, s) == 0) then
               refined(start + 1) = all(member(division%ends([1, 3], s)))
            else
               refined(start + 1:start + 2) = all(member(division%ends(:, s)))
            end if
         end associate
      end do
      do e = 1, division%elements
         associate (kind => mesh%element_kind(e), start => division%inner_start(e))
            refined(start + 1:start + inner_count(kind)) = &
               all(member(mesh%element_nodes(:element_node_count(kind), e)))
         end associate
      end do
   end function refined_members

end module mesh_division
