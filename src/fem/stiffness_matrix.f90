!> The stiffness matrices K^n of (2.4) of all bodies, and the forces that temperatures and initial
!> stresses exert on them; the same of springs and trusses. Rows 2i - 1 and 2i are u_x and u_y of
!> node i; bodies share no entries.
module stiffness_matrix
   use element_assembly, only: element_assembly_type
   use element_elasticity, only: element_stiffness, element_stress_force, element_thermal_load
   use element_kinds, only: element_node_count, generalized_strain
   use kinds, only: dp
   use materials, only: section_type, strain_freedoms
   use mesh, only: mesh_type
   use model, only: bar_type
   use point_materials, only: point_materials_type
   use quadrature, only: most_points, point_count
   use sparse_matrix, only: linear_combination, sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: assemble_stiffness, assemble_thermal_load, assemble_initial_force, bar_stiffness, &
      bar_thermal_load

contains

   !> K of all bodies, both triangles.
   pure function assemble_stiffness(mesh, sections, points) result(stiffness)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      class(point_materials_type), intent(in) :: points      !! at those of integration_rules
      type(sparse_matrix_type) :: stiffness                  !! (2 nodes, 2 nodes) [stress length]
      type(element_assembly_type) :: assembly
      type(triplet_list_type) :: along_z
      real(dp), allocatable :: k(:, :)
      integer, allocatable :: others(:), own(:)    ! degrees of freedom
      real(dp) :: e(4, 4, most_points)
      integer :: element, g, n

      call assembly%begin(mesh, 2, 2)
      call along_z%reserve(entries_along_z(mesh))
      do element = 1, size(mesh%element_number)
         associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
            section => sections(mesh%element_section(element)), &
            nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element))
            n = merge(1, point_count(kind), points%one_material(element))
            do g = 1, n
               e(:, :, g) = points%materials(points%at_point(element, g))%elasticity
            end do
            if (plane == generalized_strain) then
               k = element_stiffness(kind, plane, mesh%coordinates(:, [nodes, &
                  section%reference(1)]), e(:, :, :n), section%thickness)
               n = 2*size(nodes)
               call assembly%add(nodes, k(:n, :n))
               own = displacements_of(nodes)
               others = strain_freedoms([section])
               call along_z%add_block(own, others, k(:n, n + 1:))
               call along_z%add_block(others, own, k(n + 1:, :n))
               call along_z%add_block(others, others, k(n + 1:, n + 1:))
               cycle
            end if
            call assembly%add(nodes, element_stiffness(kind, plane, mesh%coordinates(:, nodes), &
               e(:, :, :n), section%thickness))
         end associate
      end do
      stiffness = assembly%matrix
      if (along_z%length > 0) stiffness = linear_combination(1.0_dp, stiffness, 1.0_dp, &
         along_z%compress(stiffness%row_count, stiffness%column_count))
   end function assemble_stiffness

   !> Entries of elements in generalized plane strain between their strain along z and other degrees
   !> of freedom: room for those of the stiffness, which has more than the thermal load.
   pure integer function entries_along_z(mesh) result(entries)
      type(mesh_type), intent(in) :: mesh

      entries = sum(12*element_node_count(mesh%element_kind) + 9, &
         mask=mesh%element_plane == generalized_strain)
   end function entries_along_z

   !> Degrees of freedom of nodes.
   pure function displacements_of(nodes) result(dofs)
      integer, intent(in) :: nodes(:)
      integer :: dofs(2*size(nodes)), i

      dofs = [(2*nodes(i) - 1, 2*nodes(i), i=1, size(nodes))]
   end function displacements_of

   !> Nodal forces per unit nodal temperature over the natural state, the right-hand side of (1.1).
   pure function assemble_thermal_load(mesh, sections, points) result(load)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      class(point_materials_type), intent(in) :: points      !! at those of integration_rules
      type(sparse_matrix_type) :: load                       !! (2 nodes, nodes)
      type(element_assembly_type) :: assembly
      type(triplet_list_type) :: along_z
      real(dp), allocatable :: block(:, :)
      real(dp) :: beta(4, most_points), e(4, 4, most_points)
      integer :: element, g, i, n

      call assembly%begin(mesh, 2, 1)
      call along_z%reserve(entries_along_z(mesh))
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
            if (plane == generalized_strain) then
               block = element_thermal_load(kind, plane, mesh%coordinates(:, [nodes, &
                  section%reference(1)]), e(:, :, :n), beta(:, :n), section%thickness)
               call assembly%add(nodes, block(:2*size(nodes), :))
               call along_z%add_block(strain_freedoms([section]), nodes, block(2*size(nodes) + 1:, &
                  :))
               cycle
            end if
            call assembly%add(nodes, element_thermal_load(kind, plane, &
               mesh%coordinates(:, nodes), e(:, :, :n), beta(:, :n), section%thickness))
         end associate
      end do
      load = assembly%matrix
      if (along_z%length > 0) load = linear_combination(1.0_dp, load, 1.0_dp, &
         along_z%compress(load%row_count, load%column_count))
   end function assemble_thermal_load

   !> Nodal forces of the initial stresses.
   pure function assemble_initial_force(mesh, sections) result(force)
      type(mesh_type), intent(in) :: mesh                !! with initial stresses
      type(section_type), intent(in) :: sections(:)
      real(dp) :: force(2*size(mesh%node_number))        !! (2 nodes) [force]
      integer, allocatable :: around(:), dofs(:)
      integer :: element

      force = 0.0_dp
      do element = 1, size(mesh%element_number)
         if (all(abs(mesh%initial_stress(:, element)) <= 0.0_dp)) cycle
         associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
            section => sections(mesh%element_section(element)), &
            nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element))
            dofs = displacements_of(nodes)
            around = nodes
            if (plane == generalized_strain) then
               dofs = [dofs, strain_freedoms([section])]
               around = [nodes, section%reference(1)]
            end if
            force(dofs) = force(dofs) + element_stress_force(kind, plane, &
               mesh%coordinates(:, around), mesh%initial_stress(:, element), section%thickness)
         end associate
      end do
   end function assemble_initial_force

   !> Nodal forces a k a^T of bars per nodal displacement, a being the terms of the elongation.
   pure function bar_stiffness(bars, nodes) result(stiffness)
      type(bar_type), intent(in) :: bars(:)
      integer, intent(in) :: nodes                     !! number of nodes
      type(sparse_matrix_type) :: stiffness            !! (2 nodes, 2 nodes) [force/length]
      type(triplet_list_type) :: list
      integer :: i, j, k

      call list%reserve(sum([(size(bars(k)%elongation%node)**2, k=1, size(bars))]))
      do k = 1, size(bars)
         associate (a => bars(k)%elongation)
            do i = 1, size(a%node)
               do j = 1, size(a%node)
                  call list%add(2*(a%node(i) - 1) + a%dof(i), 2*(a%node(j) - 1) + a%dof(j), &
                     bars(k)%stiffness*a%coefficient(i)*a%coefficient(j))
               end do
            end do
         end associate
      end do
      stiffness = list%compress(2*nodes, 2*nodes)
   end function bar_stiffness

   !> Nodal forces of bars per nodal temperature over the natural state.
   pure function bar_thermal_load(bars, nodes) result(load)
      type(bar_type), intent(in) :: bars(:)
      integer, intent(in) :: nodes                     !! number of nodes
      type(sparse_matrix_type) :: load                 !! (2 nodes, nodes) [force/temperature]
      type(triplet_list_type) :: list
      integer :: entries, i, j, k

      entries = 0
      do k = 1, size(bars)
         if (allocated(bars(k)%mean%node)) entries = entries + size(bars(k)%elongation%node)* &
            size(bars(k)%mean%node)
      end do
      call list%reserve(entries)
      do k = 1, size(bars)
         if (.not. allocated(bars(k)%mean%node)) cycle
         associate (a => bars(k)%elongation, mean => bars(k)%mean)
            do i = 1, size(a%node)
               do j = 1, size(mean%node)
                  call list%add(2*(a%node(i) - 1) + a%dof(i), mean%node(j), &
                     bars(k)%warm_force*a%coefficient(i)*mean%coefficient(j))
               end do
            end do
         end associate
      end do
      load = list%compress(2*nodes, nodes)
   end function bar_thermal_load

end module stiffness_matrix
