!> *GAP HEAT GENERATION -> the heat of friction of a surface interaction; *GAP RADIATION ->
!> radiation in its gap.
module deck_builder_gap_heat
   use card_parameters, only: take_parameter
   use card_values, only: check_ascending, read_row, read_rows
   use cards, only: keyword_card_type
   use conductance_laws, only: conductance_law_type, law_gas, law_none
   use deck_context, only: deck_type
   use element_kinds, only: axisymmetric
   use friction_laws, only: friction_heat_type, rough_coefficient
   use kinds, only: dp
   use steps, only: solves_heat, solves_mechanics
   use text, only: to_text
   implicit none
   private
   public :: build_friction_heat, build_gap_radiation, check_friction_heat

contains

   !> Reads one *GAP HEAT GENERATION.
   subroutine build_friction_heat(card, deck, heat)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck
      type(friction_heat_type), intent(out) :: heat
      real(dp) :: values(3)
      logical :: valid

      heat%efficiency = 1.0_dp
      if (size(card%data) > 0) then
         call read_row(card%data(1), 'eta (heat per work of friction)? >=0 <=1 =1/f (share of '// &
            'the slave)? >=0 <=1 =0.5/sliding speed? =-1', deck, values, valid)
         heat%efficiency = values(1)
         heat%slave_share = values(2)
         heat%speed = values(3)
         if (card%has('ANGULAR VELOCITY') .and. card%data(1)%has(3)) call deck%error( &
            card%data(1)%place(3), 'a sliding speed and ANGULAR VELOCITY= exclude each other; '// &
            'give one of them')
      end if
      if (.not. card%has('ANGULAR VELOCITY')) return
      if (any(deck%mesh%element_plane == axisymmetric)) then
         call take_parameter(card, 'ANGULAR VELOCITY', deck, heat%angular_velocity, '>0')
      else
         call deck%error(card%place_of('ANGULAR VELOCITY'), 'ANGULAR VELOCITY= needs '// &
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
         associate (card => deck%cards%keywords(k))
            if (card%name == 'SURFACE INTERACTION') n = n + 1
            if (card%name /= 'GAP HEAT GENERATION' .or. n == 0) cycle
            ! The largest coefficient that the interaction has in any step.
            largest = deck%model%interactions(n)%friction%coefficient
            do s = 1, size(deck%model%steps)
               if (.not. allocated(deck%model%steps(s)%changes%frictions)) cycle
               associate (changes => deck%model%steps(s)%changes%frictions)
                  largest = max(largest, maxval([0.0_dp, pack(changes%friction%coefficient, &
                     changes%interaction == n)]))
               end associate
            end do
            if (largest <= 0.0_dp) call deck%missing(card%place, 'interaction '// &
               deck%model%interactions(n)%name//' makes no heat of friction: it has no '// &
               '*FRICTION above 0', '*FRICTION')
            if (largest >= rough_coefficient) call deck%error(card%place, 'interaction '// &
               deck%model%interactions(n)%name//' is rough: its faces do not slip, so friction '// &
               'makes no heat; leave *GAP HEAT GENERATION out, or give a coefficient of friction')
            if (deck%model%interactions(n)%heat%leaves_plane()) cycle
            s = findloc(solves_heat(deck%model%steps%analysis) .and. &
               solves_mechanics(deck%model%steps%analysis) .and. .not. &
               deck%model%steps%is_transient, .true., dim=1)
            if (s > 0) call deck%warning(deck%analysis_place(s), 'step '//to_text(s)//' is '// &
               'steady, but friction makes heat by the rate of slip: the period of the step, '// &
               to_text(deck%model%steps(s)%period)//', counts as time')
         end associate
      end do
   end subroutine check_friction_heat

   !> Reads one *GAP RADIATION: emissivities of both faces, then view factors over the clearance, 1
   !> at all clearances where there are none.
   !> Two large grey faces exchange sigma/(1/e1 + 1/e2 - 1) (T1^4 - T2^4), times the view factor.
   subroutine build_gap_radiation(card, deck, law)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck
      type(conductance_law_type), intent(inout) :: law     !! receives radiation in the open gap
      real(dp) :: emissivity(2), values(2, max(size(card%data) - 1, 1))
      logical :: valid

      call read_row(card%data(1), 'emissivity >0 <=1 =1/emissivity >0 <=1 =1', deck, &
         emissivity, valid)
      values(1, :) = 1.0_dp
      values(2, :) = 0.0_dp
      associate (rows => card%data(2:), view_factor => values(1, :), gap => values(2, :))
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
         if (.not. deck%model%constants%has_radiation) call deck%error(card%place, '*GAP '// &
            'RADIATION needs *PHYSICAL CONSTANTS, ABSOLUTE ZERO=, STEFAN BOLTZMANN=')
         if (law%open_kind == law_none) law%open_kind = law_gas
         if (law%by_temperature%radiance > 0.0_dp) call deck%error(card%place, '*GAP RADIATION '// &
            'beside EMISSIVITY= of *GAP LAW: leave one of them out')
         law%by_temperature%radiance = deck%model%constants%stefan_boltzmann*maxval(view_factor)/( &
            1.0_dp/emissivity(1) + 1.0_dp/emissivity(2) - 1.0_dp)
         law%by_temperature%absolute_zero = deck%model%constants%absolute_zero
         if (minval(view_factor) >= maxval(view_factor)) return
         law%view_gap = gap
         law%view_factor = view_factor/maxval(view_factor)
      end associate
   end subroutine build_gap_radiation

end module deck_builder_gap_heat
