!> The thermal matrices of (3.3): K of conduction and C of heat capacities.
module thermal_matrix
   use element_assembly, only: element_assembly_type
   use element_conduction, only: capacity_matrix, conduction_matrix
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use materials, only: section_type
   use mesh, only: mesh_type, nodes_per_element
   use point_materials, only: point_materials_type
   use quadrature, only: most_points, point_count
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: assemble_capacity, assemble_conduction, lumped_volumes

contains

   !> K of (3.3), both triangles.
   pure function assemble_conduction(mesh, sections, points) result(conduction)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      class(point_materials_type), intent(in) :: points      !! at those of integration_rules
      type(sparse_matrix_type) :: conduction                 !! (nodes, nodes) [power/temperature]
      type(element_assembly_type) :: assembly
      real(dp), allocatable :: k(:, :)
      real(dp) :: conductivity(2, 2, most_points)
      integer :: element, g, n

      call assembly%begin(mesh, 1, 1)
      do element = 1, size(mesh%element_number)
         associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
            section => sections(mesh%element_section(element)), &
            nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element))
            n = merge(1, point_count(kind), points%one_material(element))
            do g = 1, n
               conductivity(:, :, g) = points%materials(points%at_point(element, g))%conductivity
            end do
            k = conduction_matrix(kind, plane, mesh%coordinates(:, nodes), &
               conductivity(:, :, :n), section%thickness)
            call assembly%add(nodes, k)
         end associate
      end do
      conduction = assembly%matrix
   end function assemble_conduction

   !> C of (1.2), both triangles, or another matrix of its kind: consistent in elements with nodes
   !> between corners, else lumped.
   pure function assemble_capacity(mesh, sections, heat) result(capacity)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      real(dp), intent(in) :: heat(:)          !! (elements) rho c [energy/(volume temperature)]
      type(sparse_matrix_type) :: capacity     !! (nodes, nodes) [energy/temperature]
      type(element_assembly_type) :: assembly
      integer :: element

      call assembly%begin(mesh, 1, 1)
      do element = 1, size(mesh%element_number)
         associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
            section => sections(mesh%element_section(element)), &
            nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element))
            call assembly%add(nodes, heat(element)*capacity_matrix(kind, plane, &
               mesh%coordinates(:, nodes), section%thickness))
         end associate
      end do
      capacity = assembly%matrix
   end function assemble_capacity

   !> Parts of the volume of an element that its nodes have, all positive: in the proportions of the
   !> diagonal of C, since sums of its rows are negative at corners beside midside nodes.
   !> E. Hinton, T. Rock, O. C. Zienkiewicz, Earthquake Eng. Struct. Dyn. 4 (1976) 245.
   pure function lumped_volumes(mesh, sections, element) result(volumes)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      integer, intent(in) :: element               !! which element
      real(dp) :: volumes(nodes_per_element)       !! its nodes first [length^3]
      real(dp) :: c(nodes_per_element, nodes_per_element)
      integer :: q

      volumes = 0.0_dp
      associate (n => element_node_count(mesh%element_kind(element)))
         c(:n, :n) = capacity_matrix(mesh%element_kind(element), mesh%element_plane(element), &
            mesh%coordinates(:, mesh%element_nodes(:n, element)), &
            sections(mesh%element_section(element))%thickness)
         volumes(:n) = [(c(q, q), q=1, n)]
         volumes(:n) = volumes(:n)*(sum(c(:n, :n))/sum(volumes(:n)))
      end associate
   end function lumped_volumes

end module thermal_matrix
