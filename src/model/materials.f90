!> Materials, the sections that give them to elements, and their axes in the plane (*ORIENTATION).
module materials
   use elasticity, only: anisotropic_elasticity, engineering_elasticity, isotropic_elasticity, &
      orthotropic_elasticity
   use element_kinds, only: plane_stress
   use kinds, only: dp
   use material_laws, only: material_law_type
   use text, only: named_type
   use table_rows, only: find_row, row_below
   implicit none
   private
   public :: material_type, properties_type, section_type, property_type, orientation_type, &
      material_axes, strain_rotation, heat_capacity, least_heat_capacity, set_property, &
      elasticity_of, isotropic, engineering, orthotropic, anisotropic, follows_temperature, &
      has_law, heats_by_work, reference_nodes, strain_freedoms, varies, thermal_strain, &
      heat_content, heat_capacity_at, expansion_heat, set_latent_heat, melts, melting_row, &
      latent_content, solid_fraction, melted_to, property_keywords, of_elasticity, of_expansion, &
      of_conductivity, of_density, of_specific_heat

   ! What a property is.
   integer, parameter :: of_elasticity = 1, of_expansion = 2, of_conductivity = 3, of_density = 4, &
      of_specific_heat = 5
   character(13), parameter :: property_keywords(5) = [character(13) :: 'ELASTIC', 'EXPANSION', &
      'CONDUCTIVITY', 'DENSITY', 'SPECIFIC HEAT']
   integer, parameter :: most_constants = 21

   ! What the constants of *ELASTIC are.
   integer, parameter :: isotropic = 1, engineering = 2, orthotropic = 3, anisotropic = 4

   !> Local axes: axis 1 at a fixed angle to x, or to the radius from a centre.
   type, extends(named_type) :: orientation_type
      logical :: cylindrical = .false.                   !! whether axis 1 follows the radius
      real(dp) :: centre(2) = 0.0_dp                     !! of the radius, x and y [length]
      !> Axis 1, unit vector in x and y, or in the directions of radius and circumference
      real(dp) :: direction(2) = [1.0_dp, 0.0_dp]
      real(dp) :: orientation_sign = 1.0_dp !! 1: axis 2 is left of axis 1; -1: right
   end type orientation_type

   !> A property of a material as the deck gives it: constants over temperature, linear between
   !> rows and held outside of them.
   type :: property_type
      integer :: kind = 0                             !! of_elasticity, ...
      integer :: symmetry = isotropic                 !! what the constants of *ELASTIC are
      character(24), allocatable :: names(:)          !! (constants) what they are called
      real(dp), allocatable :: values(:, :)           !! (constants, rows)
      real(dp), allocatable :: temperature(:)         !! (rows) ascending; 0 of a single row
   end type property_type

   !> Properties at one temperature, along the material's own axes 1 and 2 in the plane and 3 across
   !> it.
   type, extends(named_type) :: properties_type
      !> Stresses 11, 22, 33, 12 from strains 11, 22, 33 and the shear angle 12 [stress]
      real(dp) :: elasticity(4, 4) = 0.0_dp
      real(dp) :: expansion(3) = 0.0_dp               !! alpha along axes 1, 2, 3 [1/temperature]
      real(dp) :: conductivity(2) = 0.0_dp            !! K_1, K_2 [power/(length temperature)]
      real(dp) :: density = 0.0_dp                    !! mass per volume, 0 where not given
      real(dp) :: specific_heat = 0.0_dp              !! c_p [energy/(mass temperature)]
   end type properties_type

   !> Integral of rho c over temperature: between rows rho c is quadratic, as both factors are
   !> linear, outside of them it is constant. The first part is below the first row.
   type :: heat_table_type
      real(dp), allocatable :: from(:)                !! (parts) where the rest counts from
      real(dp), allocatable :: content(:)             !! (parts) there [energy/volume]
      real(dp), allocatable :: capacity(:, :)         !! (3, parts) rho c: 1, x, x^2 from there on
   end type heat_table_type

   !> A row of *LATENT HEAT: what melting takes up evenly from solidus to liquidus, beside the heat
   !> of the table.
   type :: latent_heat_type
      real(dp) :: solidus = 0.0_dp                    !! [temperature]
      real(dp) :: liquidus = 0.0_dp                   !! above the solidus [temperature]
      real(dp) :: content = 0.0_dp                    !! [energy/volume]
      real(dp) :: capacity = 0.0_dp                   !! content over temperature between them
   end type latent_heat_type

   !> A material; the properties that it inherits are those of the first rows.
   type, extends(properties_type) :: material_type
      real(dp) :: no_strain = 0.0_dp                  !! ZERO= of *EXPANSION [temperature]
      logical :: has(5) = .false.                     !! by of_elasticity, ...: whether it was given
      !> All properties as the deck gives them; unallocated for none
      type(property_type), allocatable :: given(:)
      type(heat_table_type) :: heat                   !! of density and specific heat
      type(latent_heat_type), allocatable :: melting(:)   !! *LATENT HEAT; unallocated for none
      type(material_law_type) :: law                  !! beyond thermoelasticity
   contains
      procedure :: set_to
   end type material_type

   !> One *SOLID SECTION.
   type :: section_type
      integer :: material = 0           !! index into model%materials
      integer :: element_set = 0        !! index into the mesh's element sets, 0 after an error
      integer :: orientation = 0        !! index into model%orientations, 0 for x and y
      real(dp) :: thickness = 1.0_dp    !! thickness [length]
      !> Of generalized plane strain: index of the node whose degrees of freedom are the change of
      !> the thickness at it and the turn of a face about x, and of that whose first is the turn
      !> about y; else 0, 0
      integer :: reference(2) = 0
   end type section_type

