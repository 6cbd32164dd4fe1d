!> Integrals over an element: nodal shares of what acts on its volume. The volume dV is the
!> thickness times dA, or 2 pi r dA in an axisymmetric model, where the thickness is not used.
module body_integrals
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use quadrature, only: load_point_count, load_rule
   use shape_functions, only: element_gradients, element_shape
   use side_integrals, only: area_factor
   implicit none
   private
   public :: body_weights, body_weights_radius, body_moments

contains

   !> Integral of psi^q dV: nodal forces or rates of a unit load per volume.
   pure function body_weights(kind, coordinates, thickness, axisymmetric) result(weights)
      integer, intent(in) :: kind                   !! kind of the element
      real(dp), intent(in) :: coordinates(:, :)     !! (2, nodes of the kind) [length]
      real(dp), intent(in) :: thickness             !! thickness [length]
      logical, intent(in) :: axisymmetric           !! whether x is a radius
      real(dp) :: weights(element_node_count(kind)) !! (nodes) [length^3]
      real(dp) :: moments(3, element_node_count(kind))

      moments = volume_moments(kind, coordinates, thickness, axisymmetric)
      weights = moments(1, :)
   end function body_weights

   !> Integral of psi^q r dV, the direction of r along x: nodal forces of a body that turns round
   !> the axis x = 0, per density and squared angular speed.
   pure function body_weights_radius(kind, coordinates, thickness, axisymmetric) result(weights)
      integer, intent(in) :: kind                   !! kind of the element
      real(dp), intent(in) :: coordinates(:, :)     !! (2, nodes of the kind) [length]
      real(dp), intent(in) :: thickness             !! thickness [length]
      logical, intent(in) :: axisymmetric           !! whether x is a radius
      real(dp) :: weights(element_node_count(kind)) !! (nodes) [length^4]
      real(dp) :: moments(2, element_node_count(kind))

      moments = body_moments(kind, coordinates, thickness, axisymmetric)
      weights = moments(1, :)
   end function body_weights_radius

   !> Integral of psi^q (x, y) dV: nodal forces of a body that turns round the origin in its plane,
   !> per density and squared angular speed.
   pure function body_moments(kind, coordinates, thickness, axisymmetric) result(moments)
      integer, intent(in) :: kind                       !! kind of the element
      real(dp), intent(in) :: coordinates(:, :)         !! (2, nodes of the kind) [length]
      real(dp), intent(in) :: thickness                 !! thickness [length]
      logical, intent(in) :: axisymmetric               !! whether x is a radius
      real(dp) :: moments(2, element_node_count(kind))  !! (2, nodes) [length^4]
      real(dp) :: all_moments(3, element_node_count(kind))

      all_moments = volume_moments(kind, coordinates, thickness, axisymmetric)
      moments = all_moments(2:3, :)
   end function body_moments

   !> Integrals of psi^q (1, x, y) dV.
   pure function volume_moments(kind, coordinates, thickness, axisymmetric) result(moments)
      integer, intent(in) :: kind
      real(dp), intent(in) :: coordinates(:, :)
      real(dp), intent(in) :: thickness
      logical, intent(in) :: axisymmetric
      real(dp) :: moments(3, element_node_count(kind))
      real(dp) :: points(2, load_point_count(kind)), weights(load_point_count(kind))
      real(dp) :: gradients(2, element_node_count(kind)), psi(element_node_count(kind))
      real(dp) :: position(2), jacobian, factor
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
   end function volume_moments

end module body_integrals
