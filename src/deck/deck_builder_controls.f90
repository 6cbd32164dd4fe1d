!> *FIXED POINT and *THERMAL SCHEME.
module deck_builder_controls
   use card_parameters, only: choose, has_parameter, parameter_place, take_parameter
   use cards, only: keyword_card_type
   use controls, only: fixed_point_type, method_picard, method_zaitsev
   use deck_report, only: deck_report_type
   use kinds, only: dp
   implicit none
   private
   public :: build_fixed_point, check_thermal_scheme

contains

   !> Takes one *FIXED POINT; what it does not say stays as it was.
   subroutine build_fixed_point(card, report, fixed_point)
      type(keyword_card_type), intent(in) :: card             !! the card
      type(deck_report_type), intent(inout) :: report         !! receives errors
      type(fixed_point_type), intent(inout) :: fixed_point    !! receives the controls
      type(fixed_point_type) :: before
      character(:), allocatable :: method

      before = fixed_point
      method = ''
      call choose(card, 'METHOD', 'PICARD/ZAITSEV', '', report, method)
      if (method == 'PICARD') fixed_point%method = method_picard
      if (method == 'ZAITSEV') fixed_point%method = method_zaitsev
      call take_parameter(card, 'TOL', report, fixed_point%tolerance)
      call take_parameter(card, 'MAXITER', report, fixed_point%max_iterations)
      call take_parameter(card, 'G', report, fixed_point%g)
      call take_parameter(card, 'CONSTANT', report, fixed_point%constant)
      if (fixed_point%tolerance <= 0.0_dp) then
         call report%error(parameter_place(card, 'TOL'), 'TOL= must be positive')
         fixed_point%tolerance = before%tolerance
      end if
      if (fixed_point%max_iterations < 1) then
         call report%error(parameter_place(card, 'MAXITER'), 'MAXITER= must be at least 1')
         fixed_point%max_iterations = before%max_iterations
      end if
      if (fixed_point%g <= 0.0_dp .or. fixed_point%g > 1.0_dp) then
         call report%error(parameter_place(card, 'G'), 'G= must be above 0 and at most 1')
         fixed_point%g = before%g
      end if
      if (fixed_point%constant < 0) then
         call report%error(parameter_place(card, 'CONSTANT'), 'CONSTANT= must not be negative')
         fixed_point%constant = before%constant
      end if
   end subroutine build_fixed_point

   !> Checks one *THERMAL SCHEME; the implicit scheme is the one that is built.
   subroutine check_thermal_scheme(card, report)
      type(keyword_card_type), intent(in) :: card             !! the card
      type(deck_report_type), intent(inout) :: report         !! receives errors
      character(:), allocatable :: kind

      kind = ''
      if (.not. has_parameter(card, 'TYPE')) then
         call report%error(card%place, '*THERMAL SCHEME needs TYPE=')
      end if
      call choose(card, 'TYPE', 'IMPLICIT', 'GALERKIN/CRANK-NICOLSON/EXPLICIT', report, kind)
   end subroutine check_thermal_scheme

end module deck_builder_controls
