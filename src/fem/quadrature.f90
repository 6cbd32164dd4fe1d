!> Gauss-Legendre points on [-1, 1] and on the square.
module quadrature
   use kinds, only: dp
   implicit none
   private
   public :: gauss_point_3, gauss_weight_3, square_points, gauss_coordinate_2

   real(dp), parameter :: gauss_point_3(3) = &
      [-0.774596669241483377_dp, 0.0_dp, 0.774596669241483377_dp]     !! roots of P3
   real(dp), parameter :: gauss_weight_3(3) = &
      [5.0_dp/9.0_dp, 8.0_dp/9.0_dp, 5.0_dp/9.0_dp]                    !! their weights
   real(dp), parameter :: gauss_coordinate_2 = 0.577350269189625765_dp !! root of P2

contains

   !> The 3 x 3 rule, exact for products of polynomials of degree 5.
   pure subroutine square_points(points, weights)
      real(dp), intent(out) :: points(2, 9)   !! xi, eta of each point
      real(dp), intent(out) :: weights(9)     !! weights; their sum is 4
      integer :: i, j

      do j = 1, 3
         do i = 1, 3
            points(:, 3*(j - 1) + i) = [gauss_point_3(i), gauss_point_3(j)]
            weights(3*(j - 1) + i) = gauss_weight_3(i)*gauss_weight_3(j)
         end do
      end do
   end subroutine square_points

end module quadrature
