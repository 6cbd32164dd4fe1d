!> Heat conduction in one eight-node element.
module element_conduction
   use element_kinds, only: quad8
   use kinds, only: dp
   use quadrature, only: integration_rule
   use shape_functions, only: element_gradients
   implicit none
   private
   public :: conduction_matrix, heat_flux_at

contains

   !> Conductance matrix of an element, the first integral of (3.2):
   !> K_pq = integral of (K_x psi^p,x psi^q,x + K_y psi^p,y psi^q,y).
   pure function conduction_matrix(coordinates, conductivity, thickness) result(k)
      real(dp), intent(in) :: coordinates(2, 8)   !! nodes [length]
      real(dp), intent(in) :: conductivity(2)     !! K_x, K_y [power/(length temperature)]
      real(dp), intent(in) :: thickness           !! thickness [length]
      real(dp) :: k(8, 8)                         !! [power/temperature]
      real(dp) :: points(2, 9), weights(9), b(2, 8), jacobian, factor
      integer :: g, q

      call integration_rule(quad8, points, weights)
      k = 0.0_dp
      do g = 1, 9
         call element_gradients(quad8, coordinates, points(:, g), b, jacobian)
         factor = weights(g)*jacobian*thickness
         do q = 1, 8
            k(:, q) = k(:, q) + factor*(conductivity(1)*b(1, q)*b(1, :) &
               + conductivity(2)*b(2, q)*b(2, :))
         end do
      end do
   end function conduction_matrix

   !> Heat flux q = -K grad T, eq. (1.4), at a point of an element.
   pure function heat_flux_at(coordinates, point, conductivity, temperature) result(flux)
      real(dp), intent(in) :: coordinates(2, 8)   !! nodes [length]
      real(dp), intent(in) :: point(2)            !! xi, eta
      real(dp), intent(in) :: conductivity(2)     !! K_x, K_y [power/(length temperature)]
      real(dp), intent(in) :: temperature(8)      !! at the nodes [temperature]
      real(dp) :: flux(2)                         !! q_x, q_y [power/length^2]
      real(dp) :: b(2, 8), jacobian

      call element_gradients(quad8, coordinates, point, b, jacobian)
      flux = -conductivity*matmul(b, temperature)
   end function heat_flux_at

end module element_conduction
