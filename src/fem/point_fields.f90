!> Stress and heat flux at given points of all elements, increment after increment: what depends on
!> geometry and materials alone is formed once. Arrays run over the points first, so that the loops
!> over the points of an element are those that the compiler turns into vector instructions.
module point_fields
   use element_kinds, only: axisymmetric, element_node_count, kind_count, plane_strain, &
      plane_stress, quad4
   use kinds, only: dp
   use materials, only: material_type, section_type
   use mesh, only: mesh_type, nodes_per_element
   use orientations, only: material_axes, orientation_type
   use point_properties, only: conductivity_in, elasticity_in, thermal_modulus_in
   use shape_functions, only: element_gradients, element_shape, node_position
   use side_integrals, only: area_factor
   implicit none
   private
   public :: point_fields_type, point_rule_type, point_material_type, apply_to_points
   public :: most_field_points

   integer, parameter :: most_field_points = 9   !! of an element
   integer, parameter :: most = most_field_points

   !> Points of a kind of element, with what its shape functions are there.
   type :: point_rule_type
      integer :: count = 0                         !! number of points
      real(dp), allocatable :: weight(:)           !! (count) sum 4 (square) or 1/2 (triangle)
      real(dp), allocatable :: shape(:, :)         !! (count, nodes) psi
      real(dp), allocatable :: slope_xi(:, :)      !! (count, nodes) d psi/d xi
      real(dp), allocatable :: slope_eta(:, :)     !! (count, nodes) d psi/d eta
   end type point_rule_type

   !> A material at a point, along x, y and z.
   type :: point_material_type
      real(dp) :: elasticity(4, 4) = 0.0_dp        !! condensed in plane stress [stress]
      real(dp) :: thermal_modulus(4) = 0.0_dp      !! [stress/temperature]
      real(dp) :: compliance(4, 4) = 0.0_dp        !! inverse of all of E; 0 without it [1/stress]
      real(dp) :: conductivity(2, 2) = 0.0_dp      !! [power/(length temperature)]
      real(dp) :: resistivity(2, 2) = 0.0_dp       !! its inverse; 0 without it
   end type point_material_type

   !> The points of all elements.
   type :: point_fields_type
      type(point_rule_type) :: rules(kind_count)         !! by the kind of the element
      integer, allocatable :: first(:)                   !! (elements + 1) first point of each
      !> For each element (points of it, 4): d xi/dx, d eta/dx, d xi/dy, d eta/dy [1/length]
      real(dp), allocatable :: inverse(:)
      real(dp), allocatable :: volume(:)                 !! (points) that each stands for [length^3]
      type(point_material_type), allocatable :: materials(:)
      integer, allocatable :: material(:)                !! (elements) first of its materials
      logical, allocatable :: one_material(:)            !! (elements) one for all of its points
   contains
      procedure :: prepare
      procedure :: stress
      procedure :: heat_flux
   end type point_fields_type

