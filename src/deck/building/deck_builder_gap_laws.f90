!> *GAP LAW -> one side of the conductance of a surface interaction; *GAP RADIATION in its gap; *GAP
!> HEAT GENERATION -> its heat of friction.
module deck_builder_gap_laws
   use card_parameters, only: needed_choice, take_parameter
   use card_values, only: check_ascending, read_row, read_rows
   use cards, only: data_card_type
   use conductance_laws, only: conductance_law_type, law_clearance, law_gas, law_none, law_power
   use deck_builder_gap_conductance, only: note_ends, read_table
   use deck_context, only: deck_type
   use element_kinds, only: axisymmetric
   use friction_laws, only: friction_heat_type, rough_coefficient
   use kinds, only: dp
   use steps, only: solves_heat, solves_mechanics
   use text, only: largest_magnitude, to_text
   implicit none
   private
   public :: build_gap_law, build_friction_heat, build_gap_radiation, check_friction_heat

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
      real(dp) :: value(5), magnitude
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
      if (kind == 'CMY') then
         law%power_n = cmy_exponent
         magnitude = log(cmy_factor*harmonic_mean(value(1), value(2))) + log(value(3)) - &
            log(value(4)) - cmy_exponent*log(value(5))
      else
         law%power_n = 1.0_dp
         magnitude = log(harmonic_mean(value(1), value(2))) - 0.5_dp*log(value(3)) - &
            log(value(4)) - log(value(5))
      end if
      if (magnitude > log(largest_magnitude)) then
         call deck%error(data%place(1), 'the conductance at a pressure of 1 exceeds '// &
            to_text(largest_magnitude))
      else if (kind == 'CMY') then
         law%power_c1 = cmy_factor*harmonic_mean(value(1), value(2))*(value(3)/value(4))/ &
            value(5)**cmy_exponent
      else
         law%power_c1 = harmonic_mean(value(1), value(2))/(sqrt(value(3))*value(4)*value(5))
      end if
   end subroutine build_solid_spots

   pure real(dp) function harmonic_mean(one, other)
      real(dp), intent(in) :: one, other    ! > 0

      harmonic_mean = 2/(1/one + 1/other)
   end function harmonic_mean

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

end module deck_builder_gap_laws
