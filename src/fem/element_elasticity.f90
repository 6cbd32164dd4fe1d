!> Thermoelasticity in one element, and the strains of a mesh. Strains and stresses are ordered xx,
!> yy, zz, xy, the shear strain being an angle; degrees of freedom u_x, u_y of node 1, u_x, u_y of
!> node 2, ... In an axisymmetric element x is the radius and zz the circumference: eps_zz = u_x/r.
!>
!> In generalized plane strain the coordinates end with those of the reference node, and three
!> degrees of freedom follow those of the nodes: with x and y from the reference node and t for the
!> thickness, eps_zz = (u_z + phi_x y - phi_y x)/t.
!>
!> Four-node elements of plane strain and axisymmetric ones use the mean dilatation of the element
!> in place of that at each point (B-bar: Hughes, Int. J. Num. Meth. Eng. 15 (1980) 1413), so that
!> nearly incompressible materials do not lock them. Those with incompatible modes have enhanced
!> strains. Axisymmetric ones use the mean of the shear strain over their area, too: where u_x grows
!> with r y and u_y with r^2, as below a contact, u_y is linear between nodes, and the shear strain
!> that is left loads the nodes on the axis by 1/r for 2 pi r is larger on one side of its zero.
module element_elasticity
   use blas_lapack, only: dgemm
   use element_integrals, only: area_factor
   use element_kinds, only: axisymmetric, element_node_count, generalized_strain, kind_count, &
      plane_stress, quad4, quad4_enhanced
   use enhanced_strains, only: enhance_strains
   use field_recovery, only: recovery_rules
   use kinds, only: dp
   use materials, only: section_type
   use mesh, only: mesh_type
   use point_gradients, only: strain_along_z
   use quadrature, only: integration_rule, point_count, point_rule_type
   use shape_functions, only: element_gradients, element_shape
   implicit none
   private
   public :: element_stiffness, element_thermal_load, element_stress_force, largest_deformation, &
      of_strain, of_rotation

   integer, parameter :: of_strain = 1     !! largest principal strain
   integer, parameter :: of_rotation = 2   !! rotation in the plane

