!> Materials at given points of all elements: one for all points that share it, or one for each
!> point where the axes turn or properties follow the temperature. Their properties are along x, y
!> and z, turned from the axes of the material, and condensed in plane stress.
module point_materials
   use element_kinds, only: element_node_count, generalized_strain, kind_count, plane_strain, &
      plane_stress
   use kinds, only: dp
   use materials, only: follows_temperature, has_law, material_axes, material_type, &
      of_conductivity, of_elasticity, of_expansion, orientation_type, properties_type, &
      section_type, strain_rotation, thermal_strain, varies
   use mesh, only: mesh_type
   use quadrature, only: point_rule_type
   implicit none
   private
   public :: point_material_type, point_materials_type, elasticity_in, thermal_modulus_in, &
      conductivity_in, along_axes

   !> A material at a point, along x, y and z.
   type :: point_material_type
      real(dp) :: elasticity(4, 4) = 0.0_dp        !! condensed in plane stress [stress]
      real(dp) :: thermal_modulus(4) = 0.0_dp      !! [stress/temperature]
      !> What temperatures hold back beyond it, where expansion follows them [stress]
      real(dp) :: thermal_stress(4) = 0.0_dp
      real(dp) :: compliance(4, 4) = 0.0_dp        !! inverse of all of E; 0 without it [1/stress]
      real(dp) :: conductivity(2, 2) = 0.0_dp      !! [power/(length temperature)]
      real(dp) :: resistivity(2, 2) = 0.0_dp       !! its inverse; 0 without it
   end type point_material_type

   !> The materials of all elements.
   type :: point_materials_type
      type(point_rule_type) :: rules(kind_count)         !! by the kind of the element
      type(point_material_type), allocatable :: materials(:)
      integer, allocatable :: material(:)                !! (elements) first of its materials
      logical, allocatable :: one_material(:)            !! (elements) one for all of its points
      ! Of the model, as they are.
      type(section_type), allocatable :: sections(:)
      type(material_type), allocatable :: library(:)
      type(orientation_type), allocatable :: orientations(:)   !! axes of the materials
      logical :: has_inverses = .true.   !! whether compliance and resistivity are asked for
      real(dp), allocatable :: temperature(:)   !! (nodes) that they were set to last [temperature]
   contains
      procedure :: place
      procedure :: set_temperature
      procedure :: take_tangents
      procedure :: at_point
   end type point_materials_type

