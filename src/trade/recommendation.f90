!> Which rows of a trade are worth their cost: those that none beats, and the cheapest for a wish.
module recommendation
   use kinds, only: dp
   use reported_quantities, only: traded
   use text, only: to_text
   use trade_quantities, only: is_there, quantity_count
   use trade_rows, only: trade_type, wish_count, wishes
   implicit none
   private
   public :: judge_rows, are_optimal, rounded

   real(dp), parameter :: negligible = 1.0e-6_dp   !! errors below it are alike

contains

   !> Marks the rows that are Pareto-optimal by CPU seconds and worst error, both with two digits,
   !> negligible errors as one; recommends one row for each wish, the cheapest that meets it in all
   !> quantities that can be known so well, and meets the wishes before it likewise.
   pure subroutine judge_rows(trade)
      type(trade_type), intent(inout) :: trade   !! the trade, with the errors of its rows
      integer :: wish

      associate (rows => trade%rows(:trade%count))
         rows%is_optimal = are_optimal(rounded(rows%cpu_seconds), &
            rounded(max(rows%worst, negligible)), &
            rows%status == 0 .and. is_there(rows%worst))
      end associate
      do wish = 1, wish_count
         call recommend(trade, wish)
      end do
   end subroutine judge_rows

   !> Which points no other one beats: none is as cheap and as good, and cheaper or better.
   pure function are_optimal(costs, errors, count) result(optimal)
      real(dp), intent(in) :: costs(:)        !! (n) costs
      real(dp), intent(in) :: errors(:)       !! (n) errors
      logical, intent(in) :: count(:)         !! (n) whether a point takes part
      logical :: optimal(size(costs))         !! (n) whether none beats it
      integer :: i

      do i = 1, size(costs)
         optimal(i) = count(i)
         if (optimal(i)) optimal(i) = .not. any(count .and. costs <= costs(i) .and. &
            errors <= errors(i) .and. (costs < costs(i) .or. errors < errors(i)))
      end do
   end function are_optimal

   pure subroutine recommend(trade, wish)
      type(trade_type), intent(inout) :: trade
      integer, intent(in) :: wish
      logical :: is_reachable(quantity_count), meets
      integer :: q, i, k, best

      is_reachable = reachable(trade, wish)
      best = 0
      if (any(is_reachable)) then
         do i = 1, trade%count
            associate (row => trade%rows(i))
               meets = row%status == 0
               do k = 1, wish
                  meets = meets .and. all(row%errors <= wishes(k) .or. .not. reachable(trade, k))
               end do
               if (.not. meets) cycle
               if (best > 0) meets = row%cpu_seconds < trade%rows(best)%cpu_seconds
               if (meets) best = i
            end associate
         end do
      end if
      if (best > 0) trade%rows(best)%is_recommended(wish) = .true.
      trade%remarks(wish)%value = ''
      do q = 1, quantity_count
         if (is_reachable(q) .or. .not. trade%is_known(q)) cycle
         call remark(trade, wish, q, trade%remarks(wish)%value)
      end do
      if (best > 0 .or. len(trade%remarks(wish)%value) > 0) return
      trade%remarks(wish)%value = 'no row meets it in all quantities'
      if (.not. any(trade%is_known)) trade%remarks(wish)%value = 'there is nothing to judge by'
   end subroutine recommend

   !> Quantities that some row has as well as wished.
   pure function reachable(trade, wish) result(is_reachable)
      type(trade_type), intent(in) :: trade
      integer, intent(in) :: wish
      logical :: is_reachable(quantity_count)
      integer :: i

      is_reachable = .false.
      do i = 1, trade%count
         if (trade%rows(i)%status == 0) is_reachable = is_reachable .or. (trade%is_known .and. &
            trade%rows(i)%errors <= wishes(wish))
      end do
   end function reachable

   !> Says how well a quantity is known that no row has as well as wished.
   pure subroutine remark(trade, wish, q, words)
      type(trade_type), intent(in) :: trade
      integer, intent(in) :: wish, q
      character(:), allocatable, intent(inout) :: words
      real(dp) :: closest
      integer :: i

      if (len(words) > 0) words = words//'; '
      if (trade%uncertainty(q) >= wishes(wish)) then
         words = words//trim(traded(q)%name)//': the reference itself is uncertain by '// &
            to_text(100.0_dp*rounded(trade%uncertainty(q)))//' %'
         return
      end if
      closest = huge(closest)
      do i = 1, trade%count
         if (trade%rows(i)%status == 0) closest = min(closest, trade%rows(i)%errors(q))
      end do
      words = words//trim(traded(q)%name)//': the best row has '// &
         to_text(100.0_dp*rounded(closest))//' %'
   end subroutine remark

   !> A number with two digits.
   elemental real(dp) function rounded(number)
      real(dp), intent(in) :: number   !! any number
      real(dp) :: unit

      rounded = number
      if (number <= 0.0_dp) return
      unit = 10.0_dp**(floor(log10(number)) - 1)
      rounded = anint(number/unit)*unit
   end function rounded

end module recommendation
