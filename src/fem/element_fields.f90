!> Stress and heat flux at points of an element of a mesh.
module element_fields
   use element_conduction, only: heat_flux_at
   use element_elasticity, only: strain_at
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use materials, only: material_type, section_type
   use mesh, only: mesh_type
   use orientations, only: material_axes, orientation_type, strain_rotation
   use point_properties, only: conductivity_in, elasticity_in, thermal_modulus_in
   use shape_functions, only: element_shape
   implicit none
   private
   public :: element_positions, element_axes, element_stress, element_heat_flux, along_axes

contains

   !> Where points of an element lie.
   pure function element_positions(mesh, element, xi_eta) result(positions)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                !! element index
      real(dp), intent(in) :: xi_eta(:, :)          !! (2, points) xi, eta
      real(dp) :: positions(2, size(xi_eta, 2))     !! x, y [length]
      integer :: g

      associate (kind => mesh%element_kind(element), &
         nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element))
         do g = 1, size(xi_eta, 2)
            positions(:, g) = matmul(mesh%coordinates(:, nodes), element_shape(kind, xi_eta(:, g)))
         end do
      end associate
   end function element_positions

   !> Axes 1 and 2 of the material at points of an element, as columns.
   pure function element_axes(mesh, sections, orientations, element, xi_eta) result(axes)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      type(orientation_type), intent(in) :: orientations(:) !! axes of the materials
      integer, intent(in) :: element                        !! element index
      real(dp), intent(in) :: xi_eta(:, :)                  !! (2, points) xi, eta
      real(dp) :: axes(2, 2, size(xi_eta, 2))               !! unit vectors
      real(dp) :: positions(2, size(xi_eta, 2))
      integer :: g

      positions = 0.0_dp
      associate (orientation => sections(mesh%element_section(element))%orientation)
         if (orientation > 0) positions = element_positions(mesh, element, xi_eta)
         do g = 1, size(xi_eta, 2)
            axes(:, :, g) = material_axes(orientations, orientation, positions(:, g))
         end do
      end associate
   end function element_axes

   !> Stress at points of an element along x and y, eq. (1.5).
   pure function element_stress(mesh, sections, materials, orientations, element, xi_eta, &
      displacement, temperature) result(stress)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      type(material_type), intent(in) :: materials(:)
      type(orientation_type), intent(in) :: orientations(:) !! axes of the materials
      integer, intent(in) :: element                        !! element index
      real(dp), intent(in) :: xi_eta(:, :)                  !! (2, points) xi, eta
      real(dp), intent(in) :: displacement(:, :)            !! (2, nodes) [length]
      real(dp), intent(in) :: temperature(:) !! (nodes) over the natural state [temperature]
      real(dp) :: stress(4, size(xi_eta, 2))                !! xx, yy, zz, xy [stress]
      real(dp) :: axes(2, 2, size(xi_eta, 2)), e(4, 4), beta(4)
      real(dp) :: coordinates(2, element_node_count(mesh%element_kind(element)))
      integer :: g

      axes = element_axes(mesh, sections, orientations, element, xi_eta)
      associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
         section => sections(mesh%element_section(element)), &
         nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element))
         coordinates = mesh%coordinates(:, nodes)
         do g = 1, size(xi_eta, 2)
            if (g == 1 .or. section%orientation > 0) then
               e = elasticity_in(plane, materials(section%material), axes(:, :, g))
               beta = thermal_modulus_in(plane, materials(section%material), axes(:, :, g))
            end if
            stress(:, g) = matmul(e, strain_at(kind, plane, coordinates, xi_eta(:, g), &
               displacement(:, nodes))) - &
               beta*dot_product(element_shape(kind, xi_eta(:, g)), temperature(nodes))
            if (allocated(mesh%initial_stress)) stress(:, g) = stress(:, g) + &
               mesh%initial_stress(:, element)
         end do
      end associate
   end function element_stress

   !> Heat flux at points of an element along x and y, eq. (1.4).
   pure function element_heat_flux(mesh, sections, materials, orientations, element, xi_eta, &
      temperature) result(flux)
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      type(material_type), intent(in) :: materials(:)
      type(orientation_type), intent(in) :: orientations(:) !! axes of the materials
      integer, intent(in) :: element                        !! element index
      real(dp), intent(in) :: xi_eta(:, :)                  !! (2, points) xi, eta
      real(dp), intent(in) :: temperature(:)                !! (nodes) [temperature]
      real(dp) :: flux(2, size(xi_eta, 2))                  !! x, y [power/length^2]
      real(dp) :: axes(2, 2, size(xi_eta, 2)), conductivity(2, 2)
      real(dp) :: coordinates(2, element_node_count(mesh%element_kind(element)))
      integer :: g

      axes = element_axes(mesh, sections, orientations, element, xi_eta)
      associate (kind => mesh%element_kind(element), &
         section => sections(mesh%element_section(element)), &
         nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element))
         coordinates = mesh%coordinates(:, nodes)
         do g = 1, size(xi_eta, 2)
            if (g == 1 .or. section%orientation > 0) then
               conductivity = conductivity_in(materials(section%material), axes(:, :, g))
            end if
            flux(:, g) = heat_flux_at(kind, coordinates, xi_eta(:, g), conductivity, &
               temperature(nodes))
         end do
      end associate
   end function element_heat_flux

   !> Stresses xx, yy, zz, xy as 11, 22, 33, 12 of axes.
   pure function along_axes(axes, stress) result(turned)
      real(dp), intent(in) :: axes(2, 2)   !! axes 1 and 2 as columns
      real(dp), intent(in) :: stress(4)    !! along x and y [stress]
      real(dp) :: turned(4)                !! along the axes [stress]

      turned = matmul(transpose(strain_rotation(transpose(axes))), stress)
   end function along_axes

end module element_fields