contains

   !> One material for a section and plane, or one a point where axes may turn or properties follow
   !> the temperature or the strain. These are as of their first rows until they are set.
   subroutine place(self, mesh, sections, materials, orientations, rules)
      class(point_materials_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      type(section_type), intent(in) :: sections(:)
      type(material_type), intent(in) :: materials(:)
      type(orientation_type), intent(in) :: orientations(:) !! axes of the materials
      type(point_rule_type), intent(in) :: rules(:)         !! (kinds) points of each kind
      integer :: shared(size(sections), generalized_strain), e, g, n, pass
      real(dp) :: axes(2, 2), position(2)

      self%rules = rules
      self%sections = sections
      self%library = materials
      self%orientations = orientations
      allocate (self%material(size(mesh%element_kind)))
      self%one_material = sections(mesh%element_section)%orientation == 0 .and. &
         .not. varies(materials(sections(mesh%element_section)%material))
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
                  position = matmul(mesh%coordinates(:, nodes), rule%shape(g, :rule%nodes))
                  axes = material_axes(orientations, sections(s)%orientation, position)
                  associate (material => materials(sections(s)%material))
                     call set_elasticity(plane, material, axes, self%has_inverses, &
                        self%materials(n))
                     call set_conduction(material, axes, self%has_inverses, self%materials(n))
                     self%materials(n)%thermal_modulus = thermal_modulus_in(plane, material, &
                        material%expansion, axes)
                  end associate
               end do
            end associate
         end do
         if (pass == 1) allocate (self%materials(n))
      end do
   end subroutine place

   !> Gives points whose properties follow the temperature those of theirs. Their thermal modulus is
   !> the slope by temperature, and what it leaves out is thermal stress.
   pure subroutine set_temperature(self, mesh, temperature, initial)
      class(point_materials_type), intent(inout) :: self    !! placed
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: temperature(:), initial(:)    !! (nodes) [temperature]
      type(properties_type) :: properties(size(self%library))
      logical, dimension(size(self%library)) :: conducts, strains   ! otherwise with the temperature
      real(dp) :: axes(2, 2)
      integer :: e, g, m

      if (allocated(self%temperature)) then
         if (all(abs(self%temperature - temperature) <= 0.0_dp)) return
      end if
      self%temperature = temperature
      conducts = follows_temperature(self%library, of_conductivity)
      strains = follows_temperature(self%library, of_elasticity) .or. &
         follows_temperature(self%library, of_expansion)
      do m = 1, size(self%library)
         properties(m) = self%library(m)%properties_type
      end do
      do e = 1, size(mesh%element_kind)
         associate (section => self%sections(mesh%element_section(e)), &
            plane => mesh%element_plane(e), rule => self%rules(mesh%element_kind(e)), &
            nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
            m = section%material
            if (.not. (conducts(m) .or. strains(m))) cycle
            axes = material_axes(self%orientations, 0, [0.0_dp, 0.0_dp])
            do g = 1, rule%count
               associate (psi => rule%shape(g, :rule%nodes))
                  if (section%orientation > 0) axes = material_axes(self%orientations, &
                     section%orientation, matmul(mesh%coordinates(:, nodes), psi))
                  associate (at => [dot_product(psi, initial(nodes)), dot_product(psi, &
                     temperature(nodes))], there => self%materials(self%material(e) + g - 1))
                     call self%library(m)%set_to(at(2), properties(m))
                     if (conducts(m)) call set_conduction(properties(m), axes, &
                        self%has_inverses, there)
                     if (strains(m)) call set_strain(plane, self%library(m), properties(m), axes, &
                        at, self%has_inverses, there)
                  end associate
               end associate
            end do
         end associate
      end do
   end subroutine set_temperature

   !> Gives points with a law the tangents of their stress for their elasticity.
   pure subroutine take_tangents(self, mesh, tangent)
      class(point_materials_type), intent(inout) :: self    !! placed
      type(mesh_type), intent(in) :: mesh
      real(dp), intent(in) :: tangent(:)                    !! (4*4*materials) [stress]
      integer :: e, g

      do e = 1, size(self%material)
         if (.not. has_law(self%library(self%sections(mesh%element_section(e))%material))) cycle
         do g = self%material(e), self%material(e) + self%rules(mesh%element_kind(e))%count - 1
            self%materials(g)%elasticity = reshape(tangent(16*g - 15:16*g), [4, 4])
         end do
      end do
   end subroutine take_tangents

   !> Elasticity and expansion at a temperature.
   pure subroutine set_strain(plane, material, properties, axes, temperature, with_inverses, there)
      integer, intent(in) :: plane
      type(material_type), intent(in) :: material
      type(properties_type), intent(in) :: properties  ! at the temperature
      real(dp), intent(in) :: axes(2, 2)
      real(dp), intent(in) :: temperature(2)           ! the initial one, and the present one
      logical, intent(in) :: with_inverses
      type(point_material_type), intent(inout) :: there
      real(dp) :: strain(3), slope(3)

      call thermal_strain(material, temperature(1), temperature(2), strain, slope)
      call set_elasticity(plane, properties, axes, with_inverses, there)
      there%thermal_modulus = stress_of(slope)
      strain = strain - slope*(temperature(2) - temperature(1))
      there%thermal_stress = 0.0_dp
      if (any(abs(strain) > 0.0_dp)) there%thermal_stress = stress_of(strain)
   contains
      !> Stress of strains along the axes of the material; E of plane stress has no row 3.
      pure function stress_of(along) result(stress)
         real(dp), intent(in) :: along(3)
         real(dp) :: stress(4), global(4)
         integer :: i

         global = [along, 0.0_dp]
         if (.not. are_x_and_y(axes)) global = matmul(strain_rotation(transpose(axes)), global)
         do i = 1, 4
            stress(i) = there%elasticity(1, i)*global(1) + there%elasticity(2, i)*global(2) + &
               there%elasticity(3, i)*global(3) + there%elasticity(4, i)*global(4)
         end do
      end function stress_of
   end subroutine set_strain

   pure subroutine set_elasticity(plane, properties, axes, with_inverses, there)
      integer, intent(in) :: plane
      class(properties_type), intent(in) :: properties
      real(dp), intent(in) :: axes(2, 2)
      logical, intent(in) :: with_inverses
      type(point_material_type), intent(inout) :: there

      there%elasticity = elasticity_in(plane, properties, axes)
      ! Not condensed: with sigma_zz = 0 its energy is that of plane stress, too.
      if (with_inverses) there%compliance = inverse_of(elasticity_in(plane_strain, properties, &
         axes))
   end subroutine set_elasticity

   pure subroutine set_conduction(properties, axes, with_inverses, there)
      class(properties_type), intent(in) :: properties
      real(dp), intent(in) :: axes(2, 2)
      logical, intent(in) :: with_inverses
      type(point_material_type), intent(inout) :: there

      there%conductivity = conductivity_in(properties, axes)
      if (with_inverses) there%resistivity = inverse_of(there%conductivity)
   end subroutine set_conduction

   !> The material at a point of an element.
   pure integer function at_point(self, element, g) result(i)
      class(point_materials_type), intent(in) :: self    !! placed
      integer, intent(in) :: element                     !! which element
      integer, intent(in) :: g                           !! which of its points

      i = self%material(element)
      if (.not. self%one_material(element)) i = i + g - 1
   end function at_point

   !> Inverse of a symmetric positive definite matrix; zero where it is not.
   pure function inverse_of(matrix) result(inverse)
      real(dp), intent(in) :: matrix(:, :)
      real(dp) :: inverse(size(matrix, 1), size(matrix, 1)), pivot, column(size(matrix, 1))
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

   !> E of (1.1): stresses xx, yy, zz, xy from strains xx, yy, zz and the angle xy. In plane stress
   !> eps_zz is eliminated by sigma_zz = 0, and its row and column are zero.
   pure function elasticity_in(plane, material, axes) result(e)
      integer, intent(in) :: plane                  !! plane_strain, ...
      class(properties_type), intent(in) :: material
      real(dp), intent(in) :: axes(2, 2)            !! its axes 1 and 2 as columns
      real(dp) :: e(4, 4)                           !! [stress]
      real(dp) :: across(4)
      integer :: j

      e = in_global_axes(material, axes)
      if (plane /= plane_stress .or. e(3, 3) <= 0.0_dp) return
      across = e(:, 3)/e(3, 3)
      do j = 1, 4
         e(:, j) = e(:, j) - across*e(3, j)
      end do
      e(3, :) = 0.0_dp
      e(:, 3) = 0.0_dp
   end function elasticity_in

   !> beta = E:alpha of (1.1): the stress that holds back a unit temperature, in plane stress with
   !> sigma_zz = 0.
   pure function thermal_modulus_in(plane, material, expansion, axes) result(beta)
      integer, intent(in) :: plane                  !! plane_strain, ...
      class(properties_type), intent(in) :: material
      real(dp), intent(in) :: expansion(3)          !! along axes 1, 2, 3 [1/temperature]
      real(dp), intent(in) :: axes(2, 2)            !! its axes 1 and 2 as columns
      real(dp) :: beta(4)                           !! xx, yy, zz, xy [stress/temperature]
      real(dp) :: e(4, 4)

      beta = matmul(material%elasticity, [expansion, 0.0_dp])
      if (.not. are_x_and_y(axes)) beta = matmul(transpose(strain_rotation(axes)), beta)
      e = in_global_axes(material, axes)
      if (plane /= plane_stress .or. e(3, 3) <= 0.0_dp) return
      beta = beta - e(:, 3)*(beta(3)/e(3, 3))
      beta(3) = 0.0_dp
   end function thermal_modulus_in

   !> K of (1.4).
   pure function conductivity_in(material, axes) result(k)
      class(properties_type), intent(in) :: material
      real(dp), intent(in) :: axes(2, 2)            !! its axes 1 and 2 as columns
      real(dp) :: k(2, 2)                           !! [power/(length temperature)]

      associate (a => axes(:, 1), b => axes(:, 2), c => material%conductivity)
         k(:, 1) = a*(c(1)*a(1)) + b*(c(2)*b(1))
         k(:, 2) = a*(c(1)*a(2)) + b*(c(2)*b(2))
      end associate
   end function conductivity_in

   !> Stresses xx, yy, zz, xy as 11, 22, 33, 12 of axes.
   pure function along_axes(axes, stress) result(turned)
      real(dp), intent(in) :: axes(2, 2)   !! axes 1 and 2 as columns
      real(dp), intent(in) :: stress(4)    !! along x and y [stress]
      real(dp) :: turned(4)                !! along the axes [stress]

      turned = matmul(transpose(strain_rotation(transpose(axes))), stress)
   end function along_axes

   !> Whether unit vectors are those along x and y.
   pure logical function are_x_and_y(axes)
      real(dp), intent(in) :: axes(2, 2)    !! as columns

      are_x_and_y = abs(axes(2, 1)) + abs(axes(1, 2)) <= 0.0_dp .and. axes(1, 1) > 0.0_dp .and. &
         axes(2, 2) > 0.0_dp
   end function are_x_and_y

   pure function in_global_axes(material, axes) result(e)
      class(properties_type), intent(in) :: material
      real(dp), intent(in) :: axes(2, 2)
      real(dp) :: e(4, 4), rotation(4, 4)

      e = material%elasticity
      if (are_x_and_y(axes)) return
      rotation = strain_rotation(axes)
      e = matmul(transpose(rotation), matmul(e, rotation))
   end function in_global_axes

end module point_materials
