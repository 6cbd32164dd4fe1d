!> *GAP LAW, *GAP CONDUCTANCE and *GAP RADIATION -> the conductance of a surface interaction;
!> *GAP HEAT GENERATION -> its heat of friction.
module deck_builder_gap_laws
   use card_values, only: check_ascending, check_unneeded, decimal_comma, needed_choice, read_row, &
      read_rows, report_decimal_comma, take_parameter
   use cards, only: data_card_type, keyword_card_type
   use conductance_laws, only: conductance_law_type, conductance_table_type, law_clearance, &
      law_gas, law_none, law_power, law_pressure, line_value
   use deck_context, only: deck_type
   use element_kinds, only: axisymmetric
   use friction_laws, only: friction_heat_type, rough_coefficient
   use kinds, only: dp
   use steps, only: solves_heat, solves_mechanics
   use text, only: largest_magnitude, read_real, to_text
   implicit none
   private
   public :: build_gap_law, build_friction_heat, build_gap_radiation, check_friction_heat, &
      build_gap_conductance, is_of_clearance

   real(dp), parameter :: cmy_factor = 1.25_dp     !! of Cooper, Mikic and Yovanovich
   real(dp), parameter :: cmy_exponent = 0.95_dp   !! of pressure over hardness

   !> Largest n of C0 + C1 p^n: laws that are measured have 1/2 to 2, and p^10 stays within the
   !> range of numbers for every pressure that a material bears.
   real(dp), parameter :: largest_exponent = 10.0_dp

   !> Parameters of TYPE=GAS only.
   character(*), parameter :: of_gas(3) = [character(10) :: 'JUMP', 'ROUGHNESS', 'EMISSIVITY']

