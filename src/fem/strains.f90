!> Strains and rotations of the elements of a mesh.
module strains
   use element_kinds, only: axisymmetric, kind_count
   use field_recovery, only: recovery_rules
   use kinds, only: dp
   use mesh, only: mesh_type
   use point_fields, only: point_rule_type
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
      type(point_rule_type) :: rules(kind_count)
      real(dp) :: there(2)
      integer :: e

      rules = recovery_rules()
      largest = -1.0_dp
      element = 0
      do e = 1, size(mesh%element_kind)
         there = element_deformation(mesh, e, displacement, rules(mesh%element_kind(e)))
         where (there > largest)
            largest = there
            element = e
         end where
      end do
   end subroutine largest_deformation

   pure function element_deformation(mesh, e, displacement, rule) result(largest)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      real(dp), intent(in) :: displacement(:, :)
      type(point_rule_type), intent(in) :: rule
      real(dp) :: largest(2)
      real(dp) :: values(4, 8)    ! coordinates and displacements of the nodes
      real(dp) :: map(4, 2)       ! their derivatives by xi and eta
      real(dp) :: at_point(4)     ! what they are at a point
      real(dp) :: jacobian, slope(2, 2)
      integer :: g, n, q

      largest = 0.0_dp
      n = rule%nodes
      do q = 1, n
         values(:2, q) = mesh%coordinates(:, mesh%element_nodes(q, e))
         values(3:, q) = displacement(:, mesh%element_nodes(q, e))
      end do
      do g = 1, rule%count
         map = 0.0_dp
         do q = 1, n
            map(:, 1) = map(:, 1) + rule%slope_xi(g, q)*values(:, q)
            map(:, 2) = map(:, 2) + rule%slope_eta(g, q)*values(:, q)
         end do
         jacobian = map(1, 1)*map(2, 2) - map(1, 2)*map(2, 1)
         slope = 0.0_dp
         if (abs(jacobian) > 0.0_dp) then
            slope(:, 1) = (map(2, 2)*map(3:, 1) - map(2, 1)*map(3:, 2))/jacobian
            slope(:, 2) = (map(1, 1)*map(3:, 2) - map(1, 2)*map(3:, 1))/jacobian
         end if
         largest(of_strain) = max(largest(of_strain), 0.5_dp*(abs(slope(1, 1) + slope(2, 2)) + &
            sqrt((slope(1, 1) - slope(2, 2))**2 + (slope(1, 2) + slope(2, 1))**2)))
         largest(of_rotation) = max(largest(of_rotation), 0.5_dp*abs(slope(2, 1) - slope(1, 2)))
         if (mesh%element_plane(e) /= axisymmetric) cycle
         at_point = matmul(values(:, :n), rule%shape(g, :n))
         largest(of_strain) = max(largest(of_strain), abs(at_point(3)/at_point(1)))
      end do
   end function element_deformation

end module strains
