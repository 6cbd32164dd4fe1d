!> *MATERIAL with *ELASTIC, *EXPANSION, *CONDUCTIVITY and *DENSITY.
module deck_builder_materials
   use card_parameters, only: choose, need_parameter, parameter_place
   use card_values, only: check_extra, field_place, has_field, need_field, take_field
   use cards, only: cards_type, data_card_type, keyword_card_type
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use deck_structure, only: card_count
   use elasticity, only: anisotropic_elasticity, couples_out_of_plane, engineering_elasticity, &
      is_positive_definite, isotropic_elasticity, orthotropic_elasticity
   use kinds, only: dp
   use materials, only: material_type
   use model, only: model_type
   implicit none
   private
   public :: build_materials, find_material

   character(*), parameter :: varies = 'properties that vary with temperature are refused: '// &
      'bodies are linear, and reduced once to their contact unknowns'

   integer, parameter :: per_card = 8   !! constants of a property on a card

   character(*), parameter :: engineering_names(9) = [character(4) :: 'E1', 'E2', 'E3', 'nu12', &
      'nu13', 'nu23', 'G12', 'G13', 'G23']
   character(*), parameter :: orthotropic_names(9) = [character(5) :: 'D1111', 'D1122', 'D2222', &
      'D1133', 'D2233', 'D3333', 'D1212', 'D1313', 'D2323']
   character(*), parameter :: anisotropic_names(21) = [character(5) :: 'D1111', 'D1122', &
      'D2222', 'D1133', 'D2233', 'D3333', 'D1112', 'D2212', 'D3312', 'D1212', 'D1113', 'D2213', &
      'D3313', 'D1213', 'D1313', 'D1123', 'D2223', 'D3323', 'D1223', 'D1323', 'D2323']

