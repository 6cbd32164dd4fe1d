!> *GAP HEAT GENERATION -> the heat of friction of a surface interaction; *GAP RADIATION ->
!> radiation in its gap.
module deck_builder_gap_heat
   use card_parameters, only: has_parameter, parameter_place, take_positive
   use card_values, only: check_extra, need_field, take_field
   use cards, only: cards_type, data_card_type, field_place, has_field, keyword_card_type
   use conductance_laws, only: conductance_law_type, law_clearance, law_gas, law_none
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use element_kinds, only: axisymmetric
   use friction_laws, only: friction_heat_type, rough_coefficient
   use kinds, only: dp
   use model, only: model_type, physical_constants_type
   use steps, only: solves_heat, solves_mechanics
   use text, only: to_text
   implicit none
   private
   public :: build_friction_heat, build_gap_radiation, check_friction_heat

contains

   !> Reads one *GAP HEAT GENERATION.
   subroutine build_friction_heat(cards, card, model, report, heat)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model                !! with its mesh
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(friction_heat_type), intent(out) :: heat
      logical :: valid

      heat%efficiency = 1.0_dp
      if (card%last_data >= card%first_data) then
         associate (data => cards%data(card%first_data))
            call take_part(data, 1, 'eta (heat per work of friction)', report, heat%efficiency)
            call take_part(data, 2, 'f (share of the slave)', report, heat%slave_share)
            valid = .true.
            call take_field(data, 3, 'sliding speed', report, heat%speed, valid)
            call check_extra(data, 3, 'eta, f, sliding speed', report)
            if (has_parameter(card, 'ANGULAR VELOCITY') .and. has_field(data, 3)) call &
               report%error(field_place(data, 3), 'a sliding speed and ANGULAR VELOCITY= '// &
               'exclude each other; give one of them')
         end associate
      end if
      if (.not. has_parameter(card, 'ANGULAR VELOCITY')) return
      if (any(model%mesh%element_plane == axisymmetric)) then
         call take_positive(card, 'ANGULAR VELOCITY', report, heat%angular_velocity)
      else
         call report%error(parameter_place(card, 'ANGULAR VELOCITY'), 'ANGULAR VELOCITY= needs '// &
            'axisymmetric elements, which turn about their axis; give a sliding speed')
      end if
   end subroutine build_friction_heat

   !> A part of a whole.
   subroutine take_part(data, i, what, report, part)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: i
      character(*), intent(in) :: what
      type(deck_report_type), intent(inout) :: report
      real(dp), intent(inout) :: part
      logical :: valid

      valid = .true.
      call take_field(data, i, what, report, part, valid)
      if (part >= 0.0_dp .and. part <= 1.0_dp) return
      call report%error(field_place(data, i), what//' must be between 0 and 1')
      part = 1.0_dp
   end subroutine take_part

   !> Heat of friction needs friction that allows slip, and time. Checked with all steps read.
   subroutine check_friction_heat(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report      !! receives errors and warnings
      real(dp) :: largest
      integer :: k, n, s

      n = 0
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (card%name == 'SURFACE INTERACTION') n = n + 1
            if (card%name /= 'GAP HEAT GENERATION' .or. n == 0) cycle
            largest = largest_friction(model, n)
            if (largest <= 0.0_dp) call report%missing(card%place, 'interaction '// &
               model%interactions(n)%name//' makes no heat of friction: it has no *FRICTION '// &
               'above 0', '*FRICTION')
            if (largest >= rough_coefficient) call report%error(card%place, 'interaction '// &
               model%interactions(n)%name//' is rough: its faces do not slip, so friction '// &
               'makes no heat; leave *GAP HEAT GENERATION out, or give a coefficient of friction')
            if (model%interactions(n)%heat%leaves_plane()) cycle
            s = findloc(solves_heat(model%steps%analysis) .and. solves_mechanics( &
               model%steps%analysis) .and. .not. model%steps%is_transient, .true., dim=1)
            if (s > 0) call report%warning(context%analysis_place(s), 'step '//to_text(s)// &
               ' is steady, but friction makes heat by the rate of slip: the period of the '// &
               'step, '//to_text(model%steps(s)%period)//', counts as time')
         end associate
      end do
   end subroutine check_friction_heat

   !> Largest coefficient of friction that an interaction has in any step.
   pure real(dp) function largest_friction(model, interaction) result(largest)
      type(model_type), intent(in) :: model
      integer, intent(in) :: interaction
      integer :: i, s

      largest = model%interactions(interaction)%friction%coefficient
      do s = 1, size(model%steps)
         if (.not. allocated(model%steps(s)%changes%frictions)) cycle
         do i = 1, size(model%steps(s)%changes%frictions)
            associate (change => model%steps(s)%changes%frictions(i))
               if (change%interaction == interaction) largest = max(largest, &
                  change%friction%coefficient)
            end associate
         end do
      end do
   end function largest_friction

   !> Reads one *GAP RADIATION: emissivities of both faces, then view factors over the clearance.
   !> Two large grey faces exchange sigma/(1/e1 + 1/e2 - 1) (T1^4 - T2^4), times the view factor.
   subroutine build_gap_radiation(cards, card, constants, context, report, law)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(physical_constants_type), intent(in) :: constants
      type(deck_context_type), intent(inout) :: context    !! receives a note
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(conductance_law_type), intent(inout) :: law     !! receives radiation in the open gap
      real(dp) :: emissivity(2), view_factor
      integer :: i, n

      n = card%last_data - card%first_data + 1
      associate (data => cards%data(card%first_data))
         do i = 1, 2
            emissivity(i) = part_above_0(data, i, 'emissivity')
         end do
         call check_extra(data, 2, 'two emissivities', report)
      end associate
      view_factor = 1.0_dp
      do i = 2, n
         call read_view_factor(i)
      end do
      if (n > 1) call context%note('*GAP RADIATION: faces radiate at all clearances, also '// &
         'beyond that of the last view factor')
      if (.not. constants%has_radiation) call report%error(card%place, '*GAP RADIATION needs '// &
         '*PHYSICAL CONSTANTS, ABSOLUTE ZERO=, STEFAN BOLTZMANN=')
      if (law%open_kind == law_clearance) call report%error(card%place, '*GAP RADIATION beside '// &
         'a table of conductance over the clearance is refused; give the gas by *GAP LAW, TYPE=GAS')
      if (law%open_kind == law_none) law%open_kind = law_gas
      if (allocated(law%by_temperature)) then
         if (law%by_temperature%radiance > 0.0_dp) call report%error(card%place, &
            '*GAP RADIATION beside EMISSIVITY= of *GAP LAW: leave one of them out')
      end if
      if (.not. allocated(law%by_temperature)) allocate (law%by_temperature)
      law%by_temperature%radiance = constants%stefan_boltzmann*view_factor/ &
         (1.0_dp/emissivity(1) + 1.0_dp/emissivity(2) - 1.0_dp)
      law%by_temperature%absolute_zero = constants%absolute_zero
   contains
      !> A field above 0 and at most 1; 1 after an error.
      real(dp) function part_above_0(data, i, what) result(part)
         type(data_card_type), intent(in) :: data
         integer, intent(in) :: i
         character(*), intent(in) :: what
         logical :: valid

         valid = .true.
         part = 1.0_dp
         call need_field(data, i, what, report, part, valid)
         if (part > 0.0_dp .and. part <= 1.0_dp) return
         call report%error(field_place(data, i), 'the '//what//' must be above 0 and at most 1')
         part = 1.0_dp
      end function part_above_0

      !> A row of the table, in which one view factor is for all clearances.
      subroutine read_view_factor(i)
         integer, intent(in) :: i
         real(dp) :: clearance, factor
         logical :: valid

         associate (data => cards%data(card%first_data + i - 1))
            factor = part_above_0(data, 1, 'view factor')
            valid = .true.
            clearance = 0.0_dp
            call take_field(data, 2, 'clearance', report, clearance, valid)
            call check_extra(data, 2, 'view factor, clearance', report)
            if (clearance < 0.0_dp) call report%error(field_place(data, 2), &
               'the clearance must not be negative')
            if (i == 2) view_factor = factor
            if (abs(factor - view_factor) > 0.0_dp) call report%error(field_place(data, 1), &
               'a view factor that varies with the clearance is refused: two faces that lie '// &
               'close together see nothing but each other; give one view factor')
         end associate
      end subroutine read_view_factor
   end subroutine build_gap_radiation

end module deck_builder_gap_heat
