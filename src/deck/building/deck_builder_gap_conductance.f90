!> *GAP CONDUCTANCE: a table of conductance over the pressure, or over the clearance.
module deck_builder_gap_conductance
   use card_parameters, only: has_parameter, parameter_place
   use card_values, only: take_field
   use cards, only: cards_type, data_card_type, field_place, has_field, keyword_card_type
   use conductance_laws, only: conductance_law_type, law_clearance, law_none, law_pressure
   use decimal_commas, only: check_unneeded_temperature, decimal_comma, &
      report_decimal_comma
   use deck_builder_gap_laws, only: note_ends, read_table
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   implicit none
   private
   public :: build_gap_clearance, build_gap_conductance, join_gap_conductance

contains

   !> Takes one *GAP CONDUCTANCE, CLEARANCE, which has the meaning that it has in Abaqus: beyond the
   !> last row no heat crosses.
   subroutine build_gap_clearance(cards, card, context, report, law)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(conductance_law_type), intent(inout) :: law     !! receives the open side

      if (has_parameter(card, 'PRESSURE')) call report%error(parameter_place(card, 'CLEARANCE'), &
         'PRESSURE and CLEARANCE on one card: its second column is one of them')
      if (law%open_kind /= law_none) then
         call report%error(card%place, 'a second open law in one surface interaction')
      end if
      law%open_kind = law_clearance
      law%open_ends = .true.
      call read_table(cards, card, 'gap', report, law%table_gap, law%open_omega)
      call check_temperatures(cards%data(card%first_data:card%last_data), context, report)
   end subroutine build_gap_clearance

   !> Takes one *GAP CONDUCTANCE into a law of its own: whether it holds is seen when all laws of
   !> the interaction are known.
   subroutine build_gap_conductance(cards, card, name, context, report, law)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(conductance_law_type), intent(inout) :: law     !! receives the closed side

      integer :: errors

      errors = report%error_count()
      if (law%closed_kind /= law_none) then
         call report%error(card%place, 'a second *GAP CONDUCTANCE in one surface interaction')
      end if
      law%closed_kind = law_pressure
      call read_table(cards, card, 'pressure', report, law%table_pressure, law%closed_omega)
      call check_temperatures(cards%data(card%first_data:card%last_data), context, report)
      if (report%error_count() == errors .and. .not. has_parameter(card, 'PRESSURE')) then
         call check_rise(card, name, law, report)
      end if
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

   !> Warns of a conductance that falls along a table of which the deck does not say that it is one
   !> of pressure: it may be one of Abaqus, where it is one of clearance.
   subroutine check_rise(card, name, law, report)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name
      type(conductance_law_type), intent(in) :: law
      type(deck_report_type), intent(inout) :: report
      integer :: n

      n = size(law%closed_omega)
      if (all(law%closed_omega(2:) >= law%closed_omega(:n - 1))) return
      call report%warning(card%place, 'the conductance of '//name//' falls along the table, '// &
         'whose second column is the pressure, as in CalculiX; in Abaqus it is the clearance: '// &
         'write *GAP CONDUCTANCE, CLEARANCE if that is meant, else PRESSURE')
   end subroutine check_rise

   !> Temperatures behind the rows: one for all of them means nothing.
   subroutine check_temperatures(rows, context, report)
      type(data_card_type), intent(in) :: rows(:)
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      real(dp) :: first, temperature
      integer :: comma, i
      logical :: valid

      valid = .true.
      do i = 1, size(rows)
         temperature = 0.0_dp
         call take_field(rows(i), 3, 'temperature', report, temperature, valid)
         if (has_field(rows(i), 3)) call context%note('*GAP CONDUCTANCE: the temperature, the '// &
            'same in every row, is read and not needed')
         if (i == 1) first = temperature
         if (i == 1 .and. valid) call check_unneeded_temperature(rows(i), 3, report)
         if (.not. valid .or. abs(temperature - first) <= 0.0_dp) cycle
         comma = decimal_comma(rows(i))
         if (comma > 0 .and. size(rows(i)%fields) > size(rows(1)%fields)) then
            call report_decimal_comma(rows(i), comma, report)
            return
         end if
         call report%error(field_place(rows(i), 3), &
            'another temperature than in the first row: properties that vary with temperature '// &
            'are refused')
         return
      end do
   end subroutine check_temperatures

end module deck_builder_gap_conductance
