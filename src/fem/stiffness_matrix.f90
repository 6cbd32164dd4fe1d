!> The stiffness matrices K^n of (2.4) of all bodies, and the forces that temperatures and initial
!> stresses exert on them. Rows 2i - 1 and 2i are u_x and u_y of node i; bodies share no entries.
module stiffness_matrix
   use element_assembly, only: element_assembly_type
   use element_elasticity, only: element_stiffness, element_stress_force, element_thermal_load
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use materials, only: section_type
   use mesh, only: mesh_type
   use point_materials, only: point_materials_type
   use quadrature, only: most_points, point_count
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: assemble_stiffness, assemble_thermal_load, assemble_initial_force

contains

   !> K of all bodies, both triangles.
   pure function assemble_stiffness(mesh, sections, points) result(stiffness)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      class(point_materials_type), intent(in) :: points      !! at those of integration_rules
      type(sparse_matrix_type) :: stiffness                  !! (2 nodes, 2 nodes) [stress length]
      type(element_assembly_type) :: assembly
      real(dp) :: e(4, 4, most_points)
      integer :: element, g, n

      call assembly%begin(mesh, 2, 2)
      do element = 1, size(mesh%element_number)
         associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
            section => sections(mesh%element_section(element)), &
            nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element))
            n = merge(1, point_count(kind), points%one_material(element))
            do g = 1, n
               e(:, :, g) = points%materials(points%at_point(element, g))%elasticity
            end do
            call assembly%add(nodes, element_stiffness(kind, plane, mesh%coordinates(:, nodes), &
               e(:, :, :n), section%thickness))
         end associate
      end do
      stiffness = assembly%matrix
   end function assemble_stiffness

   !> Nodal forces per unit nodal temperature over the natural state, the right-hand side of (1.1).
   pure function assemble_thermal_load(mesh, sections, points) result(load)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      class(point_materials_type), intent(in) :: points      !! at those of integration_rules
      type(sparse_matrix_type) :: load                       !! (2 nodes, nodes)
      type(element_assembly_type) :: assembly
      real(dp) :: beta(4, most_points), e(4, 4, most_points)
      integer :: element, g, i, n

      call assembly%begin(mesh, 2, 1)
      do element = 1, size(mesh%element_number)
         associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
            section => sections(mesh%element_section(element)), &
            nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element))
            n = merge(1, point_count(kind), points%one_material(element))
            do g = 1, n
               i = points%at_point(element, g)
               e(:, :, g) = points%materials(i)%elasticity
               beta(:, g) = points%materials(i)%thermal_modulus
            end do
            call assembly%add(nodes, element_thermal_load(kind, plane, &
               mesh%coordinates(:, nodes), e(:, :, :n), beta(:, :n), section%thickness))
         end associate
      end do
      load = assembly%matrix
   end function assemble_thermal_load

   !> Nodal forces of the initial stresses.
   pure function assemble_initial_force(mesh, sections) result(force)
      type(mesh_type), intent(in) :: mesh                !! with initial stresses
      type(section_type), intent(in) :: sections(:)
      real(dp) :: force(2*size(mesh%node_number))        !! (2 nodes) [force]
      integer, allocatable :: dofs(:)
      integer :: element, i

      force = 0.0_dp
      do element = 1, size(mesh%element_number)
         if (all(abs(mesh%initial_stress(:, element)) <= 0.0_dp)) cycle
         associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
            section => sections(mesh%element_section(element)), &
            nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element))
            dofs = [(2*nodes(i) - 1, 2*nodes(i), i=1, size(nodes))]
            force(dofs) = force(dofs) + element_stress_force(kind, plane, &
               mesh%coordinates(:, nodes), mesh%initial_stress(:, element), section%thickness)
         end associate
      end do
   end function assemble_initial_force

end module stiffness_matrix
