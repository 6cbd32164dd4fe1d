!> A trade-off study: its rows, the numbers by which they are compared, and which rows are worth
!> their cost: the Pareto-optimal ones, and the cheapest for each target.
module trade_study
   use kinds, only: dp
   use reported_quantities, only: traded
   use text, only: percent, string_type
   use variations, only: variation_type
   implicit none
   private
   public :: trade_row_type, trade_type, targets, target_count
   public :: quantity_count, figure_count, closed_length, is_there, absent, item_quantities
   public :: judge_rows, are_optimal, rounded, same_time

   integer, parameter :: quantity_count = size(traded)       !! quantities that rows are judged by
   integer, parameter :: figure_count = quantity_count - 1   !! all but the last: the temperatures
   integer, parameter :: closed_length = 0                   !! no quantity: the scale of edges
   real(dp), parameter :: absent = -1.0e300_dp               !! marks a value that does not exist

   integer, parameter :: target_count = 3
   real(dp), parameter :: targets(target_count) = [0.1_dp, 0.01_dp, 0.001_dp] !! relative errors
   real(dp), parameter :: negligible = 1.0e-6_dp   !! errors below it are equal
   real(dp), parameter :: same_time = 2.0e-3_dp    !! what runs of one row differ by anyway [s]

   !> A variation of the deck, measured.
   type :: trade_row_type
      type(variation_type) :: variation                 !! with its order and levels
      character(:), allocatable :: varied               !! one thing; empty: mesh or increments
      logical :: is_default = .false.                   !! the deck as written
      integer :: status = 0                             !! exit status
      character(:), allocatable :: reason               !! why it failed; empty where it did not
      real(dp), allocatable :: cpu(:)                   !! CPU seconds, a run each [s]
      real(dp) :: cpu_seconds = 0.0_dp                  !! their median [s]
      real(dp) :: peak_bytes = 0.0_dp                   !! largest resident memory [byte]
      integer :: increments = 0                         !! accepted increments
      integer :: passes = 0                             !! passes of the fixed point in all of them
      real(dp), allocatable :: values(:, :)             !! (items, instants), or absent
      real(dp) :: errors(quantity_count) = absent       !! stated errors [-]
      real(dp) :: worst = absent                        !! largest of them
      logical :: is_optimal = .false.                   !! Pareto-optimal
      logical :: is_recommended(target_count) = .false.
   end type trade_row_type

   !> A trade-off study.
   type :: trade_type
      type(trade_row_type), allocatable :: rows(:)
      type(trade_row_type), allocatable :: left_out(:)  !! by --limit, with the reason
      character(:), allocatable :: ended_early          !! why rows are missing; else unallocated
      real(dp), allocatable :: instants(:)              !! total times of comparison [time]
      integer, allocatable :: items(:)                  !! as from item_quantities
      real(dp) :: uncertainty(quantity_count) = absent  !! of the reference; absent: not judged
      logical :: is_known(quantity_count) = .false.     !! whether there is a reference
      !> What a recommendation does not hold for, or why there is none; empty for neither
      type(string_type) :: remarks(target_count)
   end type trade_type

contains

   elemental logical function is_there(value)
      real(dp), intent(in) :: value   !! a value, or absent

      is_there = value > 0.5_dp*absent
   end function is_there

   !> Which quantity each of the compared values is of: for every interface its figures, then its
   !> closed length; then the temperatures of nodes. A deck without contact counts as one interface,
   !> whose heat is that which enters.
   pure function item_quantities(interfaces, nodes) result(quantities)
      integer, intent(in) :: interfaces, nodes       !! number of each
      integer, allocatable :: quantities(:)          !! indexes into traded, or closed_length
      integer :: q, i

      quantities = [([(q, q=1, figure_count), closed_length], i=1, max(interfaces, 1)), &
         (quantity_count, i=1, nodes)]
   end function item_quantities

   !> Marks the rows that are Pareto-optimal by CPU seconds and worst error, both with two digits,
   !> negligible errors as one; recommends one row for each target: the cheapest that meets it, and
   !> the targets before it, in all quantities in which some row does.
   pure subroutine judge_rows(trade)
      type(trade_type), intent(inout) :: trade   !! with the errors of its rows
      logical :: meets(size(trade%rows)), is_reachable(quantity_count)
      real(dp) :: least(quantity_count)
      character(:), allocatable :: words
      integer :: k, q, i

      associate (rows => trade%rows)
         rows%is_optimal = are_optimal(rounded(rows%cpu_seconds), &
            rounded(max(rows%worst, negligible)), rows%status == 0 .and. is_there(rows%worst))
         least = [(minval(rows%errors(q), mask=rows%status == 0), q=1, quantity_count)]
         meets = rows%status == 0
         do k = 1, target_count
            is_reachable = trade%is_known .and. least <= targets(k)
            meets = meets .and. [(all(rows(i)%errors <= targets(k) .or. .not. is_reachable), &
               i=1, size(rows))]
            if (any(is_reachable) .and. any(meets)) rows(cheapest(rows, meets))% &
               is_recommended(k) = .true.
            words = ''
            do q = 1, quantity_count
               if (is_reachable(q) .or. .not. trade%is_known(q)) cycle
               if (words /= '') words = words//'; '
               words = words//trim(traded(q)%name)
               if (trade%uncertainty(q) >= targets(k)) then
                  words = words//': the reference itself is uncertain by '// &
                     percent(trade%uncertainty(q))
               else
                  words = words//': the best row has '//percent(least(q))
               end if
            end do
            if (words == '' .and. .not. any(rows%is_recommended(k))) then
               words = 'no row meets it in all quantities'
               if (.not. any(trade%is_known)) words = 'there is nothing to judge by'
            end if
            trade%remarks(k)%value = words
         end do
      end associate
   end subroutine judge_rows

   !> Which points no other one beats: none is as cheap and better, or cheaper and as good.
   pure function are_optimal(costs, errors, count) result(optimal)
      real(dp), intent(in) :: costs(:)        !! (n) costs [s]
      real(dp), intent(in) :: errors(:)       !! (n) errors
      logical, intent(in) :: count(:)         !! (n) whether a point takes part
      logical :: optimal(size(costs))         !! (n) whether none beats it
      integer :: i

      optimal = count .and. [(.not. any(count .and. ( &
         costs <= costs(i) + same_time .and. errors < errors(i) .or. &
         costs < costs(i) - same_time .and. errors <= errors(i))), i=1, size(costs))]
   end function are_optimal

   !> The cheapest of some rows; of those that cost the same the most accurate one, of these the
   !> deck as written or the first.
   pure integer function cheapest(rows, takes_part) result(best)
      type(trade_row_type), intent(in) :: rows(:)
      logical, intent(in) :: takes_part(:)    !! at least one
      logical :: candidates(size(rows))
      real(dp) :: errors(size(rows))

      candidates = takes_part .and. rows%cpu_seconds <= minval(rows%cpu_seconds, &
         mask=takes_part) + same_time
      errors = rounded(max(rows%worst, negligible))
      candidates = candidates .and. errors <= minval(errors, mask=candidates)
      best = findloc(candidates .and. rows%is_default, .true., dim=1)
      if (best == 0) best = findloc(candidates, .true., dim=1)
   end function cheapest

   !> A number with two decimal digits: the same double for the same digits, as text is read.
   elemental real(dp) function rounded(number)
      real(dp), intent(in) :: number
      character(16) :: digits

      write (digits, '(es16.1e3)') number
      read (digits, *) rounded
   end function rounded

end module trade_study
