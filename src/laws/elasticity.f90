!> Elastic constants -> stiffness in material axes. Stresses and strains are ordered 11, 22, 33, 12,
!> 13, 23, shear strains being angles; a plane model keeps the first four.
module elasticity
   use kinds, only: dp
   implicit none
   private
   public :: isotropic_elasticity, engineering_elasticity, orthotropic_elasticity
   public :: anisotropic_elasticity, is_positive_definite, couples_out_of_plane
   public :: equivalent_poisson

contains

   !> Stiffness of an isotropic material.
   pure function isotropic_elasticity(young, poisson) result(d)
      real(dp), intent(in) :: young     !! E [stress]
      real(dp), intent(in) :: poisson   !! nu [-]
      real(dp) :: d(4, 4)               !! order 11, 22, 33, 12 [stress]
      real(dp) :: lambda, shear
      integer :: i

      lambda = young*poisson/((1 + poisson)*(1 - 2*poisson))
      shear = young/(2*(1 + poisson))
      d = 0.0_dp
      d(:3, :3) = lambda
      do i = 1, 3
         d(i, i) = lambda + 2*shear
      end do
      d(4, 4) = shear
   end function isotropic_elasticity

   !> Stiffness from E1, E2, E3, nu12, nu13, nu23, G12, G13, G23, nu_ij being the contraction along
   !> j under tension along i; zero where the compliance of the normal stresses is singular.
   pure function engineering_elasticity(constants) result(d)
      real(dp), intent(in) :: constants(9)   !! see above [stress], [-], [stress]
      real(dp) :: d(6, 6)                    !! [stress]
      real(dp) :: c(3, 3), adjugate(3, 3), determinant
      integer :: i, j

      associate (young => constants(1:3), ratio => constants(4:6))
         c(:, 1) = [1.0_dp, -ratio(1), -ratio(2)]/young(1)
         c(:, 2) = [c(2, 1), 1/young(2), -ratio(3)/young(2)]
         c(:, 3) = [c(3, 1), c(3, 2), 1/young(3)]
      end associate
      do j = 1, 3
         do i = 1, 3
            associate (i1 => mod(i, 3) + 1, i2 => mod(i + 1, 3) + 1, j1 => mod(j, 3) + 1, &
               j2 => mod(j + 1, 3) + 1)
               adjugate(j, i) = c(i1, j1)*c(i2, j2) - c(i1, j2)*c(i2, j1)
            end associate
         end do
      end do
      determinant = dot_product(c(1, :), adjugate(:, 1))
      d = 0.0_dp
      if (abs(determinant) > 0.0_dp) d(:3, :3) = adjugate/determinant
      do i = 4, 6
         d(i, i) = constants(i + 3)
      end do
   end function engineering_elasticity

   !> Stiffness from D1111, D1122, D2222, D1133, D2233, D3333, D1212, D1313, D2323.
   pure function orthotropic_elasticity(constants) result(d)
      real(dp), intent(in) :: constants(9)   !! see above [stress]
      real(dp) :: d(6, 6)                    !! [stress]
      real(dp) :: all_constants(21)

      all_constants = 0.0_dp
      all_constants(:6) = constants(:6)
      all_constants([10, 15, 21]) = constants(7:9)
      d = anisotropic_elasticity(all_constants)
   end function orthotropic_elasticity

   !> Stiffness from D1111, D1122, D2222, D1133, D2233, D3333, D1112, D2212, ...: the upper triangle
   !> column by column.
   pure function anisotropic_elasticity(constants) result(d)
      real(dp), intent(in) :: constants(21)   !! see above [stress]
      real(dp) :: d(6, 6)                     !! [stress]
      integer :: i, j

      do j = 1, 6
         do i = 1, j
            d(i, j) = constants(j*(j - 1)/2 + i)
            d(j, i) = d(i, j)
         end do
      end do
   end function anisotropic_elasticity

   !> Whether a symmetric matrix is positive definite, by Cholesky's method.
   pure logical function is_positive_definite(matrix)
      real(dp), intent(in) :: matrix(:, :)   !! symmetric
      real(dp) :: factor(size(matrix, 1), size(matrix, 1)), pivot
      integer :: i, j

      is_positive_definite = .false.
      factor = 0.0_dp
      do j = 1, size(factor, 1)
         pivot = matrix(j, j) - sum(factor(j, :j - 1)**2)
         if (.not. pivot > epsilon(pivot)*abs(matrix(j, j))) return
         factor(j, j) = sqrt(pivot)
         do i = j + 1, size(factor, 1)
            factor(i, j) = (matrix(i, j) - &
               dot_product(factor(i, :j - 1), factor(j, :j - 1)))/factor(j, j)
         end do
      end do
      is_positive_definite = .true.
   end function is_positive_definite

   !> Whether shear across the plane and strain in it depend on each other.
   pure logical function couples_out_of_plane(d)
      real(dp), intent(in) :: d(6, 6)   !! [stress]

      couples_out_of_plane = any(abs(d(:4, 5:6)) > 0.0_dp)
   end function couples_out_of_plane

   !> Poisson's ratio of the isotropic material that has the same mean bulk and shear stiffness of
   !> its normal strains: 1/2 is incompressible.
   pure real(dp) function equivalent_poisson(d)
      real(dp), intent(in) :: d(4, 4)   !! order 11, 22, 33, 12 [stress]
      real(dp) :: all_around, shear, lambda

      all_around = sum(d(:3, :3))
      shear = (3*(d(1, 1) + d(2, 2) + d(3, 3)) - all_around)/12
      lambda = (all_around - 6*shear)/9
      equivalent_poisson = lambda/(2*(lambda + shear))
   end function equivalent_poisson

end module elasticity
