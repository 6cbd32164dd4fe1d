!> *GAP LAW and *GAP CONDUCTANCE: the conductance of a surface interaction.
module deck_builder_gap_laws
   use card_parameters, only: choose, has_parameter
   use card_values, only: check_extra, field_place, has_field, need_field, take_field
   use cards, only: cards_type, data_card_type, keyword_card_type
   use conductance_laws, only: conductance_law_type, law_clearance, law_gas, law_none, law_power, &
      law_pressure
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use text, only: to_text
   implicit none
   private
   public :: build_gap_law, build_gap_conductance, join_gap_conductance

   !> Largest n of C0 + C1 p^n: laws that are measured have 1/2 to 2, and p^10 stays within the
   !> range of numbers for every pressure that a material bears.
   real(dp), parameter :: largest_exponent = 10.0_dp

contains

   !> Takes one *GAP LAW.
   subroutine build_gap_law(cards, card, name, context, report, law)
      type(cards_type), intent(in) :: cards                !! the cards
      type(keyword_card_type), intent(in) :: card          !! the card
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(conductance_law_type), intent(inout) :: law     !! receives one side
      character(:), allocatable :: kind

      kind = ''
      if (.not. has_parameter(card, 'TYPE')) call report%error(card%place, '*GAP LAW needs TYPE=')
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

   !> Takes one *GAP CONDUCTANCE into a law of its own: whether it holds is seen when all laws of
   !> the interaction are known.
   subroutine build_gap_conductance(cards, card, name, context, report, law)
      type(cards_type), intent(in) :: cards                !! the cards
      type(keyword_card_type), intent(in) :: card          !! the card
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(conductance_law_type), intent(inout) :: law     !! receives the closed side

      if (law%closed_kind /= law_none) then
         call report%error(card%place, 'a second *GAP CONDUCTANCE in one surface interaction')
      end if
      law%closed_kind = law_pressure
      call read_table(cards, card, 'pressure', report, law%table_pressure, law%closed_omega)
      call check_temperatures(cards%data(card%first_data:card%last_data), context, report)
      call note_ends('*GAP CONDUCTANCE', name, 'pressures', law%table_pressure, context)
      call context%note('*GAP CONDUCTANCE: CalculiX switches NLGEOM on; here displacements and '// &
         'strains are small')
   end subroutine build_gap_conductance

   !> Gives a law the closed side of *GAP CONDUCTANCE, unless *GAP LAW gives it another: then the
   !> table is for CalculiX, which knows no *GAP LAW.
   subroutine join_gap_conductance(table, name, context, law)
      type(conductance_law_type), intent(in) :: table      !! what build_gap_conductance made
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(conductance_law_type), intent(inout) :: law     !! receives the closed side

      if (table%closed_kind == law_none) return
      if (law%closed_kind /= law_none) then
         call context%note('*GAP CONDUCTANCE of '//name// &
            ' is left to CalculiX: *GAP LAW, TYPE=POWER holds')
         return
      end if
      law%closed_kind = table%closed_kind
      law%table_pressure = table%table_pressure
      law%closed_omega = table%closed_omega
   end subroutine join_gap_conductance

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

   !> Rows of conductance and what it belongs to; a table over the pressure may have a temperature
   !> behind it.
   subroutine read_table(cards, card, noun, report, abscissas, omega)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: noun
      type(deck_report_type), intent(inout) :: report
      real(dp), allocatable, intent(out) :: abscissas(:), omega(:)
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
            if (noun == 'pressure') then
               call check_extra(data, 3, 'conductance, pressure, temperature', report)
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

   !> Temperatures behind the rows: one for all of them means nothing.
   subroutine check_temperatures(rows, context, report)
      type(data_card_type), intent(in) :: rows(:)
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      real(dp) :: first, temperature
      integer :: i
      logical :: valid

      valid = .true.
      do i = 1, size(rows)
         temperature = 0.0_dp
         call take_field(rows(i), 3, 'temperature', report, temperature, valid)
         if (has_field(rows(i), 3)) call context%note('*GAP CONDUCTANCE: the temperature, the '// &
            'same in every row, is read and not needed')
         if (i == 1) first = temperature
         if (.not. valid .or. abs(temperature - first) <= 0.0_dp) cycle
         call report%error(field_place(rows(i), 3), &
            'another temperature than in the first row: properties that vary with temperature '// &
            'are refused')
         return
      end do
   end subroutine check_temperatures

   subroutine note_ends(what, name, noun, abscissas, context)
      character(*), intent(in) :: what, name, noun
      real(dp), intent(in) :: abscissas(:)
      type(deck_context_type), intent(inout) :: context

      call context%note(what//' of '//name//': the table holds its end values outside the '// &
         noun//' '//to_text(abscissas(1))//' to '//to_text(abscissas(size(abscissas))))
   end subroutine note_ends

end module deck_builder_gap_laws
