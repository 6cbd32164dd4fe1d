!> The limit of values on meshes or with increments that are halved again and again, and what it is
!> uncertain by.
module sequence_limits
   use kinds, only: dp
   implicit none
   private
   public :: limit_type, extrapolate, halved

   real(dp), parameter :: rounding = 1.0e-11_dp   !! relative differences that are none
   real(dp), parameter :: slowest = 1.25_dp       !! ratio of differences; below it none is trusted
   real(dp), parameter :: fastest = 8.0_dp        !! ratio that is believed at most: third order
   real(dp), parameter :: doubtful = 5.0_dp       !! ratio of two differences alone: chance, perhaps
   real(dp), parameter :: faster = 1.1_dp         !! a ratio that grows more: terms that cancel
   real(dp), parameter :: slower = 2.0_dp         !! one that falls more: none is steady
   real(dp), parameter :: safety = 2.0_dp         !! on the differences of irregular sequences
   real(dp), parameter :: safety_of_three = 3.0_dp   !! the same on those of three values alone
   real(dp), parameter :: safety_of_two = 2.0_dp  !! on the difference of two values
   real(dp), parameter :: drift = 4.0_dp          !! 1/(slowest - 1), if differences fall slower

   !> The limit of a sequence.
   type :: limit_type
      real(dp) :: value = 0.0_dp
      real(dp) :: uncertainty = 0.0_dp
      logical :: differs = .false.   !! only some of them have a value
   end type limit_type

contains

   !> The limit of values with steps h, h/2, h/4, ... Where the last differences fall by a steady
   !> ratio, Richardson's extrapolation with that ratio, uncertain by all that it adds and by half
   !> the last difference. Where they do not, the last value, uncertain by what the others say if
   !> errors fall at least as h does; a position that is known to a part of h, with scatter, is
   !> always judged so.
   pure function extrapolate(values, is_position) result(limit)
      real(dp), intent(in) :: values(:)     !! (n) from the coarsest to the finest, at least one
      logical, intent(in) :: is_position    !! whether their errors are parts of h
      type(limit_type) :: limit             !! their limit
      real(dp) :: differences(size(values) - 1), ratio, added
      integer :: k, n

      n = size(values)
      limit%value = values(n)
      if (n == 1) return
      differences = values(2:) - values(:n - 1)
      if (maxval(abs(differences)) <= rounding*maxval(abs(values))) then
         limit%uncertainty = maxval(abs(differences))
         return
      else if (n == 2) then
         limit%uncertainty = safety_of_two*abs(differences(1))
         return
      end if
      ratio = 0.0_dp
      if (.not. is_position) ratio = steady_ratio(differences)
      if (ratio > 0.0_dp) then
         added = differences(n - 1)/(min(ratio, fastest) - 1.0_dp)
         limit%value = values(n) + added
         limit%uncertainty = max(abs(added), 0.5_dp*abs(differences(n - 1)))
         if (n == 3) limit%uncertainty = max(abs(added), abs(differences(2)))
      else
         ! If errors fall at least as the steps do, that of the last value is at most
         ! |v_k - v_n|/(2^(n-k) - 1) for any k; one of these may vanish by chance, not the largest.
         limit%uncertainty = merge(safety_of_three, safety, n == 3)* &
            maxval([(abs(values(k) - values(n))/(2.0_dp**(n - k) - 1.0_dp), k=1, n - 1)])
         associate (before => differences(n - 2), last => differences(n - 1))
            if (.not. is_position .and. (before > 0.0_dp .eqv. last > 0.0_dp) .and. abs(before) < &
               slowest*abs(last)) limit%uncertainty = max(limit%uncertainty, drift*abs(last))
         end associate
      end if
   end function extrapolate

   !> The last of some entries, as far as each has half the size of the one before.
   pure function halved(list, sizes) result(last)
      integer, intent(in) :: list(:)       !! entries, the smallest size last
      real(dp), intent(in) :: sizes(:)     !! of all entries
      integer, allocatable :: last(:)
      integer :: first

      do first = size(list), 2, -1
         if (abs(sizes(list(first - 1)) - 2.0_dp*sizes(list(first))) > 0.0_dp) exit
      end do
      last = list(max(first, 1):)
   end function halved

   !> By which ratio the last differences fall; 0 where that is not steady.
   pure real(dp) function steady_ratio(differences) result(ratio)
      real(dp), intent(in) :: differences(:)   !! at least two
      real(dp) :: last(min(size(differences), 3)), ratios(2)
      integer :: n

      ratio = 0.0_dp
      n = size(last)
      last = differences(size(differences) - n + 1:)
      if (any(abs(last) <= tiny(ratio)) .or. any((last > 0.0_dp) .neqv. (last(1) > 0.0_dp))) return
      ratios = [last(1)/last(2), last(n - 1)/last(n)]
      if (minval(ratios) < slowest .or. n == 2 .and. ratios(2) > doubtful) return
      if (ratios(2) > faster*ratios(1) .or. ratios(1) > slower*ratios(2)) return
      ratio = minval(ratios)
   end function steady_ratio

end module sequence_limits
