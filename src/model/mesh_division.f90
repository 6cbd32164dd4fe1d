!> Division of every eight-node element into four: where the new nodes are, and values there by the
!> shape functions.
module mesh_division
   use kinds, only: dp
   use mesh, only: face_nodes, mesh_type
   implicit none
   private
   public :: division_type, divide, node_count, side_node, inner_node, child_element, refined_values

   !> Shape functions of a three-node side at xi = -1/2; reversed at xi = 1/2.
   real(dp), parameter :: side_weights(3) = [0.375_dp, 0.75_dp, -0.125_dp]

   !> Shape functions of the eight nodes at the centre and half way from it to the midside nodes of
   !> faces 1..4.
   real(dp), parameter :: corner_weights(5) = [-0.25_dp, -0.1875_dp, -0.1875_dp, -0.1875_dp, &
      -0.1875_dp]
   real(dp), parameter :: midside_weights(4, 5) = reshape( &
      [0.5_dp, 0.5_dp, 0.5_dp, 0.5_dp, &
      0.75_dp, 0.375_dp, 0.25_dp, 0.375_dp, &
      0.375_dp, 0.75_dp, 0.375_dp, 0.25_dp, &
      0.25_dp, 0.375_dp, 0.75_dp, 0.375_dp, &
      0.375_dp, 0.25_dp, 0.375_dp, 0.75_dp], [4, 5])

   !> Where the new nodes are: behind the old ones two on each side, then five in each element.
   type :: division_type
      integer :: nodes = 0                  !! old nodes
      integer :: elements = 0               !! old elements
      integer :: sides = 0                  !! distinct sides of elements
      integer, allocatable :: side(:)  !! (nodes) side of which the node is the midside node, else 0
      integer, allocatable :: ends(:, :)    !! (3, sides) first corner, midside node, second corner
   end type division_type

contains

   !> Divides a conforming mesh; its sides are numbered in the order of the elements.
   pure function divide(mesh) result(division)
      type(mesh_type), intent(in) :: mesh     !! elements of eight nodes
      type(division_type) :: division         !! the division
      integer :: e, f, middle

      division%nodes = size(mesh%node_number)
      division%elements = size(mesh%element_number)
      allocate(division%side(division%nodes), source=0)
      allocate(division%ends(3, 4*division%elements))
      do e = 1, division%elements
         do f = 1, 4
            middle = mesh%element_nodes(face_nodes(2, f), e)
            if (division%side(middle) > 0) cycle
            division%sides = division%sides + 1
            division%side(middle) = division%sides
            division%ends(:, division%sides) = mesh%element_nodes(face_nodes(:, f), e)
         end do
      end do
   end function divide

   !> Number of nodes, old and new.
   pure integer function node_count(division)
      type(division_type), intent(in) :: division   !! the division

      node_count = division%nodes + 2*division%sides + 5*division%elements
   end function node_count

   !> Index of the new node on a side, next to one of its corners.
   pure integer function side_node(division, middle, corner)
      type(division_type), intent(in) :: division   !! the division
      integer, intent(in) :: middle                 !! midside node of the side
      integer, intent(in) :: corner                 !! the corner

      side_node = division%nodes + 2*division%side(middle)
      if (division%ends(1, division%side(middle)) == corner) side_node = side_node - 1
   end function side_node

   !> Index of an inner node of an element: 1 at the centre, 1 + f half way to face f.
   pure integer function inner_node(division, element, position)
      type(division_type), intent(in) :: division   !! the division
      integer, intent(in) :: element                !! the element
      integer, intent(in) :: position               !! 1..5

      inner_node = division%nodes + 2*division%sides + 5*(element - 1) + position
   end function inner_node

   !> Index of a child of an element: the first takes its parent's place.
   pure integer function child_element(elements, parent, child)
      integer, intent(in) :: elements   !! number of elements before
      integer, intent(in) :: parent     !! the element
      integer, intent(in) :: child      !! 1..4, the child at that corner

      child_element = elements + 3*(parent - 1) + child - 1
      if (child == 1) child_element = parent
   end function child_element

   !> Values at the old nodes and, by the shape functions, at the new ones.
   pure function refined_values(division, element_nodes, values) result(refined)
      type(division_type), intent(in) :: division      !! the division
      integer, intent(in) :: element_nodes(:, :)       !! (8, elements) nodes of the elements before
      real(dp), intent(in) :: values(:)                !! (nodes) values before
      real(dp), allocatable :: refined(:)              !! (node_count) values
      integer :: e, s, i

      allocate(refined(node_count(division)))
      refined(:division%nodes) = values
      do s = 1, division%sides
         i = division%nodes + 2*s
         refined(i - 1) = dot_product(side_weights, values(division%ends(:, s)))
         refined(i) = dot_product(side_weights, values(division%ends(3:1:-1, s)))
      end do
      do e = 1, division%elements
         do i = 1, 5
            refined(inner_node(division, e, i)) = &
               corner_weights(i)*sum(values(element_nodes(1:4, e))) + &
               dot_product(midside_weights(:, i), values(element_nodes(5:8, e)))
         end do
      end do
   end function refined_values

end module mesh_division
