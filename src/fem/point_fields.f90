!> Stress and heat flux at given points of all elements, increment after increment: what depends on
!> geometry and materials alone is formed once. Arrays run over the points first, and points are
!> taken two at a time, which the compiler turns into vector instructions: this is most of the time
!> that the recovery of an increment takes. A rule of an odd number of points ends in one without
!> weight.
module point_fields
   use element_integrals, only: area_factor
   use element_kinds, only: axisymmetric, element_node_count, plane_stress, quad4, quad4_enhanced
   use enhanced_strains, only: release_stresses
   use kinds, only: dp
   use materials, only: material_type, orientation_type, section_type
   use mesh, only: mesh_type, nodes_per_element
   use point_materials, only: point_material_type, point_materials_type
   use point_rules, only: most => most_points_of_rule, point_rule_type
   use shape_functions, only: node_position
   implicit none
   private
   public :: point_fields_type

   !> The points of all elements.
   type, extends(point_materials_type) :: point_fields_type
      integer, allocatable :: first(:)                   !! (elements + 1) first point of each
      !> (4, points) d xi/dx, d eta/dx, d xi/dy, d eta/dy [1/length]
      real(dp), allocatable :: inverse(:, :)
      real(dp), allocatable :: volume(:)                 !! (points) that each stands for [length^3]
   contains
      procedure :: prepare
      procedure :: positions
      procedure :: stress
      procedure :: heat_flux
      procedure :: nodal_forces
      procedure :: nodal_heat
   end type point_fields_type

