!> Strains and rotations of the elements of a mesh.
module strains
   use element_kinds, only: axisymmetric, element_node_count
   use kinds, only: dp
   use mesh, only: mesh_type
   use quadrature, only: recovery_count, recovery_points
   use shape_functions, only: element_gradients, element_shape
   implicit none
   private
   public :: largest_deformation, of_strain, of_rotation

   integer, parameter :: of_strain = 1     !! largest principal strain
   integer, parameter :: of_rotation = 2   !! rotation in the plane

contains

   !> Largest magnitudes of a principal strain, thermal strain included, and of the rotation in the
   !> plane, at the points where stress is recovered.
   pure subroutine largest_deformation(mesh, displacement, largest, element)
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: displacement(:, :)    !! (2, nodes) [length]
      real(dp), intent(out) :: largest(2)           !! of_strain [-], of_rotation [radian]
      integer, intent(out) :: element(2)            !! indexes of the elements that have them
      real(dp) :: there(2)
      integer :: e

      largest = -1.0_dp
      element = 0
      do e = 1, size(mesh%element_kind)
         associate (nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
            there = element_deformation(mesh%element_kind(e), mesh%element_plane(e), &
               mesh%coordinates(:, nodes), displacement(:, nodes))
         end associate
         where (there > largest)
            largest = there
            element = e
         end where
      end do
   end subroutine largest_deformation

   pure function element_deformation(kind, plane, coordinates, displacement) result(largest)
      integer, intent(in) :: kind, plane
      real(dp), intent(in) :: coordinates(:, :), displacement(:, :)
      real(dp) :: largest(2)
      real(dp) :: points(2, recovery_count(kind)), gradients(2, element_node_count(kind))
      real(dp) :: psi(element_node_count(kind)), slope(2, 2), jacobian
      integer :: g

      largest = 0.0_dp
      points = recovery_points(kind)
      do g = 1, size(points, 2)
         call element_gradients(kind, coordinates, points(:, g), gradients, jacobian)
         slope = matmul(displacement, transpose(gradients))
         largest(of_strain) = max(largest(of_strain), 0.5_dp*(abs(slope(1, 1) + slope(2, 2)) + &
            hypot(slope(1, 1) - slope(2, 2), slope(1, 2) + slope(2, 1))))
         largest(of_rotation) = max(largest(of_rotation), 0.5_dp*abs(slope(2, 1) - slope(1, 2)))
         if (plane /= axisymmetric) cycle
         psi = element_shape(kind, points(:, g))
         largest(of_strain) = max(largest(of_strain), abs(dot_product(psi, displacement(1, :))/ &
            dot_product(psi, coordinates(1, :))))
      end do
   end function element_deformation

end module strains
