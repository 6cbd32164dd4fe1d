!> What the derivative U' of the contact operator of section 2 says of a solution omega = U(omega):
!> the gain of the coupling, and whether the solution is one of several.
module coupling_gains
   use conductance_graph, only: conductance_graph_type
   use dense, only: eigenvalues, lu_type
   use kinds, only: dp
   implicit none
   private
   public :: coupling_gain_type, find_gain

   real(dp), parameter :: nearly_real = 1.0e-8_dp   !! imaginary part of a real eigenvalue, relative

   !> Eigenvalues of U', and the sign of det(I - U').
   type :: coupling_gain_type
      real(dp) :: largest = 0.0_dp        !! real part of the one that is largest in modulus [-]
      real(dp) :: largest_real = 0.0_dp   !! largest real one; -huge where none is real [-]
      !> det(I - U') < 0. The degree of I - U over all solutions is 1, as U is bounded: then there
      !> are at least two others.
      logical :: is_one_of_several = .false.
   end type coupling_gain_type

contains

   !> The gain of a solution. The conductance of a contact point that rests is no variable of U'; in
   !> det(I - U') it is one, that of a law which is all but vertical there.
   subroutine find_gain(graph, opening, derivative, resting, gain, found, by_temperature)
      type(conductance_graph_type), intent(in) :: graph(:)  !! (m) graphs of the conductance
      real(dp), intent(in) :: opening(:)                    !! (m) openings [length]
      !> (m, m) derivative of the openings by the conductances
      real(dp), intent(in) :: derivative(:, :)
      logical, intent(in) :: resting(:)                     !! (m) contact points that rest
      type(coupling_gain_type), intent(out) :: gain
      logical, intent(out) :: found                         !! whether LAPACK found it
      !> (m, m) derivative of the conductances by each other at constant openings, by way of the
      !> temperatures; absent where no law varies with these
      real(dp), intent(in), optional :: by_temperature(:, :)
      real(dp) :: u_derivative(size(opening), size(opening)), matrix(size(opening), size(opening))
      real(dp), allocatable :: real_part(:), imaginary_part(:)
      integer, allocatable :: free(:)
      type(lu_type) :: lu
      logical :: singular
      integer :: k

      free = pack([(k, k=1, size(opening))], .not. resting)
      do k = 1, size(opening)
         u_derivative(k, :) = &
            graph(k)%derivative(graph(k)%coordinate_of_opening(opening(k)))*derivative(k, :)
         if (present(by_temperature)) u_derivative(k, :) = u_derivative(k, :) + by_temperature(k, :)
         matrix(k, :) = -u_derivative(k, :)
         matrix(k, k) = matrix(k, k) + 1.0_dp
         if (resting(k)) matrix(k, :) = -sign(1.0_dp, &
            graph(k)%derivative(-0.5_dp*graph(k)%width))* derivative(k, :)
      end do
      call lu%factor(matrix, singular)
      if (.not. singular) gain%is_one_of_several = lu%negative_determinant()
      found = .true.
      if (size(free) == 0) return
      call eigenvalues(u_derivative(free, free), real_part, imaginary_part, found)
      if (.not. found) return
      k = maxloc(abs(cmplx(real_part, imaginary_part, dp)), dim=1)
      gain%largest = real_part(k)
      gain%largest_real = maxval(real_part, mask=abs(imaginary_part) <= nearly_real* &
         maxval(abs(real_part)))
   end subroutine find_gain

end module coupling_gains
