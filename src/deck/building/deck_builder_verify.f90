!> *VERIFY -> checks of the results, *ACCURACY -> targets of the uncertainties.
module deck_builder_verify
   use accuracy_targets, only: accuracy_target_type
   use card_values, only: needed_choice, take_parameter, check_extra, read_field, read_row
   use cards, only: data_card_type
   use equations, only: constrained_nodes, equation_nodes, section_nodes
   use deck_builder_steps, only: increment_rounding
   use deck_context, only: deck_type
   use deck_report, only: heatless
   use deck_source, only: place_type
   use deck_structure, only: cards_of, data_count
   use kinds, only: dp
   use load_requests, only: target_type
   use materials, only: reference_nodes
   use model, only: uncertainty_no, verify_type
   use quantity_types, only: find_quantity, needs_coupling, needs_heat, of_contact_points, &
      of_history, of_interface, of_nodes, of_references, of_sections, quantity_type
   use spelling, only: known_choices, nearest_known
   use steps, only: analysis_static
   use text, only: read_real, real_fault, string_type, to_text, to_upper
   implicit none
   private
   public :: build_verifications, check_heat_quantities, build_accuracy

contains

   !> Builds all checks: quantity, where, when, value, tolerance, REL|ABS.
   subroutine build_verifications(deck)
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: kind
      integer, allocatable :: places(:)
      type(place_type) :: fields(2)
      real(dp) :: values(6)
      integer :: k, j, n, quantity
      logical :: valid

      allocate(deck%model%verifications(data_count(deck%cards, cards_of(deck%cards, 'VERIFY'))))
      n = 0
      places = cards_of(deck%cards, 'VERIFY')
      do k = 1, size(places)
         call deck%open_card(places(k))
         kind = needed_choice(deck%card, 'KIND', &
            'ANALYTIC/EXTERNAL/LEGACY/FIGURE/REGRESSION/NONE', deck)
         do j = 1, size(deck%card%data)
            n = n + 1
            associate (data => deck%card%data(j), check => deck%model%verifications(n))
               check%kind = kind
               check%source = deck%card%text('SOURCE')
               check%line = data%end%image
               check%address = deck%source%paths(deck%source%file(check%line))%value//':'// &
                  to_text(deck%source%line(check%line))
               check%quantity = ''
               check%where = data%text(2)
               fields = [data%place(1), data%place(2)]
               check%columns = fields%column
               call read_quantity(data, deck%verifiable, '', deck, quantity, check%level)
               if (quantity > 0) then
                  check%quantity = trim(deck%verifiable(quantity)%name)
                  associate (known => deck%verifiable(quantity))
                     if (allocated(check%level) .and. (known%is_geometry .or. &
                        known%values > 1)) call deck%error(data%place(1), check%quantity// &
                        ' is not a single value that changes: it reaches nothing')
                     call check_where(data, known%kind, deck, check)
                  end associate
               end if
               if (deck%analyses_sound) call read_when(data, deck, check)
               check%expects = kind /= 'NONE'
               if (.not. check%expects) then
                  call check_extra(data, 3, 'quantity, where, when', deck)
                  cycle
               end if
               call read_row(data, '@quantity/@where/@when/value/tolerance >=0/@REL or ABS', deck, &
                  values, valid)
               check%value = values(4)
               check%tolerance = values(5)
               check%relative = is_relative(data, 6, deck)
               if (valid .and. check%relative .and. .not. abs(check%value) > &
                  0.0_dp) call deck%warning(data%place(4), 'relative to 0 only 0 itself '// &
                  'passes; give ABS')
            end associate
         end do
      end do
      if (deck%analyses_sound) call check_heat_quantities(deck)
   end subroutine build_verifications

   !> Reports quantities of heat in a deck none of whose steps solves heat.
   subroutine check_heat_quantities(deck)
      type(deck_type), intent(inout) :: deck
      integer :: i, quantity
      logical :: is_told

      if (size(deck%model%steps) == 0 .or. any(deck%model%steps%analysis /= analysis_static)) return
      do i = 1, size(deck%model%verifications)
         associate (check => deck%model%verifications(i))
            quantity = find_quantity(deck%verifiable, check%quantity)
            if (quantity == 0) cycle
            if (all(deck%verifiable(quantity)%needs /= [needs_heat, needs_coupling])) cycle
            call deck%confirm_cause(heatless, is_told)
            if (is_told) return
            call deck%error(place_type(check%line, check%columns(1)), 'no step of this deck '// &
               'solves heat: there is no '//check%quantity//'; take *COUPLED '// &
               'TEMPERATURE-DISPLACEMENT or *HEAT TRANSFER', 'quantities of heat')
            call deck%lose('heat')
         end associate
      end do
   end subroutine check_heat_quantities

   !> Whether a field is REL, which it is where it is missing, and not ABS.
   logical function is_relative(data, i, deck)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      type(deck_type), intent(inout) :: deck

      is_relative = any(to_upper(data%text(i)) == ['   ', 'REL'])
      if (is_relative .or. to_upper(data%text(i)) == 'ABS') return
      call deck%error(data%place(i), ''''//data%text(i)//''' is neither REL nor ABS')
   end function is_relative

   !> The first field: index into known quantities, 0 after an error; perhaps the value it reaches.
   subroutine read_quantity(data, known, refusal, deck, quantity, level)
      type(data_card_type), intent(in) :: data
      type(quantity_type), intent(in) :: known(:)
      character(*), intent(in) :: refusal   ! of others than these few; empty where they are many
      type(deck_type), intent(inout) :: deck
      integer, intent(out) :: quantity
      real(dp), allocatable, intent(out), optional :: level
      character(:), allocatable :: name, hint
      type(string_type) :: names(size(known))
      logical :: valid
      integer :: i

      valid = .true.
      quantity = 0
      call read_field(data, 1, 'quantity', deck, name, valid)
      if (.not. valid) return
      if (present(level)) call split_level(data, deck, name, level, valid)
      if (.not. valid) return
      quantity = find_quantity(known, name)
      if (quantity > 0) return
      do i = 1, size(names)
         names(i)%value = trim(known(i)%name)
      end do
      if (len(refusal) > 0) then
         call deck%error(data%place(1), refusal//known_choices(name, names))
         return
      end if
      hint = nearest_known(name, names)
      if (len(hint) == 0) hint = '; docs/deck/output.md lists those that are known'
      call deck%error(data%place(1), 'unknown quantity '//name//hint)
   end subroutine read_quantity

   !> Splits NT reaches 500. into the quantity and the value that it reaches.
   subroutine split_level(data, deck, name, level, valid)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      character(:), allocatable, intent(inout) :: name
      real(dp), allocatable, intent(inout) :: level
      logical, intent(inout) :: valid                   ! becomes false after an error
      character(*), parameter :: word = ' REACHES '
      type(place_type) :: place
      character(:), allocatable :: number
      integer :: at, first

      at = index(to_upper(name)//' ', word)
      if (at == 0) return
      first = min(at + len(word), len(name) + 1)
      first = first + max(verify(name(first:), ' '), 1) - 1
      number = trim(name(first:))
      allocate (level)
      call read_real(number, level, valid)
      place = data%place(1)
      if (.not. valid .and. number == '') then
         call deck%error(place, ''''//name//''': there is no value behind reaches, as in NT '// &
            'reaches 500.')
      else if (.not. valid) then
         place%column = place%column + first - 1
         call deck%error(place, ''''//number//''' '//real_fault(number))
      end if
      name = trim(name(:at))
   end subroutine split_level

   !> Checks where a quantity is judged; the only interface of a deck need not be named.
   subroutine check_where(data, kind, deck, check)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: kind
      type(deck_type), intent(inout) :: deck
      type(verify_type), intent(inout) :: check
      character(:), allocatable :: lack

      lack = ''
      select case (kind)
      case (of_interface, of_contact_points)
         if (size(deck%model%contacts) == 0) lack = 'CONTACT PAIR'
      case (of_sections)
         if (.not. any(deck%model%couplings%is_section())) lack = 'PRE-TENSION SECTION'
      case (of_references)
         if (.not. any(deck%model%sections%reference(1) > 0)) lack = 'SOLID SECTION with REF NODE='
      case default
         continue
      end select
      if (kind == of_history) then
         if (data%has(2)) call deck%error(data%place(2), check%quantity//' has no location: '// &
            'leave this field empty')
      else if (len(lack) > 0) then
         call deck%missing(data%place(1), 'the deck has no *'//lack//': there is no '// &
            check%quantity, merge('equation', '        ', kind == of_sections))
      else if (any(to_upper(check%where) == ['MIN', 'MAX'])) then
         return
      else if (any(kind == [of_nodes, of_sections, of_references])) then
         call check_nodes(data, kind, deck)
      else if (kind == of_interface .and. check%where == '' .and. size(deck%model%contacts) == 1) &
         then
         check%where = deck%model%contacts(1)%name
      else
         call check_interface(data, kind, deck)
      end if
   end subroutine check_where

   !> A node or a node set, one of whose nodes at least has values.
   subroutine check_nodes(data, kind, deck)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: kind
      type(deck_type), intent(inout) :: deck
      logical :: used(0:size(deck%mesh%node_number)), valid
      type(target_type) :: target
      integer, allocatable :: nodes(:)

      valid = .true.
      call deck%need_target('node', data, 2, target, valid)
      if (.not. valid) return
      used = .false.
      if (kind == of_sections) then
         used(section_nodes(deck%model%couplings)) = .true.
      else if (kind == of_references) then
         used(reference_nodes(deck%model%sections)) = .true.
      else
         used([deck%mesh%element_nodes]) = .true.
         used(1:) = used(1:) .or. constrained_nodes(deck%model%equations, deck%model%couplings, &
            size(used) - 1) .or. equation_nodes(deck%model%bars%elongation, size(used) - 1)
      end if
      nodes = target%members(deck%mesh%node_sets)
      nodes = pack(nodes, used(nodes))
      if (size(nodes) == 0 .and. kind /= of_nodes) then
         call deck%error(data%place(2), data%text(2)//' is not the reference node of a '// &
            trim(merge('*PRE-TENSION SECTION', '*SOLID SECTION      ', kind == of_sections)))
      else if (size(nodes) == 0) then
         if (all(deck%element_valid)) call deck%missing(data%place(2), 'no element has a node '// &
            'of '//data%text(2)//': it has no values', 'element')
      else if (all(deck%dropped(nodes))) then
         call deck%error(data%place(2), 'ORDER=1 leaves no node of '//data%text(2)//', because '// &
            'none is a corner: it has no values')
      end if
   end subroutine check_nodes

   !> name or, for a profile, name@s.
   subroutine check_interface(data, kind, deck)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: kind
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: name
      real(dp) :: s
      integer :: at
      logical :: valid

      valid = .true.
      call read_field(data, 2, 'contact pair', deck, name, valid)
      if (.not. valid) return
      at = index(name//'@', '@')
      if (at <= len(name)) then
         call read_real(trim(adjustl(name(at + 1:))), s, valid)
         if (valid) valid = s >= 0.0_dp
         if (kind /= of_contact_points .or. .not. valid) then
            call deck%error(data%place(2), ''''//name//''' is not a location of this quantity')
            return
         end if
      end if
      call deck%look_up('contact pair', trim(name(:at - 1)), data%place(2), at)
   end subroutine check_interface

   !> A total time that an increment meets, or LAST.
   subroutine read_when(data, deck, check)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      type(verify_type), intent(inout) :: check
      real(dp) :: start, rest
      integer :: s
      logical :: valid

      check%at_last = to_upper(data%text(3)) == 'LAST'
      if (check%at_last) return
      valid = .true.
      call read_field(data, 3, 'time or LAST', deck, check%when, valid)
      if (.not. valid .or. size(deck%model%steps) == 0) return
      start = 0.0_dp
      do s = 1, size(deck%model%steps)
         associate (step => deck%model%steps(s))
            rest = start + step%period - check%when
            if (rest >= -increment_rounding*step%first_increment) exit
            start = start + step%period
         end associate
      end do
      if (check%when <= 0.0_dp .or. s > size(deck%model%steps)) then
         call deck%error(data%place(3), 'no increment ends at this time; the steps end at '// &
            to_text(sum(deck%model%steps%period)))
      else if (deck%model%steps(s)%direct) then
         associate (n => (check%when - start)/deck%model%steps(s)%first_increment)
            if (abs(n - anint(n)) > increment_rounding .and. rest > &
               increment_rounding*deck%model%steps(s)%first_increment) then
               call deck%error(data%place(3), 'no increment of this DIRECT step ends at this time')
            end if
         end associate
      end if
   end subroutine read_when

   !> Reads the targets of all cards.
   subroutine build_accuracy(estimated, deck)
      type(quantity_type), intent(in) :: estimated(:)      !! quantities with an uncertainty
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: places(:)
      integer :: k, j

      places = cards_of(deck%cards, 'ACCURACY')
      do k = 1, size(places)
         call deck%open_card(places(k))
         if (k == 1) then
            allocate (deck%model%accuracy%targets(0))
            if (size(deck%model%contacts) == 0) call deck%missing(deck%card%place, 'the deck '// &
               'has no *CONTACT PAIR: there is no quantity that *ACCURACY could name')
            if (any(deck%model%steps%continuation%is_on) .or. &
               deck%model%uncertainty == uncertainty_no) call deck%error(deck%card%place, &
               '*ACCURACY needs numerical uncertainties, which *CONTINUATION and ERRORS=NO do '// &
               'not have')
         end if
         call take_parameter(deck%card, 'ROUNDS', deck, deck%model%accuracy%rounds, '>=1')
         do j = 1, size(deck%card%data)
            call build_target(deck%card%data(j), estimated, deck)
         end do
      end do
   end subroutine build_accuracy

   !> quantity, target, REL|ABS, interface.
   subroutine build_target(data, estimated, deck)
      type(data_card_type), intent(in) :: data
      type(quantity_type), intent(in) :: estimated(:)
      type(deck_type), intent(inout) :: deck
      type(accuracy_target_type) :: target
      real(dp) :: values(4)
      integer :: errors, i
      logical :: valid

      errors = deck%error_count()
      call read_quantity(data, estimated, 'no error of '//data%text(1)//' is estimated', deck, i)
      target%quantity = ''
      if (i > 0) target%quantity = trim(estimated(i)%name)
      call read_row(data, '@quantity/target >0/@REL or ABS/@contact pair', deck, values, valid)
      target%bound = values(2)
      target%is_relative = is_relative(data, 3, deck)
      if (target%is_relative .and. target%bound >= 1.0_dp) call deck%error(data%place(2), 'a '// &
         'target relative to the value must be below 1; 0.01 is 1 %')
      target%interface = 0
      if (data%has(4) .and. size(deck%model%contacts) > 0) call deck%look_up('contact pair', &
         data%text(4), data%place(4), target%interface)
      do i = 1, size(deck%model%accuracy%targets)
         associate (other => deck%model%accuracy%targets(i))
            if (other%quantity == target%quantity .and. any(target%interface == [0, &
               other%interface] .or. other%interface == 0)) call deck%error(data%place(1), 'an '// &
               'earlier card has a target of '//target%quantity//' already')
         end associate
      end do
      if (deck%error_count() == errors) deck%model%accuracy%targets = &
         [deck%model%accuracy%targets, target]
   end subroutine build_target

end module deck_builder_verify
