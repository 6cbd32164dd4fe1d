!> Checks once all elements are read: whether their planes agree, whether they meet along
!> whole sides.
module mesh_checks
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use element_kinds, only: axisymmetric, element_corner_count, element_node_count, &
      side_node_count, side_nodes
   use kinds, only: dp
   use mesh, only: mesh_type
   use sorting, only: sort_order
   use text, only: others, to_text
   implicit none
   private
   public :: check_planes, check_sides

   !> One side of one element.
   type :: element_side_type
      integer :: element = 0   !! element index
      integer :: face = 0      !! its side, 1, 2, ...
      integer :: low = 0       !! the corner with the smaller index
      integer :: high = 0      !! the other
      integer :: middle = 0    !! midside node, 0 if there is none
   end type element_side_type

contains

   !> Elements are all axisymmetric or none is; the radius is not negative.
   subroutine check_planes(context, mesh, report)
      type(deck_context_type), intent(in) :: context       !! places for messages
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: e, q, first
      logical :: turns(size(mesh%element_plane))

      turns = mesh%element_plane == axisymmetric
      first = findloc(context%element_valid, .true., dim=1)
      do e = 1, size(turns)
         if (.not. context%element_valid(e)) cycle
         if (turns(e) .neqv. turns(first)) then
            call report%error(context%element_place(e), 'element '// &
               to_text(mesh%element_number(e))//' and element '// &
               to_text(mesh%element_number(first))// &
               ': a model cannot have both axisymmetric and plane elements')
            return
         end if
      end do
      do e = 1, size(turns)
         if (.not. (turns(e) .and. context%element_valid(e))) cycle
         do q = 1, element_node_count(mesh%element_kind(e))
            if (mesh%coordinates(1, mesh%element_nodes(q, e)) >= 0.0_dp) cycle
            call report%error(context%element_place(e), 'element '// &
               to_text(mesh%element_number(e))//' is axisymmetric: x is the radius, but node '// &
               to_text(mesh%node_number(mesh%element_nodes(q, e)))//' has x < 0')
            exit
         end do
      end do
   end subroutine check_planes

   !> Elements meet along whole sides, two at each, and surfaces are faces of which one side is
   !> free.
   subroutine check_sides(context, mesh, inverted, uses, report)
      type(deck_context_type), intent(in) :: context       !! places for messages
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: inverted(:)   !! (elements) whether their sides may not be as meant
      !> (4, elements) elements that meet at each side; 0 where an error says that it is wrong
      integer, intent(out) :: uses(:, :)
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(element_side_type) :: sides(4*size(mesh%element_number))
      integer, allocatable :: order(:)
      integer :: first, last, n

      call list_sides(context%element_valid .and. .not. inverted, mesh, sides, n)
      order = sort_order(sides(:n)%high)
      order = order(sort_order(sides(order)%low))
      uses = 0
      first = 1
      do while (first <= n)
         last = first
         do while (last < n)
            if (sides(order(last + 1))%low /= sides(order(first))%low) exit
            if (sides(order(last + 1))%high /= sides(order(first))%high) exit
            last = last + 1
         end do
         call check_meeting(context, mesh, sides(order(first:last)), uses, report)
         first = last + 1
      end do
      call check_middles(context, mesh, sides(:n), report)
      call check_faces(context, mesh, uses, report)
   end subroutine check_sides

   !> The sides of sound elements, in the order of the elements.
   pure subroutine list_sides(sound, mesh, sides, n)
      logical, intent(in) :: sound(:)   !! (elements)
      type(mesh_type), intent(in) :: mesh
      type(element_side_type), intent(inout) :: sides(:)
      integer, intent(out) :: n
      integer :: e, f, nodes(3)

      n = 0
      do e = 1, size(mesh%element_number)
         if (.not. sound(e)) cycle
         associate (kind => mesh%element_kind(e))
            do f = 1, element_corner_count(kind)
               n = n + 1
               nodes(:side_node_count(kind)) = mesh%element_nodes(side_nodes(kind, f), e)
               sides(n) = element_side_type(e, f, minval(nodes([1, side_node_count(kind)])), &
                  maxval(nodes([1, side_node_count(kind)])), 0)
               if (side_node_count(kind) == 3) sides(n)%middle = nodes(2)
            end do
         end associate
      end do
   end subroutine list_sides

   !> Checks the elements that meet between two corners.
   subroutine check_meeting(context, mesh, sides, uses, report)
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      type(element_side_type), intent(in) :: sides(:)
      integer, intent(inout) :: uses(:, :)
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: fault
      integer :: i

      do i = 1, size(sides)
         uses(sides(i)%face, sides(i)%element) = size(sides)
      end do
      do i = 2, size(sides)
         if (i > 2) then
            fault = 'is the third on the side'
         else if (sides(1)%middle == sides(2)%middle) then
            cycle
         else if (min(sides(1)%middle, sides(2)%middle) == 0) then
            fault = 'has a different number of nodes from its neighbour '// &
               to_text(mesh%element_number(sides(1)%element))//' on the side'
         else
            fault = 'has a different midside node from its neighbour '// &
               to_text(mesh%element_number(sides(1)%element))//' on the side'
         end if
         call report%error(context%element_place(sides(i)%element), 'element '// &
            to_text(mesh%element_number(sides(i)%element))//' '//fault//' between nodes '// &
            to_text(mesh%node_number(sides(i)%low))//' and '// &
            to_text(mesh%node_number(sides(i)%high)))
      end do
   end subroutine check_meeting

   !> A midside node is no corner, and belongs to one side.
   subroutine check_middles(context, mesh, sides, report)
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      type(element_side_type), intent(in) :: sides(:)
      type(deck_report_type), intent(inout) :: report
      logical :: corner(size(mesh%node_number))
      integer :: first(size(mesh%node_number)), i

      corner = .false.
      corner(sides%low) = .true.
      corner(sides%high) = .true.
      first = 0
      do i = 1, size(sides)
         associate (node => sides(i)%middle)
            if (node == 0) cycle
            if (first(node) == 0) first(node) = i
            if (.not. corner(node) .and. sides(first(node))%low == sides(i)%low .and. &
               sides(first(node))%high == sides(i)%high) cycle
            call report%error(context%element_place(sides(i)%element), 'element '// &
               to_text(mesh%element_number(sides(i)%element))// &
               ' does not share the side with midside node '//to_text(mesh%node_number(node))// &
               ' with its neighbour')
         end associate
      end do
   end subroutine check_middles

   !> Faces of surfaces are free: reported once a surface, where the first is named. What is loaded
   !> through such a face is not told again.
   subroutine check_faces(context, mesh, uses, report)
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      integer, intent(inout) :: uses(:, :)   !! (4, elements) elements that meet at each side
      type(deck_report_type), intent(inout) :: report
      logical :: wrong(size(uses, 1), size(uses, 2))
      logical, allocatable :: inside(:)
      integer :: i, s

      wrong = .false.
      do s = 1, size(mesh%surfaces)
         associate (faces => mesh%surfaces(s)%faces)
            allocate(inside(size(faces, 2)))
            do i = 1, size(inside)
               inside(i) = uses(faces(2, i), faces(1, i)) > 1
               wrong(faces(2, i), faces(1, i)) = wrong(faces(2, i), faces(1, i)) .or. inside(i)
            end do
            i = findloc(inside, .true., dim=1)
            if (i > 0) call report%error(context%face_places(s)%items(i), 'face S'// &
               to_text(faces(2, i))//' of element '//to_text(mesh%element_number(faces(1, i)))// &
               ' in surface '//mesh%surfaces(s)%name//' lies inside a body'// &
               others(count(inside), '; faces of the surface that do: '))
            deallocate(inside)
         end associate
      end do
      where (wrong) uses = 0
   end subroutine check_faces

end module mesh_checks
