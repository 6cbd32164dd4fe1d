!> Stated errors of the rows of a trade: the distance from the reference and what that is uncertain
!> by, relative to the value at the instant, or to a part of the largest where that is more.
module trade_errors
   use kinds, only: dp
   use reported_quantities, only: traded
   use trade_quantities, only: figure_count, is_there, temperature
   use trade_reference, only: reference_type
   use trade_rows, only: trade_type
   implicit none
   private
   public :: state_errors

   real(dp), parameter :: idle = 0.01_dp     !! part of the largest contact below which one is idle
   real(dp), parameter :: nothing = 1.0e-12_dp   !! part of the largest temperature: no range
   real(dp), parameter :: early = 0.25_dp    !! part of the largest value: least scale over time
   real(dp), parameter :: whole = 1.0_dp     !! error of what should not be there, or should

contains

   !> States the errors of all rows that were solved, and the uncertainty of the reference.
   pure subroutine state_errors(reference, initial_temperature, trade)
      type(reference_type), intent(in) :: reference    !! what rows are measured against
      real(dp), intent(in) :: initial_temperature(:)   !! of the nodes of the deck [temperature]
      type(trade_type), intent(inout) :: trade         !! receives the errors
      real(dp), allocatable :: scales(:, :, :)
      real(dp) :: range
      integer :: q, i

      if (.not. reference%is_known) return
      scales = scales_of(reference)
      do q = 1, figure_count
         trade%is_known(q) = any(scales(q, :, :) > 0.0_dp)
         if (.not. trade%is_known(q)) cycle
         trade%uncertainty(q) = maxval(reference%uncertainty(q, :, :)/ &
            merge(scales(q, :, :), 1.0_dp, scales(q, :, :) > 0.0_dp), &
            mask=scales(q, :, :) > 0.0_dp)
         if (reference%is_contradictory(q)) trade%uncertainty(q) = whole
      end do
      range = temperature_range(reference, initial_temperature)
      trade%is_known(temperature) = range > 0.0_dp
      if (range > 0.0_dp) trade%uncertainty(temperature) = reference%temperature_uncertainty/range
      do i = 1, trade%count
         associate (row => trade%rows(i))
            if (row%status /= 0) cycle
            do q = 1, figure_count
               if (.not. trade%is_known(q)) cycle
               row%errors(q) = trade%uncertainty(q) + distance(reference%figures(q, :, :), &
                  row%values%figures(q, :, :), scales(q, :, :))
            end do
            if (trade%is_known(temperature)) row%errors(temperature) = &
               trade%uncertainty(temperature) + maxval(abs(row%values%temperatures - &
               reference%temperatures))/range
            row%worst = maxval(row%errors)
         end associate
      end do
   end subroutine state_errors

   !> Largest distance over the interfaces and instants.
   pure real(dp) function distance(expected, found, scale)
      real(dp), intent(in) :: expected(:, :), found(:, :), scale(:, :) !! (contact points, instants)
      integer :: i, t

      distance = 0.0_dp
      do t = 1, size(expected, 2)
         do i = 1, size(expected, 1)
            if (scale(i, t) <= 0.0_dp) cycle
            if (is_there(expected(i, t)) .neqv. is_there(found(i, t))) then
               distance = max(distance, whole)
            else if (is_there(expected(i, t))) then
               distance = max(distance, abs(found(i, t) - expected(i, t))/scale(i, t))
            end if
         end do
      end do
   end function distance

   !> What errors are relative to: the value at the instant, for edges the length of the contact; a
   !> quarter of the largest over time where that is more, and a hundredth of the largest of all
   !> interfaces. 0 where there is nothing to measure.
   pure function scales_of(reference) result(scales)
      type(reference_type), intent(in) :: reference
      real(dp), allocatable :: scales(:, :, :)
      integer :: q, i

      allocate (scales, mold=reference%figures)
      do q = 1, figure_count
         if (traded(q)%resolution > 0.0_dp) then
            scales(q, :, :) = reference%length
            if (.not. any(is_there(reference%figures(q, :, :)))) scales(q, :, :) = 0.0_dp
         else
            scales(q, :, :) = merge(abs(reference%figures(q, :, :)), 0.0_dp, &
               is_there(reference%figures(q, :, :)))
         end if
         do i = 1, size(scales, 2)
            scales(q, i, :) = max(scales(q, i, :), early*maxval(scales(q, i, :)))
         end do
         scales(q, :, :) = max(scales(q, :, :), idle*maxval(scales(q, :, :)))
      end do
   end function scales_of

   !> Range of all temperatures, the initial ones included; 0 where that is rounding.
   pure real(dp) function temperature_range(reference, initial) result(range)
      type(reference_type), intent(in) :: reference
      real(dp), intent(in) :: initial(:)
      real(dp) :: ends(2)

      range = 0.0_dp
      if (size(reference%temperatures) == 0) return
      ends = [min(minval(reference%temperatures), minval(initial)), &
         max(maxval(reference%temperatures), maxval(initial))]
      if (ends(2) - ends(1) > nothing*maxval(abs(ends))) range = ends(2) - ends(1)
   end function temperature_range

end module trade_errors
