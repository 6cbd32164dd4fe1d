!> *GAP CONDUCTANCE: a table of conductance over the pressure, or over the clearance, at one mean
!> temperature of the faces or at several.
module deck_builder_gap_conductance
   use card_values, only: check_unneeded, decimal_comma, read_rows, report_decimal_comma
   use cards, only: data_card_type, keyword_card_type
   use conductance_laws, only: conductance_law_type, conductance_table_type, law_clearance, &
      law_none, law_pressure, line_value
   use deck_context, only: deck_type
   use kinds, only: dp
   use text, only: read_real, to_text
   implicit none
   private
   public :: build_gap_conductance, is_of_clearance
   public :: read_table, note_ends

contains

   !> Reads one *GAP CONDUCTANCE. With CLEARANCE it has the meaning that it has in Abaqus: beyond
   !> the last row no heat crosses. Without, it is for CalculiX, which knows no *GAP LAW, where one
   !> gives the closed side.
   subroutine build_gap_conductance(name, is_open, deck, law)
      character(*), intent(in) :: name                     !! name of the surface interaction
      logical, intent(in) :: is_open                       !! whether it is over the clearance
      type(deck_type), intent(inout) :: deck
      type(conductance_law_type), intent(inout) :: law     !! receives the open or the closed side
      type(conductance_table_type) :: table
      character(:), allocatable :: title
      integer :: errors

      errors = deck%error_count()
      title = '*GAP CONDUCTANCE'
      if (is_open) then
         title = '*GAP CONDUCTANCE, CLEARANCE'
         if (deck%card%has('PRESSURE')) call deck%error(deck%card%place_of('CLEARANCE'), &
            'PRESSURE and CLEARANCE exclude each other: both name the second column')
         if (law%open_kind /= law_none) call deck%error(deck%card%place, 'a second open law in '// &
            'one surface interaction')
      end if
      call read_table(trim(merge('gap     ', 'pressure', is_open)), deck, table)
      if (deck%error_count() == errors) call check_columns(name, is_open, table, deck)
      if (allocated(table%temperature)) call note_ends(title, name, 'mean temperatures', &
         table%temperature, deck)
      if (.not. is_open) then
         call note_ends(title, name, 'pressures', table%abscissa, deck)
         call deck%note('*GAP CONDUCTANCE: CalculiX switches NLGEOM on; here displacements and '// &
            'strains are small')
         if (law%closed_kind /= law_none) then
            call deck%note('*GAP CONDUCTANCE of '//name//' is ignored: the closed *GAP LAW '// &
               'takes precedence')
            return
         end if
      end if
      if (is_open) then
         law%open_kind = law_clearance
         law%open_ends = .true.
         law%open_table = table
      else
         law%closed_kind = law_pressure
         law%closed_table = table
      end if
   end subroutine build_gap_conductance

   !> Whether a table is over the clearance: it says so, or it is one of Abaqus, which has no
   !> parameter there. Without one it is over the pressure in CalculiX, but that of Abaqus if the
   !> interaction has another one that says PRESSURE, or if the conductance falls along its rows and
   !> rises nowhere, at each temperature.
   logical function is_of_clearance(card, has_pressure)
      type(keyword_card_type), intent(in) :: card
      logical, intent(in) :: has_pressure    !! whether a card of the interaction says PRESSURE
      real(dp) :: conductance(size(card%data))
      integer :: i
      logical :: falls, valid

      is_of_clearance = card%has('CLEARANCE')
      if (is_of_clearance .or. card%has('PRESSURE')) return
      falls = .false.
      do i = 1, size(card%data)
         call read_real(card%data(i)%text(1), conductance(i), valid)
         if (.not. valid) exit
         associate (before => max(i - 1, 1))
            if (card%data(i)%text(3) /= card%data(before)%text(3)) cycle
            valid = conductance(i) <= conductance(before)
            falls = falls .or. conductance(i) < conductance(before)
         end associate
         if (.not. valid) exit
      end do
      is_of_clearance = has_pressure .or. (falls .and. valid)
   end function is_of_clearance

   !> Warns of a table that conducts nothing, and of one without a parameter that is taken as one of
   !> clearance, or that may be meant so.
   subroutine check_columns(name, is_open, table, deck)
      character(*), intent(in) :: name
      logical, intent(in) :: is_open
      type(conductance_table_type), intent(in) :: table
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: words
      integer :: n

      if (all(table%columns <= 0.0_dp)) call deck%warning(deck%card%place, 'all conductances '// &
         'of this table of '//name//' are 0: it conducts no heat; the first column of *GAP '// &
         'CONDUCTANCE is the conductance')
      if (is_open .and. .not. deck%card%has('CLEARANCE')) call deck%warning(deck%card%place, &
         'the second column of this table of '//name//' is taken as the clearance, as in '// &
         'Abaqus; in CalculiX it is the pressure: write *GAP CONDUCTANCE, CLEARANCE, or '// &
         'PRESSURE if that is meant')
      if (is_open .or. deck%card%has('PRESSURE') .or. all(table%columns <= 0.0_dp)) return
      n = size(table%abscissa)
      associate (before => table%columns(:n - 1, :), behind => table%columns(2:, :))
         if (any(behind < before)) then
            words = ' falls along the table and rises elsewhere'
         else if (any(behind > before) .or. table%abscissa(n) <= 0.0_dp) then
            return   ! it rises, or is of faces that touch without pressure
         else
            words = ' is the same in all rows'
         end if
      end associate
      call deck%warning(deck%card%place, 'the conductance of '//name//words//'; its second '// &
         'column is taken as the pressure, as in CalculiX; in Abaqus it is the clearance: '// &
         'write *GAP CONDUCTANCE, PRESSURE, or CLEARANCE if that is meant')
   end subroutine check_columns

   !> Rows of conductance and what it belongs to. Those of a table with temperatures have one behind
   !> it and are in groups of one temperature.
   subroutine read_table(noun, deck, table)
      character(*), intent(in) :: noun                     !! what it belongs to, gap or pressure
      type(deck_type), intent(inout) :: deck
      type(conductance_table_type), intent(out) :: table
      character(:), allocatable :: layout
      real(dp), allocatable :: grid(:)
      real(dp) :: values(3, size(deck%card%data))
      integer :: i, k
      logical :: valid

      layout = 'conductance >=0/'//noun//' >=0'
      if (deck%card%name == 'GAP CONDUCTANCE') layout = layout//'/temperature?'
      call read_rows(deck%card%data, layout, deck, values, valid)
      table%omega = values(1, :)
      table%abscissa = values(2, :)
      associate (temperature => values(3, :))
         call check_temperatures(deck%card%data, temperature, deck, valid)
         do i = 2, size(temperature)
            ! A gap that is not known is 0.
            if (abs(temperature(i) - temperature(i - 1)) > 0.0_dp .or. .not. (valid .or. &
               table%abscissa(i) > 0.0_dp)) cycle
            if (table%abscissa(i) <= table%abscissa(i - 1)) call deck%error(deck%card%data( &
               i)%place(2), noun//'s must ascend')
         end do
         if (all(temperature <= temperature(1)) .or. .not. valid) then
            table%columns = reshape(table%omega, [size(table%omega), 1])
            return
         end if
         do i = 1, size(temperature)
            ! Between temperatures at which it ends at other gaps, a table would end at none.
            if (noun /= 'gap' .or. any(temperature(i + 1:) <= temperature(i))) cycle
            if (abs(table%abscissa(i) - maxval(table%abscissa, mask=temperature <= temperature( &
               1))) > 0.0_dp) call deck%error(deck%card%data(i)%place(2), 'the table ends at a '// &
               'different gap than at the first temperature; no heat crosses beyond the end, '// &
               'which must be the same at all temperatures')
         end do
         ! One column for each temperature, with the conductance at all gaps or pressures.
         grid = ascending(table%abscissa)
         table%temperature = ascending(temperature)
         allocate (table%columns(size(grid), size(table%temperature)))
         do k = 1, size(table%temperature)
            associate (here => abs(temperature - table%temperature(k)) <= 0.0_dp)
               table%columns(:, k) = [(line_value(pack(table%abscissa, here), &
                  pack(table%omega, here), grid(i)), i=1, size(grid))]
            end associate
         end do
         call move_alloc(grid, table%abscissa)
         table%omega = table%columns(:, 1)
      end associate
   end subroutine read_table

   !> Temperatures behind the rows of a table: one for all of them means nothing, several ascend.
   subroutine check_temperatures(rows, temperature, deck, valid)
      type(data_card_type), intent(in) :: rows(:)
      real(dp), intent(in) :: temperature(:)               ! (rows) 0 for none
      type(deck_type), intent(inout) :: deck
      logical, intent(inout) :: valid
      integer :: comma, i
      logical :: differ

      differ = any(abs(temperature - temperature(1)) > 0.0_dp)
      do i = 2, size(rows)
         if (differ .and. (rows(i)%has(3) .neqv. rows(i - 1)%has(3))) then
            comma = decimal_comma(rows(i))
            if (comma > 0 .and. size(rows(i)%fields) > size(rows(1)%fields)) then
               call report_decimal_comma(rows(i), comma, deck)
            else
               call deck%error(rows(i)%place(3), 'a temperature in some rows only; give one in '// &
                  'each row or in none')
            end if
         else if (temperature(i) < temperature(i - 1)) then
            call deck%error(rows(i)%place(3), 'temperatures must ascend, and the rows of each '// &
               'temperature must be consecutive')
         else
            cycle
         end if
         valid = .false.
         return
      end do
      if (differ .or. .not. valid) return
      call check_unneeded(rows(1), 3, 'a temperature', deck)
      if (any([(rows(i)%has(3), i=1, size(rows))])) call deck%note('*GAP CONDUCTANCE: the '// &
         'temperature, the same in every row, is ignored')
   end subroutine check_temperatures

   pure function ascending(values) result(sorted)
      real(dp), intent(in) :: values(:)
      real(dp), allocatable :: sorted(:)

      sorted = [minval(values)]
      do while (any(values > sorted(size(sorted))))
         sorted = [sorted, minval(values, mask=values > sorted(size(sorted)))]
      end do
   end function ascending

   !> Notes that a table holds its end values.
   subroutine note_ends(what, name, noun, abscissas, deck)
      character(*), intent(in) :: what                     !! the card
      character(*), intent(in) :: name                     !! name of the surface interaction
      character(*), intent(in) :: noun                     !! gaps, pressures or temperatures
      real(dp), intent(in) :: abscissas(:)                 !! (rows) ascending
      type(deck_type), intent(inout) :: deck

      call deck%note(what//' of '//name//': the table holds its end values outside the '//noun// &
         ' '//to_text(abscissas(1))//' to '//to_text(abscissas(size(abscissas))))
   end subroutine note_ends

end module deck_builder_gap_conductance