contains

   !> Takes all materials; a property belongs to the last *MATERIAL before it.
   subroutine build_materials(cards, context, model, report)
      type(cards_type), intent(in) :: cards                !! the cards
      type(deck_context_type), intent(inout) :: context    !! receives places and notes
      type(model_type), intent(inout) :: model             !! receives the materials
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: k, n

      n = card_count(cards, 'MATERIAL')
      allocate(model%materials(n), context%material_place(n))
      n = 0
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            select case (card%name)
            case ('MATERIAL')
               n = n + 1
               context%material_place(n) = card%place
               call need_parameter(card, 'NAME', report, model%materials(n)%name)
               if (find_material(model%materials(:n - 1), model%materials(n)%name) > 0) then
                  call report%error(parameter_place(card, 'NAME'), &
                     'material '//model%materials(n)%name//' is defined twice')
               end if
            case ('ELASTIC', 'EXPANSION', 'CONDUCTIVITY', 'DENSITY')
               if (n == 0) then
                  call report%error(card%place, '*'//card%name//' has no *MATERIAL before it')
               else if (card%last_data >= card%first_data) then
                  call build_property(cards, card, context, report, model%materials(n))
               end if
            case default
               if (n > 0) call presume_property(card%meant, model%materials(n))
            end select
         end associate
      end do
   end subroutine build_materials

   !> A slip of the pen in the keyword of a property is reported already, and stands for it.
   pure subroutine presume_property(meant, material)
      character(*), intent(in) :: meant
      type(material_type), intent(inout) :: material

      if (meant == 'ELASTIC') material%has_elasticity = .true.
      if (meant == 'CONDUCTIVITY') material%has_conductivity = .true.
      if (meant == 'DENSITY') material%has_density = .true.
   end subroutine presume_property

   !> Index of a material by its name; 0 for an unknown one.
   pure integer function find_material(materials, name)
      type(material_type), intent(in) :: materials(:)   !! materials
      character(*), intent(in) :: name                  !! name in upper case

      do find_material = size(materials), 1, -1
         if (materials(find_material)%name == name) return
      end do
   end function find_material

   subroutine build_property(cards, card, context, report, material)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(material_type), intent(inout) :: material

      select case (card%name)
      case ('ELASTIC')
         call build_elasticity(cards, card, context, report, material)
      case ('EXPANSION')
         call build_expansion(cards, card, context, report, material)
      case ('CONDUCTIVITY')
         call build_conductivity(cards, card, context, report, material)
      case ('DENSITY')
         call build_density(cards, card, context, report, material)
      case default
         return
      end select
   end subroutine build_property

   !> Reads the constants of a property, eight on a card, and the temperature behind the last.
   subroutine read_constants(cards, card, names, context, report, constants, valid)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: names(:)              !! of the constants
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      real(dp), intent(out) :: constants(:)
      logical, intent(out) :: valid
      integer :: i, last, place

      valid = .true.
      constants = 0.0_dp
      last = card%first_data + (size(constants) - 1)/per_card
      do i = 1, size(constants)
         place = card%first_data + (i - 1)/per_card
         if (place > card%last_data) then
            call report%error(cards%data(card%last_data)%end, 'missing card behind this one: '// &
               trim(names(i)))
            valid = .false.
            return
         end if
         call need_field(cards%data(place), mod(i - 1, per_card) + 1, trim(names(i)), report, &
            constants(i), valid)
         if (.not. has_field(cards%data(place), mod(i - 1, per_card) + 1)) return
         if (place == last) cycle
         if (mod(i, per_card) == 0) call check_extra(cards%data(place), per_card, &
            'eight constants', report)
      end do
      call read_temperature(cards%data(last), mod(size(constants) - 1, per_card) + 2, &
         joined(names(per_card*(last - card%first_data) + 1:)), context, report)
      if (card%last_data > last) call report%error(field_place(cards%data(last + 1), 1), varies)
   end subroutine read_constants

   pure function joined(names) result(list)
      character(*), intent(in) :: names(:)
      character(:), allocatable :: list
      integer :: i

      list = trim(names(1))
      do i = 2, size(names)
         list = list//', '//trim(names(i))
      end do
   end function joined

   subroutine refuse_not_positive(cards, card, names, constants, which, report)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      character(*), intent(in) :: names(:)
      real(dp), intent(in) :: constants(:)
      integer, intent(in) :: which(:)                   !! constants that must be positive
      type(deck_report_type), intent(inout) :: report
      integer :: i

      do i = 1, size(which)
         if (constants(which(i)) > 0.0_dp) cycle
         call report%error(field_place(cards%data(card%first_data + (which(i) - 1)/per_card), &
            mod(which(i) - 1, per_card) + 1), trim(names(which(i)))//' must be positive')
      end do
   end subroutine refuse_not_positive

   !> Reads the temperature behind a property: one row of it means nothing.
   subroutine read_temperature(data, position, layout, context, report)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position
      character(*), intent(in) :: layout
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      real(dp) :: temperature
      logical :: valid

      valid = .true.
      call take_field(data, position, 'temperature', report, temperature, valid)
      call check_extra(data, position, layout//', temperature', report)
      if (has_field(data, position)) then
         call context%note('the temperature field of a single property row is read and not needed')
      end if
   end subroutine read_temperature

   subroutine build_elasticity(cards, card, context, report, material)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(material_type), intent(inout) :: material
      character(:), allocatable :: kind
      real(dp) :: constants(21), d(6, 6)
      logical :: valid

      kind = 'ISO'
      call choose(card, 'TYPE', 'ISO/ISOTROPIC/ENGINEERING CONSTANTS/ORTHO/ORTHOTROPIC/ANISO/'// &
         'ANISOTROPIC', '', report, kind)
      material%has_elasticity = .true.
      select case (kind)
      case ('ENGINEERING CONSTANTS')
         call read_constants(cards, card, engineering_names, context, report, constants(:9), valid)
         if (.not. valid) return
         if (.not. all(constants([1, 2, 3, 7, 8, 9]) > 0.0_dp)) then
            call refuse_not_positive(cards, card, engineering_names, constants, &
               [1, 2, 3, 7, 8, 9], report)
            return
         end if
         d = engineering_elasticity(constants(:9))
      case ('ORTHO', 'ORTHOTROPIC')
         call read_constants(cards, card, orthotropic_names, context, report, constants(:9), valid)
         if (.not. valid) return
         d = orthotropic_elasticity(constants(:9))
      case ('ANISO', 'ANISOTROPIC')
         call read_constants(cards, card, anisotropic_names, context, report, constants, valid)
         if (.not. valid) return
         d = anisotropic_elasticity(constants)
      case default
         call build_isotropic(cards, card, context, report, material)
         return
      end select
      if (couples_out_of_plane(d)) then
         call report%error(field_place(cards%data(card%first_data), 1), &
            'couplings of the shear 13 or 23 with strains in the plane are refused: '// &
            'the plane would warp')
      else if (.not. is_positive_definite(d)) then
         call report%error(field_place(cards%data(card%first_data), 1), &
            'these constants are not positive definite: some strain would release energy')
      end if
      material%elasticity = d(:4, :4)
   end subroutine build_elasticity

   subroutine build_isotropic(cards, card, context, report, material)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(material_type), intent(inout) :: material
      character(15), parameter :: names(2) = [character(15) :: 'Young''s modulus', &
         'Poisson''s ratio']
      real(dp) :: constants(2)
      logical :: valid

      call read_constants(cards, card, names, context, report, constants, valid)
      if (.not. valid) return
      call refuse_not_positive(cards, card, names, constants, [1], report)
      if (constants(2) <= -1.0_dp .or. constants(2) >= 0.5_dp) then
         call report%error(field_place(cards%data(card%first_data), 2), &
            'Poisson''s ratio must lie between -1 and 0.5')
         return
      end if
      material%elasticity = isotropic_elasticity(constants(1), constants(2))
   end subroutine build_isotropic

   subroutine build_expansion(cards, card, context, report, material)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(material_type), intent(inout) :: material
      character(*), parameter :: names(3) = ['alpha11', 'alpha22', 'alpha33']
      character(:), allocatable :: kind
      logical :: valid

      kind = 'ISO'
      call choose(card, 'TYPE', 'ISO/ORTHO', '', report, kind)
      material%has_expansion = .true.
      if (kind == 'ORTHO') then
         call read_constants(cards, card, names, context, report, material%expansion, valid)
      else
         call read_constants(cards, card, ['coefficient of expansion'], context, report, &
            material%expansion(:1), valid)
         material%expansion = material%expansion(1)
      end if
   end subroutine build_expansion

   !> K11 and K22; K33, which CalculiX wants, is read and means nothing in the plane.
   subroutine build_conductivity(cards, card, context, report, material)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(material_type), intent(inout) :: material
      character(*), parameter :: iso_name(1) = ['conductivity']
      character(*), parameter :: names(3) = ['K11', 'K22', 'K33']
      character(:), allocatable :: kind
      real(dp) :: constants(3)
      integer :: n
      logical :: valid

      kind = 'ISO'
      call choose(card, 'TYPE', 'ISO/ORTHO', '', report, kind)
      material%has_conductivity = .true.
      if (kind == 'ORTHO') then
         n = min(max(size(cards%data(card%first_data)%fields), 2), 3)
         call read_constants(cards, card, names(:n), context, report, constants(:n), valid)
         if (n == 3) call context%note('*CONDUCTIVITY: K33 is read and not needed')
         if (valid) call refuse_not_positive(cards, card, names, constants, [1, 2], report)
         material%conductivity = constants(:2)
      else
         call read_constants(cards, card, iso_name, context, report, constants(:1), valid)
         if (valid) call refuse_not_positive(cards, card, iso_name, constants, [1], report)
         material%conductivity = constants(1)
      end if
   end subroutine build_conductivity

   subroutine build_density(cards, card, context, report, material)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(material_type), intent(inout) :: material
      character(*), parameter :: names(1) = ['density']
      real(dp) :: constants(1)
      logical :: valid

      call read_constants(cards, card, names, context, report, constants, valid)
      if (valid) call refuse_not_positive(cards, card, names, constants, [1], report)
      material%density = constants(1)
      material%has_density = .true.
   end subroutine build_density

end module deck_builder_materials
