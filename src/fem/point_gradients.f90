!> Strains and gradients at the points of an element, two at a time, which the compiler turns into
!> vector instructions. Arrays run over the points first; a rule of an odd number of points ends in
!> one without weight.
module point_gradients
   use kinds, only: dp
   use mesh, only: nodes_per_element
   use quadrature, only: most => most_points_of_rule, point_rule_type
   implicit none
   private
   public :: add_hoop_strain, find_negative_gradient, find_strains, set_mean_dilatation, &
      strain_along_z

contains

   !> Strains, but for zz, which is zero, and the temperature.
   pure subroutine find_strains(rule, inverse, u, strain, warmth)
      type(point_rule_type), intent(in) :: rule
      real(dp), intent(in) :: inverse(4, *), u(3, nodes_per_element)
      real(dp), intent(out) :: strain(most, 4), warmth(most)
      real(dp), dimension(2) :: x_xi, x_eta, y_xi, y_eta, t
      integer :: g, q

      do g = 1, rule%count, 2
         x_xi = 0.0_dp
         x_eta = 0.0_dp
         y_xi = 0.0_dp
         y_eta = 0.0_dp
         t = 0.0_dp
         do q = 1, rule%nodes
            x_xi = x_xi + rule%slope_xi(g:g + 1, q)*u(1, q)
            x_eta = x_eta + rule%slope_eta(g:g + 1, q)*u(1, q)
            y_xi = y_xi + rule%slope_xi(g:g + 1, q)*u(2, q)
            y_eta = y_eta + rule%slope_eta(g:g + 1, q)*u(2, q)
            t = t + rule%shape(g:g + 1, q)*u(3, q)
         end do
         strain(g:g + 1, 1) = x_xi*inverse(1, g:g + 1) + x_eta*inverse(2, g:g + 1)
         strain(g:g + 1, 2) = y_xi*inverse(3, g:g + 1) + y_eta*inverse(4, g:g + 1)
         strain(g:g + 1, 3) = 0.0_dp
         strain(g:g + 1, 4) = x_xi*inverse(3, g:g + 1) + x_eta*inverse(4, g:g + 1) + &
            y_xi*inverse(1, g:g + 1) + y_eta*inverse(2, g:g + 1)
         warmth(g:g + 1) = t
      end do
   end subroutine find_strains

   !> u_x/r.
   pure subroutine add_hoop_strain(rule, nodes, coordinates, displacement, strain)
      type(point_rule_type), intent(in) :: rule
      integer, intent(in) :: nodes(:)
      real(dp), intent(in) :: coordinates(:, :), displacement(:, :)
      real(dp), intent(inout) :: strain(:)
      integer :: g

      associate (mine => nodes(:rule%nodes))
         do g = 1, size(strain)
            strain(g) = strain(g) + dot_product(rule%shape(g, :rule%nodes), displacement(1, &
               mine))/dot_product(rule%shape(g, :rule%nodes), coordinates(1, mine))
         end do
      end associate
   end subroutine add_hoop_strain

   !> eps_zz of a generalized plane strain per unit of the change of the thickness at the reference
   !> node and of the turns of a face about x and y (Abaqus Theory Guide, Generalized plane strain
   !> elements).
   pure function strain_along_z(arm, thickness) result(strain)
      real(dp), intent(in) :: arm(2)               !! from the reference node [length]
      real(dp), intent(in) :: thickness            !! [length]
      real(dp) :: strain(3)                        !! [1/length], [-], [-]

      strain = [1.0_dp, arm(2), -arm(1)]/thickness
   end function strain_along_z

   !> B-bar, as in element_elasticity; the points are those of its integration.
   pure subroutine set_mean_dilatation(volume, strain)
      real(dp), intent(in) :: volume(:)
      real(dp), intent(inout) :: strain(most, 4)
      real(dp) :: mean, change
      integer :: g

      mean = 0.0_dp
      do g = 1, size(volume)
         mean = mean + volume(g)*sum(strain(g, :3))
      end do
      mean = mean/sum(volume)
      do g = 1, size(volume)
         change = (mean - sum(strain(g, :3)))/3
         strain(g, :3) = strain(g, :3) + change
      end do
   end subroutine set_mean_dilatation

   !> -grad T.
   pure subroutine find_negative_gradient(rule, inverse, temperature, negative_gradient)
      type(point_rule_type), intent(in) :: rule
      real(dp), intent(in) :: inverse(4, *), temperature(nodes_per_element)
      real(dp), intent(out) :: negative_gradient(most, 2)
      real(dp), dimension(2) :: xi, eta
      integer :: g, q

      do g = 1, rule%count, 2
         xi = 0.0_dp
         eta = 0.0_dp
         do q = 1, rule%nodes
            xi = xi - rule%slope_xi(g:g + 1, q)*temperature(q)
            eta = eta - rule%slope_eta(g:g + 1, q)*temperature(q)
         end do
         negative_gradient(g:g + 1, 1) = xi*inverse(1, g:g + 1) + eta*inverse(2, g:g + 1)
         negative_gradient(g:g + 1, 2) = xi*inverse(3, g:g + 1) + eta*inverse(4, g:g + 1)
      end do
   end subroutine find_negative_gradient

end module point_gradients
