!> Integrals over an element or one of its sides: nodal shares of loads on it. A side has two nodes,
!> or three with the midside node between the corners, and three Gauss points. The area dA is the
!> thickness times ds, the volume dV the thickness times dA; in an axisymmetric model, where the
!> thickness is not used, they are 2 pi r ds and 2 pi r dA.
module element_integrals
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use quadrature, only: gauss_point_3, gauss_weight_3, load_point_count, load_rule
   use shape_functions, only: element_gradients, element_shape, side_shape, side_slope
   implicit none
   private
   public :: side_weights, side_pressure, side_mass, body_moments, area_factor

   real(dp), parameter :: two_pi = 2*acos(-1.0_dp)

contains

   !> Factor from a length to an area, or from an area to a volume: the thickness, or 2 pi r.
   pure function area_factor(radius, thickness, axisymmetric) result(factor)
      real(dp), intent(in) :: radius         !! x of the point [length]
      real(dp), intent(in) :: thickness      !! thickness [length]
      logical, intent(in) :: axisymmetric    !! whether x is a radius
      real(dp) :: factor                     !! [length]

      factor = thickness
      if (axisymmetric) factor = two_pi*radius
   end function area_factor

   !> Integral of psi^q dA: nodal rates of a unit flux, nodal forces of a unit traction along any
   !> one direction.
   pure function side_weights(coordinates, thickness, axisymmetric) result(weights)
      real(dp), intent(in) :: coordinates(:, :)       !! (2, 2 or 3) nodes of the side [length]
      real(dp), intent(in) :: thickness               !! thickness [length]
      logical, intent(in) :: axisymmetric             !! whether x is a radius
      real(dp) :: weights(size(coordinates, 2))       !! (nodes) [length^2]
      real(dp) :: psi(size(coordinates, 2)), along(2)
      integer :: g

      weights = 0.0_dp
      do g = 1, 3
         call side_point(coordinates, g, psi, along)
         weights = weights + gauss_weight_3(g)*norm2(along)*psi &
            *area_factor(dot_product(psi, coordinates(1, :)), thickness, axisymmetric)
      end do
   end function side_weights

   !> Nodal forces of a unit pressure; the body lies on the left of the direction of the side, and
   !> the pressure pushes towards it.
   pure function side_pressure(coordinates, thickness, axisymmetric) result(forces)
      real(dp), intent(in) :: coordinates(:, :)       !! (2, 2 or 3) nodes of the side [length]
      real(dp), intent(in) :: thickness               !! thickness [length]
      logical, intent(in) :: axisymmetric             !! whether x is a radius
      real(dp) :: forces(2, size(coordinates, 2))     !! (2, nodes) along x and y [length^2]
      real(dp) :: psi(size(coordinates, 2)), along(2), factor
      integer :: g

      forces = 0.0_dp
      do g = 1, 3
         call side_point(coordinates, g, psi, along)
         factor = gauss_weight_3(g) &
            *area_factor(dot_product(psi, coordinates(1, :)), thickness, axisymmetric)
         forces(1, :) = forces(1, :) - factor*along(2)*psi
         forces(2, :) = forces(2, :) + factor*along(1)*psi
      end do
   end function side_pressure

   !> Integral of psi^p psi^q dA.
   pure function side_mass(coordinates, thickness, axisymmetric) result(mass)
      real(dp), intent(in) :: coordinates(:, :)       !! (2, 2 or 3) nodes of the side [length]
      real(dp), intent(in) :: thickness               !! thickness [length]
      logical, intent(in) :: axisymmetric             !! whether x is a radius
      real(dp) :: mass(size(coordinates, 2), size(coordinates, 2)) !! (nodes, nodes) [length^2]
      real(dp) :: psi(size(coordinates, 2)), along(2), factor
      integer :: g, q

      mass = 0.0_dp
      do g = 1, 3
         call side_point(coordinates, g, psi, along)
         factor = gauss_weight_3(g)*norm2(along) &
            *area_factor(dot_product(psi, coordinates(1, :)), thickness, axisymmetric)
         do q = 1, size(psi)
            mass(:, q) = mass(:, q) + factor*psi(q)*psi
         end do
      end do
   end function side_mass

   !> Shape functions and d(x, y)/d xi at a Gauss point of a side.
   pure subroutine side_point(coordinates, g, psi, along)
      real(dp), intent(in) :: coordinates(:, :)
      integer, intent(in) :: g
      real(dp), intent(out) :: psi(:), along(2)

      psi = side_shape(size(coordinates, 2), gauss_point_3(g))
      along = matmul(coordinates, side_slope(size(coordinates, 2), gauss_point_3(g)))
   end subroutine side_point

   !> Integrals of psi^q (1, x, y) dV: nodal forces of a unit load per volume, and those of a body
   !> that turns round the origin in its plane, per density and squared angular speed; the second
   !> row is that of a body that turns round the axis x = 0.
   pure function body_moments(kind, coordinates, thickness, axisymmetric) result(moments)
      integer, intent(in) :: kind                       !! kind of the element
      real(dp), intent(in) :: coordinates(:, :)         !! (2, nodes of the kind) [length]
      real(dp), intent(in) :: thickness                 !! thickness [length]
      logical, intent(in) :: axisymmetric               !! whether x is a radius
      real(dp) :: moments(3, element_node_count(kind))  !! (3, nodes) [length^3, length^4]
      real(dp) :: points(2, load_point_count(kind)), weights(load_point_count(kind)), gradients(2, &
         element_node_count(kind)), psi(element_node_count(kind)), position(2), jacobian, factor
      integer :: g, q

      call load_rule(kind, points, weights)
      moments = 0.0_dp
      do g = 1, size(weights)
         call element_gradients(kind, coordinates, points(:, g), gradients, jacobian)
         psi = element_shape(kind, points(:, g))
         position = matmul(coordinates, psi)
         factor = weights(g)*jacobian*area_factor(position(1), thickness, axisymmetric)
         do q = 1, size(psi)
            moments(:, q) = moments(:, q) + factor*psi(q)*[1.0_dp, position]
         end do
      end do
   end function body_moments

end module element_integrals
