!> Responses of the materials at given points of all elements. Stress, heat flux and heat contents
!> are computed from displacements and temperatures here and nowhere else. Everything that
!> depends on geometry and constants alone is computed once. Residuals sum the responses over the
!> integration points; the operators are their tangents (stiffness_matrix, thermal_matrix).
module material_points
   use element_integrals, only: area_factor
   use element_kinds, only: axisymmetric, element_node_count, generalized_strain, plane_stress, &
      quad4, quad4_enhanced
   use enhanced_strains, only: released_strains
   use kinds, only: dp
   use material_laws, only: law_interval_type, law_points_type, material_law_type
   use materials, only: has_law, heat_content, material_type, orientation_type, section_type
   use mesh, only: mesh_type, nodes_per_element
   use point_gradients, only: add_hoop_strain, find_negative_gradient, find_strains, &
      set_mean_dilatation, strain_along_z
   use point_histories, only: point_histories_type, point_history_type
   use point_materials, only: point_material_type
   use quadrature, only: most => most_points_of_rule, point_rule_type
   use shape_functions, only: node_position
   implicit none
   private
   public :: material_points_type, elastic_part

   !> The points of all elements.
   type, extends(point_histories_type) :: material_points_type
      integer, allocatable :: first(:)                   !! (elements + 1) first point of each
      !> (4, points) d xi/dx, d eta/dx, d xi/dy, d eta/dy [1/length]
      real(dp), allocatable :: inverse(:, :)
      real(dp), allocatable :: volume(:)                 !! (points) that each stands for [length^3]
   contains
      procedure :: prepare
      procedure :: positions
      procedure :: stress
      procedure :: respond
      procedure, private :: changes_of_modes
      procedure :: heat_flux
      procedure :: add_contents
      procedure :: nodal_forces
      procedure :: nodal_heat
   end type material_points_type

   integer, parameter :: most_enhancements = 50       ! passes for enhanced strains
   integer, parameter :: most_straight = 8            ! of these, with tangents alone
   real(dp), parameter :: elastic_part = 0.01_dp      !! of the elasticity in tangents
   integer, parameter :: most_searches = 5            ! for the length of a change
   real(dp), parameter :: settled = 1.0e-12_dp        ! part of the strains that they change last

