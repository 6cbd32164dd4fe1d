!> *REFINE with a surface or a set.
module deck_builder_refinement
   use card_parameters, only: has_parameter, parameter_place, take_parameter
   use cards, only: cards_type, keyword_card_type
   use deck_builder_options, only: take_levels
   use deck_context, only: need_element_set, need_named
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use model, only: model_type
   use refined_regions, only: refined_region_type
   implicit none
   private
   public :: build_regions

contains

   !> Takes the *REFINE cards that name a surface or a set.
   subroutine build_regions(cards, model, report)
      type(cards_type), intent(in) :: cards
      type(model_type), intent(inout) :: model             !! its mesh; receives the regions
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(refined_region_type) :: region
      integer :: k

      allocate(model%regions(0))
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (card%name /= 'REFINE') cycle
            if (.not. (has_parameter(card, 'SURFACE') .or. has_parameter(card, 'ELSET'))) cycle
            call build_region(card, model%mesh, report, region)
            model%regions = [model%regions, region]
         end associate
      end do
   end subroutine build_regions

   subroutine build_region(card, mesh, report, region)
      type(keyword_card_type), intent(in) :: card
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      type(refined_region_type), intent(out) :: region
      integer :: errors, surface

      region%card = card%place%image
      call take_levels(card, report, region%levels)
      if (has_parameter(card, 'SURFACE') .and. has_parameter(card, 'ELSET')) then
         call report%error(parameter_place(card, 'ELSET'), '*REFINE takes SURFACE= or ELSET=, '// &
            'not both; give a card for each')
      else if (has_parameter(card, 'SURFACE')) then
         call need_named(card, 'SURFACE', 'surface', mesh%surfaces, report, surface)
         region%surfaces = [surface]
      else
         call need_element_set(card, mesh%element_sets, report, region%set)
      end if
      if (.not. has_parameter(card, 'DISTANCE')) return
      errors = report%error_count()
      call take_parameter(card, 'DISTANCE', report, region%distance)
      if (region%distance <= 0.0_dp .and. report%error_count() == errors) call report%error( &
         parameter_place(card, 'DISTANCE'), 'DISTANCE= must be above 0')
   end subroutine build_region

end module deck_builder_refinement
