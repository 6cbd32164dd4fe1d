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
   real(dp), parameter :: alike = 2.0_dp          !! ratios of a regular sequence differ by less
   real(dp), parameter :: safety = 1.5_dp         !! on the difference of irregular sequences
   real(dp), parameter :: safety_of_two = 2.0_dp  !! on the difference of two values
   real(dp), parameter :: drift = 8.0_dp          !! on the differences of what does not settle

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
   !> errors fall at least as h does.
   pure function extrapolate(values) result(limit)
      real(dp), intent(in) :: values(:)   !! (n) from the coarsest to the finest, at least one
      type(limit_type) :: limit           !! their limit
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
      ratio = steady_ratio(differences)
      if (ratio > 0.0_dp) then
         added = differences(n - 1)/(min(ratio, fastest) - 1.0_dp)
         limit%value = values(n) + added
         limit%uncertainty = max(abs(added), 0.5_dp*abs(differences(n - 1)))
         if (n == 3) limit%uncertainty = max(abs(added), abs(differences(2)))
      else
         limit%uncertainty = irregular_uncertainty(values)
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
      if (maxval(min(ratios, fastest)) > alike*minval(ratios)) return
      ratio = minval(ratios)
   end function steady_ratio

   !> If errors fall at least as the steps do, that of the last value is at most |v_k - v_n|/(2^(n-k)
   !> - 1) for any k; one of these may vanish by chance, the largest hardly does. Where the last
   !> differences grow, or fall too slowly for that, many times the largest.
   pure real(dp) function irregular_uncertainty(values) result(uncertainty)
      real(dp), intent(in) :: values(:)
      real(dp) :: last, before
      integer :: k, n

      n = size(values)
      uncertainty = 0.0_dp
      do k = 1, n - 1
         uncertainty = max(uncertainty, safety*abs(values(k) - values(n))/(2.0_dp**(n - k) - 1.0_dp))
      end do
      last = values(n) - values(n - 1)
      before = values(n - 1) - values(n - 2)
      if (abs(before) < slowest*abs(last) .and. (before > 0.0_dp .eqv. last > 0.0_dp)) then
         uncertainty = max(uncertainty, drift*abs(last))
      end if
   end function irregular_uncertainty

end module extrapolation
