!> Division of elements into four of their kind: where the new nodes are, and values there by the
!> shape functions. Where an element on one side of a side is divided and the one on the other is
!> not, the new nodes of that side hang (hanging_nodes).
module mesh_division
   use element_kinds, only: element_node_count, kind_count, triangle6
   use element_sides, only: element_sides_type, find_sides
   use local_refinement, only: coarse_side, fine_sides, hanging_count
   use kinds, only: dp
   use mesh, only: mesh_type
   use shape_functions, only: element_shape, side_shape
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: division_type, divide, hanging_after, side_node, child_element
   public :: refined_members

   !> New nodes inside an element by its kind.
   integer, parameter :: inner_count(kind_count) = [5, 5, 1, 3, 0, 1]

   !> xi, eta of the new nodes inside an element: of a square at its centre and half way from it to
   !> each side, of a triangle half way between the midside nodes at each corner.
   real(dp), parameter :: in_square(2, 5) = reshape([0.0_dp, 0.0_dp, 0.0_dp, -0.5_dp, &
      0.5_dp, 0.0_dp, 0.0_dp, 0.5_dp, -0.5_dp, 0.0_dp], [2, 5])
   real(dp), parameter :: in_triangle(2, 3) = reshape([0.25_dp, 0.25_dp, 0.5_dp, 0.25_dp, &
      0.25_dp, 0.5_dp], [2, 3])

   !> Where the new nodes are: behind the old ones those of each side, then those in each element.
   !> A side of three nodes gets two new ones, a side of two its midpoint.
   type :: division_type
      integer :: nodes = 0                          !! old nodes
      integer :: elements = 0                       !! old elements
      integer :: nodes_after = 0                    !! old and new nodes
      integer :: elements_after = 0                 !! elements afterwards
      type(element_sides_type) :: sides             !! sides of the old elements
      !> (2, sides) nodes between the ends of each side, from its first end on: new ones, or old
      !> ones that hang there; 0 where there are none, the second one also on a side of two nodes
      integer, allocatable :: between(:, :)
      !> (elements) index before the nodes inside: of a quadrilateral 1 at the centre, 1 + f half
      !> way to side f; of a triangle with six nodes i half way between the midside nodes near
      !> corner i
      integer, allocatable :: inner_start(:)
      integer, allocatable :: rank(:) !! (elements) how many are divided up to each, 0 if it is not
      !> (nodes_after, nodes) of the old nodes in the values at all nodes; columns in any order
      type(sparse_matrix_type) :: weights
   contains
      procedure :: prolong
      procedure, private :: elements_at
   end type division_type