contains

   !> Reads one *GAP LAW.
   subroutine build_gap_law(name, deck, law)
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(deck_type), intent(inout) :: deck
      type(conductance_law_type), intent(inout) :: law     !! receives one side
      character(:), allocatable :: kind
      real(dp) :: values(3)
      integer :: i
      logical :: valid

      kind = needed_choice(deck%card, 'TYPE', 'GAS/POWER/CLEARANCE/CMY/ROSS-STOUTE', deck)
      if (kind == '') return
      if (any(kind == ['GAS      ', 'CLEARANCE'])) then
         if (law%open_kind /= law_none) call deck%error(deck%card%place, 'a second open law in '// &
            'one surface interaction')
      else if (law%closed_kind /= law_none) then
         call deck%error(deck%card%place, 'a second closed law in one surface interaction')
      end if
      if (kind == 'GAS') then
         law%open_kind = law_gas
         call build_gas_law(name, deck, law)
         return
      end if
      do i = 1, size(of_gas)
         if (deck%card%has(trim(of_gas(i)))) call deck%error(deck%card%place_of(trim(of_gas(i))), &
            trim(of_gas(i))//'= belongs to *GAP LAW, TYPE=GAS')
      end do
      if (kind == 'CLEARANCE') then
         law%open_kind = law_clearance
         call read_table('gap', deck, law%open_table)
         call note_ends('*GAP LAW, TYPE=CLEARANCE', name, 'gaps', law%open_table%abscissa, deck)
         return
      end if
      if (size(deck%card%data) > 1) call deck%error(deck%card%data(2)%place(1), 'extra data '// &
         'card; *GAP LAW, TYPE='//kind//' has one')
      law%closed_kind = law_power
      if (kind == 'POWER') then
         ! omega = C0 + C1 p^n.
         call read_row(deck%card%data(1), 'C0 >=0/C1 >=0/n >0', deck, values, valid)
         if (valid .and. values(3) > largest_exponent) call deck%error(deck%card%data(1)%place(3), &
            'n must not exceed '//to_text(largest_exponent)//'; for rough faces it is about 0.95')
         law%power_c0 = values(1)
         law%power_c1 = values(2)
         law%power_n = min(values(3), largest_exponent)
      else
         call build_solid_spots(deck%card%data(1), kind, deck, law)
      end if
   end subroutine build_gap_law

   !> Reads one data card. With ks = 2 k1 k2/(k1 + k2), CMY is 1.25 ks (m/sigma) (p/H)^0.95 and
   !> ROSS-STOUTE ks p/(a0 sqrt(R) H).
   subroutine build_solid_spots(data, kind, deck, law)
      type(data_card_type), intent(in) :: data
      character(*), intent(in) :: kind                     !! CMY or ROSS-STOUTE
      type(deck_type), intent(inout) :: deck
      type(conductance_law_type), intent(inout) :: law     !! receives the closed side
      real(dp) :: value(5), magnitude, mean   ! harmonic, of the conductivities
      logical :: valid

      if (kind == 'CMY') then
         call read_row(data, 'conductivity >0/conductivity >0/slope >0/roughness >0/hardness >0', &
            deck, value, valid)
      else
         call read_row(data, 'conductivity >0/conductivity >0/roughness >0/hardness >0/a0 >0', &
            deck, value, valid)
      end if
      law%closed_adds = .true.
      if (.not. valid) return
      mean = 2/(1/value(1) + 1/value(2))
      if (kind == 'CMY') then
         law%power_n = cmy_exponent
         magnitude = log(cmy_factor*mean) + log(value(3)) - log(value(4)) - &
            cmy_exponent*log(value(5))
      else
         law%power_n = 1.0_dp
         magnitude = log(mean) - 0.5_dp*log(value(3)) - log(value(4)) - log(value(5))
      end if
      if (magnitude > log(largest_magnitude)) then
         call deck%error(data%place(1), 'the conductance at a pressure of 1 exceeds '// &
            to_text(largest_magnitude))
      else if (kind == 'CMY') then
         law%power_c1 = cmy_factor*mean*(value(3)/value(4))/value(5)**cmy_exponent
      else
         law%power_c1 = mean/(sqrt(value(3))*value(4)*value(5))
      end if
   end subroutine build_solid_spots

   !> omega = A/(B + JUMP + ROUGHNESS + gamma) + radiation; A and B of one row, or of a row for each
   !> mean temperature of the faces. A is positive, or 0 where faces radiate.
   subroutine build_gas_law(name, deck, law)
      character(*), intent(in) :: name                     !! name of the surface interaction
      type(deck_type), intent(inout) :: deck
      type(conductance_law_type), intent(inout) :: law     !! receives the open side
      character(:), allocatable :: layout
      real(dp) :: added(2), emissivity, values(3, size(deck%card%data))
      integer :: i
      logical :: valid

      added = 0.0_dp
      call take_parameter(deck%card, 'JUMP', deck, added(1), '>=0')
      call take_parameter(deck%card, 'ROUGHNESS', deck, added(2), '>=0')
      law%added_length = sum(added)
      if (deck%card%has('EMISSIVITY')) then
         emissivity = 1.0_dp
         call take_parameter(deck%card, 'EMISSIVITY', deck, emissivity, '>0 <=1')
         if (.not. deck%model%constants%has_radiation) call deck%error(deck%card%place_of( &
            'EMISSIVITY'), 'EMISSIVITY= needs *PHYSICAL CONSTANTS, ABSOLUTE ZERO=, STEFAN '// &
            'BOLTZMANN=')
         law%by_temperature%radiance = emissivity*deck%model%constants%stefan_boltzmann
         law%by_temperature%absolute_zero = deck%model%constants%absolute_zero
      end if
      layout = 'A >0/B >=0'
      if (deck%card%has('EMISSIVITY')) layout = 'A >=0/B >=0'
      if (law%added_length > 0.0_dp) layout = layout(:index(layout, 'B'))//'? >=0'
      layout = layout//'/temperature'
      if (size(deck%card%data) == 1) layout = layout//'?'
      do i = 1, size(deck%card%data)
         call read_row(deck%card%data(i), layout, deck, values(:, i), valid)
         ! The conductance at gap 0 is a number.
         associate (least => values(2, i) + law%added_length)
            if (valid .and. least <= 0.0_dp) then
               call deck%error(deck%card%data(i)%place(2), 'B must be positive')
            else if (valid .and. values(1, i) > largest_magnitude*least) then
               call deck%error(deck%card%data(i)%place(1), &
                  'the conductance A/B at gap 0 exceeds '//to_text(largest_magnitude))
            end if
         end associate
         if (values(2, i) + law%added_length <= 0.0_dp) values(2, i) = 1.0_dp
      end do
      if (valid) call check_ascending(deck%card%data, 3, 'temperatures', values(3, :), deck)
      law%gas_a = values(1, 1)
      law%gas_b = values(2, 1)
      if (size(deck%card%data) == 1) return
      law%by_temperature%gas_temperature = values(3, :)
      law%by_temperature%gas_a = values(1, :)
      law%by_temperature%gas_b = values(2, :)
      call note_ends('*GAP LAW, TYPE=GAS', name, 'mean temperatures', values(3, :), deck)
   end subroutine build_gas_law

   !> Reads one *GAP HEAT GENERATION.
   subroutine build_friction_heat(deck, heat)
      type(deck_type), intent(inout) :: deck
      type(friction_heat_type), intent(out) :: heat
      real(dp) :: values(3)
      logical :: valid

      heat%efficiency = 1.0_dp
      if (size(deck%card%data) > 0) then
         call read_row(deck%card%data(1), 'eta (heat per work of friction)? >=0 <=1 =1/f '// &
            '(share of the slave)? >=0 <=1 =0.5/sliding speed? =-1', deck, values, valid)
         heat%efficiency = values(1)
         heat%slave_share = values(2)
         heat%speed = values(3)
         if (deck%card%has('ANGULAR VELOCITY') .and. deck%card%data(1)%has(3)) call deck%error( &
            deck%card%data(1)%place(3), 'a sliding speed and ANGULAR VELOCITY= exclude each '// &
            'other; give one of them')
      end if
      if (.not. deck%card%has('ANGULAR VELOCITY')) return
      if (any(deck%mesh%element_plane == axisymmetric)) then
         call take_parameter(deck%card, 'ANGULAR VELOCITY', deck, heat%angular_velocity, '>0')
      else
         call deck%error(deck%card%place_of('ANGULAR VELOCITY'), 'ANGULAR VELOCITY= needs '// &
            'axisymmetric elements, which turn about their axis; give a sliding speed')
      end if
   end subroutine build_friction_heat

   !> Heat of friction needs friction that allows slip, and time. Checked with all steps read.
   subroutine check_friction_heat(deck)
      type(deck_type), intent(inout) :: deck
      real(dp) :: largest
      integer :: k, n, s

      n = 0
      do k = 1, size(deck%cards%keywords)
         call deck%open_card(k)
         if (deck%card%name == 'SURFACE INTERACTION') n = n + 1
         if (deck%card%name /= 'GAP HEAT GENERATION' .or. n == 0) cycle
         ! The largest coefficient that the interaction has in any step.
         largest = deck%model%interactions(n)%friction%coefficient
         do s = 1, size(deck%model%steps)
            if (.not. allocated(deck%model%steps(s)%changes%frictions)) cycle
            associate (changes => deck%model%steps(s)%changes%frictions)
               largest = max(largest, maxval([0.0_dp, pack(changes%friction%coefficient, &
                  changes%interaction == n)]))
            end associate
         end do
         if (largest <= 0.0_dp) call deck%missing(deck%card%place, 'interaction '// &
            deck%model%interactions(n)%name//' makes no heat of friction: it has no *FRICTION '// &
            'above 0', '*FRICTION')
         if (largest >= rough_coefficient) call deck%error(deck%card%place, 'interaction '// &
            deck%model%interactions(n)%name//' is rough: its faces do not slip, so friction '// &
            'makes no heat; leave *GAP HEAT GENERATION out, or give a coefficient of friction')
         if (deck%model%interactions(n)%heat%leaves_plane()) cycle
         s = findloc(solves_heat(deck%model%steps%analysis) .and. solves_mechanics( &
            deck%model%steps%analysis) .and. .not. deck%model%steps%is_transient, .true., dim=1)
         if (s > 0) call deck%warning(deck%analysis_place(s), 'step '//to_text(s)//' is '// &
            'steady, but friction makes heat by the rate of slip: the period of the step, '// &
            to_text(deck%model%steps(s)%period)//', counts as time')
      end do
   end subroutine check_friction_heat

   !> Reads one *GAP RADIATION: emissivities of both faces, then view factors over the clearance, 1
   !> at all clearances where there are none.
   !> Two large grey faces exchange sigma/(1/e1 + 1/e2 - 1) (T1^4 - T2^4), times the view factor.
   subroutine build_gap_radiation(deck, law)
      type(deck_type), intent(inout) :: deck
      type(conductance_law_type), intent(inout) :: law     !! receives radiation in the open gap
      real(dp) :: emissivity(2), values(2, max(size(deck%card%data) - 1, 1))
      logical :: valid

      call read_row(deck%card%data(1), 'emissivity >0 <=1 =1/emissivity >0 <=1 =1', deck, &
         emissivity, valid)
      values(1, :) = 1.0_dp
      values(2, :) = 0.0_dp
      associate (rows => deck%card%data(2:), view_factor => values(1, :), gap => values(2, :))
         call read_rows(rows, 'view factor >=0 <=1 =1/clearance? >=0', deck, values, valid)
         if (valid) call check_ascending(rows, 2, 'clearances', gap, deck)
         if (maxval(view_factor) <= 0.0_dp) then
            call deck%error(rows(1)%place(1), 'all view factors are 0: the faces do not '// &
               'radiate; leave *GAP RADIATION out')
            view_factor = 1.0_dp
         end if
         if (size(rows) > 0 .and. view_factor(size(view_factor)) > 0.0_dp) call deck%note( &
            '*GAP RADIATION: faces radiate at all clearances, also beyond that of the last '// &
            'view factor')
         if (.not. deck%model%constants%has_radiation) call deck%error(deck%card%place, '*GAP '// &
            'RADIATION needs *PHYSICAL CONSTANTS, ABSOLUTE ZERO=, STEFAN BOLTZMANN=')
         if (law%open_kind == law_none) law%open_kind = law_gas
         if (law%by_temperature%radiance > 0.0_dp) call deck%error(deck%card%place, '*GAP '// &
            'RADIATION beside EMISSIVITY= of *GAP LAW: leave one of them out')
         law%by_temperature%radiance = deck%model%constants%stefan_boltzmann*maxval(view_factor)/( &
            1.0_dp/emissivity(1) + 1.0_dp/emissivity(2) - 1.0_dp)
         law%by_temperature%absolute_zero = deck%model%constants%absolute_zero
         if (minval(view_factor) >= maxval(view_factor)) return
         law%view_gap = gap
         law%view_factor = view_factor/maxval(view_factor)
      end associate
   end subroutine build_gap_radiation

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
            if (table%abscissa(i) <= table%abscissa(i - 1)) call deck%error( &
               deck%card%data(i)%place(2), noun//'s must ascend')
         end do
         if (all(temperature <= temperature(1)) .or. .not. valid) then
            table%columns = reshape(table%omega, [size(table%omega), 1])
            return
         end if
         do i = 1, size(temperature)
            ! Between temperatures at which it ends at other gaps, a table would end at none.
            if (noun /= 'gap' .or. any(temperature(i + 1:) <= temperature(i))) cycle
            if (abs(table%abscissa(i) - maxval(table%abscissa, mask=temperature <= &
               temperature(1))) > 0.0_dp) call deck%error(deck%card%data(i)%place(2), 'the '// &
               'table ends at a different gap than at the first temperature; no heat crosses '// &
               'beyond the end, which must be the same at all temperatures')
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

end module deck_builder_gap_laws
