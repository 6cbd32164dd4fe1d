!> *MATERIAL with *ELASTIC, *EXPANSION, *CONDUCTIVITY and *DENSITY; *SOLID SECTION, which gives
!> elements their material, its axes and their thickness.
module deck_builder_materials
   use card_values, only: choice, take_parameter, check_ascending, check_unneeded, &
      decimal_comma, decimal_comma_words, read_row
   use cards, only: data_card_type
   use deck_builder_equations, only: find_reference
   use deck_builder_material_laws, only: build_inelasticity, complete_law, build_melting
   use deck_context, only: deck_type
   use deck_structure, only: cards_of, has_stand_in
   use elasticity, only: couples_out_of_plane, is_positive_definite
   use element_kinds, only: axisymmetric, generalized_strain
   use element_types, only: truss
   use kinds, only: dp
   use materials, only: anisotropic, elasticity_of, engineering, isotropic, material_type, &
      orthotropic, property_keywords, property_type, set_property
   use text, only: split_words, string_type, to_text
   implicit none
   private
   public :: build_materials, build_sections

   ! Constants of *ELASTIC, as read_row; one layout a card.
   character(*), parameter :: isotropic_layout = 'Young''s modulus >0/Poisson''s ratio'
   character(*), parameter :: engineering_layout(2) = [character(51) :: &
      'E1 >0/E2 >0/E3 >0/nu12/nu13/nu23/G12 >0/G13 >0', 'G23 >0']
   character(*), parameter :: orthotropic_layout(2) = [character(47) :: &
      'D1111/D1122/D2222/D1133/D2233/D3333/D1212/D1313', 'D2323']
   character(*), parameter :: anisotropic_layout(3) = [character(47) :: &
      'D1111/D1122/D2222/D1133/D2233/D3333/D1112/D2212', &
      'D3312/D1212/D1113/D2213/D3313/D1213/D1313/D1123', 'D2223/D3323/D1223/D1323/D2323']

   integer, parameter :: per_card = 8   !! constants of a property on a card

