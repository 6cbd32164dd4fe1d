!> *FRICTION -> law of friction.
module deck_builder_friction
   use card_parameters, only: has_parameter, parameter_place, take_parameter
   use card_values, only: check_extra, need_field, take_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use decimal_commas, only: check_unneeded
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use friction_laws, only: friction_law_type, rough_coefficient
   use kinds, only: dp
   use text, only: to_text
   implicit none
   private
   public :: build_friction

   !> Group of warnings that explain bodies which friction should hold.
   character(*), parameter, public :: frictionless = 'friction'

   real(dp), parameter :: largest_usual = 5.0_dp   !! coefficient, of rubber and of rough joints

contains

   !> Takes one card: coefficient of friction, or ROUGH; TAUMAX= bounds the shear.
   subroutine build_friction(cards, card, context, report, friction)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(friction_law_type), intent(out) :: friction

      call take_parameter(card, 'TAUMAX', report, friction%largest_shear)
      if (friction%largest_shear <= 0.0_dp) call report%error(parameter_place(card, 'TAUMAX'), &
         'TAUMAX= must be positive; without friction leave out the card')
      if (has_parameter(card, 'ROUGH')) then
         friction%coefficient = rough_coefficient
         if (has_parameter(card, 'TAUMAX')) call report%error(parameter_place(card, 'ROUGH'), &
            'TAUMAX= and ROUGH exclude each other: rough faces do not slip')
         if (card%last_data >= card%first_data) call report%error( &
            field_place(cards%data(card%first_data), 1), '*FRICTION, ROUGH has no data')
      else if (card%last_data >= card%first_data) then
         call read_coefficient(cards%data(card%first_data), context, report, &
            friction%coefficient)
      end if
   end subroutine build_friction

   !> The coefficient, which is not so large that a pressure is lost in the last places of mu times
   !> it; a stick slope behind it is not needed.
   subroutine read_coefficient(data, context, report, coefficient)
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      real(dp), intent(inout) :: coefficient
      real(dp) :: slope
      logical :: valid

      valid = .true.
      call need_field(data, 1, 'coefficient of friction', report, coefficient, valid)
      call take_field(data, 2, 'stick slope', report, slope, valid)
      call check_extra(data, 2, 'coefficient of friction, stick slope', report)
      if (coefficient < 0.0_dp) then
         call report%error(field_place(data, 1), 'the coefficient of friction must not be negative')
      else if (coefficient > rough_coefficient) then
         call report%error(field_place(data, 1), 'the coefficient of friction must not exceed '// &
            to_text(rough_coefficient)//'; use ROUGH for faces that never slip while closed')
      else if (coefficient > largest_usual .and. coefficient < rough_coefficient) then
         call report%warning(field_place(data, 1), 'a coefficient of friction of '// &
            to_text(coefficient)//' is unusual: is it in per cent? Use ROUGH for faces that '// &
            'never slip while closed')
      end if
      if (size(data%fields) > 1) then
         call context%note('*FRICTION: the stick slope is ignored')
         call check_unneeded(data, 2, 'a stick slope', report, frictionless)
      end if
   end subroutine read_coefficient

end module deck_builder_friction