contains

   !> A field at the old nodes as one at all nodes.
   pure function prolong(self, values, components) result(field)
      class(division_type), intent(in) :: self
      real(dp), intent(in) :: values(:)               !! (components*nodes) node by node
      integer, intent(in) :: components               !! values of a node
      real(dp) :: field(components*self%nodes_after)
      integer :: c

      do c = 1, components
         field(c::components) = self%weights%multiply(values(c::components))
      end do
   end function prolong

   !> Divides some elements of a mesh; where an element is divided, so must be the ones beside it
   !> whose sides are twice as long.
   pure function divide(mesh, chosen) result(division)
      type(mesh_type), intent(in) :: mesh           !! elements of any kinds
      logical, intent(in) :: chosen(:)              !! (elements) those that are divided
      type(division_type) :: division               !! the division
      integer :: e, h, last, side

      division%nodes = size(mesh%node_number)
      division%elements = size(mesh%element_number)
      division%elements_after = division%elements + 3*count(chosen)
      division%sides = find_sides(mesh)
      allocate(division%rank(division%elements), source=0)
      division%rank = unpack([(e, e=1, count(chosen))], chosen, division%rank)
      allocate(division%between(2, division%sides%count), source=0)
      do h = 1, hanging_count(mesh)
         side = division%sides%index_of(coarse_side(mesh, h))
         associate (nodes => mesh%hanging_sides(:, h), between => division%between(:, side))
            between = nodes(4:5)
            if (nodes(4) == 0) between = [nodes(2), 0]
            if (nodes(4) > 0 .and. division%sides%ends(1, side) == nodes(3)) between = nodes([5, 4])
         end associate
      end do
      last = division%nodes
      do side = 1, division%sides%count
         if (division%between(1, side) > 0) cycle
         if (.not. any(chosen(division%elements_at(side)))) cycle
         division%between(1, side) = last + 1
         if (division%sides%ends(2, side) > 0) division%between(2, side) = last + 2
         last = maxval(division%between(:, side))
      end do
      allocate(division%inner_start(division%elements))
      do e = 1, division%elements
         division%inner_start(e) = last
         if (chosen(e)) last = last + inner_count(mesh%element_kind(e))
      end do
      division%nodes_after = last
      call find_weights(mesh, division)
   end function divide

   !> Sides where nodes hang afterwards, as in mesh_type.
   pure function hanging_after(division, mesh) result(hanging)
      type(division_type), intent(in) :: division
      type(mesh_type), intent(in) :: mesh           !! the mesh before
      integer, allocatable :: hanging(:, :)         !! (5, sides)
      logical :: is_fine(division%sides%count), meet(division%sides%count), stays
      integer :: h, n, s

      allocate(hanging(5, hanging_count(mesh) + division%sides%count))
      is_fine = .false.
      n = 0
      do h = 1, hanging_count(mesh)
         associate (sides => division%sides)
            stays = division%rank(sides%elements(1, sides%index_of(coarse_side(mesh, h)))) == 0
            associate (halves => fine_sides(mesh, h))
               is_fine(sides%index_of(halves(:, 1))) = .true.
               is_fine(sides%index_of(halves(:, 2))) = .true.
            end associate
         end associate
         if (.not. stays) cycle
         n = n + 1
         hanging(:, n) = mesh%hanging_sides(:, h)
      end do
      do s = 1, division%sides%count
         associate (around => division%elements_at(s))
            meet(s) = division%between(1, s) > division%nodes .and. (is_fine(s) .or. &
               any(division%rank(around) == 0))
         end associate
         if (.not. meet(s)) cycle
         n = n + 1
         associate (ends => division%sides%ends(:, s), between => division%between(:, s))
            if (ends(2) > 0) then
               hanging(:, n) = [ends, between]
            else
               hanging(:, n) = [ends(1), between(1), ends(3), 0, 0]
            end if
         end associate
      end do
      hanging = hanging(:, :n)
   end function hanging_after

   !> The elements that have a side.
   pure function elements_at(self, side) result(elements)
      class(division_type), intent(in) :: self
      integer, intent(in) :: side                   !! the side
      integer, allocatable :: elements(:)           !! one or two

      elements = pack(self%sides%elements(:, side), self%sides%elements(:, side) > 0)
   end function elements_at

   !> Index of the node between the ends of a side of a divided element: next to one of the corners
   !> where it has three nodes, at its middle where it has two.
   pure integer function side_node(division, element, side, corner)
      type(division_type), intent(in) :: division
      integer, intent(in) :: element                !! the element
      integer, intent(in) :: side                   !! 1..element_corner_count
      integer, intent(in) :: corner                 !! node at the corner

      associate (s => division%sides%of_element(side, element))
         side_node = division%between(1, s)
         if (division%between(2, s) == 0) return
         if (division%sides%ends(1, s) /= corner) side_node = division%between(2, s)
      end associate
   end function side_node

   !> Index of a child of a divided element: the first takes its parent's place.
   pure integer function child_element(division, parent, child)
      type(division_type), intent(in) :: division
      integer, intent(in) :: parent     !! the element
      integer, intent(in) :: child      !! the child at that corner; 4 of a triangle: in the middle

      child_element = division%elements + 3*(division%rank(parent) - 1) + child - 1
      if (child == 1) child_element = parent
   end function child_element

   !> Weights of the old nodes in the new mesh's: one for a node itself, at a new one the shape
   !> functions of the side, or of the element, that it lies on.
   pure subroutine find_weights(mesh, division)
      type(mesh_type), intent(in) :: mesh              ! the mesh before
      type(division_type), intent(inout) :: division   ! numbered
      integer :: e, i, s
      real(dp) :: point(2)

      associate (weights => division%weights, sides => division%sides)
         weights%row_count = division%nodes_after
         weights%column_count = division%nodes
         allocate (weights%row_start(division%nodes_after + 1))
         i = division%nodes + 6*sides%count + sum(inner_count(mesh%element_kind)* &
            element_node_count(mesh%element_kind), mask=division%rank > 0)
         allocate (weights%column(i), weights%value(i))
         do i = 1, division%nodes
            call set_row(weights, i, [i], [1.0_dp])
         end do
         do s = 1, sides%count
            i = division%between(1, s)
            if (i <= division%nodes) cycle
            if (sides%ends(2, s) == 0) then
               call set_row(weights, i, sides%ends([1, 3], s), side_shape(2, 0.0_dp))
            else
               call set_row(weights, i, sides%ends(:, s), side_shape(3, -0.5_dp))
               call set_row(weights, i + 1, sides%ends(3:1:-1, s), side_shape(3, -0.5_dp))
            end if
         end do
         do e = 1, division%elements
            if (division%rank(e) == 0) cycle
            associate (kind => mesh%element_kind(e))
               do i = 1, inner_count(kind)
                  point = in_square(:, i)
                  if (kind == triangle6) point = in_triangle(:, i)
                  call set_row(weights, division%inner_start(e) + i, &
                     mesh%element_nodes(:element_node_count(kind), e), element_shape(kind, point))
               end do
            end associate
         end do
      end associate
   end subroutine find_weights

   !> Sets a row behind those before it.
   pure subroutine set_row(matrix, row, columns, values)
      type(sparse_matrix_type), intent(inout) :: matrix
      integer, intent(in) :: row, columns(:)
      real(dp), intent(in) :: values(:)

      if (row == 1) matrix%row_start(1) = 1
      matrix%row_start(row + 1) = matrix%row_start(row) + size(columns)
      matrix%column(matrix%row_start(row):matrix%row_start(row + 1) - 1) = columns
      matrix%value(matrix%row_start(row):matrix%row_start(row + 1) - 1) = values
   end subroutine set_row

   !> Members of a set of nodes, old and new: a new node belongs to it if all nodes of the side, or
   !> of the element, that it lies on do.
   pure function refined_members(division, member) result(refined)
      type(division_type), intent(in) :: division
      logical, intent(in) :: member(:)                 !! (nodes) whether a node is in the set
      logical :: refined(division%nodes_after)         !! likewise
      integer :: i, k

      refined = .true.
      associate (weights => division%weights)
         do i = 1, division%nodes_after
            do k = weights%row_start(i), weights%row_start(i + 1) - 1
               if (.not. member(weights%column(k))) refined(i) = .false.
            end do
         end do
      end associate
   end function refined_members

end module mesh_division
