!> *FIXED POINT, *THERMAL SCHEME and *START.
module deck_builder_controls
   use card_parameters, only: choose, need_choice, parameter_place, take_from, take_parameter, &
      take_positive
   use card_values, only: check_extra, need_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use controls, only: crank_nicolson_scheme, explicit_scheme, fixed_point_type, galerkin_scheme, &
      implicit_scheme, method_names, start_both, start_closed, start_given, start_open, &
      start_previous, start_type, thermal_scheme_type
   use deck_context, only: report_unknown
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use model, only: model_type
   use named_items, only: find_named
   use text, only: to_text
   implicit none
   private
   public :: build_fixed_point, build_thermal_scheme, build_start

   real(dp), parameter :: consistent = 1.0e-9_dp   !! sums of coefficients count as equal, relative
   character(2), parameter :: coefficient_names(8) = &
      ['a1', 'a2', 'a3', 'b1', 'b2', 'b3', 'c1', 'c2']   !! of eq. (3.4), in the order of the card

contains

   !> Reads one *FIXED POINT; what it does not say stays as it was.
   subroutine build_fixed_point(card, report, fixed_point)
      type(keyword_card_type), intent(in) :: card
      type(deck_report_type), intent(inout) :: report         !! receives errors
      type(fixed_point_type), intent(inout) :: fixed_point    !! receives the controls
      type(fixed_point_type) :: before
      character(:), allocatable :: method

      before = fixed_point
      method = ''
      call choose(card, 'METHOD', 'PICARD/ZAITSEV/ANDERSON/NEWTON', report, method)
      if (method /= '') fixed_point%method = findloc(method_names == method, .true., dim=1)
      call take_positive(card, 'TOL', report, fixed_point%tolerance)
      call take_from(1, card, 'MAXITER', report, fixed_point%max_iterations)
      call take_parameter(card, 'G', report, fixed_point%g)
      if (fixed_point%g <= 0.0_dp .or. fixed_point%g > 1.0_dp) then
         call report%error(parameter_place(card, 'G'), 'G= must be above 0 and at most 1')
         fixed_point%g = before%g
      end if
      call take_from(0, card, 'CONSTANT', report, fixed_point%constant)
   end subroutine build_fixed_point

   !> Reads one *THERMAL SCHEME; after an error the scheme stays as it was.
   subroutine build_thermal_scheme(cards, card, report, scheme)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_report_type), intent(inout) :: report         !! receives errors
      type(thermal_scheme_type), intent(inout) :: scheme      !! receives the coefficients
      character(:), allocatable :: kind

      call need_choice(card, 'TYPE', 'IMPLICIT/GALERKIN/CRANK-NICOLSON/EXPLICIT/FREE', report, &
         kind)
      if (kind == 'FREE') then
         if (card%last_data < card%first_data) then
            call report%error(card%place, '*THERMAL SCHEME, TYPE=FREE needs a data card')
         else
            call build_free_scheme(cards%data(card%first_data), report, scheme)
         end if
      else if (card%last_data >= card%first_data .and. kind /= '') then
         call report%error(field_place(cards%data(card%first_data), 1), &
            'extra data card; *THERMAL SCHEME has one with TYPE=FREE only')
      end if
      if (kind == 'IMPLICIT') scheme = implicit_scheme
      if (kind == 'GALERKIN') scheme = galerkin_scheme
      if (kind == 'CRANK-NICOLSON') scheme = crank_nicolson_scheme
      if (kind == 'EXPLICIT') scheme = explicit_scheme
   end subroutine build_thermal_scheme

   !> Coefficients of eq. (3.4) as the card gives them; multiples of them are the same scheme.
   subroutine build_free_scheme(data, report, scheme)
      type(data_card_type), intent(in) :: data
      type(deck_report_type), intent(inout) :: report
      type(thermal_scheme_type), intent(inout) :: scheme
      real(dp) :: given(8), sums(3)
      integer :: i
      logical :: valid

      valid = .true.
      given = 0.0_dp
      do i = 1, 8
         call need_field(data, i, coefficient_names(i), report, given(i), valid)
      end do
      call check_extra(data, 8, 'a1, a2, a3, b1, b2, b3, c1, c2', report)
      if (.not. valid) return
      do i = 1, 3
         if (given(i) > 0.0_dp .or. (i > 1 .and. given(i) >= 0.0_dp)) cycle
         call report%error(field_place(data, i), coefficient_names(i)// &
            trim(merge(' must be positive    ', ' must not be negative', i == 1)))
         valid = .false.
      end do
      if (.not. valid) return
      sums = [given(1) + given(4), sum(given(7:8)), sum(given([2, 3, 5, 6]))]
      if (given(2) + given(3) <= 0.0_dp) then
         call report%error(field_place(data, 2), 'a2 + a3 must be positive')
      else if (sums(1) <= 0.0_dp) then
         call report%error(field_place(data, 4), 'a1 + b1 must be positive')
      else if (any(abs(sums - sums(1)) > consistent*sums(1))) then
         call report%error(field_place(data, 1), 'a steady state would not stay: a1 + b1 = '// &
            to_text(sums(1))//', c1 + c2 = '//to_text(sums(2))//', a2 + a3 + b2 + b3 = '// &
            to_text(sums(3))//' must be equal')
      else
         scheme = thermal_scheme_type(given(1:3)/sums(1), given(4:6)/sums(1), given(7:8)/sums(1))
      end if
   end subroutine build_free_scheme

   !> Reads one *START; after an error the start stays as it was.
   subroutine build_start(cards, card, model, report, start)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model              !! its interfaces
      type(deck_report_type), intent(inout) :: report    !! receives errors
      type(start_type), intent(inout) :: start           !! receives the start
      character(:), allocatable :: from

      call need_choice(card, 'FROM', 'PREVIOUS/OPEN/CLOSED/BOTH/GIVEN', report, from)
      if (from == 'GIVEN') then
         call build_given(cards, card, model, report, start)
      else if (card%last_data >= card%first_data .and. from /= '') then
         call report%error(field_place(cards%data(card%first_data), 1), &
            'extra data card; *START has them with FROM=GIVEN only')
      end if
      if (from == 'PREVIOUS') start%kind = start_previous
      if (from == 'OPEN') start%kind = start_open
      if (from == 'CLOSED') start%kind = start_closed
      if (from == 'BOTH') start%kind = start_both
   end subroutine build_start

   !> Interface and conductance, a card each.
   subroutine build_given(cards, card, model, report, start)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(start_type), intent(inout) :: start
      real(dp) :: given(size(model%contacts)), value
      character(:), allocatable :: name
      integer :: i, k
      logical :: sound, valid

      given = 0.0_dp
      sound = .true.
      do k = card%first_data, card%last_data
         associate (data => cards%data(k))
            valid = .true.
            name = ''
            call need_field(data, 1, 'contact pair', report, name, valid)
            i = find_named(model%contacts, name)
            if (valid .and. i == 0) call report_unknown('contact pair', name, model%contacts, &
               field_place(data, 1), report)
            valid = valid .and. i > 0
            value = 0.0_dp
            call need_field(data, 2, 'conductance', report, value, valid)
            call check_extra(data, 2, 'contact pair, conductance', report)
            if (valid .and. value <= 0.0_dp) then
               call report%error(field_place(data, 2), 'the conductance must be positive')
               valid = .false.
            end if
            if (valid) given(i) = value
            sound = sound .and. valid
         end associate
      end do
      if (.not. sound) return
      do i = 1, size(given)
         if (given(i) > 0.0_dp) cycle
         call report%error(card%place, '*START, FROM=GIVEN gives no conductance to '// &
            model%contacts(i)%name)
         return
      end do
      start = start_type(kind=start_given, conductance=given)
   end subroutine build_given

end module deck_builder_controls
