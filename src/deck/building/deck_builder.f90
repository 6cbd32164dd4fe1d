!> Cards -> model. The cards are taken by theme, so that their order matters only where the dialect
!> says so.
module deck_builder
   use bodies, only: find_bodies
   use cards, only: cards_type
   use controls, only: method_names
   use deck_builder_contact, only: build_contacts
   use deck_builder_histories, only: build_amplitudes, build_temperatures
   use deck_builder_interactions, only: build_interactions
   use deck_builder_lines, only: build_lines, split_line_sets
   use deck_builder_load_axis, only: build_load_axis
   use deck_builder_materials, only: build_materials
   use deck_builder_mesh, only: build_elements, build_nodes
   use deck_builder_options, only: build_options
   use deck_builder_order, only: apply_order, find_dropped
   use deck_builder_orientations, only: build_orientations
   use deck_builder_sections, only: build_sections
   use deck_builder_sets, only: build_sets
   use deck_builder_steps, only: build_steps
   use deck_builder_surfaces, only: build_surfaces
   use deck_builder_ties, only: build_ties
   use deck_builder_verify, only: build_verifications, check_heat_quantities
   use deck_checks, only: check_model
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use deck_structure, only: card_count, check_structure
   use errors, only: error_type
   use heat_checks, only: check_heat_paths
   use load_application, only: apply_boundaries, apply_loads, apply_temperatures
   use load_checks, only: first_heat
   use memory_calls, only: check_memory
   use memory_needs, only: memory_needed
   use mesh, only: set_type
   use model, only: model_type
   use quantity_types, only: quantity_type
   use refinement, only: refine
   use steps, only: analysis_coupled, analysis_static, solves_heat
   use text, only: to_text
   use usage_checks, only: check_usage
   use variations, only: apply_variation, variation_type
   implicit none
   private
   public :: build_model

