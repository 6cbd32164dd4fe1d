!> Which rows of a trade are worth their cost: those that none beats, and the cheapest for a target.
module recommendation
   use kinds, only: dp
   use reported_quantities, only: traded
   use text, only: percent
   use trade_quantities, only: is_there, quantity_count
   use trade_rows, only: trade_row_type, trade_type, target_count, targets
   implicit none
   private
   public :: judge_rows, are_optimal, rounded, same_time

   real(dp), parameter :: negligible = 1.0e-6_dp   !! errors below it are equal
   real(dp), parameter :: same_time = 2.0e-3_dp    !! what runs of one row differ by anyway [s]

contains

   !> Marks the rows that are Pareto-optimal by CPU seconds and worst error, both with two digits,
   !> negligible errors as one; recommends one row for each target, the cheapest that meets it in
   !> all quantities that can be known so well, and meets the targets before it likewise. Of rows
   !> whose times differ by no more than chance the more accurate one is better.
   pure subroutine judge_rows(trade)
      type(trade_type), intent(inout) :: trade   !! the trade, with the errors of its rows
      integer :: target_index

      associate (rows => trade%rows(:trade%count))
         rows%is_optimal = are_optimal(rounded(rows%cpu_seconds), &
            rounded(max(rows%worst, negligible)), &
            rows%status == 0 .and. is_there(rows%worst))
      end associate
      do target_index = 1, target_count
         call recommend(trade, target_index)
      end do
   end subroutine judge_rows

   !> Which points no other one beats: none is as cheap and better, or cheaper and as good.
   pure function are_optimal(costs, errors, count) result(optimal)
      real(dp), intent(in) :: costs(:)        !! (n) costs [s]
      real(dp), intent(in) :: errors(:)       !! (n) errors
      logical, intent(in) :: count(:)         !! (n) whether a point takes part
      logical :: optimal(size(costs))         !! (n) whether none beats it
      integer :: i

      do i = 1, size(costs)
         optimal(i) = count(i)
         if (optimal(i)) optimal(i) = .not. any(count .and. ( &
            costs <= costs(i) + same_time .and. errors < errors(i) .or. &
            costs < costs(i) - same_time .and. errors <= errors(i)))
      end do
   end function are_optimal

   pure subroutine recommend(trade, target_index)
      type(trade_type), intent(inout) :: trade
      integer, intent(in) :: target_index
      logical :: is_reachable(quantity_count), meets(trade%count)
      integer :: q, i, k, best

      is_reachable = reachable(trade, target_index)
      best = 0
      if (any(is_reachable)) then
         do i = 1, trade%count
            associate (row => trade%rows(i))
               meets(i) = row%status == 0
               do k = 1, target_index
                  meets(i) = meets(i) .and. all(row%errors <= targets(k) .or. .not. &
                     reachable(trade, k))
               end do
            end associate
         end do
         best = best_of(trade%rows(:trade%count), meets)
      end if
      if (best > 0) trade%rows(best)%is_recommended(target_index) = .true.
      trade%remarks(target_index)%value = ''
      do q = 1, quantity_count
         if (is_reachable(q) .or. .not. trade%is_known(q)) cycle
         call remark(trade, target_index, q, trade%remarks(target_index)%value)
      end do
      if (best > 0 .or. len(trade%remarks(target_index)%value) > 0) return
      trade%remarks(target_index)%value = 'no row meets it in all quantities'
      if (.not. any(trade%is_known)) trade%remarks(target_index)%value = &
         'there is nothing to judge by'
   end subroutine recommend

   !> The cheapest of some rows; of those that cost the same the most accurate one, of these the
   !> deck as written or the first. 0 for none.
   pure integer function best_of(rows, takes_part) result(best)
      type(trade_row_type), intent(in) :: rows(:)
      logical, intent(in) :: takes_part(:)
      real(dp) :: errors(size(rows))
      logical :: candidates(size(rows))

      candidates = takes_part
      candidates = candidates .and. rows%cpu_seconds <= minval(rows%cpu_seconds, mask=candidates) &
         + same_time
      errors = rounded(max(rows%worst, negligible))
      candidates = candidates .and. errors <= minval(errors, mask=candidates)
      best = findloc(candidates .and. rows%is_default, .true., dim=1)
      if (best == 0) best = findloc(candidates, .true., dim=1)
   end function best_of

   !> Quantities that some row has as well as its target asks.
   pure function reachable(trade, target_index) result(is_reachable)
      type(trade_type), intent(in) :: trade
      integer, intent(in) :: target_index
      logical :: is_reachable(quantity_count)
      integer :: i

      is_reachable = .false.
      do i = 1, trade%count
         if (trade%rows(i)%status == 0) is_reachable = is_reachable .or. (trade%is_known .and. &
            trade%rows(i)%errors <= targets(target_index))
      end do
   end function reachable

   !> Says how well a quantity is known that no row has as well as its target asks.
   pure subroutine remark(trade, target_index, q, words)
      type(trade_type), intent(in) :: trade
      integer, intent(in) :: target_index, q
      character(:), allocatable, intent(inout) :: words
      real(dp) :: closest
      integer :: i

      if (len(words) > 0) words = words//'; '
      if (trade%uncertainty(q) >= targets(target_index)) then
         words = words//trim(traded(q)%name)//': the reference itself is uncertain by '// &
            percent(trade%uncertainty(q))
         return
      end if
      closest = huge(closest)
      do i = 1, trade%count
         if (trade%rows(i)%status == 0) closest = min(closest, trade%rows(i)%errors(q))
      end do
      words = words//trim(traded(q)%name)//': the best row has '// &
         percent(closest)
   end subroutine remark

   !> A number with two decimal digits: the same double for the same digits, as text is read.
   elemental real(dp) function rounded(number)
      real(dp), intent(in) :: number   !! any number
      character(16) :: digits

      write (digits, '(es16.1e3)') number
      read (digits, *) rounded
   end function rounded

end module recommendation
