!> *MATERIAL with *ELASTIC, *EXPANSION, *CONDUCTIVITY and *DENSITY.
module deck_builder_materials
   use card_parameters, only: choose, need_parameter, parameter_place
   use card_values, only: check_extra, field_place, has_field, need_field, take_field
   use cards, only: cards_type, data_card_type, keyword_card_type
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use deck_structure, only: card_count
   use kinds, only: dp
   use materials, only: material_type
   use model, only: model_type
   implicit none
   private
   public :: build_materials, find_material

   character(*), parameter :: varies = 'properties that vary with temperature are refused: '// &
      'bodies are linear, and reduced once to their contact unknowns'

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

      if (card%last_data > card%first_data .and. card%name /= 'DENSITY') then
         call report%error(field_place(cards%data(card%first_data + 1), 1), varies)
      end if
      associate (data => cards%data(card%first_data))
         select case (card%name)
         case ('ELASTIC')
            call build_elasticity(card, data, context, report, material)
         case ('EXPANSION')
            call build_expansion(card, data, context, report, material)
         case ('CONDUCTIVITY')
            call build_conductivity(card, data, context, report, material)
         case ('DENSITY')
            call build_density(data, context, report, material)
         case default
            return
         end select
      end associate
   end subroutine build_property

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

   subroutine build_elasticity(card, data, context, report, material)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(material_type), intent(inout) :: material
      character(:), allocatable :: kind
      logical :: valid

      valid = .true.
      kind = 'ISO'
      call choose(card, 'TYPE', 'ISO/ISOTROPIC', '', report, kind)
      call need_field(data, 1, 'Young''s modulus', report, material%young, valid)
      call need_field(data, 2, 'Poisson''s ratio', report, material%poisson, valid)
      call read_temperature(data, 3, 'modulus, ratio', context, report)
      material%has_elasticity = .true.
      if (.not. valid) return
      if (material%young <= 0.0_dp) then
         call report%error(field_place(data, 1), 'Young''s modulus must be positive')
      end if
      if (material%poisson <= -1.0_dp .or. material%poisson >= 0.5_dp) then
         call report%error(field_place(data, 2), 'Poisson''s ratio must lie between -1 and 0.5')
      end if
   end subroutine build_elasticity

   subroutine build_expansion(card, data, context, report, material)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(material_type), intent(inout) :: material
      character(:), allocatable :: kind
      logical :: valid

      valid = .true.
      kind = 'ISO'
      call choose(card, 'TYPE', 'ISO', '', report, kind)
      call need_field(data, 1, 'coefficient of expansion', report, material%expansion, valid)
      call read_temperature(data, 2, 'coefficient', context, report)
      material%has_expansion = .true.
   end subroutine build_expansion

   !> K_x and K_y; a third conductivity, which CalculiX wants, is read and means nothing in the
   !> plane.
   subroutine build_conductivity(card, data, context, report, material)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(material_type), intent(inout) :: material
      character(:), allocatable :: kind
      real(dp) :: third
      logical :: valid
      integer :: i

      valid = .true.
      kind = 'ISO'
      call choose(card, 'TYPE', 'ISO/ORTHO', '', report, kind)
      call need_field(data, 1, 'conductivity', report, material%conductivity(1), valid)
      if (kind == 'ORTHO') then
         call need_field(data, 2, 'conductivity along y', report, material%conductivity(2), valid)
         call take_field(data, 3, 'conductivity along z', report, third, valid)
         if (has_field(data, 3)) call context%note('*CONDUCTIVITY: K_z is read and not needed')
         call read_temperature(data, 4, 'K_x, K_y, K_z', context, report)
      else
         material%conductivity(2) = material%conductivity(1)
         call read_temperature(data, 2, 'conductivity', context, report)
      end if
      material%has_conductivity = .true.
      if (.not. valid) return
      do i = 1, merge(2, 1, kind == 'ORTHO')
         if (material%conductivity(i) <= 0.0_dp) then
            call report%error(field_place(data, i), 'conductivity must be positive')
         end if
      end do
   end subroutine build_conductivity

   subroutine build_density(data, context, report, material)
      type(data_card_type), intent(in) :: data
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(material_type), intent(inout) :: material
      logical :: valid

      valid = .true.
      material%has_density = .true.
      call need_field(data, 1, 'density', report, material%density, valid)
      call read_temperature(data, 2, 'density', context, report)
      if (.not. valid .or. material%density > 0.0_dp) return
      call report%error(field_place(data, 1), 'density must be positive')
   end subroutine build_density

end module deck_builder_materials
