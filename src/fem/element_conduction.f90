!> Heat conduction in one element.
module element_conduction
   use element_integrals, only: area_factor
   use element_kinds, only: axisymmetric, element_node_count
   use kinds, only: dp
   use quadrature, only: integration_rule, load_point_count, load_rule, point_count
   use shape_functions, only: element_gradients, element_shape
   implicit none
   private
   public :: capacity_matrix, conduction_matrix

contains

   !> Conductance matrix of an element, the first integral of (3.2):
   !> K_pq = integral of grad psi^p . K grad psi^q dV.
   pure function conduction_matrix(kind, plane, coordinates, conductivity, thickness) result(k)
      integer, intent(in) :: kind                  !! kind of the element
      integer, intent(in) :: plane                 !! plane_strain, ...
      real(dp), intent(in) :: coordinates(:, :)    !! (2, nodes of the kind) [length]
      !> (2, 2, points of integration_rule, or 1 for all) [power/(length temperature)]
      real(dp), intent(in) :: conductivity(:, :, :)
      real(dp), intent(in) :: thickness            !! thickness; not of axisymmetric ones [length]
      real(dp) :: k(element_node_count(kind), element_node_count(kind)) !! [power/temperature]
      real(dp) :: points(2, point_count(kind)), weights(point_count(kind))
      real(dp) :: b(2, element_node_count(kind)), flux(2, element_node_count(kind))
      real(dp) :: jacobian, radius, factor
      integer :: g, i, q

      call integration_rule(kind, points, weights)
      k = 0.0_dp
      do g = 1, size(weights)
         call element_gradients(kind, coordinates, points(:, g), b, jacobian)
         radius = 0.0_dp
         if (plane == axisymmetric) radius = dot_product(element_shape(kind, points(:, g)), &
            coordinates(1, :))
         factor = weights(g)*jacobian*area_factor(radius, thickness, plane == axisymmetric)
         i = min(g, size(conductivity, 3))
         flux = factor*matmul(conductivity(:, :, i), b)
         do q = 1, size(k, 2)
            k(:, q) = k(:, q) + b(1, :)*flux(1, q) + b(2, :)*flux(2, q)
         end do
      end do
   end function conduction_matrix

   !> Capacity matrix of an element per heat capacity of a unit volume:
   !> C_pq = integral of psi^p psi^q dV; where all nodes are corners lumped, the sums of the rows,
   !> since a consistent one overshoots in short increments.
   pure function capacity_matrix(kind, plane, coordinates, thickness) result(c)
      integer, intent(in) :: kind                  !! kind of the element
      integer, intent(in) :: plane                 !! plane_strain, ...
      real(dp), intent(in) :: coordinates(:, :)    !! (2, nodes of the kind) [length]
      real(dp), intent(in) :: thickness            !! thickness; not of axisymmetric ones [length]
      real(dp) :: c(element_node_count(kind), element_node_count(kind))   !! [length^3]
      real(dp) :: points(2, load_point_count(kind)), weights(load_point_count(kind))
      real(dp) :: b(2, element_node_count(kind)), shape(element_node_count(kind))
      real(dp) :: jacobian, factor, sums(element_node_count(kind))
      integer :: g, q

      call load_rule(kind, points, weights)
      c = 0.0_dp
      do g = 1, size(weights)
         call element_gradients(kind, coordinates, points(:, g), b, jacobian)
         shape = element_shape(kind, points(:, g))
         factor = weights(g)*jacobian*area_factor(dot_product(shape, coordinates(1, :)), &
            thickness, plane == axisymmetric)
         do q = 1, size(c, 2)
            c(:, q) = c(:, q) + factor*shape(q)*shape
         end do
      end do
      if (size(c, 1) > 4) return
      sums = sum(c, dim=2)
      c = 0.0_dp
      do q = 1, size(c, 2)
         c(q, q) = sums(q)
      end do
   end function capacity_matrix

end module element_conduction
