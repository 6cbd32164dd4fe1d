!> Shape functions of the eight-node element and of its three-node sides.
module shape_functions
   use kinds, only: dp
   implicit none
   private
   public :: element_shape, element_gradients, side_shape, side_slope
   public :: node_position

   !> xi, eta of the eight nodes: corners anticlockwise, then the midsides of 1-2, 2-3, 3-4, 4-1.
   real(dp), parameter :: node_position(2, 8) = reshape( &
      [-1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, &
      0.0_dp, -1.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, -1.0_dp, 0.0_dp], [2, 8])

contains

   !> psi^q at a point of the square.
   pure function element_shape(point) result(psi)
      real(dp), intent(in) :: point(2)   !! xi, eta
      real(dp) :: psi(8)                 !! values
      real(dp) :: xi, eta
      integer :: q

      do q = 1, 4
         xi = point(1)*node_position(1, q)
         eta = point(2)*node_position(2, q)
         psi(q) = (1 + xi)*(1 + eta)*(xi + eta - 1)/4
      end do
      do q = 5, 7, 2
         psi(q) = (1 - point(1)**2)*(1 + point(2)*node_position(2, q))/2
      end do
      do q = 6, 8, 2
         psi(q) = (1 - point(2)**2)*(1 + point(1)*node_position(1, q))/2
      end do
   end function element_shape

   !> Derivatives of psi^q by xi and eta.
   pure function local_gradients(point) result(slope)
      real(dp), intent(in) :: point(2)
      real(dp) :: slope(2, 8)
      real(dp) :: a, b, xi, eta
      integer :: q

      do q = 1, 4
         a = node_position(1, q)
         b = node_position(2, q)
         xi = point(1)*a
         eta = point(2)*b
         slope(1, q) = a*(1 + eta)*(2*xi + eta)/4
         slope(2, q) = b*(1 + xi)*(2*eta + xi)/4
      end do
      do q = 5, 7, 2
         b = node_position(2, q)
         slope(1, q) = -point(1)*(1 + point(2)*b)
         slope(2, q) = b*(1 - point(1)**2)/2
      end do
      do q = 6, 8, 2
         a = node_position(1, q)
         slope(1, q) = a*(1 - point(2)**2)/2
         slope(2, q) = -point(2)*(1 + point(1)*a)
      end do
   end function local_gradients

   !> Derivatives of psi^q by x and y, and the Jacobian determinant.
   pure subroutine element_gradients(coordinates, point, gradients, jacobian)
      real(dp), intent(in) :: coordinates(2, 8)   !! nodes [length]
      real(dp), intent(in) :: point(2)            !! xi, eta
      real(dp), intent(out) :: gradients(2, 8)    !! d psi/dx, d psi/dy [1/length]
      real(dp), intent(out) :: jacobian           !! d(x, y)/d(xi, eta) [length^2]
      real(dp) :: slope(2, 8), map(2, 2)

      slope = local_gradients(point)
      map = matmul(slope, transpose(coordinates))
      jacobian = map(1, 1)*map(2, 2) - map(1, 2)*map(2, 1)
      gradients(1, :) = (map(2, 2)*slope(1, :) - map(1, 2)*slope(2, :))/jacobian
      gradients(2, :) = (map(1, 1)*slope(2, :) - map(2, 1)*slope(1, :))/jacobian
   end subroutine element_gradients

   !> Shape functions of a side: first corner, midside node if there is one, second corner.
   pure function side_shape(nodes, xi) result(psi)
      integer, intent(in) :: nodes   !! 2 or 3
      real(dp), intent(in) :: xi     !! -1 at the first corner, 1 at the second
      real(dp) :: psi(nodes)         !! values

      if (nodes == 2) then
         psi = [(1 - xi)/2, (1 + xi)/2]
      else
         psi = [xi*(xi - 1)/2, 1 - xi**2, xi*(xi + 1)/2]
      end if
   end function side_shape

   !> Their derivatives by xi.
   pure function side_slope(nodes, xi) result(slope)
      integer, intent(in) :: nodes   !! 2 or 3
      real(dp), intent(in) :: xi     !! -1 at the first corner, 1 at the second
      real(dp) :: slope(nodes)       !! derivatives

      if (nodes == 2) then
         slope = [-0.5_dp, 0.5_dp]
      else
         slope = [xi - 0.5_dp, -2*xi, xi + 0.5_dp]
      end if
   end function side_slope

end module shape_functions
