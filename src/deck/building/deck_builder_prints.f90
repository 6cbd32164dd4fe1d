!> *NODE PRINT and *EL PRINT -> tables of the listing.
module deck_builder_prints
   use card_parameters, only: choose, parameter_place, parameter_text, take_from
   use cards, only: cards_type, data_card_type, field_place, field_text, has_field, &
      keyword_card_type
   use deck_context, only: deck_context_type, need_element_set, need_named
   use deck_report, only: deck_report_type
   use mesh, only: mesh_type, set_type
   use named_items, only: find_named
   use print_requests, only: append_request, print_displacement, print_force, print_heat, &
      print_heat_flux, print_position, print_request_type, print_stress, print_temperature
   use spelling, only: known_choices
   use text, only: append, string_type, to_upper
   implicit none
   private
   public :: build_print, read_frequency

   integer, parameter :: not_computed = 0   !! meaning of keys that only CalculiX has

   !> A key of a card.
   type :: print_key_type
      character(5) :: name = ''
      integer :: quantity = not_computed    !! print_displacement, ...
   end type print_key_type

   type(print_key_type), parameter :: node_keys(*) = [ &
      print_key_type('U', print_displacement), print_key_type('NT', print_temperature), &
      print_key_type('TS', print_temperature), print_key_type('RF', print_force), &
      print_key_type('RFL', print_heat), print_key_type('PN'), print_key_type('PS'), &
      print_key_type('PT'), print_key_type('PSF'), print_key_type('PTF'), print_key_type('TSF'), &
      print_key_type('TTF'), print_key_type('TT'), print_key_type('V'), print_key_type('VF'), &
      print_key_type('MF'), print_key_type('MACH'), print_key_type('CP'), &
      print_key_type('DEPF'), print_key_type('TURB')]
   type(print_key_type), parameter :: element_keys(*) = [ &
      print_key_type('S', print_stress), print_key_type('HFL', print_heat_flux), &
      print_key_type('COORD', print_position), print_key_type('SVF'), print_key_type('E'), &
      print_key_type('ME'), print_key_type('PEEQ'), print_key_type('CEEQ'), &
      print_key_type('ENER'), print_key_type('SDV'), print_key_type('HFLF'), &
      print_key_type('ELSE'), print_key_type('ELKE'), print_key_type('EVOL'), &
      print_key_type('EMAS'), print_key_type('EBHE'), print_key_type('CENT')]

contains

   !> Reads *NODE PRINT or *EL PRINT. The first card of its keyword in a step ends the tables of
   !> former steps.
   subroutine build_print(cards, card, is_first, context, mesh, report, requests)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      logical, intent(in) :: is_first                     !! first of its keyword in its step
      type(deck_context_type), intent(in) :: context      !! whether the sets are sound
      type(mesh_type), intent(in) :: mesh                 !! has the sets
      type(deck_report_type), intent(inout) :: report     !! receives errors
      type(print_request_type), allocatable, intent(inout) :: requests(:) !! receives the table
      type(print_request_type) :: request
      character(:), allocatable :: choice
      type(print_key_type), allocatable :: keys(:)
      integer :: i, j

      if (is_first .and. allocated(requests)) deallocate(requests)
      choice = 'NO'
      keys = element_keys
      if (card%name == 'NODE PRINT') then
         keys = node_keys
         if (names_set(card, 'NSET', mesh%node_sets, context)) call need_named(card, 'NSET', &
            'node set', mesh%node_sets, report, request%set)
         call check_dropped(card, context, mesh, report, request%set)
         call choose(card, 'TOTALS', 'YES/NO/ONLY', report, choice)
         request%each_node = choice /= 'ONLY'
         request%totals = choice /= 'NO'
         choice = 'NO'
      else if (names_set(card, 'ELSET', mesh%element_sets, context)) then
         call need_element_set(card, mesh%element_sets, report, request%set)
      end if
      call choose(card, 'GLOBAL', 'YES/NO', report, choice)
      request%local_axes = choice == 'NO'
      call read_frequency(card, report, request%frequency)
      allocate(request%quantities(0))
      do j = card%first_data, card%last_data
         do i = 1, size(cards%data(j)%fields)
            if (has_field(cards%data(j), i)) call take_quantity(card, cards%data(j), i, keys, &
               report, request%quantities)
         end do
      end do
      if (request%set > 0 .and. size(request%quantities) > 0) call append_request(requests, request)
   end subroutine build_print

   !> Whether a set is known, or must be: not where the cards of sets have errors.
   pure logical function names_set(card, parameter, sets, context)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: parameter
      type(set_type), intent(in) :: sets(:)
      type(deck_context_type), intent(in) :: context

      names_set = context%sets_sound .or. find_named(sets, parameter_text(card, parameter)) > 0
   end function names_set

   !> Warns of a node set of which ORDER=1 leaves no node: there is nothing to print.
   subroutine check_dropped(card, context, mesh, report, set)
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      integer, intent(inout) :: set   ! becomes 0 then

      if (set == 0) return
      associate (members => mesh%node_sets(set)%members)
         if (size(members) == 0) return
         if (.not. all(context%dropped(members))) return
      end associate
      call report%warning(parameter_place(card, 'NSET'), 'ORDER=1 leaves no node of '// &
         mesh%node_sets(set)%name//', because none is a corner: nothing is printed')
      set = 0
   end subroutine check_dropped

   !> One key: what is not computed is ignored with a warning, what nobody knows is an error.
   subroutine take_quantity(card, data, position, keys, report, quantities)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position
      type(print_key_type), intent(in) :: keys(:)
      type(deck_report_type), intent(inout) :: report
      integer, allocatable, intent(inout) :: quantities(:)
      type(string_type), allocatable :: known(:)
      character(:), allocatable :: key
      integer :: i

      key = to_upper(field_text(data, position))
      allocate(known(0))
      do i = 1, size(keys)
         if (keys(i)%quantity /= not_computed) call append(known, trim(keys(i)%name))
         if (keys(i)%name /= key) cycle
         if (keys(i)%quantity == not_computed) then
            call report%warning(field_place(data, position), key//' of *'//card%name// &
               ' is not computed: it is not printed')
         else if (.not. any(quantities == keys(i)%quantity)) then
            quantities = [quantities, keys(i)%quantity]
         end if
         return
      end do
      call report%error(field_place(data, position), 'unknown quantity '//key//' of *'// &
         card%name//known_choices(key, known))
   end subroutine take_quantity

   !> FREQUENCY=n, default 1.
   subroutine read_frequency(card, report, frequency)
      type(keyword_card_type), intent(in) :: card
      type(deck_report_type), intent(inout) :: report   !! receives errors
      integer, intent(out) :: frequency                 !! n, at least 0

      frequency = 1
      call take_from(0, card, 'FREQUENCY', report, frequency)
   end subroutine read_frequency

end module deck_builder_prints
