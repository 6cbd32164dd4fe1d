!> Surfaces of R2D2 and RAX2 elements -> lines of rigid bodies.
module deck_builder_rigid_lines
   use card_values, only: check_extra, need_field
   use cards, only: data_card_type, keyword_card_type
   use deck_builder_drawings, only: check_smooth, turn_round
   use deck_context, only: deck_type
   use deck_source, only: place_type
   use drawn_lines, only: drawn_line_type
   use element_types, only: rigid_line
   use kinds, only: dp
   use mesh, only: mesh_type, surface_type
   use text, only: read_integer, to_upper
   implicit none
   private
   public :: build_line_surface, is_rigid_side, lines_of

contains

   !> Whether a data card of a *SURFACE names sides of rigid line elements.
   pure logical function is_rigid_side(data, deck)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(in) :: deck
      integer, allocatable :: lines(:)

      lines = lines_of(data%text(1), deck)
      is_rigid_side = size(lines) > 0
      if (is_rigid_side) is_rigid_side = all(deck%line_kind(lines) == rigid_line)
   end function is_rigid_side

   !> The lines of a set, or the one of a number; none where there is no such set or line.
   pure function lines_of(name, deck) result(lines)
      character(*), intent(in) :: name
      type(deck_type), intent(in) :: deck
      integer, allocatable :: lines(:)
      integer :: number, set
      logical :: is_number

      allocate (lines(0))
      call read_integer(name, number, is_number)
      if (is_number) then
         set = findloc(deck%line_number, number, dim=1)
         if (set > 0) lines = [set]
      else
         set = deck%element_index%sets%find(name)
         if (set > 0) lines = deck%line_sets(set)%members
      end if
   end function lines_of

   !> Builds the surface of the sides of rigid line elements: SPOS is on the left from the first to
   !> the second node, SNEG on the right.
   subroutine build_line_surface(card, deck, mesh, surface)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck   !! receives errors
      type(mesh_type), intent(in) :: mesh
      type(surface_type), intent(inout) :: surface         !! receives the line
      integer, allocatable :: ends(:, :), lines(:), more(:)
      character(:), allocatable :: side
      integer :: i, j
      logical :: valid

      allocate (lines(0), ends(2, 0))
      do j = 1, size(card%data)
         valid = .true.
         call need_field(card%data(j), 2, 'side SPOS or SNEG', deck, side, valid)
         call check_extra(card%data(j), 2, 'element or set, side', deck)
         if (.not. valid) return
         side = to_upper(side)
         more = lines_of(card%data(j)%text(1), deck)
         if ((side /= 'SPOS' .and. side /= 'SNEG') .or. size(more) == 0) then
            call deck%error(card%data(j)%place(merge(1, 2, size(more) == 0)), 'a surface of '// &
               'rigid elements has sides SPOS or SNEG of such elements only')
            return
         end if
         if (any(deck%line_nodes(:2, more) == 0)) return
         lines = [lines, more]
         do i = 1, size(more)
            ends = reshape([ends, merge(deck%line_nodes(:2, more(i)), &
               deck%line_nodes([2, 1], more(i)), side == 'SPOS')], [2, size(ends, 2) + 1])
         end do
      end do
      call join_lines(card, lines, ends, mesh, deck, surface)
   end subroutine build_line_surface

   !> Puts lines one behind the other.
   subroutine join_lines(card, lines, ends, mesh, deck, surface)
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: lines(:), ends(:, :)          ! (n), (2, n) nodes
      type(mesh_type), intent(in) :: mesh
      type(deck_type), intent(inout) :: deck
      type(surface_type), intent(inout) :: surface
      type(drawn_line_type) :: line
      integer :: i, order(size(lines))

      order(1) = 1
      do i = 1, size(lines)
         if (all(ends(2, :) /= ends(1, i))) order(1) = i
      end do
      do i = 2, size(lines)
         order(i) = findloc(ends(1, :), ends(2, order(i - 1)), dim=1)
         if (order(i) > 0) then
            if (all(order(:i - 1) /= order(i))) cycle
         end if
         call deck%error(card%place, 'the rigid elements of surface '//surface%name//' are not '// &
            'one line, each from the node where another one ends; number their nodes that way, '// &
            'or name the pieces as surfaces of their own')
         return
      end do
      line%line = lines(order)
      line%start = mesh%coordinates(:, ends(1, order))
      line%finish = mesh%coordinates(:, ends(2, order))
      allocate (line%is_arc(size(lines)), source=.false.)
      line%centre = 0.0_dp*line%start
      line%closed = ends(1, order(1)) == ends(2, order(size(order)))
      call check_smooth(spread_place(card%place, size(lines)), surface%name, line, deck)
      call turn_round(line)
      surface%drawing = line
   end subroutine join_lines

   pure function spread_place(place, n) result(places)
      type(place_type), intent(in) :: place
      integer, intent(in) :: n
      type(place_type) :: places(n)

      places = place
   end function spread_place

end module deck_builder_rigid_lines
