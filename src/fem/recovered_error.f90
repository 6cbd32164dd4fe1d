!> The estimate of Zienkiewicz & Zhu (Int. J. Num. Meth. Eng. 24 (1987) 337) in one element: how far
!> its stress or flux s is from a smooth one s*, which is better, given at the nodes.
!>
!> Points: 3 x 3 in elements of eight nodes, 2 x 2 in those of four, six and three in triangles. In
!> parallelograms and straight triangles these integrate the square of s* - s exactly, s* being of
!> the element's shape functions. Not the 2 x 2 points at which s of elements of eight nodes is
!> best: there s* is s, but for what smoothing leaves, and their sum would be near zero.
module recovered_error
   use element_kinds, only: kind_count, quad8, quad8_reduced, triangle6
   use kinds, only: dp
   use mesh, only: nodes_per_element
   use point_fields, only: integration_rules, most => most_field_points, point_rule, &
      point_rule_type
   use quadrature, only: load_point_count, load_rule
   implicit none
   private
   public :: element_error_type, measure_stress, measure_heat_flux, error_rules, error_record_type

   !> Estimated discretisation error of stress or of heat flux (Zienkiewicz & Zhu).
   type :: error_record_type
      !> (bodies) error in the energy norm, relative to that of the whole; 0 without either
      real(dp), allocatable :: body(:)
      !> (elements) root mean square of the difference to the recovered field [stress or flux]
      real(dp), allocatable :: element(:)
   end type error_record_type

   !> Integrals over an element.
   type :: element_error_type
      real(dp) :: error = 0.0_dp    !! of (s* - s)^T C^-1 (s* - s)
      real(dp) :: energy = 0.0_dp   !! of s^T C^-1 s
      real(dp) :: square = 0.0_dp   !! of |s* - s|^2
      real(dp) :: volume = 0.0_dp   !! of one
   end type element_error_type

contains

   !> The points at which errors are integrated.
   pure function error_rules() result(rules)
      type(point_rule_type) :: rules(kind_count)   !! by kind; weights sum to 4 (square) or 1/2
      integer, parameter :: higher(3) = [quad8, quad8_reduced, triangle6]
      real(dp) :: points(2, most), weights(most)
      integer :: i

      rules = integration_rules()
      do i = 1, size(higher)
         associate (n => load_point_count(higher(i)))
            call load_rule(higher(i), points(:, :n), weights(:n))
            rules(higher(i)) = point_rule(higher(i), points(:, :n), weights(:n))
         end associate
      end do
   end function error_rules

   !> The integrals of stress over two points of an element.
   pure subroutine measure_stress(rule, g, smooth, values, compliance, volume, measured)
      type(point_rule_type), intent(in) :: rule             !! points of the kind
      integer, intent(in) :: g                              !! first of the two points
      real(dp), intent(in) :: smooth(4, nodes_per_element)  !! s* at the nodes [stress]
      real(dp), intent(in) :: values(most, 4)               !! s at the points [stress]
      real(dp), intent(in) :: compliance(4, 4)              !! C^-1 [1/stress]
      real(dp), intent(in) :: volume(2)                     !! that each stands for [length^3]
      type(element_error_type), intent(inout) :: measured   !! the integrals, added to
      real(dp) :: d(2, 4), error(2), energy(2)
      integer :: i, q

      d = -values(g:g + 1, :)
      do q = 1, rule%nodes
         d(:, 1) = d(:, 1) + rule%shape(g:g + 1, q)*smooth(1, q)
         d(:, 2) = d(:, 2) + rule%shape(g:g + 1, q)*smooth(2, q)
         d(:, 3) = d(:, 3) + rule%shape(g:g + 1, q)*smooth(3, q)
         d(:, 4) = d(:, 4) + rule%shape(g:g + 1, q)*smooth(4, q)
      end do
      error = 0.0_dp
      energy = 0.0_dp
      do i = 1, 4
         error = error + d(:, i)*(compliance(1, i)*d(:, 1) + compliance(2, i)*d(:, 2) + &
            compliance(3, i)*d(:, 3) + compliance(4, i)*d(:, 4))
         energy = energy + values(g:g + 1, i)*(compliance(1, i)*values(g:g + 1, 1) + &
            compliance(2, i)*values(g:g + 1, 2) + compliance(3, i)*values(g:g + 1, 3) + &
            compliance(4, i)*values(g:g + 1, 4))
      end do
      measured%error = measured%error + sum(volume*error)
      measured%energy = measured%energy + sum(volume*energy)
      ! Shear stress is twice in the tensor.
      measured%square = measured%square + sum(volume*(d(:, 1)**2 + d(:, 2)**2 + d(:, 3)**2 + &
         2*d(:, 4)**2))
      measured%volume = measured%volume + sum(volume)
   end subroutine measure_stress

   !> The integrals of heat flux over two points of an element.
   pure subroutine measure_heat_flux(rule, g, smooth, values, resistivity, volume, measured)
      type(point_rule_type), intent(in) :: rule             !! points of the kind
      integer, intent(in) :: g                              !! first of the two points
      real(dp), intent(in) :: smooth(2, nodes_per_element)  !! s* at the nodes [power/length^2]
      real(dp), intent(in) :: values(most, 2)               !! s at the points [power/length^2]
      real(dp), intent(in) :: resistivity(2, 2)             !! C^-1 [length temperature/power]
      real(dp), intent(in) :: volume(2)                     !! that each stands for [length^3]
      type(element_error_type), intent(inout) :: measured   !! the integrals, added to
      real(dp) :: d(2, 2), x(2), y(2)
      integer :: q

      x = values(g:g + 1, 1)
      y = values(g:g + 1, 2)
      d(:, 1) = -x
      d(:, 2) = -y
      do q = 1, rule%nodes
         d(:, 1) = d(:, 1) + rule%shape(g:g + 1, q)*smooth(1, q)
         d(:, 2) = d(:, 2) + rule%shape(g:g + 1, q)*smooth(2, q)
      end do
      associate (c => resistivity)
         measured%error = measured%error + sum(volume*(c(1, 1)*d(:, 1)**2 + &
            2*c(1, 2)*d(:, 1)*d(:, 2) + c(2, 2)*d(:, 2)**2))
         measured%energy = measured%energy + sum(volume*(c(1, 1)*x**2 + 2*c(1, 2)*x*y + &
            c(2, 2)*y**2))
      end associate
      measured%square = measured%square + sum(volume*(d(:, 1)**2 + d(:, 2)**2))
      measured%volume = measured%volume + sum(volume)
   end subroutine measure_heat_flux

end module recovered_error
