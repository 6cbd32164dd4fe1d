!> *REFINE with a surface or a set, and the refinement of the whole model.
module deck_builder_refinement
   use card_parameters, only: has_parameter, lacks_parameter, parameter_place, take_parameter
   use cards, only: cards_type, keyword_card_type
   use deck_builder_options, only: take_levels
   use deck_checks, only: check_numbers
   use deck_context, only: deck_context_type, need_element_set, need_named
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use errors, only: error_type
   use kinds, only: dp, long
   use local_refinement, only: choose_neighbours, elements_at_points, elements_in_region
   use memory_calls, only: check_memory
   use memory_needs, only: memory_needed
   use mesh, only: mesh_type
   use model, only: model_type
   use refined_regions, only: division_type, refined_region_type
   use refinement, only: refine, refine_chosen
   implicit none
   private
   public :: build_regions, refine_model

contains

   !> Takes the *REFINE cards that name a surface or a set.
   subroutine build_regions(cards, context, mesh, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives the regions
      type(mesh_type), intent(in) :: mesh                  !! its surfaces and sets
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(refined_region_type) :: region
      integer :: k

      allocate(context%regions(0))
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (card%name /= 'REFINE') cycle
            if (.not. (has_parameter(card, 'SURFACE') .or. has_parameter(card, 'ELSET'))) cycle
            call build_region(card, mesh, report, region)
            context%regions = [context%regions, region]
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

   !> Divides the elements of a sound model: all of them, then those of each region in turn, then
   !> those of a variation.
   !> Error: as check_memory.
   subroutine refine_model(context, model, report, error)
      type(deck_context_type), intent(in) :: context       !! levels, order, regions
      type(model_type), intent(inout) :: model
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: levels(:)
      integer :: i, level

      model%memory_needed = memory_needed(model, context%levels, context%order)
      call check_memory(model%memory_needed, error)
      if (allocated(error)) return
      call refine(model, context%levels)
      do i = 1, size(context%regions)
         do level = 1, context%regions(i)%levels
            levels = merge(1, 0, elements_in_region(model%mesh, context%regions(i)))
            call divide_once(context, place_type(image=context%regions(i)%card), model, levels, &
               report, error)
            if (allocated(error) .or. report%has_errors()) return
         end do
      end do
      if (.not. allocated(context%divisions)) return
      do i = 1, size(context%divisions)
         levels = context%divisions(i)%levels
         do while (any(levels > 0))
            call divide_once(context, place_type(), model, levels, report, error)
            if (allocated(error) .or. report%has_errors()) return
         end do
         call divide_at_points(context, context%divisions(i), model, report, error)
         if (allocated(error) .or. report%has_errors()) return
      end do
   end subroutine refine_model

   !> Divides the elements at points, each time those that are left there.
   !> Error: as check_memory.
   subroutine divide_at_points(context, division, model, report, error)
      type(deck_context_type), intent(in) :: context
      type(division_type), intent(in) :: division
      type(model_type), intent(inout) :: model
      type(deck_report_type), intent(inout) :: report
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: levels(:), chosen(:)
      integer :: i, level

      do level = 1, maxval(division%point_levels)
         chosen = pack([(i, i=1, size(division%point_levels))], division%point_levels >= level)
         levels = merge(1, 0, elements_at_points(model%mesh, division%points(:, chosen)))
         call divide_once(context, place_type(), model, levels, report, error)
         if (allocated(error) .or. report%has_errors()) return
      end do
   end subroutine divide_at_points

   !> Divides the elements with levels above 0, and those that must be divided with them.
   !> Error: as check_memory.
   subroutine divide_once(context, place, model, levels, report, error)
      type(deck_context_type), intent(in) :: context
      type(place_type), intent(in) :: place                ! of the card that asks for it
      type(model_type), intent(inout) :: model
      integer, allocatable, intent(inout) :: levels(:)     ! (elements); receives what is left
      type(deck_report_type), intent(inout) :: report
      type(error_type), allocatable, intent(out) :: error
      logical :: chosen(size(levels))

      chosen = levels > 0
      call choose_neighbours(model, chosen)
      call check_numbers(place, size(chosen, kind=long) + 3*count(chosen, kind=long), model%mesh, &
         report)
      if (report%has_errors()) return
      call refine_chosen(model, chosen, levels)
      model%memory_needed = memory_needed(model, 0, context%order)
      call check_memory(model%memory_needed, error)
   end subroutine divide_once

end module deck_builder_refinement