contains

   !> Builds all materials; a property belongs to the last *MATERIAL before it.
   subroutine build_materials(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: melting(:)                  ! (materials) *LATENT HEAT, 0 for none
      integer :: k, n

      n = size(cards_of(deck%cards, 'MATERIAL'))
      allocate(deck%model%materials(n), deck%material_place(n))
      allocate (melting(n), source=0)
      n = 0
      do k = 1, size(deck%cards%keywords)
         call deck%open_card(k)
         select case (deck%card%name)
         case ('MATERIAL')
            n = n + 1
            deck%material_place(n) = deck%card%place
            call deck%take_name('material', deck%model%materials(n)%name)
            if (.not. deck%has_lost('material')) cycle
            call deck%lose('*ELASTIC')   ! another material may have these
            call deck%lose('*CONDUCTIVITY')
            call deck%lose('*DENSITY')
            call deck%lose('*SPECIFIC HEAT')
         case ('ELASTIC', 'EXPANSION', 'CONDUCTIVITY', 'DENSITY', 'SPECIFIC HEAT', 'LATENT HEAT', &
            'PLASTIC', 'CYCLIC HARDENING', 'CREEP', 'INELASTIC HEAT FRACTION', 'ANNEAL TEMPERATURE')
            if (n == 0) then
               if (len(deck%card%meant) == 0) call deck%missing(deck%card%place, '*'// &
                  deck%card%name//' has no *MATERIAL before it')
               call deck%lose('*'//deck%card%name)
            else if (size(deck%card%data) == 0 .and. deck%card%name(:1) /= 'I') then
               cycle
            else if (any(property_keywords == deck%card%name)) then
               call build_property(deck, deck%model%materials(n))
            else if (deck%card%name == 'LATENT HEAT') then
               melting(n) = k
            else
               call build_inelasticity(deck, deck%model%materials(n))
            end if
         case default
            cycle
         end select
      end do
      do n = 1, size(deck%model%materials)
         call complete_law(n, deck, deck%model%materials(n))
         if (melting(n) == 0) cycle
         call deck%open_card(melting(n))
         call build_melting(deck, deck%model%materials(n))
      end do
   end subroutine build_materials

   !> Reads a property. One with errors in it is not kept.
   subroutine build_property(deck, material)
      type(deck_type), intent(inout) :: deck
      type(material_type), intent(inout) :: material
      type(property_type) :: property
      logical :: valid

      property%kind = findloc(property_keywords == deck%card%name, .true., dim=1)
      material%has(property%kind) = .true.
      select case (deck%card%name)
      case ('ELASTIC')
         call build_elasticity(deck, property, valid)
      case ('EXPANSION')
         if (is_isotropic(deck)) then
            call read_property(['coefficient of expansion'], deck, property, valid)
         else
            call read_property(['alpha11/alpha22/alpha33'], deck, property, valid)
         end if
         call take_parameter(deck%card, 'ZERO', deck, material%no_strain)
         if (valid .and. deck%card%has('ZERO')) then
            if (size(property%temperature) == 1) call deck%note('*EXPANSION: ZERO is ignored '// &
               'with a single row: strains begin at the initial temperature')
         end if
      case ('CONDUCTIVITY')
         if (is_isotropic(deck)) then
            call read_property(['conductivity >0'], deck, property, valid)
         else
            call build_conductivity(deck, property, valid)
         end if
      case ('SPECIFIC HEAT')
         call read_property(['specific heat >0'], deck, property, valid)
      case default
         call read_property(['density >0'], deck, property, valid)
      end select
      if (valid) call set_property(material, property)
   end subroutine build_property

   !> TYPE= of expansion and conductivity, whose first letters alone CalculiX reads.
   logical function is_isotropic(deck)
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: symmetry

      symmetry = choice(deck%card, 'TYPE', 'ISO/ORTHO/ISOTROPIC/ORTHOTROPIC', deck, 'ISO')
      is_isotropic = symmetry(:3) == 'ISO'
   end function is_isotropic

   subroutine build_elasticity(deck, property, valid)
      type(deck_type), intent(inout) :: deck
      type(property_type), intent(inout) :: property
      logical, intent(out) :: valid                       ! whether it has no errors
      character(:), allocatable :: kind
      integer :: row

      kind = choice(deck%card, 'TYPE', 'ISO/ISOTROPIC/ENGINEERING '// &
         'CONSTANTS/ORTHO/ORTHOTROPIC/ANISO/ANISOTROPIC', deck, '')
      valid = len(kind) > 0 .or. .not. deck%card%has('TYPE')
      if (.not. valid) return
      select case (kind)
      case ('ENGINEERING CONSTANTS')
         property%symmetry = engineering
         call read_property(engineering_layout, deck, property, valid)
      case ('ORTHO', 'ORTHOTROPIC')
         property%symmetry = orthotropic
         call read_property(orthotropic_layout, deck, property, valid)
      case ('ANISO', 'ANISOTROPIC')
         property%symmetry = anisotropic
         call read_property(anisotropic_layout, deck, property, valid)
      case default
         call read_property([isotropic_layout], deck, property, valid)
      end select
      do row = 1, size(property%temperature)
         if (.not. valid .and. property%symmetry /= isotropic) exit
         associate (data => deck%card%data(1 + (row - 1)*((size(property%names) - 1)/per_card + 1)))
            call check_elasticity(data, property, row, deck, valid)
         end associate
      end do
   end subroutine build_elasticity

   !> Reports a row whose stiffness has no energy, or warps the plane.
   subroutine check_elasticity(data, property, row, deck, valid)
      type(data_card_type), intent(in) :: data            ! the first card of the row
      type(property_type), intent(in) :: property
      integer, intent(in) :: row
      type(deck_type), intent(inout) :: deck
      logical, intent(inout) :: valid                     ! false where it does
      character(:), allocatable :: fault
      integer :: comma

      associate (constants => property%values(:, row))
         if (property%symmetry == isotropic) then
            if (constants(2) > -1.0_dp .and. constants(2) < 0.5_dp) return
            fault = 'Poisson''s ratio must lie between -1 and 0.5'
         else if (couples_out_of_plane(elasticity_of(property%symmetry, constants))) then
            fault = 'couplings of the shear 13 or 23 with strains in the plane are refused: '// &
               'the plane would warp'
         else if (.not. is_positive_definite(elasticity_of(property%symmetry, constants))) then
            fault = 'these constants are not positive definite: some strain would release energy'
         else
            return
         end if
      end associate
      comma = decimal_comma(data)
      if (comma > 0) fault = fault//'; or a '//decimal_comma_words(data%fields(comma)%text, &
         data%fields(comma + 1)%text)
      call deck%error(data%place(merge(2, 1, property%symmetry == isotropic)), fault)
      valid = .false.
   end subroutine check_elasticity

   !> K11 and K22; K33, which CalculiX wants, is read and means nothing in the plane.
   subroutine build_conductivity(deck, property, valid)
      type(deck_type), intent(inout) :: deck
      type(property_type), intent(inout) :: property
      logical, intent(out) :: valid                       ! whether it has no errors
      integer :: fields, n, row

      fields = size(deck%card%data(1)%fields)
      n = min(max(fields, 2), 3)
      if (n == 2) call read_property(['K11 >0/K22 >0'], deck, property, valid)
      if (n == 3) call read_property(['K11 >0/K22 >0/K33'], deck, property, valid)
      if (n == 3) call deck%note('*CONDUCTIVITY: K33 is ignored')
      if (.not. valid) return
      if (n == 3) then
         ! Across the plane most materials conduct as along one of its axes.
         do row = 1, size(property%temperature)
            associate (constants => property%values(:, row))
               if (all(abs(constants(:2) - constants(3)) > 0.0_dp)) call check_unneeded( &
                  deck%card%data(row), 3, 'K33', deck)
            end associate
         end do
      end if
      property%names = property%names(:2)
      property%values = property%values(:2, :)
   end subroutine build_conductivity

   !> Reads the rows of a property: constants, eight on a card, and the temperature behind the last,
   !> which means nothing where there is one row.
   subroutine read_property(layouts, deck, property, valid)
      character(*), intent(in) :: layouts(:)                ! of the cards of a row, as read_row
      type(deck_type), intent(inout) :: deck
      type(property_type), intent(inout) :: property
      logical, intent(out) :: valid                         ! whether all could be read
      type(string_type), allocatable :: fields(:)
      character(:), allocatable :: ending
      integer :: c, errors, i, n, rows
      real(dp) :: given(per_card + 1)
      logical :: sound

      n = 0
      allocate (property%names(per_card*size(layouts)))
      do c = 1, size(layouts)
         fields = split_words(trim(layouts(c)))
         do i = 1, size(fields)
            n = n + 1
            property%names(n) = fields(i)%value(:index(fields(i)%value//' >', ' >') - 1)
         end do
      end do
      property%names = property%names(:n)
      rows = (size(deck%card%data) - 1)/size(layouts) + 1
      allocate (property%values(n, rows), property%temperature(rows), source=0.0_dp)
      valid = .not. deck%card%flawed
      if (.not. valid) return
      ending = ''
      do i = 1, rows*size(layouts)
         c = modulo(i - 1, size(layouts)) + 1
         n = per_card*(c - 1)                               ! constants on the cards before
         if (i > size(deck%card%data)) then
            call deck%error(deck%card%data(size(deck%card%data))%end, 'a card is missing after '// &
               'this one: '//trim(property%names(n + 1)))
            valid = .false.
            return
         end if
         if (c == size(layouts)) ending = '/temperature'//trim(merge('?', ' ', rows == 1))
         call read_row(deck%card%data(i), trim(layouts(c))//ending, deck, given, sound)
         ending = ''
         valid = valid .and. sound
         associate (row => (i - 1)/size(layouts) + 1, last => min(n + per_card, size( &
            property%names)))
            property%values(n + 1:last, row) = given(:last - n)
            property%temperature(row) = given(last - n + 1)
            if (c == size(layouts) .and. rows == 1 .and. deck%card%data(i)%has(last - n + 1)) then
               call deck%note('the temperature field of a single property row is ignored')
               call check_unneeded(deck%card%data(i), last - n + 1, 'a temperature', deck)
            end if
         end associate
      end do
      if (.not. valid) return
      errors = deck%error_count()
      call check_ascending(deck%card%data(size(layouts)::size(layouts)), modulo(size( &
         property%names) - 1, per_card) + 2, 'the temperatures of the rows', property%temperature, &
         deck)
      valid = deck%error_count() == errors
   end subroutine read_property

   !> Builds all sections, and gives the elements theirs.
   subroutine build_sections(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: places(:)
      real(dp) :: thickness(1)
      integer :: n, node, other, unnamed
      logical :: valid

      places = cards_of(deck%cards, 'SOLID SECTION')
      allocate(deck%model%sections(size(places)))
      deck%sections_sound = &
         .not. (has_stand_in(deck%cards, 'SOLID SECTION') .or. deck%has_lost('element set'))
      valid = .true.
      unnamed = size(deck%node_height)
      do n = 1, size(places)
         call deck%open_card(places(n))
         associate (section => deck%model%sections(n))
            call deck%need_named('MATERIAL', 'material', section%material)
            call deck%take_named('ORIENTATION', 'orientation', section%orientation)
            if (size(deck%card%data) > 0) then
               associate (data => deck%card%data(1))
                  call read_row(data, 'thickness? >0 =1/@points', deck, thickness, valid)
                  section%thickness = thickness(1)
                  if (size(data%fields) > 1) then
                     call check_unneeded(data, 2, 'a number of points', deck)
                     call deck%note('*SOLID SECTION: what is behind the thickness is ignored')
                  end if
               end associate
            end if
            call give_section(n, deck, section%element_set)
            if (deck%card%has('REF NODE')) then
               ! Sections may have one in common; the other node the builder of nodes left for it.
               unnamed = unnamed + 1
               call find_reference('REF NODE', deck, node)
               if (any(deck%mesh%element_nodes == node) .and. node > 0) call deck%error( &
                  deck%card%place_of('REF NODE'), 'elements have node '//to_text( &
                  deck%mesh%node_number(node))//': REF NODE= is a node of its own')
               other = findloc(deck%model%sections(:n - 1)%reference(1), node, dim=1)
               if (node > 0) section%reference = [node, unnamed]
               if (node > 0 .and. other > 0) section%reference = &
                  deck%model%sections(other)%reference
            end if
            call check_reference(section%element_set, deck)
            if (size(deck%card%data) > 0 .or. section%element_set == 0) cycle
            if (any(deck%mesh%element_plane(deck%mesh%element_sets(section%element_set)%members) &
               /= axisymmetric)) call deck%note('*SOLID SECTION without a thickness: '// &
               to_text(section%thickness))
         end associate
      end do
   end subroutine build_sections

   !> Elements in generalized plane strain need a reference node, others have none.
   subroutine check_reference(set, deck)
      integer, intent(in) :: set         ! element set of the section, 0 after an error
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: element
      integer :: other

      if (set == 0) return
      associate (members => deck%mesh%element_sets(set)%members, has_node => deck%card%has( &
         'REF NODE'))
         other = findloc(deck%element_valid(members) .and. (deck%mesh%element_plane(members) == &
            generalized_strain .neqv. has_node), .true., dim=1)
         if (other == 0) return
         element = 'element '//to_text(deck%mesh%element_number(members(other)))//' of '// &
            deck%mesh%element_sets(set)%name
         if (has_node) then
            call deck%error(deck%card%place_of('REF NODE'), element//' has no strain along z: '// &
               'REF NODE= goes with elements CPEG')
         else
            call deck%error(deck%card%place, element//' is in generalized plane strain: give '// &
               'REF NODE=, the node whose degrees of freedom 3, 4 and 5 are its strain along z')
         end if
      end associate
   end subroutine check_reference

   !> Gives the elements of its set a section, which is not sound where the set is not known.
   subroutine give_section(section, deck, set)
      integer, intent(in) :: section
      type(deck_type), intent(inout) :: deck
      integer, intent(out) :: set        ! that of the card; 0 after an error
      integer, allocatable :: kinds(:)   ! of the lines of the set

      call deck%need_named('ELSET', 'element set', set)
      if (set > 0) then
         kinds = deck%line_kind(deck%line_sets(set)%members)
         if (all(kinds /= truss)) call deck%need_element_set(set)
      end if
      deck%sections_sound = deck%sections_sound .and. set > 0
      if (set == 0) return
      if (size(kinds) > 0 .and. all(kinds /= truss)) call deck%warning(deck%card%place_of( &
         'ELSET'), 'element set '//deck%mesh%element_sets(set)%name//' also has lines, which '// &
         'are ignored')
      associate (members => deck%mesh%element_sets(set)%members)
         if (any(deck%mesh%element_section(members) > 0)) call deck%warning(deck%card%place, &
            'this section replaces an earlier one; elements concerned: '//to_text(count( &
            deck%mesh%element_section(members) > 0)))
         deck%mesh%element_section(members) = section
      end associate
   end subroutine give_section

end module deck_builder_materials
