!> The stiffness matrices K^n of (2.4) of all bodies, and the forces that temperatures exert on
!> them. Rows 2i - 1 and 2i are u_x and u_y of node i; bodies share no entries.
module stiffness_matrix
   use element_elasticity, only: elastic_matrix, element_stiffness, element_thermal_load, &
      thermal_modulus
   use kinds, only: dp
   use materials, only: material_type, section_type
   use mesh, only: mesh_type
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: assemble_stiffness, assemble_thermal_load

contains

   !> K of all bodies, both triangles.
   pure function assemble_stiffness(mesh, sections, materials) result(stiffness)
      type(mesh_type), intent(in) :: mesh             !! the mesh
      type(section_type), intent(in) :: sections(:)   !! sections
      type(material_type), intent(in) :: materials(:) !! materials
      type(sparse_matrix_type) :: stiffness           !! (2 nodes, 2 nodes) [stress length]
      type(triplet_list_type) :: list
      real(dp) :: k(16, 16)
      integer :: dofs(16), element, i, j

      call list%reserve(256*size(mesh%element_number))
      do element = 1, size(mesh%element_number)
         associate (section => sections(mesh%element_section(element)))
            k = element_stiffness(mesh%coordinates(:, mesh%element_nodes(:, element)), &
               elastic_matrix(materials(section%material)%young, &
               materials(section%material)%poisson), section%thickness)
         end associate
         dofs = element_dofs(mesh%element_nodes(:, element))
         do j = 1, 16
            do i = 1, 16
               call list%add(dofs(i), dofs(j), k(i, j))
            end do
         end do
      end do
      stiffness = list%compress(2*size(mesh%node_number), 2*size(mesh%node_number))
   end function assemble_stiffness

   !> Nodal forces per unit nodal temperature over the natural state, the right-hand side of (1.1).
   pure function assemble_thermal_load(mesh, sections, materials) result(load)
      type(mesh_type), intent(in) :: mesh             !! the mesh
      type(section_type), intent(in) :: sections(:)   !! sections
      type(material_type), intent(in) :: materials(:) !! materials
      type(sparse_matrix_type) :: load                !! (2 nodes, nodes)
      type(triplet_list_type) :: list
      real(dp) :: f(16, 8), beta
      integer :: dofs(16), element, i, j

      call list%reserve(128*size(mesh%element_number))
      do element = 1, size(mesh%element_number)
         associate (section => sections(mesh%element_section(element)))
            associate (material => materials(section%material))
               beta = thermal_modulus(material%young, material%poisson, material%expansion)
            end associate
            f = element_thermal_load(mesh%coordinates(:, mesh%element_nodes(:, element)), beta, &
               section%thickness)
         end associate
         dofs = element_dofs(mesh%element_nodes(:, element))
         do j = 1, 8
            do i = 1, 16
               call list%add(dofs(i), mesh%element_nodes(j, element), f(i, j))
            end do
         end do
      end do
      load = list%compress(2*size(mesh%node_number), size(mesh%node_number))
   end function assemble_thermal_load

   !> Rows of an element's degrees of freedom.
   pure function element_dofs(nodes) result(dofs)
      integer, intent(in) :: nodes(8)
      integer :: dofs(16)

      dofs(1::2) = 2*nodes - 1
      dofs(2::2) = 2*nodes
   end function element_dofs

end module stiffness_matrix
