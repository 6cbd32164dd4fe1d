!> The thermal matrices of (3.3): K of conduction and C of heat capacities.
module thermal_matrix
   use element_assembly, only: element_assembly_type
   use element_integrals, only: area_factor
   use element_kinds, only: axisymmetric, element_node_count
   use kinds, only: dp
   use materials, only: section_type
   use mesh, only: mesh_type, nodes_per_element
   use point_materials, only: point_materials_type
   use quadrature, only: integration_rule, load_point_count, load_rule, most_points, point_count
   use shape_functions, only: element_gradients, element_shape
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: assemble_capacity, assemble_conduction, capacity_matrix, conduction_matrix, &
      lumped_volumes

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

   !> Conductance matrix of an element, the first integral of (3.2):
   !> K_pq = integral of grad psi^p . K grad psi^q dV.
   pure function conduction_matrix(kind, plane, coordinates, conductivity, thickness) result(k)
      integer, intent(in) :: kind                  !! kind of the element
      integer, intent(in) :: plane                 !! plane_strain, ...
      real(dp), intent(in) :: coordinates(:, :)    !! (2, nodes of the kind) [length]
      !> (2, 2, points of integration_rule, or 1 for all) [power/(length temperature)]
      real(dp), intent(in) :: conductivity(:, :, :)
      real(dp), intent(in) :: thickness            !! thickness; not of axisymmetric ones [length]
      real(dp) :: k(element_node_count(kind), element_node_count(kind)) !! [power/temperature]
      real(dp) :: points(2, point_count(kind)), weights(point_count(kind)), b(2, &
         element_node_count(kind)), flux(2, element_node_count(kind)), jacobian, radius, factor
      integer :: g, i, q

      call integration_rule(kind, points, weights)
      k = 0.0_dp
      do g = 1, size(weights)
         call element_gradients(kind, coordinates, points(:, g), b, jacobian)
         radius = 0.0_dp
         if (plane == axisymmetric) radius = dot_product(element_shape(kind, points(:, g)), &
            coordinates(1, :))
         factor = weights(g)*jacobian*area_factor(radius, thickness, plane == axisymmetric)
         i = min(g, size(conductivity, 3))
         flux = factor*matmul(conductivity(:, :, i), b)
         do q = 1, size(k, 2)
            k(:, q) = k(:, q) + b(1, :)*flux(1, q) + b(2, :)*flux(2, q)
         end do
      end do
   end function conduction_matrix

   !> Capacity matrix of an element per heat capacity of a unit volume:
   !> C_pq = integral of psi^p psi^q dV; where all nodes are corners lumped, the sums of the rows,
   !> since a consistent one overshoots in short increments.
   pure function capacity_matrix(kind, plane, coordinates, thickness) result(c)
      integer, intent(in) :: kind                  !! kind of the element
      integer, intent(in) :: plane                 !! plane_strain, ...
      real(dp), intent(in) :: coordinates(:, :)    !! (2, nodes of the kind) [length]
      real(dp), intent(in) :: thickness            !! thickness; not of axisymmetric ones [length]
      real(dp) :: c(element_node_count(kind), element_node_count(kind))   !! [length^3]
      real(dp) :: points(2, load_point_count(kind)), weights(load_point_count(kind))
      real(dp) :: b(2, element_node_count(kind)), shape(element_node_count(kind))
      real(dp) :: jacobian, factor, sums(element_node_count(kind))
      integer :: g, q

      call load_rule(kind, points, weights)
      c = 0.0_dp
      do g = 1, size(weights)
         call element_gradients(kind, coordinates, points(:, g), b, jacobian)
         shape = element_shape(kind, points(:, g))
         factor = weights(g)*jacobian*area_factor(dot_product(shape, coordinates(1, :)), &
            thickness, plane == axisymmetric)
         do q = 1, size(c, 2)
            c(:, q) = c(:, q) + factor*shape(q)*shape
         end do
      end do
      if (size(c, 1) > 4) return
      sums = sum(c, dim=2)
      c = 0.0_dp
      do q = 1, size(c, 2)
         c(q, q) = sums(q)
      end do
   end function capacity_matrix

end module thermal_matrix
