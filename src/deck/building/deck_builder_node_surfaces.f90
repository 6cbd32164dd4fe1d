!> *SURFACE, TYPE=NODE: the faces whose nodes the surface names.
module deck_builder_node_surfaces
   use card_values, only: chosen, surface_kinds, read_row
   use deck_context, only: deck_type
   use deck_structure, only: cards_of
   use element_kinds, only: element_corner_count
   use element_sides, only: element_sides_type, find_sides
   use kinds, only: dp
   use load_requests, only: target_type
   use number_lists, only: number_list_type
   use text, only: to_text
   implicit none
   private
   public :: build_node_surfaces

contains

   !> Finds the faces of all surfaces of nodes.
   subroutine build_node_surfaces(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: places(:)
      type(target_type) :: target
      logical, allocatable :: named(:)
      real(dp) :: area(2)
      integer :: errors, j, n
      logical :: valid

      places = cards_of(deck%cards, 'SURFACE')
      do n = 1, size(places)
         call deck%open_card(places(n))
         if (chosen(deck%card, 'TYPE', surface_kinds) /= 'NODE') cycle
         errors = deck%error_count()
         named = spread(.false., 1, size(deck%mesh%node_number))
         do j = 1, size(deck%card%data)
            call read_row(deck%card%data(j), '@node or set/area?', deck, area, valid)
            if (deck%card%data(j)%has(2)) call deck%note('*SURFACE, TYPE=NODE: areas are '// &
               'ignored: those of the faces are taken')
            call deck%need_target('node', deck%card%data(j), 1, target, valid)
            if (valid) named(target%members(deck%mesh%node_sets)) = .true.
         end do
         if (deck%error_count() == errors .and. all(deck%element_valid)) call find_faces(named, &
            deck, n)
         if (size(deck%mesh%surfaces(n)%faces, 2) == 0) call deck%lose('surface')
      end do
   end subroutine build_node_surfaces

   !> The outer sides of elements all of whose nodes are named. A node on none of them is an error.
   subroutine find_faces(named, deck, surface)
      logical, intent(in) :: named(:)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: surface
      type(element_sides_type) :: sides
      type(number_list_type) :: found
      logical :: taken(0:size(named))
      integer :: e, f

      sides = find_sides(deck%mesh)
      taken = .false.
      do e = 1, size(deck%mesh%element_number)
         do f = 1, element_corner_count(deck%mesh%element_kind(e))
            associate (side => sides%of_element(f, e))
               associate (nodes => pack(sides%ends(:, side), sides%ends(:, side) > 0))
                  if (sides%elements(2, side) > 0 .or. .not. all(named(nodes))) cycle
                  taken(nodes) = .true.
               end associate
            end associate
            call found%add([e, f])
         end do
      end do
      deck%mesh%surfaces(surface)%faces = reshape(found%numbers(), [2, found%count/2])
      deck%face_places(surface)%items = spread(deck%card%place, 1, size( &
         deck%mesh%surfaces(surface)%faces, 2))
      e = findloc(named .and. .not. taken(1:), .true., dim=1)
      if (e > 0) call deck%error(deck%card%data(1)%place(1), 'node '//to_text( &
         deck%mesh%node_number(e))//' of surface '//deck%mesh%surfaces(surface)%name//' is on '// &
         'no side of an element, at the edge of its body, whose nodes are all in the surface: '// &
         'add the nodes that are missing, or name elements and faces S1 to S4')
   end subroutine find_faces

end module deck_builder_node_surfaces