contains

   !> Builds the model that a deck describes; it is usable only if the report then has no errors.
   !> Error: status_internal, when a run would need more memory than there is.
   subroutine build_model(cards, verifiable, model, report, error, variation)
      type(cards_type), intent(in) :: cards               !! the cards, as read_deck left them
      type(quantity_type), intent(in) :: verifiable(:)    !! what *VERIFY may name
      type(model_type), intent(out) :: model
      type(deck_report_type), intent(inout) :: report     !! what is wrong with the deck
      type(error_type), allocatable, intent(out) :: error
      !> What is to be other than the cards say, once they are found sound
      type(variation_type), intent(in), optional :: variation
      type(deck_context_type) :: context
      type(set_type), allocatable :: sets(:)
      integer :: i, errors

      if (size(cards%keywords) == 0) return
      context%verifiable = verifiable
      if (allocated(cards%notes)) then
         do i = 1, size(cards%notes)
            call context%note(cards%notes(i)%value)
         end do
      end if
      call check_structure(cards, report)
      call build_options(cards, context, model, report)
      call build_nodes(cards, context, model%mesh, report)
      call build_lines(cards, context, report)
      call build_elements(cards, context, model%mesh, report)
      call find_dropped(context, model%mesh)
      errors = report%error_count()
      call build_sets('element', cards, context, model%mesh, report, sets)
      call split_line_sets(size(model%mesh%element_number), sets, context%line_sets)
      call move_alloc(sets, model%mesh%element_sets)
      context%sets_sound = report%error_count() == errors .and. .not. report%has_lost('element')
      call build_surfaces(cards, context, model%mesh, report)
      errors = report%error_count()
      call build_sets('node', cards, context, model%mesh, report, sets)
      call move_alloc(sets, model%mesh%node_sets)
      context%sets_sound = context%sets_sound .and. report%error_count() == errors .and. &
         .not. report%has_lost('node set')
      call build_materials(cards, context, model, report)
      call build_orientations(cards, model, report)
      call build_sections(cards, context, model, report)
      call build_amplitudes(cards, model, report)
      call build_temperatures(cards, context, model, report)
      call build_interactions(cards, context, model, report)
      call build_contacts(cards, context, model, report)
      call build_ties(cards, context, model, report)
      call build_steps(cards, context, model, report)
      call build_verifications(cards, context, model, report)
      call build_load_axis(cards%last, context, model, report)
      call check_model(context, model, report)
      if (.not. report%has_errors()) then
         if (present(variation)) call apply_variation(variation, context%order, context%levels, &
            model)
         call complete_model(cards, context, model, report, error)
         if (allocated(error)) return
      end if
      call take_notes(context, model)
      model%warnings = report%warnings()
   end subroutine build_model

   !> Refines the sound model of a deck, and puts its loads on the mesh.
   !> Error: as check_memory.
   subroutine complete_model(cards, context, model, report, error)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context
      type(model_type), intent(inout) :: model
      type(deck_report_type), intent(inout) :: report
      type(error_type), allocatable, intent(out) :: error
      integer :: deck_nodes

      call drop_idle_heat(context, model, report)
      call check_heat_quantities(context%verifiable, model, report)
      call apply_loads(context, model, report)
      deck_nodes = size(model%mesh%node_number)
      call apply_temperatures(context, deck_nodes, .true., model)
      model%memory_needed = memory_needed(model, context%levels, context%order)
      call check_memory(model%memory_needed, error)
      if (allocated(error)) return
      call refine(model, context%levels)
      call apply_temperatures(context, deck_nodes, .false., model)
      call apply_boundaries(context, model)
      call apply_order(context, model, report)
      if (.not. report%has_errors()) then
         call check_usage(cards, context, model, report)
         call check_heat_paths(cards, model, report)
      end if
      call find_bodies(model%mesh)
      call note_defaults(cards, context, model)
   end subroutine complete_model

   !> A step in which, and before which, no temperature is prescribed and no heat loaded solves
   !> none. That is rarely meant.
   subroutine drop_idle_heat(context, model, report)
      type(deck_context_type), intent(in) :: context
      type(model_type), intent(inout) :: model
      type(deck_report_type), intent(inout) :: report
      integer :: s

      do s = 1, first_heat(context, model) - 1
         if (model%steps(s)%analysis /= analysis_coupled) cycle
         model%steps(s)%analysis = analysis_static
         call report%warning(context%step_place(s), 'step '//to_text(s)//' solves no heat: '// &
            'nothing prescribes a temperature and nothing heats the bodies; give *BOUNDARY '// &
            'with degree of freedom 11, or take *STATIC')
      end do
   end subroutine drop_idle_heat

   !> Notes the defaults of what the deck does not say at all.
   subroutine note_defaults(cards, context, model)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context
      type(model_type), intent(in) :: model

      if (context%temperatures%count == 0) then
         call context%note('no *INITIAL CONDITIONS: the initial temperature is 0')
      end if
      if (card_count(cards, 'SOLVER') == 0) call context%note('no *SOLVER: SKYLINE')
      if (.not. any(model%materials%has_expansion)) then
         call context%note('no *EXPANSION: temperatures do not strain the bodies')
      else if (.not. all(model%materials%has_expansion)) then
         call context%note('a material without *EXPANSION: coefficient 0')
      end if
      if (.not. any(solves_heat(model%steps%analysis))) return
      if (card_count(cards, 'THERMAL SCHEME') == 0) then
         call context%note('no *THERMAL SCHEME: IMPLICIT')
      end if
      if (size(model%contacts) == 0) return
      if (.not. any(model%steps%analysis == analysis_coupled)) return
      associate (fixed_point => model%steps(1)%fixed_point)
         call context%note('*FIXED POINT in step 1: METHOD='// &
            trim(method_names(fixed_point%method))//', TOL='// &
            to_text(fixed_point%tolerance)//', MAXITER='//to_text(fixed_point%max_iterations)// &
            ', G='//to_text(fixed_point%g)//', CONSTANT='//to_text(fixed_point%constant))
      end associate
   end subroutine note_defaults

   subroutine take_notes(context, model)
      type(deck_context_type), intent(inout) :: context
      type(model_type), intent(inout) :: model

      if (.not. allocated(context%notes)) allocate(context%notes(0))
      call move_alloc(context%notes, model%notes)
   end subroutine take_notes

end module deck_builder
