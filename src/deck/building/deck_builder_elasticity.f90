!> *ELASTIC -> stiffness of a material along its own axes.
module deck_builder_elasticity
   use card_parameters, only: choose
   use cards, only: cards_type, field_place, keyword_card_type
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use elasticity, only: anisotropic_elasticity, couples_out_of_plane, engineering_elasticity, &
      is_positive_definite, isotropic_elasticity, orthotropic_elasticity
   use kinds, only: dp
   use materials, only: material_type, set_constants
   use property_constants, only: read_constants, refuse_not_positive
   implicit none
   private
   public :: build_elasticity

   character(*), parameter :: engineering_names(9) = [character(4) :: 'E1', 'E2', 'E3', 'nu12', &
      'nu13', 'nu23', 'G12', 'G13', 'G23']
   character(*), parameter :: orthotropic_names(9) = [character(5) :: 'D1111', 'D1122', 'D2222', &
      'D1133', 'D2233', 'D3333', 'D1212', 'D1313', 'D2323']
   character(*), parameter :: anisotropic_names(21) = [character(5) :: 'D1111', 'D1122', &
      'D2222', 'D1133', 'D2233', 'D3333', 'D1112', 'D2212', 'D3312', 'D1212', 'D1113', 'D2213', &
      'D3313', 'D1213', 'D1313', 'D1123', 'D2223', 'D3323', 'D1223', 'D1323', 'D2323']

contains

   !> Takes the elasticity of a material.
   subroutine build_elasticity(cards, card, context, report, material)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card         !! *ELASTIC, with a data card
      type(deck_context_type), intent(inout) :: context   !! receives a note
      type(deck_report_type), intent(inout) :: report     !! receives errors
      type(material_type), intent(inout) :: material      !! receives the elasticity
      character(:), allocatable :: kind
      real(dp) :: constants(21), d(6, 6)
      logical :: valid

      kind = 'ISO'
      call choose(card, 'TYPE', 'ISO/ISOTROPIC/ENGINEERING CONSTANTS/ORTHO/ORTHOTROPIC/ANISO/'// &
         'ANISOTROPIC', report, kind)
      material%has_elasticity = .true.
      select case (kind)
      case ('ENGINEERING CONSTANTS')
         call read_constants(cards, card, engineering_names, context, report, constants(:9), valid)
         if (.not. valid) return
         call set_constants(material, card%name, engineering_names, constants(:9))
         if (.not. all(constants([1, 2, 3, 7, 8, 9]) > 0.0_dp)) then
            call refuse_not_positive(cards, card, engineering_names, constants, &
               [1, 2, 3, 7, 8, 9], report)
            return
         end if
         d = engineering_elasticity(constants(:9))
      case ('ORTHO', 'ORTHOTROPIC')
         call read_constants(cards, card, orthotropic_names, context, report, constants(:9), valid)
         if (.not. valid) return
         call set_constants(material, card%name, orthotropic_names, constants(:9))
         d = orthotropic_elasticity(constants(:9))
      case ('ANISO', 'ANISOTROPIC')
         call read_constants(cards, card, anisotropic_names, context, report, constants, valid)
         if (.not. valid) return
         call set_constants(material, card%name, anisotropic_names, constants)
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
      call set_constants(material, card%name, names, constants)
      call refuse_not_positive(cards, card, names, constants, [1], report)
      if (constants(2) <= -1.0_dp .or. constants(2) >= 0.5_dp) then
         call report%error(field_place(cards%data(card%first_data), 2), &
            'Poisson''s ratio must lie between -1 and 0.5')
         return
      end if
      material%elasticity = isotropic_elasticity(constants(1), constants(2))
   end subroutine build_isotropic

end module deck_builder_elasticity
