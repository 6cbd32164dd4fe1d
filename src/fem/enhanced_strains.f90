!> Enhanced strains of the four-node element (Simo & Rifai, Int. J. Num. Meth. Eng. 29 (1990) 1595),
!> which are the incompatible modes of Wilson in a form that passes the patch test on any mesh. They
!> are G a, where the amplitudes a of an element follow from its displacements and temperatures:
!>
!>    integral of G^T sigma dV = 0,   sigma = E (B u + G a) - beta T.
!>
!> In the axes xi, eta of the centre the strains are, over the Jacobian j,
!>
!>    eps_xi = xi, eps_eta = eta, gamma = xi, gamma = eta, and eps_zz = xi eta around an axis,
!>
!> each less its mean, so that a uniform stress does no work on them. Around an axis shear strains
!> have the mean over the area, not over the volume: a uniform shear stress is in no equilibrium
!> there, and what the others would leave loads the nodes on the axis (element_elasticity).
module enhanced_strains
   use blas_lapack, only: dgetrf, dgetrs
   use kinds, only: dp
   implicit none
   private
   public :: enhance_strains, released_strains

   integer, parameter :: most_modes = 5
   !> Signs of xi, eta and xi eta at the corners.
   real(dp), parameter :: signs(4, 3) = reshape([-1.0_dp, 1.0_dp, 1.0_dp, -1.0_dp, &
      -1.0_dp, -1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp], [4, 3])

