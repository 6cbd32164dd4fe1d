!> The estimate of Zienkiewicz & Zhu (Int. J. Num. Meth. Eng. 24 (1987) 337) in one element: how far
!> its stress or flux s is from a smooth one s*, which is better, given at the nodes.
!>
!> Points: 3 x 3 in elements of eight nodes, 2 x 2 in those of four, six and three in triangles. In
!> parallelograms and straight triangles these integrate the square of s* - s exactly, s* being of
!> the element's shape functions. Not the 2 x 2 points at which s of elements of eight nodes is
!> best: there s* is s, but for what smoothing leaves, and their sum would be near zero.
module recovered_error
   use element_kinds, only: kind_count, quad4, quad8, quad8_reduced, triangle3, triangle6
   use kinds, only: dp
   use point_fields, only: apply_to_points, most => most_field_points
   use quadrature, only: integration_rule, load_point_count, load_rule, point_count
   implicit none
   private
   public :: element_error_type, measure_element, error_points

   !> Integrals over an element.
   type :: element_error_type
      real(dp) :: error = 0.0_dp    !! of (s* - s)^T C^-1 (s* - s)
      real(dp) :: energy = 0.0_dp   !! of s^T C^-1 s
      real(dp) :: square = 0.0_dp   !! of |s* - s|^2
      real(dp) :: volume = 0.0_dp   !! of one
   end type element_error_type

contains

   !> The points at which errors are integrated.
   pure subroutine error_points(points, weights, counts)
      real(dp), intent(out) :: points(2, most, kind_count)   !! xi, eta
      real(dp), intent(out) :: weights(most, kind_count)     !! sum 4 (square) or 1/2 (triangle)
      integer, intent(out) :: counts(kind_count)             !! points of a kind
      integer, parameter :: kinds(kind_count) = [quad8, quad8_reduced, quad4, triangle6, triangle3]
      integer :: i, k, n

      points = 0.0_dp
      weights = 0.0_dp
      do i = 1, kind_count
         k = kinds(i)
         if (k == quad4 .or. k == triangle3) then
            n = point_count(k)
            call integration_rule(k, points(:, :n, k), weights(:n, k))
         else
            n = load_point_count(k)
            call load_rule(k, points(:, :n, k), weights(:n, k))
         end if
         counts(k) = n
      end do
   end subroutine error_points

   !> The integrals over the points of an element at which one matrix C^-1 holds.
   pure subroutine measure_element(components, first, last, shape, smooth, values, softness, &
      volume, measured)
      integer, intent(in) :: components                 !! 4 for stress, 2 for flux
      integer, intent(in) :: first                      !! first of the points
      integer, intent(in) :: last                       !! last of them
      real(dp), intent(in) :: shape(:, :)               !! (points, nodes) psi
      real(dp), intent(in) :: smooth(:, :)              !! (components, nodes) s*
      real(dp), intent(in) :: values(most, components)  !! (points, components) s
      real(dp), intent(in) :: softness(components, components)   !! C^-1
      real(dp), intent(in) :: volume(:)                 !! (points) that each stands for [length^3]
      type(element_error_type), intent(inout) :: measured        !! the integrals, added to
      real(dp) :: difference(most, 4), product(most, 4), error(most), energy(most), square(most)
      integer :: c, q

      do c = 1, components
         difference(first:last, c) = -values(first:last, c)
         do q = 1, size(shape, 2)
            difference(first:last, c) = difference(first:last, c) + &
               shape(first:last, q)*smooth(c, q)
         end do
      end do
      error(first:last) = 0.0_dp
      energy(first:last) = 0.0_dp
      square(first:last) = 0.0_dp
      call apply_to_points(softness, components, first, last, difference, product)
      do c = 1, components
         error(first:last) = error(first:last) + difference(first:last, c)*product(first:last, c)
         ! Shear stress stands twice in the tensor.
         square(first:last) = square(first:last) + merge(2, 1, c == 4)*difference(first:last, c)**2
      end do
      call apply_to_points(softness, components, first, last, values, product)
      do c = 1, components
         energy(first:last) = energy(first:last) + values(first:last, c)*product(first:last, c)
      end do
      measured%error = measured%error + dot_product(volume(first:last), error(first:last))
      measured%energy = measured%energy + dot_product(volume(first:last), energy(first:last))
      measured%square = measured%square + dot_product(volume(first:last), square(first:last))
      measured%volume = measured%volume + sum(volume(first:last))
   end subroutine measure_element

end module recovered_error
