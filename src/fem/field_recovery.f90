!> Stress and heat flux at nodes: evaluated at the points where they are best, extrapolated to the
!> nodes, averaged over the elements of one body and section. A node shared by several sections so
!> is several points.
module field_recovery
   use element_fields, only: element_heat_flux, element_stress
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use materials, only: material_type, section_type
   use mesh, only: mesh_type
   use orientations, only: orientation_type
   use quadrature, only: recovery_points, recovery_weights
   use shape_functions, only: node_position
   implicit none
   private
   public :: point_map_type, make_points, recover_stress, recover_heat_flux

   !> The points at which averaged fields live: one per node and section.
   type :: point_map_type
      integer, allocatable :: node(:)               !! (points) node index
      integer, allocatable :: element_points(:, :)  !! (8, elements) point of each node, or 0
      integer, allocatable :: sharing(:)            !! (points) elements that meet there
   end type point_map_type

   !> How values at the recovery points of a kind of element give those at its nodes.
   type :: extrapolation_type
      integer :: kind = 0                     !! kind of the element
      real(dp), allocatable :: places(:, :)   !! (2, recovery points) xi, eta
      real(dp), allocatable :: weights(:, :)  !! (recovery points, nodes)
   contains
      procedure :: set_kind
   end type extrapolation_type

contains

   !> Numbers the points: first one per node in the order of the nodes, then further ones for
   !> further sections.
   pure function make_points(mesh) result(points)
      type(mesh_type), intent(in) :: mesh   !! the mesh
      type(point_map_type) :: points        !! the points
      integer :: owner(size(mesh%node_number))
      integer :: element, i, k, n, node
      integer, allocatable :: extra_node(:), extra_section(:)

      n = size(mesh%node_number)
      owner = 0
      allocate (extra_node(0), extra_section(0))
      allocate (points%element_points, mold=mesh%element_nodes)
      points%element_points = 0
      do element = 1, size(mesh%element_number)
         do i = 1, element_node_count(mesh%element_kind(element))
            node = mesh%element_nodes(i, element)
            points%element_points(i, element) = node
            if (owner(node) == 0) owner(node) = mesh%element_section(element)
            if (owner(node) == mesh%element_section(element)) cycle
            do k = 1, size(extra_node)
               if (extra_node(k) == node .and. &
                  extra_section(k) == mesh%element_section(element)) exit
            end do
            if (k > size(extra_node)) then
               extra_node = [extra_node, node]
               extra_section = [extra_section, mesh%element_section(element)]
            end if
            points%element_points(i, element) = n + k
         end do
      end do
      points%node = [[(i, i=1, n)], extra_node]
      allocate (points%sharing(size(points%node)), source=0)
      do element = 1, size(mesh%element_number)
         associate (mine => points%element_points(:element_node_count(mesh%element_kind(element)), &
            element))
            points%sharing(mine) = points%sharing(mine) + 1
         end associate
      end do
   end function make_points

   !> Stress at the points along x and y, eq. (1.5).
   pure function recover_stress(mesh, sections, materials, orientations, points, displacement, &
      temperature) result(stress)
      type(mesh_type), intent(in) :: mesh                   !! the mesh
      type(section_type), intent(in) :: sections(:)         !! sections
      type(material_type), intent(in) :: materials(:)       !! materials
      type(orientation_type), intent(in) :: orientations(:) !! axes of the materials
      type(point_map_type), intent(in) :: points            !! the points
      real(dp), intent(in) :: displacement(:, :)            !! (2, nodes) [length]
      real(dp), intent(in) :: temperature(:) !! (nodes) over the natural state [temperature]
      real(dp) :: stress(4, size(points%node))              !! xx, yy, zz, xy [stress]
      type(extrapolation_type) :: rule
      integer :: element

      stress = 0.0_dp
      do element = 1, size(mesh%element_number)
         call rule%set_kind(mesh%element_kind(element))
         call spread_to_nodes(rule%weights, element_stress(mesh, sections, materials, &
            orientations, element, rule%places, displacement, temperature), &
            points%element_points(:, element), stress)
      end do
      call average(points, stress)
   end function recover_stress

   !> Heat flux at the points along x and y, eq. (1.4).
   pure function recover_heat_flux(mesh, sections, materials, orientations, points, temperature) &
      result(flux)
      type(mesh_type), intent(in) :: mesh                   !! the mesh
      type(section_type), intent(in) :: sections(:)         !! sections
      type(material_type), intent(in) :: materials(:)       !! materials
      type(orientation_type), intent(in) :: orientations(:) !! axes of the materials
      type(point_map_type), intent(in) :: points            !! the points
      real(dp), intent(in) :: temperature(:)                !! (nodes) [temperature]
      real(dp) :: flux(2, size(points%node))                !! x, y [power/length^2]
      type(extrapolation_type) :: rule
      integer :: element

      flux = 0.0_dp
      do element = 1, size(mesh%element_number)
         call rule%set_kind(mesh%element_kind(element))
         call spread_to_nodes(rule%weights, element_heat_flux(mesh, sections, materials, &
            orientations, element, rule%places, temperature), points%element_points(:, element), &
            flux)
      end do
      call average(points, flux)
   end function recover_heat_flux

   !> Adds the extrapolation of the values at the recovery points to the nodes of an element.
   pure subroutine spread_to_nodes(weights, at_points, points, values)
      real(dp), intent(in) :: weights(:, :)      !! (recovery points, nodes)
      real(dp), intent(in) :: at_points(:, :)    !! (components, recovery points)
      integer, intent(in) :: points(:)
      real(dp), intent(inout) :: values(:, :)    !! (components, points)
      integer :: g, q

      do q = 1, size(weights, 2)
         do g = 1, size(weights, 1)
            values(:, points(q)) = values(:, points(q)) + weights(g, q)*at_points(:, g)
         end do
      end do
   end subroutine spread_to_nodes

   !> Makes the rule that of a kind of element, where it is not.
   pure subroutine set_kind(self, kind)
      class(extrapolation_type), intent(inout) :: self   !! the rule
      integer, intent(in) :: kind                        !! kind of the element
      real(dp) :: position(2, element_node_count(kind))
      integer :: q

      if (kind == self%kind) return
      self%kind = kind
      self%places = recovery_points(kind)
      if (allocated(self%weights)) deallocate (self%weights)
      allocate (self%weights(size(self%places, 2), element_node_count(kind)))
      position = node_position(kind)
      do q = 1, size(position, 2)
         self%weights(:, q) = recovery_weights(kind, position(:, q))
      end do
   end subroutine set_kind

   pure subroutine average(points, values)
      type(point_map_type), intent(in) :: points
      real(dp), intent(inout) :: values(:, :)
      integer :: i

      do i = 1, size(points%sharing)
         if (points%sharing(i) > 0) values(:, i) = values(:, i)/points%sharing(i)
      end do
   end subroutine average

end module field_recovery
