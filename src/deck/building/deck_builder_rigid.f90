!> *RIGID BODY -> what follows a reference node; where decks may name rigid surfaces.
module deck_builder_rigid
   use card_parameters, only: choice, is_on
   use cards, only: keyword_card_type
   use deck_builder_drawings, only: lines_of
   use deck_context, only: deck_type
   use deck_source, only: place_type
   use equations, only: coupling_type
   implicit none
   private
   public :: build_rigid_body, need_faces, check_rigid_masters

contains

   !> Reads what follows the reference node, which is known: sets of nodes and elements, and the
   !> surfaces that are lines.
   subroutine build_rigid_body(card, deck, coupling)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck
      type(coupling_type), intent(inout) :: coupling       !! receives the rest
      character(*), parameter :: names(3) = [character(8) :: 'NSET', 'TIE NSET', 'PIN NSET']
      character(:), allocatable :: position
      integer, allocatable :: lines(:)
      integer :: i, set, surface
      logical :: isothermal

      coupling%is_rigid = .true.
      coupling%follows = .true.
      allocate (coupling%node_sets(0), lines(0))
      do i = 1, size(names)
         set = 0
         call deck%take_named(card, trim(names(i)), 'node set', set)
         if (set > 0) coupling%node_sets = [coupling%node_sets, set]
      end do
      call deck%take_named(card, 'ELSET', 'element set', coupling%element_set)
      if (coupling%element_set > 0) then
         lines = lines_of(deck%mesh%element_sets(coupling%element_set)%name, deck)
         coupling%nodes = pack(deck%line_nodes(:, lines), deck%line_nodes(:, lines) > 0)
      end if
      surface = 0
      call deck%take_named(card, 'ANALYTICAL SURFACE', 'surface', surface)
      if (surface > 0) then
         if (.not. allocated(deck%mesh%surfaces(surface)%drawing)) then
            call deck%error(card%place_of('ANALYTICAL SURFACE'), 'surface '// &
               deck%mesh%surfaces(surface)%name//' is no drawing; name one of *SURFACE, '// &
               'TYPE=SEGMENTS, or the elements by ELSET=')
            return
         end if
      end if
      position = choice(card, 'POSITION', 'INPUT', deck, '')
      isothermal = is_on(card, 'ISOTHERMAL', deck)
      ! Lines conduct no heat: they have one temperature.
      coupling%is_warm = isothermal .or. (size(lines) > 0 .and. size(coupling%node_sets) == 0)
      do i = 1, size(deck%mesh%surfaces)
         associate (given => deck%mesh%surfaces(i))
            if (.not. allocated(given%drawing)) cycle
            if (i /= surface) then
               if (.not. allocated(given%drawing%line)) cycle
               if (all(given%drawing%line(1) /= lines)) cycle
            end if
            given%drawing%reference = coupling%reference
            given%drawing%rotation = coupling%rotation
         end associate
      end do
      if (.not. (card%has('ELSET') .or. card%has('ANALYTICAL SURFACE') .or. any([(card%has( &
         trim(names(i))), i=1, size(names))]))) call deck%error(card%place, '*RIGID BODY names '// &
         'nothing that is rigid; give ELSET=, NSET= or ANALYTICAL SURFACE=')
   end subroutine build_rigid_body

   !> Refuses a rigid surface where faces of elements are needed.
   subroutine need_faces(place, advice, deck, surface)
      type(place_type), intent(in) :: place                !! where it is named
      character(*), intent(in) :: advice                   !! what to name in its place
      type(deck_type), intent(inout) :: deck
      integer, intent(inout) :: surface                    !! 0 for none, and after an error

      if (surface == 0) return
      if (.not. allocated(deck%mesh%surfaces(surface)%drawing)) return
      call deck%error(place, 'surface '//deck%mesh%surfaces(surface)%name//' is rigid: it has '// &
         'no faces; '//advice)
      surface = 0
   end subroutine need_faces

   !> Rigid surfaces in contact have a reference node.
   subroutine check_rigid_masters(deck)
      type(deck_type), intent(inout) :: deck
      integer :: i

      do i = 1, size(deck%model%contacts)
         if (deck%model%contacts(i)%master == 0) cycle
         associate (surface => deck%mesh%surfaces(deck%model%contacts(i)%master))
            if (.not. allocated(surface%drawing)) cycle
            if (surface%drawing%reference > 0) cycle
            call deck%missing(place_type(image=deck%model%contacts(i)%card), 'rigid surface '// &
               surface%name//' belongs to no *RIGID BODY, whose reference node it follows; '// &
               'give *RIGID BODY, REF NODE=node, '//trim(merge('ELSET=its elements         ', &
               'ANALYTICAL SURFACE=its name', allocated(surface%drawing%line))), 'equation')
         end associate
      end do
   end subroutine check_rigid_masters

end module deck_builder_rigid