contains

   !> Adds to B the strains that unit displacements enhance: B - G (G^T E G)^-1 G^T E B.
   pure subroutine enhance_strains(coordinates, points, is_axisymmetric, e, volumes, b)
      real(dp), intent(in) :: coordinates(:, :)   !! (2, 4 or more) corners first [length]
      real(dp), intent(in) :: points(:, :)        !! (2, 4) xi, eta of the integration points
      logical, intent(in) :: is_axisymmetric      !! whether x is a radius
      real(dp), intent(in) :: e(:, :, :)          !! (4, 4, points, or 1 for all) [stress]
      real(dp), intent(in) :: volumes(:)          !! (4) that the points stand for [length^3]
      real(dp), intent(inout) :: b(:, :, :)       !! (4, points, columns)
      real(dp) :: modes(4, 4, most_modes), forces(4, 4, most_modes), a(most_modes, size(b, 3))
      integer :: j, k, n

      call find_modes(coordinates, points, is_axisymmetric, modes, n)
      call stress_modes(modes, e, volumes, forces)
      do j = 1, size(b, 3)
         do k = 1, n
            a(k, j) = sum(forces(:, :, k)*b(:, :, j))
         end do
      end do
      call find_amplitudes(modes, forces, n, a)
      do j = 1, size(b, 3)
         do k = 1, n
            b(:, :, j) = b(:, :, j) - modes(:, :, k)*a(k, j)
         end do
      end do
   end subroutine enhance_strains

   !> Enhanced strains with which stresses, those of B u and of temperatures, do no work on the
   !> modes.
   pure function released_strains(coordinates, points, is_axisymmetric, e, volumes, stress) &
      result(strains)
      real(dp), intent(in) :: coordinates(:, :)   !! (2, 4) corners [length]
      real(dp), intent(in) :: points(:, :)        !! (2, 4) xi, eta of the integration points
      logical, intent(in) :: is_axisymmetric      !! whether x is a radius
      real(dp), intent(in) :: e(:, :, :)          !! (4, 4, points, or 1 for all) [stress]
      real(dp), intent(in) :: volumes(:)          !! (4) that the points stand for [length^3]
      real(dp), intent(in) :: stress(:, :)        !! (4, points) without them [stress]
      real(dp) :: strains(4, 4)                   !! (4, points)
      real(dp) :: modes(4, 4, most_modes), forces(4, 4, most_modes), a(most_modes, 1)
      integer :: g, k, n

      call find_modes(coordinates, points, is_axisymmetric, modes, n)
      call stress_modes(modes, e, volumes, forces)
      do k = 1, n
         a(k, 1) = 0.0_dp
         do g = 1, 4
            a(k, 1) = a(k, 1) + volumes(g)*dot_product(modes(:, g, k), stress(:, g))
         end do
      end do
      call find_amplitudes(modes, forces, n, a)
      do g = 1, 4
         strains(:, g) = -matmul(modes(:, g, :n), a(:n, 1))
      end do
   end function released_strains

   !> G at the points.
   pure subroutine find_modes(coordinates, points, is_axisymmetric, modes, n)
      real(dp), intent(in) :: coordinates(:, :), points(:, :)
      logical, intent(in) :: is_axisymmetric
      real(dp), intent(out) :: modes(4, 4, most_modes)
      integer, intent(out) :: n                   ! modes that there are
      real(dp) :: slopes(2, 3), values(4, most_modes), strains(4, most_modes)
      real(dp) :: a(2), b(2), jacobian(4), mean, radius(4)
      integer :: g, k

      n = merge(most_modes, most_modes - 1, is_axisymmetric)
      slopes = matmul(coordinates(:, :4), signs)/4
      ! Gradients of xi and eta at the centre, times its Jacobian.
      a = [slopes(2, 2), -slopes(1, 2)]
      b = [-slopes(2, 1), slopes(1, 1)]
      strains(:, 1) = [a(1)**2, a(2)**2, 0.0_dp, 2*a(1)*a(2)]
      strains(:, 2) = [b(1)**2, b(2)**2, 0.0_dp, 2*b(1)*b(2)]
      strains(:, 3) = [a(1)*b(1), a(2)*b(2), 0.0_dp, a(1)*b(2) + a(2)*b(1)]
      strains(:, 4) = strains(:, 3)
      strains(:, 5) = [0.0_dp, 0.0_dp, a(1)*b(2) - a(2)*b(1), 0.0_dp]
      radius = 1.0_dp
      do g = 1, 4
         associate (xi => points(1, g), eta => points(2, g))
            values(g, :) = [xi, eta, xi, eta, xi*eta]
            a = slopes(:, 1) + slopes(:, 3)*eta
            b = slopes(:, 2) + slopes(:, 3)*xi
            jacobian(g) = a(1)*b(2) - a(2)*b(1)
            if (is_axisymmetric) radius(g) = sum(coordinates(1, :4))/4 + &
               dot_product(slopes(1, :), [xi, eta, xi*eta])
         end associate
      end do
      modes = 0.0_dp
      do k = 1, n
         mean = dot_product(radius, values(:, k))/sum(radius)
         do g = 1, 4
            modes(:3, g, k) = strains(:3, k)*(values(g, k) - mean)/jacobian(g)
            modes(4, g, k) = strains(4, k)*values(g, k)/jacobian(g)
         end do
      end do
   end subroutine find_modes

   !> Stresses of the modes, times the volumes.
   pure subroutine stress_modes(modes, e, volumes, forces)
      real(dp), intent(in) :: modes(:, :, :), e(:, :, :), volumes(:)
      real(dp), intent(out) :: forces(:, :, :)
      integer :: g, i

      do g = 1, 4
         i = min(g, size(e, 3))
         forces(:, g, :) = volumes(g)*matmul(e(:, :, i), modes(:, g, :))
      end do
   end subroutine stress_modes

   !> Amplitudes at which the modes bear forces; none in an element without stiffness.
   pure subroutine find_amplitudes(modes, forces, n, a)
      real(dp), intent(in) :: modes(:, :, :), forces(:, :, :)
      integer, intent(in) :: n
      real(dp), intent(inout) :: a(:, :)          ! (modes, columns) forces on them, amplitudes
      real(dp) :: stiffness(most_modes, most_modes)
      integer :: info, k, l, pivots(most_modes)

      do l = 1, n
         do k = 1, n
            stiffness(k, l) = sum(modes(:, :, k)*forces(:, :, l))
         end do
      end do
      call dgetrf(n, n, stiffness, most_modes, pivots, info)
      if (info == 0) call dgetrs('N', n, size(a, 2), stiffness, most_modes, pivots, a, &
         most_modes, info)
      if (info /= 0) a(:n, :) = 0.0_dp
   end subroutine find_amplitudes

end module enhanced_strains