contains

   !> Degrees of freedom of the strains along z of sections, each once.
   pure function strain_freedoms(sections) result(dofs)
      type(section_type), intent(in) :: sections(:)
      integer, allocatable :: dofs(:)                   !! (3 per reference node)
      integer :: i

      dofs = [integer ::]
      do i = 1, size(sections)
         associate (own => sections(i)%reference)
            if (own(1) == 0 .or. any(sections(:i - 1)%reference(1) == own(1))) cycle
            dofs = [dofs, 2*own(1) - 1, 2*own(1), 2*own(2) - 1]
         end associate
      end do
   end function strain_freedoms

   !> Reference nodes of sections, each once.
   pure function reference_nodes(sections) result(nodes)
      type(section_type), intent(in) :: sections(:)
      integer, allocatable :: nodes(:)

      associate (dofs => strain_freedoms(sections))
         nodes = (dofs(1::3) + 1)/2
      end associate
   end function reference_nodes

   !> rho c_p, 0 of a material without one.
   elemental real(dp) function heat_capacity(material)
      class(properties_type), intent(in) :: material

      heat_capacity = material%density*material%specific_heat
   end function heat_capacity

   !> Whether a property varies with temperature, or any.
   elemental logical function follows_temperature(material, kind)
      type(material_type), intent(in) :: material
      integer, optional, intent(in) :: kind             !! of_elasticity, ...
      integer :: i

      follows_temperature = .false.
      if (.not. allocated(material%given)) return
      do i = 1, size(material%given)
         if (size(material%given(i)%temperature) == 1) cycle
         if (present(kind)) then
            if (material%given(i)%kind /= kind) cycle
         end if
         follows_temperature = .true.
      end do
   end function follows_temperature

   !> Whether it has a latent heat.
   elemental logical function melts(material)
      type(material_type), intent(in) :: material

      melts = allocated(material%melting)
   end function melts

   !> Whether stress is more than thermoelasticity.
   elemental logical function has_law(material)
      type(material_type), intent(in) :: material

      has_law = associated(material%law%respond)
   end function has_law

   !> Whether plastic work or creep heats it.
   elemental logical function heats_by_work(material)
      type(material_type), intent(in) :: material

      heats_by_work = material%law%heat_fraction > 0.0_dp
   end function heats_by_work

   !> Whether heat and stress are more than constants times temperatures and displacements.
   elemental logical function varies(material)
      type(material_type), intent(in) :: material

      varies = follows_temperature(material) .or. has_law(material)
   end function varies

   !> Keeps a property, in place of that of an earlier card; what the material inherits is of its
   !> first row. Rows that are all alike are one.
   pure subroutine set_property(material, property)
      type(material_type), intent(inout) :: material
      type(property_type), intent(in) :: property
      type(property_type), allocatable :: others(:)
      integer :: i

      allocate (others(0))
      if (allocated(material%given)) then
         do i = 1, size(material%given)
            if (material%given(i)%kind /= property%kind) others = [others, material%given(i)]
         end do
      end if
      material%given = [others, property]
      associate (given => material%given(size(material%given)))
         if (all(abs(given%values - spread(given%values(:, 1), 2, size(given%temperature))) <= &
            0.0_dp)) then
            given%values = given%values(:, :1)
            given%temperature = given%temperature(:1)
         end if
      end associate
      call take_values(property%kind, property%symmetry, property%values(:, 1), material)
      call integrate_capacity(material)
   end subroutine set_property

   !> Gives a material with density and specific heat its latent heats, in ascending intervals that
   !> do not overlap. The mass is that at the solidus.
   pure subroutine set_latent_heat(material, heat, solidus, liquidus)
      type(material_type), intent(inout) :: material
      real(dp), intent(in) :: heat(:)                   !! (rows) [energy/mass]
      real(dp), intent(in) :: solidus(:), liquidus(:)   !! (rows) [temperature]
      real(dp) :: density(1)
      integer :: i, k

      if (allocated(material%melting)) deallocate (material%melting)
      allocate (material%melting(size(heat)))
      material%melting%solidus = solidus
      material%melting%liquidus = liquidus
      do i = 1, size(heat)
         do k = 1, size(material%given)
            if (material%given(k)%kind /= of_density) cycle
            call interpolate(material%given(k), solidus(i), density)
            material%melting(i)%content = density(1)*heat(i)
         end do
      end do
      material%melting%capacity = material%melting%content/(liquidus - solidus)
   end subroutine set_latent_heat

   !> The latent heat that a temperature is in the interval of, or 0.
   pure integer function melting_row(material, temperature) result(row)
      type(material_type), intent(in) :: material       !! that melts
      real(dp), intent(in) :: temperature

      do row = size(material%melting), 1, -1
         if (material%melting(row)%solidus <= temperature) exit
      end do
      if (row == 0) return
      if (temperature >= material%melting(row)%liquidus) row = 0
   end function melting_row

   !> Latent heat that a unit volume has taken up.
   pure real(dp) function latent_content(material, temperature) result(content)
      type(material_type), intent(in) :: material       !! that melts
      real(dp), intent(in) :: temperature
      integer :: i

      content = 0.0_dp
      do i = 1, size(material%melting)
         associate (row => material%melting(i))
            if (temperature >= row%liquidus) then
               content = content + row%content
            else if (temperature > row%solidus) then
               content = content + row%capacity*(temperature - row%solidus)
            end if
         end associate
      end do
   end function latent_content

   !> Part of the latent heats that is given off at a temperature.
   pure real(dp) function solid_fraction(material, temperature) result(fraction)
      type(material_type), intent(in) :: material       !! that melts
      real(dp), intent(in) :: temperature

      fraction = 1.0_dp - latent_content(material, temperature)/sum(material%melting%content)
   end function solid_fraction

   !> Where a temperature gets to with a latent heat that it has not taken up: with a heat capacity
   !> beside it, the temperature that has the heat of both, and the latent heat that this is
   !> within, or 0. An interval may be as narrow as temperatures round, so the heat says which.
   pure subroutine melted_to(material, capacity, given, latent, temperature, row)
      type(material_type), intent(in) :: material       !! that melts
      real(dp), intent(in) :: capacity                  !! [energy/(volume temperature)]
      real(dp), intent(in) :: given                     !! [temperature]
      real(dp), intent(in) :: latent                    !! [energy/volume]
      real(dp), intent(out) :: temperature
      integer, intent(out) :: row
      real(dp) :: content, taken_up

      taken_up = 0.0_dp
      do row = 1, size(material%melting)
         associate (melting => material%melting(row))
            content = capacity*(given - melting%solidus) + latent - taken_up
            if (content <= 0.0_dp) exit
            if (content < capacity*(melting%liquidus - melting%solidus) + melting%content) then
               temperature = melting%solidus + content/(capacity + melting%capacity)
               return
            end if
            taken_up = taken_up + melting%content
         end associate
      end do
      row = 0
      temperature = given + (latent - taken_up)/capacity
   end subroutine melted_to

   !> Gives properties the constants of a card.
   pure subroutine take_values(kind, symmetry, values, there)
      integer, intent(in) :: kind, symmetry
      real(dp), intent(in) :: values(:)                 ! (constants)
      class(properties_type), intent(inout) :: there
      real(dp) :: whole(6, 6)

      select case (kind)
      case (of_elasticity)
         whole = elasticity_of(symmetry, values)
         there%elasticity = whole(:4, :4)
      case (of_expansion)
         there%expansion = along_axes(values)
      case (of_conductivity)
         there%conductivity = [values(1), values(size(values))]
      case (of_density)
         there%density = values(1)
      case default
         there%specific_heat = values(1)
      end select
   end subroutine take_values

   !> One or three values along axes 1, 2, 3.
   pure function along_axes(values) result(along)
      real(dp), intent(in) :: values(:)
      real(dp) :: along(3)

      along = values(1)
      if (size(values) == 3) along = values
   end function along_axes

   !> Stiffness from the constants of *ELASTIC.
   pure function elasticity_of(symmetry, constants) result(stiffness)
      integer, intent(in) :: symmetry                   !! isotropic, ...
      real(dp), intent(in) :: constants(:)              !! as the deck gives them
      !> Order 11, 22, 33, 12, 13, 23; of isotropic ones without the last two [stress]
      real(dp) :: stiffness(6, 6)

      select case (symmetry)
      case (isotropic)
         stiffness = 0.0_dp
         stiffness(:4, :4) = isotropic_elasticity(constants(1), constants(2))
      case (engineering)
         stiffness = engineering_elasticity(constants)
      case (orthotropic)
         stiffness = orthotropic_elasticity(constants)
      case default
         stiffness = anisotropic_elasticity(constants)
      end select
   end function elasticity_of

   !> Elasticity and conductivity at a temperature. Those that do not vary stay as they are; heat
   !> and thermal strain have procedures of their own.
   pure subroutine set_to(self, temperature, there)
      class(material_type), intent(in) :: self
      real(dp), intent(in) :: temperature
      class(properties_type), intent(inout) :: there    !! of this material at any temperature
      real(dp) :: values(most_constants)
      integer :: i

      do i = 1, size(self%given)
         associate (property => self%given(i))
            if (size(property%temperature) == 1 .or. .not. (property%kind == of_elasticity .or. &
               property%kind == of_conductivity)) cycle
            call interpolate(property, temperature, values)
            call take_values(property%kind, property%symmetry, &
               values(:size(property%values, 1)), there)
         end associate
      end do
   end subroutine set_to

   !> The constants at a temperature.
   pure subroutine interpolate(property, temperature, values)
      type(property_type), intent(in) :: property
      real(dp), intent(in) :: temperature
      real(dp), intent(out) :: values(:)                ! its constants first
      real(dp) :: part
      integer :: k, row

      call find_row(property%temperature, temperature, row, part)
      do k = 1, size(property%values, 1)
         values(k) = property%values(k, row)
         if (part > 0.0_dp) values(k) = values(k) + part*(property%values(k, row + 1) - values(k))
      end do
   end subroutine interpolate

   !> Strain along axes 1, 2, 3 that temperatures make from the initial one on, and its slope. The
   !> coefficients of a table are secants from ZERO= on:
   !> alpha(T) (T - ZERO) - alpha(T_initial) (T_initial - ZERO).
   pure subroutine thermal_strain(material, initial, temperature, strain, slope)
      type(material_type), intent(in) :: material
      real(dp), intent(in) :: initial, temperature
      real(dp), intent(out) :: strain(3)                !! [-]
      real(dp), intent(out) :: slope(3)                 !! [1/temperature]
      real(dp) :: values(most_constants), first(3)
      integer :: i, row

      strain = material%expansion*(temperature - initial)
      slope = material%expansion
      do i = 1, size(material%given)
         associate (property => material%given(i), rows => material%given(i)%temperature, &
            zero => material%no_strain, n => size(material%given(i)%values, 1))
            if (property%kind /= of_expansion .or. size(rows) == 1) cycle
            call interpolate(property, initial, values)
            first = along_axes(values(:n))
            call interpolate(property, temperature, values)
            slope = along_axes(values(:n))
            strain = slope*(temperature - zero) - first*(initial - zero)
            row = row_below(rows, temperature)
            if (row > 0 .and. row < size(rows)) slope = slope + (temperature - zero)/(rows(row + &
               1) - rows(row))*along_axes(property%values(:, row + 1) - property%values(:, row))
         end associate
      end do
   end subroutine thermal_strain

   !> Heat in a unit volume, the integral of rho c from the lowest row of both, or 0, on.
   pure real(dp) function heat_content(material, temperature) result(content)
      type(material_type), intent(in) :: material
      real(dp), intent(in) :: temperature
      real(dp) :: x
      integer :: i

      associate (heat => material%heat)
         call find_part(heat, temperature, i, x)
         content = heat%content(i) + x*(heat%capacity(1, i) + x*(heat%capacity(2, i)/2 + &
            x*heat%capacity(3, i)/3))
      end associate
   end function heat_content

   !> rho c at a temperature.
   pure real(dp) function heat_capacity_at(material, temperature) result(capacity)
      type(material_type), intent(in) :: material
      real(dp), intent(in) :: temperature
      real(dp) :: x
      integer :: i

      associate (heat => material%heat)
         call find_part(heat, temperature, i, x)
         capacity = heat%capacity(1, i) + x*(heat%capacity(2, i) + x*heat%capacity(3, i))
      end associate
   end function heat_capacity_at

   !> The part of a table with a temperature, and how far it is into it.
   pure subroutine find_part(heat, temperature, part, x)
      type(heat_table_type), intent(in) :: heat
      real(dp), intent(in) :: temperature
      integer, intent(out) :: part
      real(dp), intent(out) :: x

      part = 1 + row_below(heat%from(2:), temperature)
      x = temperature - heat%from(part)
   end subroutine find_part

   !> Integrates rho c of the properties that the material has.
   pure subroutine integrate_capacity(material)
      type(material_type), intent(inout) :: material
      real(dp), allocatable :: rows(:)
      real(dp) :: at(3), width
      integer :: i, k

      ! Those of density and specific heat, ascending.
      allocate (rows(0))
      do i = 1, size(material%given)
         associate (property => material%given(i))
            if (size(property%temperature) == 1 .or. .not. any(property%kind == [of_density, &
               of_specific_heat])) cycle
            do k = 1, size(property%temperature)
               associate (there => property%temperature(k))
                  if (.not. any(abs(rows - there) <= 0.0_dp)) rows = [pack(rows, rows < there), &
                     there, pack(rows, rows > there)]
               end associate
            end do
         end associate
      end do
      if (size(rows) == 0) rows = [0.0_dp]
      associate (n => size(rows), heat => material%heat)
         heat%from = [rows(1), rows]
         heat%content = 0.0_dp*heat%from
         heat%capacity = spread([heat_capacity(material), 0.0_dp, 0.0_dp], 2, n + 1)
         do i = 2, n
            width = rows(i) - rows(i - 1)
            at = [capacity_at(material, rows(i - 1)), capacity_at(material, rows(i - 1) + &
               width/2), capacity_at(material, rows(i))]
            heat%capacity(:, i) = [at(1), (4*at(2) - 3*at(1) - at(3))/width, &
               (2*at(1) - 4*at(2) + 2*at(3))/width**2]
            ! Simpson's rule is exact.
            heat%content(i + 1) = heat%content(i) + width/6*(at(1) + 4*at(2) + at(3))
            heat%capacity(1, i + 1) = at(3)
         end do
      end associate
   end subroutine integrate_capacity

   !> beta:alpha of a material; in plane stress that of the strains in the plane.
   pure real(dp) function expansion_heat(material, plane)
      class(properties_type), intent(in) :: material
      integer, intent(in) :: plane                      !! plane_strain, ...
      real(dp) :: beta(4)                               !! [stress/temperature]

      beta = matmul(material%elasticity, [material%expansion, 0.0_dp])
      expansion_heat = dot_product(beta(:3), material%expansion)
      if (plane == plane_stress) expansion_heat = expansion_heat - &
         beta(3)**2/material%elasticity(3, 3)
   end function expansion_heat

   !> Smallest rho c, and the row where it is: between rows, where both factors are linear, their
   !> product is nowhere below both of its ends.
   pure subroutine least_heat_capacity(material, least, temperature)
      type(material_type), intent(in) :: material
      real(dp), intent(out) :: least                    !! [energy/(volume temperature)]
      real(dp), intent(out) :: temperature              !! 0 of a material without tables
      integer :: i

      associate (heat => material%heat)
         i = 1 + minloc(heat%capacity(1, 2:), dim=1)
         least = heat%capacity(1, i)
         temperature = heat%from(i)
      end associate
   end subroutine least_heat_capacity

   pure real(dp) function capacity_at(material, temperature) result(capacity)
      type(material_type), intent(in) :: material
      real(dp), intent(in) :: temperature
      real(dp) :: values(most_constants)
      integer :: i

      capacity = heat_capacity(material)
      do i = 1, size(material%given)
         associate (property => material%given(i))
            if (size(property%temperature) == 1) cycle
            if (all(property%kind /= [of_density, of_specific_heat])) cycle
            call interpolate(property, temperature, values)
            capacity = capacity/merge(material%density, material%specific_heat, &
               property%kind == of_density)*values(1)
         end associate
      end do
   end function capacity_at

   !> Axes 1 and 2 at a point, as columns in x and y. On the very axis of a cylindrical system the
   !> radius is along x.
   pure function material_axes(orientations, index, position) result(axes)
      type(orientation_type), intent(in) :: orientations(:)   !! all orientations
      integer, intent(in) :: index                            !! which, or 0 for x and y
      real(dp), intent(in) :: position(2)                     !! the point [length]
      real(dp) :: axes(2, 2)                                  !! unit vectors
      real(dp) :: radial(2)

      axes = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
      if (index == 0) return
      associate (orientation => orientations(index))
         axes(:, 1) = orientation%direction
         if (orientation%cylindrical) then
            radial = position - orientation%centre
            if (norm2(radial) > 0.0_dp) then
               radial = radial/norm2(radial)
               axes(:, 1) = orientation%direction(1)*radial + &
                  orientation%direction(2)*[-radial(2), radial(1)]
            end if
         end if
         axes(:, 2) = orientation%orientation_sign*[-axes(2, 1), axes(1, 1)]
      end associate
   end function material_axes

   !> Strains 11, 22, 33 and angle 12 from strains xx, yy, zz and angle xy; its transpose turns
   !> stresses back.
   pure function strain_rotation(axes) result(rotation)
      real(dp), intent(in) :: axes(2, 2)   !! from material_axes
      real(dp) :: rotation(4, 4)           !! [-]

      associate (a => axes(:, 1), b => axes(:, 2))
         rotation(1, :) = [a(1)**2, a(2)**2, 0.0_dp, a(1)*a(2)]
         rotation(2, :) = [b(1)**2, b(2)**2, 0.0_dp, b(1)*b(2)]
         rotation(3, :) = [0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp]
         rotation(4, :) = [2*a(1)*b(1), 2*a(2)*b(2), 0.0_dp, a(1)*b(2) + a(2)*b(1)]
      end associate
   end function strain_rotation

end module materials