contains

   !> Forms what stays.
   pure subroutine prepare(self, mesh, sections, materials, orientations, points, weights, counts)
      class(point_fields_type), intent(inout) :: self       !! the points
      type(mesh_type), intent(in) :: mesh                   !! the mesh
      type(section_type), intent(in) :: sections(:)         !! sections
      type(material_type), intent(in) :: materials(:)       !! materials
      type(orientation_type), intent(in) :: orientations(:) !! axes of the materials
      real(dp), intent(in) :: points(:, :, :)               !! (2, most, kinds) xi, eta
      real(dp), intent(in) :: weights(:, :)                 !! (most, kinds)
      integer, intent(in) :: counts(:)                      !! (kinds) points of each
      integer :: e, kind, n

      do kind = 1, kind_count
         self%rules(kind) = make_rule(kind, points(:, :counts(kind), kind), &
            weights(:counts(kind), kind))
      end do
      n = size(mesh%element_kind)
      allocate (self%first(n + 1), source=1)
      do e = 1, n
         self%first(e + 1) = self%first(e) + counts(mesh%element_kind(e))
      end do
      allocate (self%inverse(4*(self%first(n + 1) - 1)), self%volume(self%first(n + 1) - 1))
      do e = 1, n
         associate (nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
            call map_points(self%rules(mesh%element_kind(e)), mesh%coordinates(:, nodes), &
               sections(mesh%element_section(e))%thickness, &
               mesh%element_plane(e) == axisymmetric, counts(mesh%element_kind(e)), &
               self%inverse(4*self%first(e) - 3), self%volume(self%first(e)))
         end associate
      end do
      call place_materials(self, mesh, sections, materials, orientations)
   end subroutine prepare

   pure function make_rule(kind, points, weights) result(rule)
      integer, intent(in) :: kind
      real(dp), intent(in) :: points(:, :), weights(:)
      type(point_rule_type) :: rule
      real(dp) :: slope(2, element_node_count(kind)), jacobian
      integer :: g, n

      n = element_node_count(kind)
      rule%count = size(weights)
      rule%weight = weights
      allocate (rule%shape(rule%count, n), rule%slope_xi(rule%count, n))
      allocate (rule%slope_eta(rule%count, n))
      do g = 1, rule%count
         rule%shape(g, :) = element_shape(kind, points(:, g))
         ! In the reference element x is xi and y is eta.
         call element_gradients(kind, node_position(kind), points(:, g), slope, jacobian)
         rule%slope_xi(g, :) = slope(1, :)
         rule%slope_eta(g, :) = slope(2, :)
      end do
   end function make_rule

   pure subroutine map_points(rule, coordinates, thickness, is_ring, n, inverse, volume)
      type(point_rule_type), intent(in) :: rule
      real(dp), intent(in) :: coordinates(:, :), thickness
      logical, intent(in) :: is_ring
      integer, intent(in) :: n
      real(dp), intent(inout) :: inverse(n, 4), volume(n)
      real(dp) :: along_xi(2), along_eta(2), jacobian, radius
      integer :: g

      do g = 1, n
         along_xi = matmul(coordinates, rule%slope_xi(g, :))
         along_eta = matmul(coordinates, rule%slope_eta(g, :))
         jacobian = along_xi(1)*along_eta(2) - along_xi(2)*along_eta(1)
         inverse(g, :) = [along_eta(2), -along_xi(2), -along_eta(1), along_xi(1)]/jacobian
         radius = dot_product(rule%shape(g, :), coordinates(1, :))
         volume(g) = rule%weight(g)*jacobian*area_factor(radius, thickness, is_ring)
      end do
   end subroutine map_points

   !> One material for a section and plane, or one a point where axes may turn.
   pure subroutine place_materials(self, mesh, sections, materials, orientations)
      class(point_fields_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      type(material_type), intent(in) :: materials(:)
      type(orientation_type), intent(in) :: orientations(:)
      integer :: shared(size(sections), axisymmetric), e, g, n, pass
      real(dp) :: position(2)

      allocate (self%material(size(mesh%element_kind)))
      self%one_material = sections(mesh%element_section)%orientation == 0
      ! First counted, then made.
      do pass = 1, 2
         shared = 0
         n = 0
         do e = 1, size(self%material)
            associate (s => mesh%element_section(e), plane => mesh%element_plane(e), &
               rule => self%rules(mesh%element_kind(e)), &
               nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
               if (self%one_material(e) .and. shared(s, plane) > 0) then
                  self%material(e) = shared(s, plane)
                  cycle
               end if
               self%material(e) = n + 1
               if (self%one_material(e)) shared(s, plane) = n + 1
               do g = 1, merge(1, rule%count, self%one_material(e))
                  n = n + 1
                  if (pass == 1) cycle
                  position = matmul(mesh%coordinates(:, nodes), rule%shape(g, :))
                  self%materials(n) = material_at(materials(sections(s)%material), plane, &
                     material_axes(orientations, sections(s)%orientation, position))
               end do
            end associate
         end do
         if (pass == 1) allocate (self%materials(n))
      end do
   end subroutine place_materials

   pure function material_at(material, plane, axes) result(there)
      type(material_type), intent(in) :: material
      integer, intent(in) :: plane
      real(dp), intent(in) :: axes(2, 2)
      type(point_material_type) :: there

      there%elasticity = elasticity_in(plane, material, axes)
      there%thermal_modulus = thermal_modulus_in(plane, material, axes)
      ! Not condensed: with sigma_zz = 0 its energy is that of plane stress, too.
      there%compliance = inverse_of(elasticity_in(plane_strain, material, axes))
      there%conductivity = conductivity_in(material, axes)
      there%resistivity = inverse_of(there%conductivity)
   end function material_at

   !> Inverse of a symmetric positive definite matrix; zero where it is not.
   pure function inverse_of(matrix) result(inverse)
      real(dp), intent(in) :: matrix(:, :)
      real(dp) :: inverse(size(matrix, 1), size(matrix, 1))
      real(dp) :: pivot, column(size(matrix, 1))
      integer :: i, k

      ! Gauss-Jordan in place.
      inverse = matrix
      do k = 1, size(matrix, 1)
         pivot = inverse(k, k)
         if (.not. pivot > 0.0_dp) then
            inverse = 0.0_dp
            return
         end if
         column = inverse(:, k)
         inverse(:, k) = 0.0_dp
         inverse(k, k) = 1.0_dp
         inverse(k, :) = inverse(k, :)/pivot
         do i = 1, size(matrix, 1)
            if (i /= k) inverse(i, :) = inverse(i, :) - column(i)*inverse(k, :)
         end do
      end do
   end function inverse_of

   !> Stress of an element at its points along x and y, eq. (1.5).
   pure subroutine stress(self, mesh, element, displacement, temperature, values)
      class(point_fields_type), intent(in) :: self   !! the points
      type(mesh_type), intent(in) :: mesh            !! the mesh
      integer, intent(in) :: element                 !! which element
      real(dp), intent(in) :: displacement(:, :)     !! (2, nodes) [length]
      real(dp), intent(in) :: temperature(:) !! (nodes) over the natural state [temperature]
      real(dp), intent(out) :: values(most, 4)       !! its points first; xx, yy, zz, xy [stress]
      real(dp) :: strain(most, 4), warmth(most)
      integer :: g, i, last, n

      associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
         first => self%first(element), nodes => mesh%element_nodes(:, element))
         n = self%rules(kind)%count
         call find_strains(self%rules(kind), n, nodes, self%inverse(4*first - 3), displacement, &
            temperature, strain, warmth)
         if (plane == axisymmetric) call add_hoop_strain(self%rules(kind), nodes, &
            mesh%coordinates, displacement, strain(:n, 3))
         if (kind == quad4 .and. plane /= plane_stress) call set_mean_dilatation( &
            self%volume(first:first + n - 1), strain)
         do g = 1, n
            i = self%material(element)
            if (.not. self%one_material(element)) i = i - 1 + g
            last = merge(n, g, self%one_material(element))
            call apply_to_points(self%materials(i)%elasticity, 4, g, last, strain, values)
            call subtract_heat(self%materials(i)%thermal_modulus, g, last, warmth, values)
            if (last == n) exit
         end do
      end associate
   end subroutine stress

   !> Heat flux of an element at its points along x and y, eq. (1.4).
   pure subroutine heat_flux(self, mesh, element, temperature, values)
      class(point_fields_type), intent(in) :: self   !! the points
      type(mesh_type), intent(in) :: mesh            !! the mesh
      integer, intent(in) :: element                 !! which element
      real(dp), intent(in) :: temperature(:)         !! (nodes) [temperature]
      real(dp), intent(out) :: values(most, 2)       !! its points first; x, y [power/length^2]
      real(dp) :: fall(most, 2)
      integer :: g, i, last, n

      associate (rule => self%rules(mesh%element_kind(element)))
         n = rule%count
         call find_fall(rule, n, mesh%element_nodes(:, element), &
            self%inverse(4*self%first(element) - 3), temperature, fall)
         do g = 1, n
            i = self%material(element)
            if (.not. self%one_material(element)) i = i - 1 + g
            last = merge(n, g, self%one_material(element))
            call apply_to_points(self%materials(i)%conductivity, 2, g, last, fall, values)
            if (last == n) exit
         end do
      end associate
   end subroutine heat_flux

   !> Strains, but for zz, which is zero, and the temperature.
   pure subroutine find_strains(rule, n, nodes, inverse, displacement, temperature, strain, warmth)
      type(point_rule_type), intent(in) :: rule
      integer, intent(in) :: n, nodes(nodes_per_element)
      real(dp), intent(in) :: inverse(n, 4), displacement(:, :), temperature(:)
      real(dp), intent(out) :: strain(most, 4), warmth(most)
      real(dp) :: local(most, 4), u(2), t
      integer :: g, q

      local(:n, :) = 0.0_dp
      warmth(:n) = 0.0_dp
      do q = 1, size(rule%shape, 2)
         u = displacement(:, nodes(q))
         t = temperature(nodes(q))
         do g = 1, n
            local(g, 1) = local(g, 1) + rule%slope_xi(g, q)*u(1)
            local(g, 2) = local(g, 2) + rule%slope_eta(g, q)*u(1)
            local(g, 3) = local(g, 3) + rule%slope_xi(g, q)*u(2)
            local(g, 4) = local(g, 4) + rule%slope_eta(g, q)*u(2)
            warmth(g) = warmth(g) + rule%shape(g, q)*t
         end do
      end do
      do g = 1, n
         strain(g, 1) = local(g, 1)*inverse(g, 1) + local(g, 2)*inverse(g, 2)
         strain(g, 2) = local(g, 3)*inverse(g, 3) + local(g, 4)*inverse(g, 4)
         strain(g, 3) = 0.0_dp
         strain(g, 4) = local(g, 1)*inverse(g, 3) + local(g, 2)*inverse(g, 4) + &
            local(g, 3)*inverse(g, 1) + local(g, 4)*inverse(g, 2)
      end do
   end subroutine find_strains

   !> u_x/r.
   pure subroutine add_hoop_strain(rule, nodes, coordinates, displacement, strain)
      type(point_rule_type), intent(in) :: rule
      integer, intent(in) :: nodes(:)
      real(dp), intent(in) :: coordinates(:, :), displacement(:, :)
      real(dp), intent(inout) :: strain(:)
      integer :: g

      associate (mine => nodes(:size(rule%shape, 2)))
         do g = 1, size(strain)
            strain(g) = strain(g) + dot_product(rule%shape(g, :), displacement(1, mine))/ &
               dot_product(rule%shape(g, :), coordinates(1, mine))
         end do
      end associate
   end subroutine add_hoop_strain

   !> B-bar, as in element_elasticity; the points are those of its integration.
   pure subroutine set_mean_dilatation(volume, strain)
      real(dp), intent(in) :: volume(:)
      real(dp), intent(inout) :: strain(most, 4)
      real(dp) :: mean, change
      integer :: g

      mean = 0.0_dp
      do g = 1, size(volume)
         mean = mean + volume(g)*sum(strain(g, :3))
      end do
      mean = mean/sum(volume)
      do g = 1, size(volume)
         change = (mean - sum(strain(g, :3)))/3
         strain(g, :3) = strain(g, :3) + change
      end do
   end subroutine set_mean_dilatation

   !> -grad T.
   pure subroutine find_fall(rule, n, nodes, inverse, temperature, fall)
      type(point_rule_type), intent(in) :: rule
      integer, intent(in) :: n, nodes(nodes_per_element)
      real(dp), intent(in) :: inverse(n, 4), temperature(:)
      real(dp), intent(out) :: fall(most, 2)
      real(dp) :: local(most, 2), t
      integer :: g, q

      local(:n, :) = 0.0_dp
      do q = 1, size(rule%shape, 2)
         t = temperature(nodes(q))
         do g = 1, n
            local(g, 1) = local(g, 1) - rule%slope_xi(g, q)*t
            local(g, 2) = local(g, 2) - rule%slope_eta(g, q)*t
         end do
      end do
      do g = 1, n
         fall(g, 1) = local(g, 1)*inverse(g, 1) + local(g, 2)*inverse(g, 2)
         fall(g, 2) = local(g, 1)*inverse(g, 3) + local(g, 2)*inverse(g, 4)
      end do
   end subroutine find_fall

   !> A matrix times the values at each of some points.
   pure subroutine apply_to_points(matrix, components, first, last, values, product)
      integer, intent(in) :: components                            !! 2 or 4
      real(dp), intent(in) :: matrix(components, components)       !! the matrix
      integer, intent(in) :: first                                 !! first of the points
      integer, intent(in) :: last                                  !! last of them
      real(dp), intent(in) :: values(most, components)             !! what it is applied to
      real(dp), intent(inout) :: product(most, components)         !! its products
      integer :: i, j

      do i = 1, components
         product(first:last, i) = matrix(i, 1)*values(first:last, 1)
         do j = 2, components
            if (abs(matrix(i, j)) > 0.0_dp) product(first:last, i) = product(first:last, i) + &
               matrix(i, j)*values(first:last, j)
         end do
      end do
   end subroutine apply_to_points

   pure subroutine subtract_heat(modulus, first, last, warmth, values)
      real(dp), intent(in) :: modulus(4), warmth(most)
      integer, intent(in) :: first, last
      real(dp), intent(inout) :: values(most, 4)
      integer :: i

      do i = 1, 4
         if (abs(modulus(i)) > 0.0_dp) values(first:last, i) = values(first:last, i) - &
            modulus(i)*warmth(first:last)
      end do
   end subroutine subtract_heat

end module point_fields