contains

   !> Forms what stays.
   subroutine prepare(self, mesh, sections, materials, orientations, rules)
      class(material_points_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      type(material_type), intent(in) :: materials(:)
      type(orientation_type), intent(in) :: orientations(:) !! axes of the materials
      type(point_rule_type), intent(in) :: rules(:)         !! (kinds) points of each kind
      integer :: e, n

      call self%place(mesh, sections, materials, orientations, rules)
      call self%place_histories(mesh)
      n = size(mesh%element_kind)
      allocate (self%first(n + 1), source=1)
      do e = 1, n
         self%first(e + 1) = self%first(e) + rules(mesh%element_kind(e))%count
      end do
      allocate (self%inverse(4, self%first(n + 1)), self%volume(self%first(n + 1)), source=0.0_dp)
      do e = 1, n
         associate (nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
            call map_points(self%rules(mesh%element_kind(e)), mesh%coordinates(:, nodes), &
               sections(mesh%element_section(e))%thickness, mesh%element_plane(e) == axisymmetric, &
               self%inverse(:, self%first(e):), self%volume(self%first(e):))
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
      class(material_points_type), intent(in) :: self
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

   !> Stress of an element at its points along x and y by thermoelasticity, eq. (1.5), with the
   !> initial one.
   pure subroutine stress(self, mesh, element, displacement, temperature, values)
      class(material_points_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                 !! which element
      real(dp), intent(in) :: displacement(:, :)     !! (2, nodes) [length]
      real(dp), intent(in) :: temperature(:) !! (nodes) over the natural state [temperature]
      real(dp), intent(inout) :: values(most, 4)     !! its points first; xx, yy, zz, xy [stress]
      real(dp) :: strain(most, 4)

      call elastic_stress(self, mesh, element, displacement, temperature, strain, values)
      if (mesh%element_kind(element) == quad4_enhanced) call release(self, mesh, element, values)
      call add_initial_stress(mesh, element, self%rules(mesh%element_kind(element))%count, values)
   end subroutine stress

   !> Stress of an element at its points, its tangent and the new history, by the law of its
   !> material. Source: theory notes, section 3.
   pure subroutine respond(self, mesh, element, displacement, temperature, history, points)
      class(material_points_type), intent(in) :: self        !! at their temperatures
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                         !! which element
      real(dp), intent(in) :: displacement(:, :)             !! (2, nodes) [length]
      real(dp), intent(in) :: temperature(:) !! (nodes) over the natural state [temperature]
      type(point_history_type), intent(inout) :: history     !! receives that of the element
      type(law_points_type), intent(inout) :: points
      real(dp) :: numbers(self%library(self%sections(mesh%element_section(element))%material)%law% &
         history_count, self%rules(mesh%element_kind(element))%count)
      type(law_points_type) :: elastic
      integer :: g

      points%failed = .false.
      associate (material => self%library(self%sections(mesh%element_section(element))%material), &
         rule => self%rules(mesh%element_kind(element)), first => self%history_start(element), &
         last => self%history_start(element + 1) - 1)
         if (.not. has_law(material)) then
            call self%stress(mesh, element, displacement, temperature, points%stress)
            return
         end if
         call elastic_stress(self, mesh, element, displacement, temperature, points%strain, &
            points%stress)
         call add_initial_stress(mesh, element, rule%count, points%stress)
         points%count = rule%count
         points%plane = mesh%element_plane(element)
         points%stiffness = 1.0_dp
         do g = 1, rule%count
            points%tangent(:, :, g) = self%materials(self%at_point(element, g))%elasticity
            points%temperature(g) = dot_product(rule%shape(g, :rule%nodes), &
               self%temperature(mesh%element_nodes(:rule%nodes, element)))
         end do
         if (mesh%element_kind(element) == quad4_enhanced) elastic = points
         numbers = reshape(history%before(first:last), shape(numbers))
         call material%law%respond(material%law, points, history%law_interval_type, numbers)
         if (mesh%element_kind(element) == quad4_enhanced) call enhance(self, mesh, element, &
            history, elastic, points, numbers)
         history%after(first:last) = [numbers]
      end associate
   end subroutine respond

   !> Finds the enhanced strains on which the stresses do no work, by Newton's method.
   pure subroutine enhance(self, mesh, element, history, elastic, points, numbers)
      class(material_points_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      type(point_history_type), intent(in) :: history
      type(law_points_type), intent(in) :: elastic           ! without them and without the law
      type(law_points_type), intent(inout) :: points         ! the response
      real(dp), intent(inout) :: numbers(:, :)               ! its history
      type(law_points_type) :: stiffer
      real(dp) :: change(4, 4), part, slope, strained, strains(4, 4)
      integer :: g, pass, search

      strains = 0.0_dp
      ! Where an element is held, heat and initial stress strain it.
      strained = maxval(abs(elastic%strain(:4, :))) + maxval(abs(elastic%stress(:4, :)))/ &
         maxval(abs(elastic%tangent(:, :, :4)))
      do pass = 1, most_enhancements
         if (points%failed) return
         ! A part of the elasticity keeps modes regular; Newton's changes alone go to and fro where
         ! points yield and unload by turns.
         part = merge(0.5_dp, elastic_part, pass > most_straight .and. modulo(pass, 2) == 0)
         stiffer = points
         do g = 1, 4
            stiffer%tangent(:, :, g) = (1.0_dp - part)*points%tangent(:, :, g) + &
               part*points%stiffness(g)*elastic%tangent(:, :, g)
         end do
         change = self%changes_of_modes(mesh, element, stiffer)
         if (maxval(abs(change)) <= settled*(maxval(abs(strains)) + strained)) return
         slope = work_on(change)
         part = 1.0_dp
         do search = 1, most_searches
            associate (law => self%library(self%sections(mesh%element_section(element))% &
               material)%law, first => self%history_start(element))
               call respond_to(law, history%law_interval_type, history%before(first:first + &
                  size(numbers) - 1), elastic, strains + part*change, points, numbers)
            end associate
            ! Beyond the least energy the stresses do work on the change.
            if (points%failed .or. work_on(change) <= -0.5_dp*slope) exit
            part = part*slope/(slope - work_on(change))
         end do
         strains = strains + part*change
      end do
      points%failed = .true.
   contains
      !> Work of the stresses on strains.
      pure real(dp) function work_on(strain) result(work)
         real(dp), intent(in) :: strain(4, 4)
         integer :: g

         work = 0.0_dp
         do g = 1, 4
            work = work + self%volume(self%first(element) + g - 1)*dot_product( &
               points%stress(g, :), strain(:, g))
         end do
      end function work_on
   end subroutine enhance

   !> The response of a law to enhanced strains.
   pure subroutine respond_to(law, interval, before, elastic, strains, points, numbers)
      type(material_law_type), intent(in) :: law
      type(law_interval_type), intent(in) :: interval
      real(dp), intent(in) :: before(:)                      ! history at its start
      type(law_points_type), intent(in) :: elastic           ! without them and without the law
      real(dp), intent(in) :: strains(4, 4)                  ! (4, points)
      type(law_points_type), intent(inout) :: points
      real(dp), intent(inout) :: numbers(:, :)
      integer :: g

      points = elastic
      do g = 1, 4
         points%strain(g, :) = elastic%strain(g, :) + strains(:, g)
         points%stress(g, :) = elastic%stress(g, :) + matmul(elastic%tangent(:, :, g), &
            strains(:, g))
      end do
      numbers = reshape(before, shape(numbers))
      call law%respond(law, points, interval, numbers)
   end subroutine respond_to

   !> Changes of the enhanced strains of an element that its stresses and their tangents ask for.
   pure function changes_of_modes(self, mesh, element, points) result(strains)
      class(material_points_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                         !! which element
      type(law_points_type), intent(in) :: points            !! its response
      real(dp) :: strains(4, 4)                              !! (4, points)

      associate (first => self%first(element), rule => self%rules(quad4_enhanced))
         strains = released_strains(mesh%coordinates(:, mesh%element_nodes(:4, element)), &
            matmul(node_position(quad4_enhanced), transpose(rule%shape(:4, :4))), &
            mesh%element_plane(element) == axisymmetric, points%tangent(:, :, :4), &
            self%volume(first:first + 3), transpose(points%stress(:4, :)))
      end associate
   end function changes_of_modes

   !> Stress by thermoelasticity, and the strains without those that are enhanced.
   pure subroutine elastic_stress(self, mesh, element, displacement, temperature, strain, values)
      class(material_points_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      real(dp), intent(in) :: displacement(:, :), temperature(:)
      real(dp), intent(inout) :: strain(most, 4), values(most, 4)
      real(dp) :: areas(most), warmth(most), u(3, nodes_per_element)
      integer :: g, i, n, q

      associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
         first => self%first(element), nodes => mesh%element_nodes(:, element))
         n = self%rules(kind)%count
         do q = 1, self%rules(kind)%nodes
            u(:2, q) = displacement(:, nodes(q))
            u(3, q) = temperature(nodes(q))
         end do
         call find_strains(self%rules(kind), self%inverse(:, first), u, strain, warmth)
         if (plane == axisymmetric) then
            call add_hoop_strain(self%rules(kind), nodes, mesh%coordinates, displacement, &
               strain(:n, 3))
            if (kind == quad4) then
               areas(:n) = areas_of(self, mesh, element)
               strain(:n, 4) = dot_product(areas(:n), strain(:n, 4))/sum(areas(:n))
            end if
         end if
         if (plane == generalized_strain) call add_strain_along_z(self, mesh, element, &
            displacement, strain(:n, 3))
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
      end associate
   end subroutine elastic_stress

   !> Areas that the points of an axisymmetric element stand for, times 2 pi.
   pure function areas_of(self, mesh, element) result(areas)
      class(material_points_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      real(dp) :: areas(self%rules(mesh%element_kind(element))%count)

      associate (rule => self%rules(mesh%element_kind(element)), first => self%first(element))
         areas = self%volume(first:first + rule%count - 1)/matmul(rule%shape(:rule%count, &
            :rule%nodes), mesh%coordinates(1, mesh%element_nodes(:rule%nodes, element)))
      end associate
   end function areas_of

   !> Adds eps_zz of a generalized plane strain.
   pure subroutine add_strain_along_z(self, mesh, element, displacement, strain)
      class(material_points_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      real(dp), intent(in) :: displacement(:, :)
      real(dp), intent(inout) :: strain(:)           ! (points)
      real(dp) :: positions(2, size(strain))
      integer :: g

      positions = self%positions(mesh, element)
      associate (section => self%sections(mesh%element_section(element)))
         associate (reference => section%reference)
            do g = 1, size(strain)
               strain(g) = strain(g) + dot_product(strain_along_z(positions(:, g) - &
                  mesh%coordinates(:, reference(1)), section%thickness), &
                  [displacement(:, reference(1)), displacement(1, reference(2))])
            end do
         end associate
      end associate
   end subroutine add_strain_along_z

   pure subroutine add_initial_stress(mesh, element, n, values)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element, n              ! number of its points
      real(dp), intent(inout) :: values(most, 4)
      integer :: g

      if (.not. allocated(mesh%initial_stress)) return
      do g = 1, n
         values(g, :) = values(g, :) + mesh%initial_stress(:, element)
      end do
   end subroutine add_initial_stress

   !> Adds the stresses of enhanced strains.
   pure subroutine release(self, mesh, element, values)
      class(material_points_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      real(dp), intent(inout) :: values(most, 4)
      type(law_points_type) :: points
      real(dp) :: strains(4, 4)
      integer :: g

      do g = 1, 4
         points%tangent(:, :, g) = self%materials(self%at_point(element, g))%elasticity
      end do
      points%stress(:4, :) = values(:4, :)
      strains = self%changes_of_modes(mesh, element, points)
      do g = 1, 4
         values(g, :) = values(g, :) + matmul(points%tangent(:, :, g), strains(:, g))
      end do
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
            material%elasticity(2, i)*strain(g:g + 1, 2) + material%elasticity(3, i)*strain(g:g + &
            1, 3) + material%elasticity(4, i)*strain(g:g + 1, 4) - &
            material%thermal_modulus(i)*warmth(g:g + 1)
      end do
   end subroutine stress_from_strain

   !> Heat flux of an element at its points along x and y, eq. (1.4).
   pure subroutine heat_flux(self, mesh, element, temperature, values)
      class(material_points_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                 !! which element
      real(dp), intent(in) :: temperature(:)         !! (nodes) [temperature]
      real(dp), intent(inout) :: values(most, 2)     !! its points first; x, y [power/length^2]
      real(dp) :: negative_gradient(most, 2), t(nodes_per_element), k(2, 2)
      integer :: g, q

      associate (rule => self%rules(mesh%element_kind(element)))
         do q = 1, rule%nodes
            t(q) = temperature(mesh%element_nodes(q, element))
         end do
         call find_negative_gradient(rule, self%inverse(:, self%first(element)), t, &
            negative_gradient)
         do g = 1, rule%count
            k = self%materials(self%at_point(element, g))%conductivity
            values(g, 1) = k(1, 1)*negative_gradient(g, 1) + k(1, 2)*negative_gradient(g, 2)
            values(g, 2) = k(2, 1)*negative_gradient(g, 1) + k(2, 2)*negative_gradient(g, 2)
         end do
      end associate
   end subroutine heat_flux

   !> Adds the heat contents of an element to its nodes: consistent where it has nodes between
   !> corners, else lumped, as the capacity matrix is.
   pure subroutine add_contents(self, mesh, element, temperature, contents)
      class(material_points_type), intent(in) :: self   !! points of load_rules
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                    !! which element
      real(dp), intent(in) :: temperature(:)            !! (nodes) [temperature]
      real(dp), intent(inout) :: contents(:)            !! (nodes) [energy]
      real(dp) :: there
      integer :: g, q

      associate (rule => self%rules(mesh%element_kind(element)), first => self%first(element), &
         nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(element)), element), &
         material => self%library(self%sections(mesh%element_section(element))%material))
         if (size(nodes) <= 4) then
            do q = 1, size(nodes)
               contents(nodes(q)) = contents(nodes(q)) + heat_content(material, &
                  temperature(nodes(q)))*dot_product(rule%shape(:rule%count, q), &
                  self%volume(first:first + rule%count - 1))
            end do
            return
         end if
         do g = 1, rule%count
            associate (psi => rule%shape(g, :rule%nodes))
               there = heat_content(material, dot_product(psi, temperature(nodes)))
               contents(nodes) = contents(nodes) + there*self%volume(first + g - 1)*psi
            end associate
         end do
      end associate
   end subroutine add_contents

   !> Nodal forces that stresses of an element balance: the integral of B^T sigma, B as in
   !> element_elasticity, but without enhanced strains, on which stresses do no work. Those of the
   !> section's reference nodes are behind those of the element's.
   pure function nodal_forces(self, mesh, element, stress) result(forces)
      class(material_points_type), intent(in) :: self   !! points of integration_rules
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                 !! which element
      real(dp), intent(in) :: stress(most, 4)        !! its points first; xx, yy, zz, xy [stress]
      real(dp) :: forces(2, nodes_per_element + 2)   !! x, y of its nodes [force]
      real(dp) :: s(most, 4), t(most, 2, 2), areas(most), hoop(most)
      integer :: g, q

      associate (kind => mesh%element_kind(element), plane => mesh%element_plane(element), &
         first => self%first(element), nodes => mesh%element_nodes(:, element), &
         rule => self%rules(mesh%element_kind(element)))
         s = stress
         ! The transpose of a mean dilatation is a mean of the pressure.
         if (kind == quad4 .and. plane /= plane_stress) call set_mean_dilatation( &
            self%volume(first:first + rule%count - 1), s)
         t = 0.0_dp
         do g = 1, rule%count
            s(g, :) = self%volume(first + g - 1)*s(g, :)
         end do
         ! That of a mean shear strain parts the shear stress by areas.
         if (kind == quad4 .and. plane == axisymmetric) then
            areas(:rule%count) = areas_of(self, mesh, element)
            s(:rule%count, 4) = areas(:rule%count)*sum(s(:rule%count, 4))/sum(areas(:rule%count))
         end if
         do g = 1, rule%count
            t(g, :, 1) = along_reference(self%inverse(:, first + g - 1), s(g, 1), s(g, 4))
            t(g, :, 2) = along_reference(self%inverse(:, first + g - 1), s(g, 4), s(g, 2))
         end do
         forces = 0.0_dp
         do q = 1, rule%nodes
            forces(1, q) = sum_along(rule, q, t(:, :, 1))
            forces(2, q) = sum_along(rule, q, t(:, :, 2))
         end do
         if (plane == generalized_strain) forces(:, nodes_per_element + 1:) = &
            forces_along_z(self, mesh, element, s(:rule%count, 3))
         if (plane /= axisymmetric) return
         do g = 1, rule%count
            hoop(g) = s(g, 3)/dot_product(rule%shape(g, :rule%nodes), mesh%coordinates(1, &
               nodes(:rule%nodes)))
         end do
         do q = 1, rule%nodes
            forces(1, q) = forces(1, q) + dot_product(rule%shape(:rule%count, q), hoop(:rule%count))
         end do
      end associate
   end function nodal_forces

   !> Forces on the degrees of freedom of the strain along z that stresses of an element balance.
   pure function forces_along_z(self, mesh, element, stress) result(forces)
      class(material_points_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      real(dp), intent(in) :: stress(:)              ! (points) zz, times their volume
      real(dp) :: forces(2, 2)                       ! of the reference nodes
      real(dp) :: positions(2, size(stress)), sums(3)
      integer :: g

      positions = self%positions(mesh, element)
      sums = 0.0_dp
      associate (section => self%sections(mesh%element_section(element)))
         do g = 1, size(stress)
            sums = sums + stress(g)*strain_along_z(positions(:, g) - &
               mesh%coordinates(:, section%reference(1)), section%thickness)
         end do
      end associate
      forces = reshape([sums, 0.0_dp], [2, 2])
   end function forces_along_z

   !> Heat that fluxes of an element take from its nodes: minus the integral of grad psi q.
   pure function nodal_heat(self, mesh, element, flux) result(heat)
      class(material_points_type), intent(in) :: self   !! points of integration_rules
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element                 !! which element
      real(dp), intent(in) :: flux(most, 2)          !! its points first; x, y [power/length^2]
      real(dp) :: heat(nodes_per_element)            !! of its nodes [power]
      real(dp) :: t(most, 2)
      integer :: g, q

      heat = 0.0_dp
      t = 0.0_dp
      associate (first => self%first(element), rule => self%rules(mesh%element_kind(element)))
         do g = 1, rule%count
            t(g, :) = -self%volume(first + g - 1)*along_reference( &
               self%inverse(:, first + g - 1), flux(g, 1), flux(g, 2))
         end do
         do q = 1, rule%nodes
            heat(q) = sum_along(rule, q, t)
         end do
      end associate
   end function nodal_heat

   !> A vector, x and y, along xi and eta, so that its product with a gradient stays.
   pure function along_reference(inverse, x, y) result(along)
      real(dp), intent(in) :: inverse(4), x, y
      real(dp) :: along(2)

      along = [inverse(1)*x + inverse(3)*y, inverse(2)*x + inverse(4)*y]
   end function along_reference

   !> Sum over the points of grad psi^q with vectors along xi and eta.
   pure real(dp) function sum_along(rule, q, along) result(total)
      type(point_rule_type), intent(in) :: rule
      integer, intent(in) :: q
      real(dp), intent(in) :: along(most, 2)
      integer :: g

      total = 0.0_dp
      do g = 1, most
         total = total + rule%slope_xi(g, q)*along(g, 1) + rule%slope_eta(g, q)*along(g, 2)
      end do
   end function sum_along

end module material_points
