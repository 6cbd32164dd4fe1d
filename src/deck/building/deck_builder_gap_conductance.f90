!> *GAP CONDUCTANCE: a table of conductance over the pressure, or over the clearance.
module deck_builder_gap_conductance
   use card_parameters, only: has_parameter, parameter_place
   use card_values, only: need_field
   use cards, only: cards_type, field_place, keyword_card_type
   use conductance_laws, only: conductance_law_type, law_clearance, law_none, law_pressure
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use gap_tables, only: gap_table_type, note_ends, read_table, read_temperatures
   use kinds, only: dp
   implicit none
   private
   public :: build_gap_clearance, build_gap_conductance, join_gap_conductance

contains

   !> Takes one *GAP CONDUCTANCE, CLEARANCE, which has the meaning that it has in Abaqus: beyond the
   !> last row no heat crosses.
   subroutine build_gap_clearance(cards, card, name, context, report, law)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(conductance_law_type), intent(inout) :: law     !! receives the open side
      type(gap_table_type) :: table
      real(dp), allocatable :: temperature(:)
      integer :: errors

      errors = report%error_count()
      if (has_parameter(card, 'PRESSURE')) call report%error(parameter_place(card, 'CLEARANCE'), &
         'PRESSURE and CLEARANCE exclude each other: both name the second column')
      if (law%open_kind /= law_none) then
         call report%error(card%place, 'a second open law in one surface interaction')
      end if
      law%open_kind = law_clearance
      law%open_ends = .true.
      call read_temperatures(cards, card, context, report, temperature)
      call read_table(cards, card, 'gap', temperature, report, table)
      if (report%error_count() == errors) call check_zero(card, name, table, report)
      if (allocated(table%temperature)) then
         if (report%error_count() == errors) call check_last_gaps(cards, card, temperature, report)
         if (.not. allocated(law%by_temperature)) allocate (law%by_temperature)
         call note_ends('*GAP CONDUCTANCE, CLEARANCE', name, 'mean temperatures', &
            table%temperature, context)
         call move_alloc(table%temperature, law%by_temperature%open_temperature)
         call move_alloc(table%columns, law%by_temperature%open_columns)
      end if
      call move_alloc(table%abscissa, law%table_gap)
      call move_alloc(table%omega, law%open_omega)
   end subroutine build_gap_clearance

   !> Refuses a table that ends at other gaps at other temperatures: between them it would end at
   !> none.
   subroutine check_last_gaps(cards, card, temperature, report)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      real(dp), intent(in) :: temperature(:)
      type(deck_report_type), intent(inout) :: report
      real(dp) :: first, gap
      integer :: i, n
      logical :: valid

      n = size(temperature)
      valid = .true.
      do i = 1, n
         if (i < n) then
            if (temperature(i + 1) <= temperature(i)) cycle
         end if
         associate (data => cards%data(card%first_data + i - 1))
            call need_field(data, 2, 'gap', report, gap, valid)
            if (temperature(i) <= temperature(1)) first = gap
            if (abs(gap - first) > 0.0_dp) call report%error(field_place(data, 2), &
               'the table ends at a different gap than at the first temperature; no heat '// &
               'crosses beyond the end, which must be the same at all temperatures')
         end associate
      end do
   end subroutine check_last_gaps

   !> Takes one *GAP CONDUCTANCE into a law of its own: whether it holds is seen when all laws of
   !> the interaction are known.
   subroutine build_gap_conductance(cards, card, name, context, report, law)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(conductance_law_type), intent(inout) :: law     !! receives the closed side
      type(gap_table_type) :: table
      real(dp), allocatable :: temperature(:)
      integer :: errors

      errors = report%error_count()
      if (law%closed_kind /= law_none) then
         call report%error(card%place, 'a second *GAP CONDUCTANCE in one surface interaction')
      end if
      law%closed_kind = law_pressure
      call read_temperatures(cards, card, context, report, temperature)
      call read_table(cards, card, 'pressure', temperature, report, table)
      if (report%error_count() == errors) call check_zero(card, name, table, report)
      if (allocated(table%temperature)) then
         call note_ends('*GAP CONDUCTANCE', name, 'mean temperatures', table%temperature, context)
         if (.not. allocated(law%by_temperature)) allocate (law%by_temperature)
         call move_alloc(table%temperature, law%by_temperature%closed_temperature)
         call move_alloc(table%columns, law%by_temperature%closed_columns)
      end if
      call move_alloc(table%abscissa, law%table_pressure)
      call move_alloc(table%omega, law%closed_omega)
      if (report%error_count() == errors .and. .not. has_parameter(card, 'PRESSURE')) then
         call check_rise(card, name, law, report)
      end if
      call note_ends('*GAP CONDUCTANCE', name, 'pressures', law%table_pressure, context)
      call context%note('*GAP CONDUCTANCE: CalculiX switches NLGEOM on; here displacements and '// &
         'strains are small')
   end subroutine build_gap_conductance

   !> Warns of a table that conducts nothing.
   subroutine check_zero(card, name, table, report)
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: name
      type(gap_table_type), intent(in) :: table
      type(deck_report_type), intent(inout) :: report

      if (allocated(table%columns)) then
         if (any(table%columns > 0.0_dp)) return
      else if (any(table%omega > 0.0_dp)) then
         return
      end if
      call report%warning(card%place, 'all conductances of this table of '//name//' are 0: it '// &
         'conducts no heat; the first column of *GAP CONDUCTANCE is the conductance')
   end subroutine check_zero

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
            ' is ignored: the closed *GAP LAW takes precedence')
         return
      end if
      law%closed_kind = table%closed_kind
      law%table_pressure = table%table_pressure
      law%closed_omega = table%closed_omega
      if (.not. allocated(table%by_temperature)) return
      if (.not. allocated(law%by_temperature)) allocate (law%by_temperature)
      law%by_temperature%closed_temperature = table%by_temperature%closed_temperature
      law%by_temperature%closed_columns = table%by_temperature%closed_columns
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
      if (allocated(law%by_temperature)) then
         associate (columns => law%by_temperature%closed_columns)
            if (all(columns(2:, :) >= columns(:n - 1, :))) return
         end associate
      else if (all(law%closed_omega(2:) >= law%closed_omega(:n - 1))) then
         return
      end if
      call report%warning(card%place, 'the conductance of '//name//' falls along the table, '// &
         'whose second column is the pressure, as in CalculiX; in Abaqus it is the clearance: '// &
         'write *GAP CONDUCTANCE, CLEARANCE if that is meant, else PRESSURE')
   end subroutine check_rise

end module deck_builder_gap_conductance
