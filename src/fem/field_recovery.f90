!> Stress and heat flux at nodes: evaluated at the 2 x 2 Gauss points, extrapolated bilinearly,
!> averaged over the elements of one body and section. A node shared by several sections so is
!> several points.
module field_recovery
   use element_conduction, only: heat_flux_at
   use element_elasticity, only: elastic_matrix, stress_at, thermal_modulus
   use element_kinds, only: quad8
   use kinds, only: dp
   use materials, only: material_type, section_type
   use mesh, only: mesh_type
   use quadrature, only: gauss_coordinate_2
   use shape_functions, only: node_position
   implicit none
   private
   public :: point_map_type, make_points, recover_stress, recover_heat_flux

   !> The points at which averaged fields live: one per node and section.
   type :: point_map_type
      integer, allocatable :: node(:)               !! (points) node index
      integer, allocatable :: element_points(:, :)  !! (8, elements) point of each element node
      integer, allocatable :: sharing(:)            !! (points) elements that meet there
   end type point_map_type

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
      do element = 1, size(mesh%element_number)
         do i = 1, size(mesh%element_nodes, 1)
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
         associate (mine => points%element_points(:, element))
            points%sharing(mine) = points%sharing(mine) + 1
         end associate
      end do
   end function make_points

   !> Stress at the points, eq. (1.5).
   pure function recover_stress(mesh, sections, materials, points, displacement, temperature) &
      result(stress)
      type(mesh_type), intent(in) :: mesh             !! the mesh
      type(section_type), intent(in) :: sections(:)   !! sections
      type(material_type), intent(in) :: materials(:) !! materials
      type(point_map_type), intent(in) :: points      !! the points
      real(dp), intent(in) :: displacement(:, :)      !! (2, nodes) [length]
      real(dp), intent(in) :: temperature(:) !! (nodes) over the natural state [temperature]
      real(dp) :: stress(4, size(points%node))        !! xx, yy, zz, xy [stress]
      real(dp) :: at_gauss(4, 4), e(3, 3), beta
      real(dp) :: square(2, 8)
      integer :: element, g

      square = node_position(quad8)
      stress = 0.0_dp
      do element = 1, size(mesh%element_number)
         associate (nodes => mesh%element_nodes(:, element), &
            material => materials(sections(mesh%element_section(element))%material))
            e = elastic_matrix(material%young, material%poisson)
            beta = thermal_modulus(material%young, material%poisson, material%expansion)
            do g = 1, 4
               at_gauss(:, g) = stress_at(mesh%coordinates(:, nodes), &
                  gauss_coordinate_2*square(:, g), e, beta, displacement(:, nodes), &
                  temperature(nodes))
            end do
         end associate
         call spread_to_nodes(at_gauss, points%element_points(:, element), stress)
      end do
      call average(points, stress)
   end function recover_stress

   !> Heat flux at the points, eq. (1.4).
   pure function recover_heat_flux(mesh, sections, materials, points, temperature) result(flux)
      type(mesh_type), intent(in) :: mesh             !! the mesh
      type(section_type), intent(in) :: sections(:)   !! sections
      type(material_type), intent(in) :: materials(:) !! materials
      type(point_map_type), intent(in) :: points      !! the points
      real(dp), intent(in) :: temperature(:)          !! (nodes) [temperature]
      real(dp) :: flux(2, size(points%node))          !! x, y [power/length^2]
      real(dp) :: at_gauss(2, 4)
      real(dp) :: square(2, 8)
      integer :: element, g

      square = node_position(quad8)
      flux = 0.0_dp
      do element = 1, size(mesh%element_number)
         associate (nodes => mesh%element_nodes(:, element), &
            material => materials(sections(mesh%element_section(element))%material))
            do g = 1, 4
               at_gauss(:, g) = heat_flux_at(mesh%coordinates(:, nodes), &
                  gauss_coordinate_2*square(:, g), material%conductivity, &
                  temperature(nodes))
            end do
         end associate
         call spread_to_nodes(at_gauss, points%element_points(:, element), flux)
      end do
      call average(points, flux)
   end function recover_heat_flux

   !> Adds the bilinear extrapolation of Gauss values to the nodes of an element.
   pure subroutine spread_to_nodes(at_gauss, points, values)
      real(dp), intent(in) :: at_gauss(:, :)     !! (components, 4)
      integer, intent(in) :: points(8)
      real(dp), intent(inout) :: values(:, :)    !! (components, points)
      real(dp) :: position(2)
      real(dp) :: square(2, 8)
      integer :: g, q

      square = node_position(quad8)
      do q = 1, 8
         position = square(:, q)/gauss_coordinate_2
         do g = 1, 4
            values(:, points(q)) = values(:, points(q)) + at_gauss(:, g)* &
               (1 + position(1)*square(1, g))*(1 + position(2)*square(2, g))/4
         end do
      end do
   end subroutine spread_to_nodes

   pure subroutine average(points, values)
      type(point_map_type), intent(in) :: points
      real(dp), intent(inout) :: values(:, :)
      integer :: i

      do i = 1, size(points%sharing)
         if (points%sharing(i) > 0) values(:, i) = values(:, i)/points%sharing(i)
      end do
   end subroutine average

end module field_recovery
