!> *GAP LAW, TYPE=GAS: conduction through the gas of a gap and radiation between its faces.
module deck_builder_gas_laws
   use card_parameters, only: has_parameter, parameter_place, take_parameter
   use card_values, only: check_extra, need_field, take_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use conductance_laws, only: conductance_law_type
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use gap_tables, only: note_ends
   use kinds, only: dp
   use model, only: physical_constants_type
   use text, only: largest_magnitude, to_text
   implicit none
   private
   public :: build_gas_law

contains

   !> omega = A/(B + JUMP + ROUGHNESS + gamma) + radiation; A and B of one row, or of a row for each
   !> mean temperature of the faces.
   subroutine build_gas_law(cards, card, name, constants, context, report, law)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(physical_constants_type), intent(in) :: constants
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(conductance_law_type), intent(inout) :: law     !! receives the open side
      real(dp), allocatable :: a(:), b(:), temperature(:)
      integer :: i, n

      law%added_length = length_of(card, 'JUMP', report) + length_of(card, 'ROUGHNESS', report)
      call take_emissivity(card, constants, report, law)
      n = card%last_data - card%first_data + 1
      allocate (a(n), b(n), temperature(n))
      do i = 1, n
         call read_row(i, a(i), b(i), temperature(i))
      end do
      law%gas_a = a(1)
      law%gas_b = b(1)
      if (n == 1) return
      if (.not. allocated(law%by_temperature)) allocate (law%by_temperature)
      law%by_temperature%gas_temperature = temperature
      law%by_temperature%gas_a = a
      law%by_temperature%gas_b = b
      call note_ends('*GAP LAW, TYPE=GAS', name, 'mean temperatures', temperature, context)
   contains
      !> One row, with values that are sound where those of the deck are not.
      subroutine read_row(i, a, b, at)
         integer, intent(in) :: i
         real(dp), intent(out) :: a, b, at
         logical :: valid(3)

         a = 0.0_dp
         b = 0.0_dp
         at = 0.0_dp
         valid = .true.
         associate (data => cards%data(card%first_data + i - 1))
            call need_field(data, 1, 'A', report, a, valid(1))
            if (law%added_length > 0.0_dp) then
               call take_field(data, 2, 'B', report, b, valid(2))
            else
               call need_field(data, 2, 'B', report, b, valid(2))
            end if
            if (n > 1) call need_field(data, 3, 'temperature', report, at, valid(3))
            if (n == 1) call take_field(data, 3, 'temperature', report, at, valid(3))
            call check_extra(data, 3, 'A, B of A/(B + gap), temperature', report)
            call check_values(data, a, b, law%added_length, has_parameter(card, 'EMISSIVITY'), &
               valid(:2), report)
            if (.not. all(valid(2:)) .or. b + law%added_length <= 0.0_dp) b = 1.0_dp
            if (i == 1 .or. .not. valid(3)) return
            if (at <= temperature(i - 1)) call report%error(field_place(data, 3), &
               'temperatures must ascend')
         end associate
      end subroutine read_row
   end subroutine build_gas_law

   !> A is positive, or 0 where faces radiate; B with the lengths that add to it is positive.
   subroutine check_values(data, a, b, added, radiates, valid, report)
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: a, b
      real(dp), intent(in) :: added       ! to B [length]
      logical, intent(in) :: radiates
      logical, intent(in) :: valid(2)     ! whether A and B were read
      type(deck_report_type), intent(inout) :: report

      if (valid(1) .and. a < 0.0_dp .and. radiates) then
         call report%error(field_place(data, 1), 'A must not be negative')
      else if (valid(1) .and. a <= 0.0_dp .and. .not. radiates) then
         call report%error(field_place(data, 1), 'A must be positive')
      end if
      if (valid(2) .and. b < 0.0_dp) then
         call report%error(field_place(data, 2), 'B must not be negative')
      else if (valid(2) .and. b + added <= 0.0_dp) then
         call report%error(field_place(data, 2), 'B must be positive')
      else if (all(valid) .and. a > largest_magnitude*(b + added)) then
         call report%error(field_place(data, 1), 'the conductance A/B at gap 0 exceeds '// &
            to_text(largest_magnitude))
      end if
   end subroutine check_values

   !> A length that adds to B.
   function length_of(card, name, report) result(length)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name
      type(deck_report_type), intent(inout) :: report
      real(dp) :: length

      length = 0.0_dp
      call take_parameter(card, name, report, length)
      if (length >= 0.0_dp) return
      call report%error(parameter_place(card, name), name//'= must not be negative')
      length = 0.0_dp
   end function length_of

   !> sigma eps of the radiation between the faces.
   subroutine take_emissivity(card, constants, report, law)
      type(keyword_card_type), intent(in) :: card
      type(physical_constants_type), intent(in) :: constants
      type(deck_report_type), intent(inout) :: report
      type(conductance_law_type), intent(inout) :: law
      real(dp) :: emissivity

      if (.not. has_parameter(card, 'EMISSIVITY')) return
      emissivity = 1.0_dp
      call take_parameter(card, 'EMISSIVITY', report, emissivity)
      if (emissivity <= 0.0_dp .or. emissivity > 1.0_dp) call report%error( &
         parameter_place(card, 'EMISSIVITY'), 'EMISSIVITY= must be above 0 and at most 1')
      if (.not. constants%has_radiation) call report%error(parameter_place(card, 'EMISSIVITY'), &
         'EMISSIVITY= needs *PHYSICAL CONSTANTS, ABSOLUTE ZERO=, STEFAN BOLTZMANN=')
      if (.not. allocated(law%by_temperature)) allocate (law%by_temperature)
      law%by_temperature%radiance = max(emissivity, 0.0_dp)*constants%stefan_boltzmann
      law%by_temperature%absolute_zero = constants%absolute_zero
   end subroutine take_emissivity

end module deck_builder_gas_laws
