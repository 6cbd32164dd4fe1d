!> Strains of the elements of a mesh.
module strains
   use element_kinds, only: axisymmetric, element_node_count
   use kinds, only: dp
   use mesh, only: mesh_type
   use quadrature, only: recovery_count, recovery_points
   use shape_functions, only: element_gradients, element_shape
   implicit none
   private
   public :: largest_strain

contains

   !> Largest magnitude of a principal strain, thermal strain included, at the points where stress
   !> is recovered.
   pure subroutine largest_strain(mesh, displacement, strain, element)
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: displacement(:, :)    !! (2, nodes) [length]
      real(dp), intent(out) :: strain               !! [-]
      integer, intent(out) :: element               !! index of the element that has it
      real(dp) :: there
      integer :: e

      strain = -1.0_dp
      element = 0
      do e = 1, size(mesh%element_kind)
         associate (nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
            there = element_strain(mesh%element_kind(e), mesh%element_plane(e), &
               mesh%coordinates(:, nodes), displacement(:, nodes))
         end associate
         if (.not. there > strain) cycle
         strain = there
         element = e
      end do
   end subroutine largest_strain

   pure function element_strain(kind, plane, coordinates, displacement) result(largest)
      integer, intent(in) :: kind, plane
      real(dp), intent(in) :: coordinates(:, :), displacement(:, :)
      real(dp) :: largest
      real(dp) :: points(2, recovery_count(kind)), gradients(2, element_node_count(kind))
      real(dp) :: psi(element_node_count(kind)), slope(2, 2), jacobian
      integer :: g

      largest = 0.0_dp
      points = recovery_points(kind)
      do g = 1, size(points, 2)
         call element_gradients(kind, coordinates, points(:, g), gradients, jacobian)
         slope = matmul(displacement, transpose(gradients))
         largest = max(largest, 0.5_dp*(abs(slope(1, 1) + slope(2, 2)) + &
            hypot(slope(1, 1) - slope(2, 2), slope(1, 2) + slope(2, 1))))
         if (plane /= axisymmetric) cycle
         psi = element_shape(kind, points(:, g))
         largest = max(largest, abs(dot_product(psi, displacement(1, :))/ &
            dot_product(psi, coordinates(1, :))))
      end do
   end function element_strain

end module strains