contains

   !> Degrees of freedom of an element: two a node, three of a reference node.
   pure integer function freedoms(kind, coordinates)
      integer, intent(in) :: kind
      real(dp), intent(in) :: coordinates(:, :)

      freedoms = 3*size(coordinates, 2) - element_node_count(kind)
   end function freedoms

   !> Stiffness matrix, the element's part of K^n in (2.4): integral of B^T E B.
   pure function element_stiffness(kind, plane, coordinates, e, thickness) result(k)
      integer, intent(in) :: kind                 !! kind of the element
      integer, intent(in) :: plane                !! plane_strain, ...
      real(dp), intent(in) :: coordinates(:, :)   !! (2, nodes) as above [length]
      !> (4, 4, points of integration_rule, or 1 for all) [stress]
      real(dp), intent(in) :: e(:, :, :)
      real(dp), intent(in) :: thickness           !! thickness; not of axisymmetric ones [length]
      real(dp) :: k(freedoms(kind, coordinates), freedoms(kind, coordinates)) !! [stress length]
      real(dp) :: b(4, point_count(kind), size(k, 1)), volumes(point_count(kind))
      real(dp) :: stress(4, point_count(kind), size(k, 1)), weighted(4, 4)
      integer :: g, j

      call strain_matrices(kind, plane, coordinates, thickness, b, volumes, e)
      do g = 1, size(volumes)
         weighted = volumes(g)*e(:, :, min(g, size(e, 3)))
         do j = 1, size(k, 1)
            stress(:, g, j) = weighted(:, 1)*b(1, g, j) + weighted(:, 2)*b(2, g, j) + &
               weighted(:, 3)*b(3, g, j) + weighted(:, 4)*b(4, g, j)
         end do
      end do
      call dgemm('T', 'N', size(k, 1), size(k, 1), 4*size(volumes), 1.0_dp, b, 4*size(volumes), &
         stress, 4*size(volumes), 0.0_dp, k, size(k, 1))
      do j = 2, size(k, 1)
         k(j, :j - 1) = k(:j - 1, j)
      end do
   end function element_stiffness

   !> Nodal forces of a temperature increment, per unit nodal temperature: integral of B^T beta
   !> psi^q.
   pure function element_thermal_load(kind, plane, coordinates, e, beta, thickness) result(load)
      integer, intent(in) :: kind                 !! kind of the element
      integer, intent(in) :: plane                !! plane_strain, ...
      real(dp), intent(in) :: coordinates(:, :)   !! (2, nodes) as above [length]
      !> (4, 4, points of integration_rule, or 1 for all) [stress]
      real(dp), intent(in) :: e(:, :, :)
      !> (4, points of integration_rule, or 1 for all) [stress/temperature]
      real(dp), intent(in) :: beta(:, :)
      real(dp), intent(in) :: thickness           !! thickness; not of axisymmetric ones [length]
      !> (degrees of freedom, nodes) [stress length^2/temperature]
      real(dp) :: load(freedoms(kind, coordinates), element_node_count(kind)), b(4, point_count( &
         kind), size(load, 1)), volumes(point_count(kind)), points(2, point_count(kind)), weights( &
         point_count(kind)), psi(element_node_count(kind)), force(size(load, 1))
      integer :: g, i, q

      call integration_rule(kind, points, weights)
      call strain_matrices(kind, plane, coordinates, thickness, b, volumes, e)
      load = 0.0_dp
      do g = 1, size(volumes)
         psi = element_shape(kind, points(:, g))
         i = min(g, size(beta, 2))
         force = volumes(g)*matmul(beta(:, i), b(:, g, :))
         do q = 1, size(psi)
            load(:, q) = load(:, q) + force*psi(q)
         end do
      end do
   end function element_thermal_load

   !> Nodal forces that a uniform stress of the element exerts: minus the integral of B^T sigma. It
   !> does no work on enhanced strains.
   pure function element_stress_force(kind, plane, coordinates, stress, thickness) result(force)
      integer, intent(in) :: kind                 !! kind of the element
      integer, intent(in) :: plane                !! plane_strain, ...
      real(dp), intent(in) :: coordinates(:, :)   !! (2, nodes) as above [length]
      real(dp), intent(in) :: stress(4)           !! xx, yy, zz, xy [stress]
      real(dp), intent(in) :: thickness           !! thickness; not of axisymmetric ones [length]
      real(dp) :: force(freedoms(kind, coordinates))   !! [force]
      real(dp) :: b(4, point_count(kind), size(force)), volumes(point_count(kind))
      integer :: g

      call strain_matrices(kind, plane, coordinates, thickness, b, volumes)
      force = 0.0_dp
      do g = 1, size(volumes)
         force = force - volumes(g)*matmul(stress, b(:, g, :))
      end do
   end function element_stress_force

   !> B at all integration points, with the means where the element uses them or, for an elasticity,
   !> with the enhanced strains that it has; and the volumes that the points stand for.
   pure subroutine strain_matrices(kind, plane, coordinates, thickness, b, volumes, e)
      integer, intent(in) :: kind, plane
      real(dp), intent(in) :: coordinates(:, :), thickness
      real(dp), intent(out) :: b(:, :, :), volumes(:)
      real(dp), intent(in), optional :: e(:, :, :)
      real(dp) :: points(2, point_count(kind)), weights(point_count(kind)), areas(point_count(kind))
      real(dp), dimension(size(b, 3)) :: change, mean
      integer :: g, i

      call integration_rule(kind, points, weights)
      do g = 1, size(weights)
         call strain_matrix(kind, plane, coordinates, thickness, points(:, g), &
            b(:, g, :2*element_node_count(kind)), volumes(g))
      end do
      if (plane == generalized_strain) then
         ! Those of a reference node.
         associate (n => element_node_count(kind))
            b(:, :, 2*n + 1:) = 0.0_dp
            do g = 1, size(weights)
               b(3, g, 2*n + 1:) = strain_along_z(matmul(coordinates(:, :n), element_shape(kind, &
                  points(:, g))) - coordinates(:, n + 1), thickness)
            end do
         end associate
      end if
      volumes = volumes*weights
      if (present(e) .and. kind == quad4_enhanced) call enhance_strains(coordinates, points, &
         plane == axisymmetric, e, volumes, b)
      if (kind /= quad4 .or. plane == plane_stress) return
      if (plane == axisymmetric) then
         ! The sum of the shape functions over r is 1/r.
         areas = volumes*sum(b(3, :, :), dim=2)
         mean = matmul(areas, b(4, :, :))/sum(areas)
         do g = 1, size(volumes)
            b(4, g, :) = mean
         end do
      end if
      ! Mean of eps_xx + eps_yy + eps_zz over the volume, per degree of freedom.
      mean = 0.0_dp
      do g = 1, size(volumes)
         mean = mean + volumes(g)*sum(b(:3, g, :), dim=1)
      end do
      mean = mean/sum(volumes)
      do g = 1, size(volumes)
         change = (mean - sum(b(:3, g, :), dim=1))/3
         do i = 1, 3
            b(i, g, :) = b(i, g, :) + change
         end do
      end do
   end subroutine strain_matrices

   !> B at a point, and the volume per d xi d eta.
   pure subroutine strain_matrix(kind, plane, coordinates, thickness, point, b, volume)
      integer, intent(in) :: kind, plane
      real(dp), intent(in) :: coordinates(:, :), thickness, point(2)
      real(dp), intent(out) :: b(:, :), volume
      real(dp) :: gradients(2, element_node_count(kind)), psi(element_node_count(kind))
      real(dp) :: jacobian, radius

      call element_gradients(kind, coordinates, point, gradients, jacobian)
      b = 0.0_dp
      radius = 0.0_dp
      if (plane == axisymmetric) then
         psi = element_shape(kind, point)
         radius = dot_product(psi, coordinates(1, :))
         b(3, 1::2) = psi/radius
      end if
      volume = jacobian*area_factor(radius, thickness, plane == axisymmetric)
      b(1, 1::2) = gradients(1, :)
      b(2, 2::2) = gradients(2, :)
      b(4, 1::2) = gradients(2, :)
      b(4, 2::2) = gradients(1, :)
   end subroutine strain_matrix

   !> Largest magnitudes of a principal strain, thermal strain included, and of the rotation in the
   !> plane, at the points where stress is recovered.
   pure subroutine largest_deformation(mesh, sections, displacement, largest, element)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      real(dp), intent(in) :: displacement(:, :)    !! (2, nodes) [length]
      real(dp), intent(out) :: largest(2)           !! of_strain [-], of_rotation [radian]
      integer, intent(out) :: element(2)            !! indexes of the elements that have them
      type(point_rule_type) :: rules(kind_count)
      real(dp) :: there(2)
      integer :: e, q

      rules = recovery_rules()
      largest = -1.0_dp
      element = 0
      do e = 1, size(mesh%element_kind)
         there = element_deformation(mesh, e, displacement, rules(mesh%element_kind(e)))
         if (mesh%element_plane(e) == generalized_strain) then
            associate (own => sections(mesh%element_section(e)))
               do q = 1, element_node_count(mesh%element_kind(e))   ! where eps_zz is largest
                  there(of_strain) = max(there(of_strain), abs(dot_product(strain_along_z( &
                     mesh%coordinates(:, mesh%element_nodes(q, e)) - mesh%coordinates(:, &
                     own%reference(1)), own%thickness), [displacement(:, own%reference(1)), &
                     displacement(1, own%reference(2))])))
               end do
            end associate
         end if
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

end module element_elasticity
