!> *MATERIAL with *ELASTIC, *EXPANSION, *CONDUCTIVITY and *DENSITY.
module deck_builder_materials
   use card_parameters, only: need_parameter
   use cards, only: cards_type, keyword_card_type
   use decimal_commas, only: check_unneeded
   use deck_builder_elasticity, only: build_elasticity
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use deck_structure, only: card_count, report_twice
   use kinds, only: dp
   use materials, only: material_type, set_constants
   use model, only: model_type
   use property_constants, only: choose_symmetry, read_constants, refuse_not_positive
   implicit none
   private
   public :: build_materials, find_material

contains

   !> Takes all materials; a property belongs to the last *MATERIAL before it.
   subroutine build_materials(cards, context, model, report)
      type(cards_type), intent(in) :: cards
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
                  call report_twice(cards, k, 'material '//model%materials(n)%name, report)
                  call report%lose('material')   ! another name may have been meant
                  call report%lose('*ELASTIC')   ! the other one may have these
                  call report%lose('*CONDUCTIVITY')
                  call report%lose('*DENSITY')
               end if
            case ('ELASTIC', 'EXPANSION', 'CONDUCTIVITY', 'DENSITY')
               if (n == 0) then
                  if (len(card%meant) == 0) call report%missing(card%place, '*'//card%name// &
                     ' has no *MATERIAL before it')
               else if (card%last_data >= card%first_data) then
                  call build_property(cards, card, context, report, model%materials(n))
               end if
            case default
               cycle
            end select
         end associate
      end do
   end subroutine build_materials

   !> Index of a material by its name; 0 for an unknown one.
   pure integer function find_material(materials, name)
      type(material_type), intent(in) :: materials(:)
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

   subroutine build_expansion(cards, card, context, report, material)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      type(material_type), intent(inout) :: material
      character(*), parameter :: iso_name(1) = ['coefficient of expansion']
      character(*), parameter :: names(3) = ['alpha11', 'alpha22', 'alpha33']
      character(:), allocatable :: kind
      logical :: valid

      kind = 'ISO'
      call choose_symmetry(card, 'ISO/ORTHO', report, kind)
      material%has_expansion = .true.
      if (kind == 'ORTHO') then
         call read_constants(cards, card, names, context, report, material%expansion, valid)
         call set_constants(material, card%name, names, material%expansion)
      else
         call read_constants(cards, card, iso_name, context, report, material%expansion(:1), valid)
         call set_constants(material, card%name, iso_name, material%expansion(:1))
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
      call choose_symmetry(card, 'ISO/ORTHO', report, kind)
      material%has_conductivity = .true.
      if (kind == 'ORTHO') then
         n = min(max(size(cards%data(card%first_data)%fields), 2), 3)
         call read_constants(cards, card, names(:n), context, report, constants(:n), valid)
         if (n == 3) call context%note('*CONDUCTIVITY: K33 is ignored')
         if (valid) call refuse_not_positive(cards, card, names, constants, [1, 2], report)
         if (valid .and. n == 3) then
            ! Across the plane most materials conduct as along one of its axes.
            if (all(abs(constants(:2) - constants(3)) > 0.0_dp)) call check_unneeded( &
               cards%data(card%first_data), 3, 'K33', report)
         end if
         material%conductivity = constants(:2)
         call set_constants(material, card%name, names(:2), constants(:2))
      else
         call read_constants(cards, card, iso_name, context, report, constants(:1), valid)
         if (valid) call refuse_not_positive(cards, card, iso_name, constants, [1], report)
         material%conductivity = constants(1)
         call set_constants(material, card%name, iso_name, constants(:1))
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
      call set_constants(material, card%name, names, constants)
      material%has_density = .true.
   end subroutine build_density

end module deck_builder_materials
