!> *LATENT HEAT -> the heat contents of a material.
module deck_builder_melting
   use card_values, only: read_rows
   use cards, only: keyword_card_type
   use deck_context, only: deck_type
   use kinds, only: dp
   use materials, only: material_type, of_density, of_specific_heat, set_latent_heat
   use text, only: to_text
   implicit none
   private
   public :: build_melting

   !> Least interval of melting, a part of latent over specific heat.
   real(dp), parameter :: least_interval = 1.0e-4_dp

   character(*), parameter :: row = 'latent heat >0/solidus temperature/liquidus temperature'

contains

   !> Reads a card of a material whose other cards have all been read.
   subroutine build_melting(card, deck, material)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck
      type(material_type), intent(inout) :: material
      real(dp) :: above, values(3, size(card%data)), width
      integer :: errors, i
      logical :: valid

      errors = deck%error_count()
      call read_rows(card%data, row, deck, values, valid)
      if (card%flawed .or. .not. valid) return
      do i = 1, 2
         if (material%has(merge(of_density, of_specific_heat, i == 1))) cycle
         call deck%missing(card%place, 'material '//material%name//' has *LATENT HEAT, but no '// &
            trim(merge('*DENSITY      ', '*SPECIFIC HEAT', i == 1))//': the heat of a volume '// &
            'needs both', trim(merge('*DENSITY      ', '*SPECIFIC HEAT', i == 1)))
         return
      end do
      if (material%specific_heat <= 0.0_dp) return
      above = -huge(above)
      do i = 1, size(values, 2)
         if (values(3, i) < values(2, i)) call deck%error(card%data(i)%place(3), 'the '// &
            'liquidus, '//to_text(values(3, i))//', is below the solidus, '//to_text(values(2, i)))
         if (deck%error_count() > errors) return
         width = least_interval*values(1, i)/material%specific_heat
         if (values(3, i) - values(2, i) < width) then
            values(2, i) = values(3, i) - width
            call deck%note('*LATENT HEAT: material '//material%name//' melts from '// &
               to_text(values(2, i))//' to '//to_text(values(3, i))//': the smallest interval '// &
               'is 1e-4 of latent over specific heat')
         end if
         if (values(2, i) < above) call deck%error(card%data(i)%place(2), 'rows must ascend '// &
            'and not overlap: melting from '//to_text(values(2, i))//' on follows a liquidus '// &
            'of '//to_text(above))
         above = values(3, i)
      end do
      if (deck%error_count() == errors) call set_latent_heat(material, values(1, :), &
         values(2, :), values(3, :))
   end subroutine build_melting

end module deck_builder_melting
