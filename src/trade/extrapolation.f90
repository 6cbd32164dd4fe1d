!> Limits of sequences whose steps are halved each time, with what they are uncertain by.
module extrapolation
   use kinds, only: dp
   implicit none
   private
   public :: limit_type, extrapolate

   real(dp), parameter :: rounding = 1.0e-11_dp   !! relative differences that are none
   real(dp), parameter :: slowest = 1.25_dp       !! ratio of differences; below it none is trusted
   real(dp), parameter :: fastest = 8.0_dp        !! ratio that is believed at most: third order
   real(dp), parameter :: doubtful = 5.0_dp       !! ratio of two differences alone: chance, perhaps
   real(dp), parameter :: faster = 1.1_dp         !! a ratio that grows more: terms that cancel
   real(dp), parameter :: slower = 2.0_dp         !! one that falls more: none is steady
   real(dp), parameter :: safety = 2.0_dp         !! on the differences of irregular sequences
   real(dp), parameter :: safety_of_three = 3.0_dp   !! the same on those of three values alone
   real(dp), parameter :: safety_of_two = 2.0_dp  !! on the difference of two values
   real(dp), parameter :: drift = 4.0_dp          !! 1/(slowest - 1), on what settles no faster

   !> The limit of a sequence.
   type :: limit_type
      real(dp) :: value = 0.0_dp        !! what it is taken to be
      real(dp) :: uncertainty = 0.0_dp  !! by how much it may be wrong
      logical :: is_known = .false.     !! false: nothing can be said, the value is the last one
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
      integer :: n

      n = size(values)
      limit%value = values(n)
      limit%is_known = n > 1
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
         limit%uncertainty = irregular_uncertainty(values)
         if (.not. is_position) limit%uncertainty = max(limit%uncertainty, &
            drift_of(differences(n - 2), differences(n - 1)))
      end if
   end function extrapolate

   !> By which ratio the last differences fall; 0 where that is not steady.
   pure real(dp) function steady_ratio(differences) result(ratio)
      real(dp), intent(in) :: differences(:)
      real(dp) :: ratios(2)
      integer :: n, k

      ratio = 0.0_dp
      n = size(differences)
      do k = max(n - 2, 1), n - 1
         if (abs(differences(k)) < slowest*abs(differences(k + 1))) return
         if (abs(differences(k + 1)) <= tiny(ratio)) return
         if (differences(k) > 0.0_dp .neqv. differences(k + 1) > 0.0_dp) return
      end do
      ratios(2) = differences(n - 1)/differences(n)
      ratios(1) = ratios(2)
      if (n > 2) ratios(1) = differences(n - 2)/differences(n - 1)
      if (n == 2 .and. ratios(2) > doubtful) return
      if (ratios(2) > faster*ratios(1) .or. ratios(1) > slower*ratios(2)) return
      ratio = minval(ratios)
   end function steady_ratio

   !> If errors fall at least as the steps do, that of the last value is at most
   !> |v_k - v_n|/(2^(n-k) - 1) for any k; one of these may vanish by chance, the largest hardly.
   pure real(dp) function irregular_uncertainty(values) result(uncertainty)
      real(dp), intent(in) :: values(:)
      integer :: k, n

      n = size(values)
      uncertainty = 0.0_dp
      do k = 1, n - 1
         uncertainty = max(uncertainty, abs(values(k) - values(n))/(2.0_dp**(n - k) - 1.0_dp))
      end do
      uncertainty = merge(safety_of_three, safety, n == 3)*uncertainty
   end function irregular_uncertainty

   !> What may be left where two differences of one sign fall too slowly to be trusted, or grow.
   pure real(dp) function drift_of(before, last)
      real(dp), intent(in) :: before, last

      drift_of = 0.0_dp
      if (abs(before) < slowest*abs(last) .and. (before > 0.0_dp .eqv. last > 0.0_dp)) then
         drift_of = drift*abs(last)
      end if
   end function drift_of

end module extrapolation