contains

   !> Forms what stays.
   pure subroutine prepare(self, mesh, sections, materials, orientations, rules)
      class(point_fields_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      type(material_type), intent(in) :: materials(:)
      type(orientation_type), intent(in) :: orientations(:) !! axes of the materials
      type(point_rule_type), intent(in) :: rules(:)         !! (kinds) points of each kind
      integer :: e, n

      call self%place(mesh, sections, materials, orientations, rules)
      n = size(mesh%element_kind)
      allocate (self%first(n + 1), source=1)
      do e = 1, n
         self%first(e + 1) = self%first(e) + rules(mesh%element_kind(e))%count
      end do
      allocate (self%inverse(4, self%first(n + 1)), self%volume(self%first(n + 1)), source=0.0_dp)
      do e = 1, n
         associate (nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
            call map_points(self%rules(mesh%element_kind(e)), mesh%coordinates(:, nodes), &
               sections(mesh%element_section(e))%thickness, &
               mesh%element_plane(e) == axisymmetric, self%inverse(:, self%first(e):), &
               self%volume(self%first(e):))
         end associate
      end do
   end subroutine prepare

   pure subroutine map_points(rule, coordinates, thickness, is_axisymmetric, inverse, volume)
      type(point_rule_type), intent(in) :: rule
      real(dp), intent(in) :: coordinates(:, :), thickness
      logical, intent(in) :: is_axisymmetric
      real(dp), intent(inout) :: inverse(:, :), volume(:)
      real(dp) :: along_xi(2), along_eta(2), jacobian, radius
      integer :: g

      do g = 1, rule%count
         along_xi = matmul(coordinates, rule%slope_xi(g, :rule%nodes))
         along_eta = matmul(coordinates, rule%slope_eta(g, :rule%nodes))
         jacobian = along_xi(1)*along_eta(2) - along_xi(2)*along_eta(1)
         ! A point without volume, in the fold of an element, adds nothing to a sum.
         if (abs(jacobian) > 0.0_dp) inverse(:, g) = [along_eta(2), -along_xi(2), -along_eta(1), &
            along_xi(1)]/jacobian
         radius = dot_product(rule%shape(g, :rule%nodes), coordinates(1, :))
         volume(g) = rule%weight(g)*jacobian*area_factor(radius, thickness, is_axisymmetric)
      end do
   end subroutine map_points

   !> Where the points of an element lie.
   pure function positions(self, mesh, element)
      class(point_fields_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                 !! which element
      real(dp) :: positions(2, self%rules(mesh%element_kind(element))%count) !! x, y [length]
      integer :: g

      associate (rule => self%rules(mesh%element_kind(element)))
         do g = 1, rule%count
            positions(:, g) = matmul(mesh%coordinates(:, mesh%element_nodes(:rule%nodes, &
               element)), rule%shape(g, :rule%nodes))
         end do
      end associate
   end function positions

   !> Stress of an element at its points along x and y, eq. (1.5).
   pure subroutine stress(self, mesh, element, displacement, temperature, values)
      class(point_fields_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                 !! which element
      real(dp), intent(in) :: displacement(:, :)     !! (2, nodes) [length]
      real(dp), intent(in) :: temperature(:) !! (nodes) over the natural state [temperature]
      real(dp), intent(inout) :: values(most, 4)     !! its points first; xx, yy, zz, xy [stress]
      real(dp) :: strain(most, 4), warmth(most), u(3, nodes_per_element)
      integer :: g, i, n, q

      associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
         first => self%first(element), nodes => mesh%element_nodes(:, element))
         n = self%rules(kind)%count
         do q = 1, self%rules(kind)%nodes
            u(:2, q) = displacement(:, nodes(q))
            u(3, q) = temperature(nodes(q))
         end do
         call find_strains(self%rules(kind), self%inverse(:, first), u, strain, warmth)
         if (plane == axisymmetric) call add_hoop_strain(self%rules(kind), nodes, &
            mesh%coordinates, displacement, strain(:n, 3))
         if (kind == quad4 .and. plane /= plane_stress) call set_mean_dilatation( &
            self%volume(first:first + n - 1), strain)
         i = self%material(element)
         do g = 1, n, 2
            call stress_from_strain(self%materials(i), g, strain, warmth, values)
            if (self%one_material(element)) cycle
            if (g < n) values(g + 1, :) = matmul(self%materials(i + 1)%elasticity, &
               strain(g + 1, :)) - self%materials(i + 1)%thermal_modulus*warmth(g + 1)
            i = i + 2
         end do
         if (.not. self%one_material(element)) then
            do g = 1, n
               values(g, :) = values(g, :) - &
                  self%materials(self%at_point(element, g))%thermal_stress
            end do
         end if
         if (kind == quad4_enhanced) call release(self, mesh, element, values)
         if (.not. allocated(mesh%initial_stress)) return
         do g = 1, n
            values(g, :) = values(g, :) + mesh%initial_stress(:, element)
         end do
      end associate
   end subroutine stress

   !> Adds the stresses of enhanced strains.
   pure subroutine release(self, mesh, element, values)
      class(point_fields_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      real(dp), intent(inout) :: values(most, 4)
      real(dp) :: e(4, 4, 4), points(2, 4), stress(4, 4)
      integer :: g

      associate (first => self%first(element), rule => self%rules(quad4_enhanced))
         points = matmul(node_position(quad4_enhanced), transpose(rule%shape(:4, :4)))
         do g = 1, 4
            e(:, :, g) = self%materials(self%at_point(element, g))%elasticity
         end do
         stress = transpose(values(:4, :))
         call release_stresses(mesh%coordinates(:, mesh%element_nodes(:4, element)), points, &
            mesh%element_plane(element) == axisymmetric, e, self%volume(first:first + 3), stress)
         values(:4, :) = transpose(stress)
      end associate
   end subroutine release

   !> Two points of one material.
   pure subroutine stress_from_strain(material, g, strain, warmth, values)
      type(point_material_type), intent(in) :: material
      integer, intent(in) :: g
      real(dp), intent(in) :: strain(most, 4), warmth(most)
      real(dp), intent(inout) :: values(most, 4)
      integer :: i

      do i = 1, 4
         values(g:g + 1, i) = material%elasticity(1, i)*strain(g:g + 1, 1) + &
            material%elasticity(2, i)*strain(g:g + 1, 2) + &
            material%elasticity(3, i)*strain(g:g + 1, 3) + &
            material%elasticity(4, i)*strain(g:g + 1, 4) - &
            material%thermal_modulus(i)*warmth(g:g + 1)
      end do
   end subroutine stress_from_strain

   !> Heat flux of an element at its points along x and y, eq. (1.4).
   pure subroutine heat_flux(self, mesh, element, temperature, values)
      class(point_fields_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                 !! which element
      real(dp), intent(in) :: temperature(:)         !! (nodes) [temperature]
      real(dp), intent(inout) :: values(most, 2)     !! its points first; x, y [power/length^2]
      real(dp) :: fall(most, 2), t(nodes_per_element), k(2, 2)
      integer :: g, q

      associate (rule => self%rules(mesh%element_kind(element)))
         do q = 1, rule%nodes
            t(q) = temperature(mesh%element_nodes(q, element))
         end do
         call find_fall(rule, self%inverse(:, self%first(element)), t, fall)
         do g = 1, rule%count
            k = self%materials(self%at_point(element, g))%conductivity
            values(g, 1) = k(1, 1)*fall(g, 1) + k(1, 2)*fall(g, 2)
            values(g, 2) = k(2, 1)*fall(g, 1) + k(2, 2)*fall(g, 2)
         end do
      end associate
   end subroutine heat_flux

   !> Nodal forces that stresses of an element balance: the integral of B^T sigma, B as in
   !> element_elasticity, but without enhanced strains, on which stresses do no work.
   pure function nodal_forces(self, mesh, element, stress) result(forces)
      class(point_fields_type), intent(in) :: self   !! points of integration_rules
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                 !! which element
      real(dp), intent(in) :: stress(most, 4)        !! its points first; xx, yy, zz, xy [stress]
      real(dp) :: forces(2, nodes_per_element)       !! x, y of its nodes [force]
      real(dp) :: s(most, 4), slope(2), radius
      integer :: g, q

      associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
         first => self%first(element), nodes => mesh%element_nodes(:, element), &
         rule => self%rules(mesh%element_kind(element)))
         s = stress
         ! The transpose of a mean dilatation is a mean of the pressure.
         if (kind == quad4 .and. plane /= plane_stress) call set_mean_dilatation( &
            self%volume(first:first + rule%count - 1), s)
         forces = 0.0_dp
         do g = 1, rule%count
            s(g, :) = self%volume(first + g - 1)*s(g, :)
            radius = dot_product(rule%shape(g, :rule%nodes), mesh%coordinates(1, &
               nodes(:rule%nodes)))
            do q = 1, rule%nodes
               slope = slope_of(rule, self%inverse(:, first + g - 1), g, q)
               forces(:, q) = forces(:, q) + [slope(1)*s(g, 1) + slope(2)*s(g, 4), &
                  slope(2)*s(g, 2) + slope(1)*s(g, 4)]
               if (plane == axisymmetric) forces(1, q) = forces(1, q) + &
                  rule%shape(g, q)/radius*s(g, 3)
            end do
         end do
      end associate
   end function nodal_forces

   !> Heat that fluxes of an element take from its nodes: minus the integral of grad psi q.
   pure function nodal_heat(self, mesh, element, flux) result(heat)
      class(point_fields_type), intent(in) :: self   !! points of integration_rules
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                 !! which element
      real(dp), intent(in) :: flux(most, 2)          !! its points first; x, y [power/length^2]
      real(dp) :: heat(nodes_per_element)            !! of its nodes [power]
      integer :: g, q

      heat = 0.0_dp
      associate (first => self%first(element), rule => self%rules(mesh%element_kind(element)))
         do g = 1, rule%count
            do q = 1, rule%nodes
               heat(q) = heat(q) - self%volume(first + g - 1)*dot_product( &
                  slope_of(rule, self%inverse(:, first + g - 1), g, q), flux(g, :))
            end do
         end do
      end associate
   end function nodal_heat

   !> d psi^q/dx and d psi^q/dy at a point.
   pure function slope_of(rule, inverse, g, q) result(slope)
      type(point_rule_type), intent(in) :: rule
      real(dp), intent(in) :: inverse(4)
      integer, intent(in) :: g, q
      real(dp) :: slope(2)

      slope = rule%slope_xi(g, q)*inverse(1:3:2) + rule%slope_eta(g, q)*inverse(2:4:2)
   end function slope_of

   !> Strains, but for zz, which is zero, and the temperature.
   pure subroutine find_strains(rule, inverse, u, strain, warmth)
      type(point_rule_type), intent(in) :: rule
      real(dp), intent(in) :: inverse(4, *), u(3, nodes_per_element)
      real(dp), intent(out) :: strain(most, 4), warmth(most)
      real(dp), dimension(2) :: x_xi, x_eta, y_xi, y_eta, t
      integer :: g, q

      do g = 1, rule%count, 2
         x_xi = 0.0_dp
         x_eta = 0.0_dp
         y_xi = 0.0_dp
         y_eta = 0.0_dp
         t = 0.0_dp
         do q = 1, rule%nodes
            x_xi = x_xi + rule%slope_xi(g:g + 1, q)*u(1, q)
            x_eta = x_eta + rule%slope_eta(g:g + 1, q)*u(1, q)
            y_xi = y_xi + rule%slope_xi(g:g + 1, q)*u(2, q)
            y_eta = y_eta + rule%slope_eta(g:g + 1, q)*u(2, q)
            t = t + rule%shape(g:g + 1, q)*u(3, q)
         end do
         strain(g:g + 1, 1) = x_xi*inverse(1, g:g + 1) + x_eta*inverse(2, g:g + 1)
         strain(g:g + 1, 2) = y_xi*inverse(3, g:g + 1) + y_eta*inverse(4, g:g + 1)
         strain(g:g + 1, 3) = 0.0_dp
         strain(g:g + 1, 4) = x_xi*inverse(3, g:g + 1) + x_eta*inverse(4, g:g + 1) + &
            y_xi*inverse(1, g:g + 1) + y_eta*inverse(2, g:g + 1)
         warmth(g:g + 1) = t
      end do
   end subroutine find_strains

   !> u_x/r.
   pure subroutine add_hoop_strain(rule, nodes, coordinates, displacement, strain)
      type(point_rule_type), intent(in) :: rule
      integer, intent(in) :: nodes(:)
      real(dp), intent(in) :: coordinates(:, :), displacement(:, :)
      real(dp), intent(inout) :: strain(:)
      integer :: g

      associate (mine => nodes(:rule%nodes))
         do g = 1, size(strain)
            strain(g) = strain(g) + &
               dot_product(rule%shape(g, :rule%nodes), displacement(1, mine))/ &
               dot_product(rule%shape(g, :rule%nodes), coordinates(1, mine))
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
   pure subroutine find_fall(rule, inverse, temperature, fall)
      type(point_rule_type), intent(in) :: rule
      real(dp), intent(in) :: inverse(4, *), temperature(nodes_per_element)
      real(dp), intent(out) :: fall(most, 2)
      real(dp), dimension(2) :: xi, eta
      integer :: g, q

      do g = 1, rule%count, 2
         xi = 0.0_dp
         eta = 0.0_dp
         do q = 1, rule%nodes
            xi = xi - rule%slope_xi(g:g + 1, q)*temperature(q)
            eta = eta - rule%slope_eta(g:g + 1, q)*temperature(q)
         end do
         fall(g:g + 1, 1) = xi*inverse(1, g:g + 1) + eta*inverse(2, g:g + 1)
         fall(g:g + 1, 2) = xi*inverse(3, g:g + 1) + eta*inverse(4, g:g + 1)
      end do
   end subroutine find_fall

end module point_fields
