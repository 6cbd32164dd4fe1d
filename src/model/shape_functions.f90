!> Shape functions of the elements and of their sides. The square runs over xi, eta = -1..1; the
!> triangle has its corners at (0, 0), (1, 0), (0, 1).
module shape_functions
   use element_kinds, only: element_corner_count, element_node_count, quad4, quad4_enhanced, &
      quad8, quad8_reduced, triangle3, triangle6
   use kinds, only: dp
   implicit none
   private
   public :: element_shape, element_gradients, side_shape, side_slope, node_position

   !> xi, eta of the eight nodes: corners anticlockwise, then the midsides of 1-2, 2-3, 3-4, 4-1.
   real(dp), parameter :: square_position(2, 8) = reshape( &
      [-1.0_dp, -1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp, &
      0.0_dp, -1.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, -1.0_dp, 0.0_dp], [2, 8])

   !> xi, eta of the six nodes of the triangle.
   real(dp), parameter :: triangle_position(2, 6) = reshape( &
      [0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, &
      0.5_dp, 0.0_dp, 0.5_dp, 0.5_dp, 0.0_dp, 0.5_dp], [2, 6])

   !> Slopes of the area coordinates by xi and eta.
   real(dp), parameter :: area_slope(2, 3) = reshape( &
      [-1.0_dp, -1.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 3])

contains

   !> Local coordinates of the nodes of an element.
   pure function node_position(kind) result(position)
      integer, intent(in) :: kind                             !! kind of the element
      real(dp) :: position(2, element_node_count(kind))       !! xi, eta

      if (element_corner_count(kind) == 3) then
         position = triangle_position(:, :element_node_count(kind))
      else
         position = square_position(:, :element_node_count(kind))
      end if
   end function node_position

   !> psi^q at a point of an element.
   pure function element_shape(kind, point) result(psi)
      integer, intent(in) :: kind                   !! kind of the element
      real(dp), intent(in) :: point(2)              !! xi, eta
      real(dp) :: psi(element_node_count(kind))     !! values
      real(dp) :: area(3), eta, xi
      integer :: q

      area = [1 - point(1) - point(2), point(1), point(2)]
      select case (kind)
      case (quad8, quad8_reduced)
         do q = 1, 4
            xi = point(1)*square_position(1, q)
            eta = point(2)*square_position(2, q)
            psi(q) = (1 + xi)*(1 + eta)*(xi + eta - 1)/4
         end do
         do q = 5, 7, 2
            psi(q) = (1 - point(1)**2)*(1 + point(2)*square_position(2, q))/2
         end do
         do q = 6, 8, 2
            psi(q) = (1 - point(2)**2)*(1 + point(1)*square_position(1, q))/2
         end do
      case (quad4, quad4_enhanced)
         psi = (1 + point(1)*square_position(1, :4))*(1 + point(2)*square_position(2, :4))/4
      case (triangle6)
         psi(1:3) = area*(2*area - 1)
         psi(4:6) = 4*area*cshift(area, 1)
      case (triangle3)
         psi = area
      case default
         psi = 0.0_dp
      end select
   end function element_shape

   !> Derivatives of psi^q by xi and eta.
   pure function local_gradients(kind, point) result(slope)
      integer, intent(in) :: kind                          !! kind of the element
      real(dp), intent(in) :: point(2)                     !! xi, eta
      real(dp) :: slope(2, element_node_count(kind)), a, area(3), b, eta, xi
      integer :: q, next

      select case (kind)
      case (quad8, quad8_reduced)
         do q = 1, 4
            a = square_position(1, q)
            b = square_position(2, q)
            xi = point(1)*a
            eta = point(2)*b
            slope(1, q) = a*(1 + eta)*(2*xi + eta)/4
            slope(2, q) = b*(1 + xi)*(2*eta + xi)/4
         end do
         do q = 5, 7, 2
            b = square_position(2, q)
            slope(1, q) = -point(1)*(1 + point(2)*b)
            slope(2, q) = b*(1 - point(1)**2)/2
         end do
         do q = 6, 8, 2
            a = square_position(1, q)
            slope(1, q) = a*(1 - point(2)**2)/2
            slope(2, q) = -point(2)*(1 + point(1)*a)
         end do
      case (quad4, quad4_enhanced)
         slope(1, :) = square_position(1, :4)*(1 + point(2)*square_position(2, :4))/4
         slope(2, :) = square_position(2, :4)*(1 + point(1)*square_position(1, :4))/4
      case (triangle6)
         area = [1 - point(1) - point(2), point(1), point(2)]
         do q = 1, 3
            next = mod(q, 3) + 1
            slope(:, q) = (4*area(q) - 1)*area_slope(:, q)
            slope(:, q + 3) = 4*(area(q)*area_slope(:, next) + area(next)*area_slope(:, q))
         end do
      case (triangle3)
         slope = area_slope
      case default
         slope = 0.0_dp
      end select
   end function local_gradients

   !> Derivatives of psi^q by x and y, and the Jacobian determinant.
   pure subroutine element_gradients(kind, coordinates, point, gradients, jacobian)
      integer, intent(in) :: kind                 !! kind of the element
      real(dp), intent(in) :: coordinates(:, :)   !! (2, nodes of the kind) [length]
      real(dp), intent(in) :: point(2)            !! xi, eta
      real(dp), intent(out) :: gradients(:, :)    !! (2, nodes) d psi/dx, d psi/dy [1/length]
      real(dp), intent(out) :: jacobian           !! d(x, y)/d(xi, eta) [length^2]
      real(dp) :: slope(2, element_node_count(kind)), map(2, 2)
      integer :: q

      slope = local_gradients(kind, point)
      map = 0.0_dp
      do q = 1, size(slope, 2)
         map(:, 1) = map(:, 1) + slope(:, q)*coordinates(1, q)
         map(:, 2) = map(:, 2) + slope(:, q)*coordinates(2, q)
      end do
      jacobian = map(1, 1)*map(2, 2) - map(1, 2)*map(2, 1)
      if (abs(jacobian) <= 0.0_dp) then
         ! An element without area, which callers find by its Jacobian.
         gradients = 0.0_dp
         return
      end if
      do q = 1, size(slope, 2)
         gradients(1, q) = (map(2, 2)*slope(1, q) - map(1, 2)*slope(2, q))/jacobian
         gradients(2, q) = (map(1, 1)*slope(2, q) - map(2, 1)*slope(1, q))/jacobian
      end do
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
