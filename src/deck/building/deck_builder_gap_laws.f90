!> *GAP LAW -> one side of the conductance of a surface interaction, and the rows of its tables.
module deck_builder_gap_laws
   use card_parameters, only: choose, lacks_parameter
   use card_values, only: check_extra, need_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use conductance_laws, only: conductance_law_type, law_clearance, law_gas, law_none, law_power
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use text, only: largest_magnitude, to_text
   implicit none
   private
   public :: build_gap_law, read_table, note_ends

   !> Largest n of C0 + C1 p^n: laws that are measured have 1/2 to 2, and p^10 stays within the
   !> range of numbers for every pressure that a material bears.
   real(dp), parameter :: largest_exponent = 10.0_dp

contains

   !> Takes one *GAP LAW.
   subroutine build_gap_law(cards, card, name, context, report, law)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(conductance_law_type), intent(inout) :: law     !! receives one side
      character(:), allocatable :: kind

      kind = ''
      if (lacks_parameter(card, 'TYPE')) call report%error(card%place, '*GAP LAW needs TYPE=')
      call choose(card, 'TYPE', 'GAS/POWER/CLEARANCE', report, kind)
      if (kind == '') return
      if (kind == 'POWER' .and. law%closed_kind /= law_none) then
         call report%error(card%place, 'a second closed law in one surface interaction')
      else if (kind /= 'POWER' .and. law%open_kind /= law_none) then
         call report%error(card%place, 'a second open law in one surface interaction')
      end if
      if (kind == 'CLEARANCE') then
         law%open_kind = law_clearance
         call read_table(cards, card, 'gap', report, law%table_gap, law%open_omega)
         call note_ends('*GAP LAW, TYPE=CLEARANCE', name, 'gaps', law%table_gap, context)
         return
      end if
      if (card%last_data > card%first_data) call report%error( &
         field_place(cards%data(card%first_data + 1), 1), &
         'extra data card; *GAP LAW, TYPE='//kind//' has one')
      if (kind == 'GAS') then
         law%open_kind = law_gas
         call build_gas_law(cards%data(card%first_data), report, law)
      else
         law%closed_kind = law_power
         call build_power_law(cards%data(card%first_data), report, law)
      end if
   end subroutine build_gap_law

   !> omega = A/(B + gamma).
   subroutine build_gas_law(data, report, law)
      type(data_card_type), intent(in) :: data
      type(deck_report_type), intent(inout) :: report
      type(conductance_law_type), intent(inout) :: law
      logical :: valid(2)

      valid = .true.
      call need_field(data, 1, 'A', report, law%gas_a, valid(1))
      call need_field(data, 2, 'B', report, law%gas_b, valid(2))
      call check_extra(data, 2, 'A, B of A/(B + gap)', report)
      if (valid(1) .and. law%gas_a <= 0.0_dp) then
         call report%error(field_place(data, 1), 'A must be positive')
      end if
      if (valid(2) .and. law%gas_b <= 0.0_dp) then
         call report%error(field_place(data, 2), 'B must be positive')
         law%gas_b = 1.0_dp
      else if (all(valid) .and. law%gas_a > largest_magnitude*law%gas_b) then
         call report%error(field_place(data, 1), 'the conductance A/B of a gap of 0 exceeds '// &
            to_text(largest_magnitude))
      end if
   end subroutine build_gas_law

   !> omega = C0 + C1 p^n.
   subroutine build_power_law(data, report, law)
      type(data_card_type), intent(in) :: data
      type(deck_report_type), intent(inout) :: report
      type(conductance_law_type), intent(inout) :: law
      logical :: valid(3)

      valid = .true.
      call need_field(data, 1, 'C0', report, law%power_c0, valid(1))
      call need_field(data, 2, 'C1', report, law%power_c1, valid(2))
      call need_field(data, 3, 'n', report, law%power_n, valid(3))
      call check_extra(data, 3, 'C0, C1, n of C0 + C1 pressure^n', report)
      if (valid(1) .and. law%power_c0 < 0.0_dp) then
         call report%error(field_place(data, 1), 'C0 must not be negative')
      end if
      if (valid(2) .and. law%power_c1 < 0.0_dp) then
         call report%error(field_place(data, 2), 'C1 must not be negative')
      end if
      if (valid(3) .and. law%power_n <= 0.0_dp) then
         call report%error(field_place(data, 3), 'n must be positive')
         law%power_n = 1.0_dp
      else if (valid(3) .and. law%power_n > largest_exponent) then
         call report%error(field_place(data, 3), 'n must not exceed '//to_text(largest_exponent)// &
            '; for rough faces it is about 0.95')
         law%power_n = 1.0_dp
      end if
   end subroutine build_power_law

   !> Rows of conductance and what it belongs to; those of *GAP CONDUCTANCE may have a temperature
   !> behind it.
   subroutine read_table(cards, card, noun, report, abscissas, omega)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: noun                     !! what it belongs to, gap or pressure
      type(deck_report_type), intent(inout) :: report      !! receives errors
      real(dp), allocatable, intent(out) :: abscissas(:)   !! (rows) gap or pressure, ascending
      real(dp), allocatable, intent(out) :: omega(:)       !! (rows) conductance
      integer :: i, n
      logical :: valid(2), valid_before

      n = card%last_data - card%first_data + 1
      allocate (abscissas(n), omega(n), source=0.0_dp)
      valid_before = .false.
      do i = 1, n
         associate (data => cards%data(card%first_data + i - 1))
            valid = .true.
            call need_field(data, 1, 'conductance', report, omega(i), valid(1))
            call need_field(data, 2, noun, report, abscissas(i), valid(2))
            if (card%name == 'GAP CONDUCTANCE') then
               call check_extra(data, 3, 'conductance, '//noun//', temperature', report)
            else
               call check_extra(data, 2, 'conductance, '//noun, report)
            end if
            if (valid(1) .and. omega(i) < 0.0_dp) then
               call report%error(field_place(data, 1), 'the conductance must not be negative')
            end if
            if (valid(2) .and. abscissas(i) < 0.0_dp) then
               call report%error(field_place(data, 2), 'the '//noun//' must not be negative')
            else if (valid(2) .and. valid_before) then
               if (abscissas(i) <= abscissas(i - 1)) then
                  call report%error(field_place(data, 2), noun//'s must ascend')
               end if
            end if
            valid_before = valid(2)
         end associate
      end do
   end subroutine read_table

   !> Notes that a table holds its end values.
   subroutine note_ends(what, name, noun, abscissas, context)
      character(*), intent(in) :: what                     !! the card
      character(*), intent(in) :: name                     !! name of the surface interaction
      character(*), intent(in) :: noun                     !! gaps or pressures
      real(dp), intent(in) :: abscissas(:)                 !! (rows) gaps or pressures
      type(deck_context_type), intent(inout) :: context    !! receives the note

      call context%note(what//' of '//name//': the table holds its end values outside the '// &
         noun//' '//to_text(abscissas(1))//' to '//to_text(abscissas(size(abscissas))))
   end subroutine note_ends

end module deck_builder_gap_laws
