!> Bodies that are drawn on each other: nothing keeps one from passing through the other.
module overlap_checks
   use deck_context, only: deck_type
   use element_kinds, only: element_corner_count
   use element_sides, only: element_sides_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use mesh_bodies, only: body_name
   implicit none
   private
   public :: check_overlaps

   integer, parameter :: most_looked_at = 50      !! elements of a body
   real(dp), parameter :: drawn_in = 0.9_dp       !! part of the way from the middle to a corner

contains

   !> Warns of every body that lies wholly inside another.
   subroutine check_overlaps(deck, sides)
      type(deck_type), intent(inout) :: deck
      type(element_sides_type), intent(in) :: sides   !! those of all elements
      real(dp) :: box(4, deck%mesh%body_count)        ! lowest x and y, highest x and y
      logical :: is_told(deck%mesh%body_count)
      integer :: inner, n, outer

      box(:2, :) = huge(1.0_dp)
      box(3:, :) = -huge(1.0_dp)
      do n = 1, size(deck%mesh%node_body)
         if (deck%mesh%node_body(n) == 0) cycle
         associate (x => deck%mesh%coordinates(:, n), own => box(:, deck%mesh%node_body(n)))
            own = [min(own(:2), x), max(own(3:), x)]
         end associate
      end do
      is_told = .false.
      do inner = 1, size(box, 2)
         do outer = 1, size(box, 2)
            if (outer == inner .or. is_told(outer)) cycle
            associate (low => box(:2, :), high => box(3:, :))
               if (any(low(:, inner) < low(:, outer) .or. high(:, inner) > high(:, outer))) cycle
            end associate
            if (.not. lies_inside(deck%mesh, sides, inner, outer)) cycle
            is_told(inner) = .true.
            call deck%warning(deck%node_place(findloc(deck%mesh%node_body, inner, dim=1)), &
               body_name(deck%model, inner)//' lies wholly inside '//body_name(deck%model, &
               outer)//': both fill the same place; check the positions of the bodies')
            exit
         end do
      end do
   end subroutine check_overlaps

   !> Whether elements of one body, evenly chosen, are within another with all their corners: these
   !> are drawn in a little, as outlines may coincide.
   pure logical function lies_inside(mesh, sides, inner, outer)
      type(mesh_type), intent(in) :: mesh
      type(element_sides_type), intent(in) :: sides
      integer, intent(in) :: inner, outer    ! bodies
      integer, allocatable :: corners(:), elements(:), outline(:)
      real(dp) :: middle(2)
      integer :: i, k

      elements = pack([(i, i=1, size(mesh%element_body))], mesh%element_body == inner)
      outline = pack([(i, i=1, sides%count)], sides%elements(2, :sides%count) == 0 .and. &
         mesh%element_body(sides%elements(1, :sides%count)) == outer)
      lies_inside = .false.
      do i = 1, size(elements), size(elements)/most_looked_at + 1
         corners = mesh%element_nodes(:element_corner_count(mesh%element_kind(elements(i))), &
            elements(i))
         middle = sum(mesh%coordinates(:, corners), dim=2)/size(corners)
         do k = 1, size(corners)
            if (.not. is_within(mesh, sides%ends(:, outline), middle + drawn_in* &
               (mesh%coordinates(:, corners(k)) - middle))) return
         end do
      end do
      lies_inside = .true.
   end function lies_inside

   !> Whether a ray from a point along x crosses an outline an odd number of times.
   pure logical function is_within(mesh, outline, x)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: outline(:, :)   ! (3, sides)
      real(dp), intent(in) :: x(2)
      integer :: k

      is_within = .false.
      do k = 1, size(outline, 2)
         if (outline(2, k) == 0) then
            if (crosses(outline(1, k), outline(3, k))) is_within = .not. is_within
         else
            if (crosses(outline(1, k), outline(2, k))) is_within = .not. is_within
            if (crosses(outline(2, k), outline(3, k))) is_within = .not. is_within
         end if
      end do
   contains
      pure logical function crosses(first, second)
         integer, intent(in) :: first, second   ! nodes of a straight line

         associate (a => mesh%coordinates(:, first) - x, b => mesh%coordinates(:, second) - x)
            crosses = .false.
            if ((a(2) > 0.0_dp) .eqv. (b(2) > 0.0_dp)) return
            crosses = (a(1)*b(2) - a(2)*b(1) > 0.0_dp) .eqv. (b(2) > a(2))
         end associate
      end function crosses
   end function is_within

end module overlap_checks
