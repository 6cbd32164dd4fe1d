!> Nodes of the four children of each divided element.
module child_elements
   use element_kinds, only: quad4, quad8, quad8_reduced, triangle6
   use mesh_division, only: child_element, division_type, inner_node, side_node
   implicit none
   private
   public :: refine_elements

contains

   !> Puts the children in the place of the elements that are divided.
   subroutine refine_elements(division, kinds, element_nodes)
      type(division_type), intent(in) :: division
      integer, intent(in) :: kinds(:)                           !! (elements) before
      integer, allocatable, intent(inout) :: element_nodes(:, :) !! (8, elements) as in mesh_type
      integer, allocatable :: children(:, :)
      integer :: e, nodes(8, 4), child

      allocate(children(8, division%elements_after))
      children(:, :division%elements) = element_nodes
      do e = 1, division%elements
         if (division%rank(e) == 0) cycle
         nodes = 0
         select case (kinds(e))
         case (quad8, quad8_reduced)
            nodes = quad8_children(division, element_nodes(:, e), e)
         case (quad4)
            nodes(:4, :) = quad4_children(division, element_nodes(:, e), e)
         case (triangle6)
            nodes(:6, :) = triangle6_children(division, element_nodes(:, e), e)
         case default
            nodes(:3, :) = triangle3_children(division, element_nodes(:, e), e)
         end select
         do child = 1, 4
            children(:, child_element(division, e, child)) = nodes(:, child)
         end do
      end do
      call move_alloc(children, element_nodes)
   end subroutine refine_elements

   !> Nodes of the four children of an eight-node element.
   pure function quad8_children(division, nodes, e) result(children)
      type(division_type), intent(in) :: division
      integer, intent(in) :: nodes(8), e
      integer :: children(8, 4)
      integer :: f, centre, inner(4), near_first(4), near_second(4)

      centre = inner_node(division, e, 1)
      do f = 1, 4
         near_first(f) = side_node(division, e, f, nodes(f))
         near_second(f) = side_node(division, e, f, nodes(mod(f, 4) + 1))
         inner(f) = inner_node(division, e, 1 + f)
      end do
      associate (c => nodes(1:4), m => nodes(5:8))
         children(:, 1) = [c(1), m(1), centre, m(4), &
            near_first(1), inner(1), inner(4), near_second(4)]
         children(:, 2) = [m(1), c(2), m(2), centre, &
            near_second(1), near_first(2), inner(2), inner(1)]
         children(:, 3) = [centre, m(2), c(3), m(3), &
            inner(2), near_second(2), near_first(3), inner(3)]
         children(:, 4) = [m(4), centre, m(3), c(4), &
            inner(4), inner(3), near_second(3), near_first(4)]
      end associate
   end function quad8_children

   !> Nodes of the four children of a four-node element.
   pure function quad4_children(division, nodes, e) result(children)
      type(division_type), intent(in) :: division
      integer, intent(in) :: nodes(8), e
      integer :: children(4, 4)
      integer :: f, centre, m(4)

      centre = inner_node(division, e, 1)
      m = [(side_node(division, e, f, nodes(f)), f=1, 4)]
      associate (c => nodes(1:4))
         children(:, 1) = [c(1), m(1), centre, m(4)]
         children(:, 2) = [m(1), c(2), m(2), centre]
         children(:, 3) = [centre, m(2), c(3), m(3)]
         children(:, 4) = [m(4), centre, m(3), c(4)]
      end associate
   end function quad4_children

   !> Nodes of the four children of a six-node triangle; the fourth lies between its midside nodes.
   pure function triangle6_children(division, nodes, e) result(children)
      type(division_type), intent(in) :: division
      integer, intent(in) :: nodes(8), e
      integer :: children(6, 4)
      integer :: f, inner(3), near_first(3), near_second(3)

      do f = 1, 3
         near_first(f) = side_node(division, e, f, nodes(f))
         near_second(f) = side_node(division, e, f, nodes(mod(f, 3) + 1))
         inner(f) = inner_node(division, e, f)
      end do
      associate (c => nodes(1:3), m => nodes(4:6))
         children(:, 1) = [c(1), m(1), m(3), near_first(1), inner(1), near_second(3)]
         children(:, 2) = [m(1), c(2), m(2), near_second(1), near_first(2), inner(2)]
         children(:, 3) = [m(3), m(2), c(3), inner(3), near_second(2), near_first(3)]
         children(:, 4) = [m(1), m(2), m(3), inner(2), inner(3), inner(1)]
      end associate
   end function triangle6_children

   !> Nodes of the four children of a three-node triangle; the fourth is in the middle.
   pure function triangle3_children(division, nodes, e) result(children)
      type(division_type), intent(in) :: division
      integer, intent(in) :: nodes(8), e
      integer :: children(3, 4)
      integer :: f, m(3)

      m = [(side_node(division, e, f, nodes(f)), f=1, 3)]
      associate (c => nodes(1:3))
         children(:, 1) = [c(1), m(1), m(3)]
         children(:, 2) = [m(1), c(2), m(2)]
         children(:, 3) = [m(3), m(2), c(3)]
         children(:, 4) = m
      end associate
   end function triangle3_children

end module child_elements
