!> Cards -> model. The cards are read by theme, so their order matters only where the dialect
!> says so.
module deck_builder
   use mesh_bodies, only: find_bodies
   use cards, only: cards_type
   use continuation_checks, only: check_continuations
   use controls, only: method_names
   use deck_builder_verify, only: build_accuracy, build_verifications, check_heat_quantities, &
      heatless
   use deck_builder_contact, only: build_contacts, build_ties
   use deck_builder_bars, only: build_bars
   use deck_builder_equations, only: build_couplings, build_equations, build_transforms
   use deck_builder_gap_heat, only: check_friction_heat
   use deck_builder_histories, only: build_amplitudes, build_initial_stresses, build_temperatures, &
      build_time_points
   use deck_builder_interactions, only: build_interactions
   use deck_builder_lines, only: build_lines, split_line_sets
   use deck_builder_materials, only: build_materials, build_orientations, build_sections
   use deck_builder_mesh, only: build_elements, build_nodes
   use deck_builder_node_surfaces, only: build_node_surfaces
   use deck_builder_options, only: build_load_axis, build_options, build_regions
   use deck_builder_sections, only: build_pre_tensions
   use deck_builder_sets, only: build_sets, build_surfaces
   use deck_builder_steps, only: build_steps
   use deck_checks, only: check_model, check_usage
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use deck_structure, only: card_count, check_structure
   use heat_checks, only: check_heat_paths, check_starts
   use mesh_checks, only: check_folds
   use load_application, only: apply_requests, collect_fields, turn_equations
   use load_checks, only: check_amplitudes, first_heat
   use mesh, only: mesh_type, set_type
   use model, only: model_type
   use no_estimates, only: no_reason, reason_of_deck, words_of_reason
   use quantity_types, only: quantity_type
   use order_reduction, only: side_corners
   use steps, only: analysis_coupled, analysis_static, solves_heat, solves_mechanics
   use storage_checks, only: check_storage
   use text, only: to_text
   use touch_checks, only: check_touches
   use unit_checks, only: check_units
   implicit none
   private
   public :: build_model

contains

   !> Builds the model that a deck describes, on the mesh of the deck, from which `vary` makes those
   !> that are solved. It is usable only if the report then has no errors.
   subroutine build_model(cards, verifiable, estimated, model, report)
      type(cards_type), intent(in) :: cards               !! the cards, as read_deck left them
      type(quantity_type), intent(in) :: verifiable(:)    !! what *VERIFY may name
      type(quantity_type), intent(in) :: estimated(:)     !! what *ACCURACY may name
      type(model_type), intent(out) :: model
      type(deck_report_type), intent(inout) :: report     !! what is wrong with the deck
      type(deck_context_type) :: context
      integer :: i, why

      if (size(cards%keywords) == 0) return
      context%verifiable = verifiable
      if (allocated(cards%notes)) then
         do i = 1, size(cards%notes)
            call context%note(cards%notes(i)%value)
         end do
      end if
      call check_structure(cards, report)
      call build_options(cards, context, model, report)
      call build_mesh(cards, context, model%mesh, report)
      call build_regions(cards, context, model, report)
      call build_materials(cards, context, model, report)
      call build_orientations(cards, context, model, report)
      call build_sections(cards, context, model, report)
      call build_amplitudes(cards, context, model, report)
      call build_time_points(cards, context, report)
      call build_temperatures(cards, context, model, report)
      call build_initial_stresses(cards, context, model%mesh, report)
      call build_interactions(cards, context, model, report)
      call build_contacts(cards, context, model, report)
      call build_ties(cards, context, model, report)
      call build_transforms(cards, context, model, report)
      call build_bars(cards, context, model, report)
      call build_equations(cards, context, model, report)
      call build_couplings(cards, context, model, report)
      call build_pre_tensions(cards, context, model, report)
      call build_steps(cards, context, model, report)
      why = reason_of_deck(model)
      if (why /= no_reason .and. model%estimates_errors) then
         call context%note('no bounds of errors: they do not know '//words_of_reason(why))
         model%estimates_errors = .false.
      end if
      call build_verifications(cards, context, model, report)
      call build_accuracy(cards, estimated, context, model, report)
      if (allocated(model%accuracy%targets) .and. any(model%steps%restart_frequency > 0)) then
         call context%note('*RESTART is ignored: each round of *ACCURACY solves the deck anew')
         model%steps%restart_frequency = 0
      end if
      call build_load_axis(cards%last, context, model, report)
      call check_model(context, model, report)
      if (.not. report%has_errors()) call complete_model(cards, context, model, report)
      if (.not. allocated(context%notes)) allocate (context%notes(0))
      call move_alloc(context%notes, model%notes)
      model%warnings = report%warnings()
   end subroutine build_model

   !> Builds nodes and elements, their sets and surfaces. The sets of nodes come last: they may
   !> consist of the nodes of the others.
   subroutine build_mesh(cards, context, mesh, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context
      type(mesh_type), intent(inout) :: mesh
      type(deck_report_type), intent(inout) :: report
      type(set_type), allocatable :: sets(:)
      integer, allocatable :: corners(:, :)
      integer :: errors

      call build_nodes(cards, context, mesh, report)
      call build_lines(cards, context, report)
      call build_elements(cards, context, mesh, report)
      ! ORDER=1 drops nodes between corners; refined elements have those of the deck at corners.
      allocate (corners(2, size(mesh%node_number)), source=0)
      if (context%order == 1 .and. context%levels == 0) corners = side_corners(mesh)
      context%dropped = corners(1, :) > 0
      errors = report%error_count()
      call build_sets('element', cards, context, mesh, report, sets)
      call split_line_sets(size(mesh%element_number), sets, context%line_sets)
      call move_alloc(sets, mesh%element_sets)
      context%sets_sound = report%error_count() == errors .and. .not. report%has_lost('element')
      call build_surfaces(cards, context, mesh, report)
      errors = report%error_count()
      call build_sets('node', cards, context, mesh, report, sets)
      call move_alloc(sets, mesh%node_sets)
      context%node_index%sets%others = context%element_index%sets%name_index_type
      context%element_index%sets%others = context%node_index%sets%name_index_type
      call build_node_surfaces(cards, context, mesh, report)
      context%sets_sound = context%sets_sound .and. report%error_count() == errors .and. &
         .not. report%has_lost('node set')
   end subroutine build_mesh

   !> Puts the loads and supports of a sound deck on its mesh, and checks what that shows.
   subroutine complete_model(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context
      type(model_type), intent(inout) :: model
      type(deck_report_type), intent(inout) :: report
      integer :: s

      call find_bodies(model%mesh)
      call check_folds(context, model%mesh, report)
      call check_touches(context, model, report)
      do s = 1, first_heat(context, model) - 1
         if (model%steps(s)%is_transient) exit
         if (model%steps(s)%analysis /= analysis_coupled) cycle
         model%steps(s)%analysis = analysis_static
         call report%warning(context%step_place(s), 'step '//to_text(s)//' solves no heat: '// &
            'nothing prescribes a temperature and nothing heats the bodies; give *BOUNDARY '// &
            'with degree of freedom 11, or take *STATIC', heatless)
      end do
      call check_heat_quantities(context%verifiable, model, report)
      call turn_equations(model)
      model%deck_equations = size(model%equations)
      model%written_levels = context%levels
      model%written_order = context%order
      call take_requests(context, report, model)
      call apply_requests(model)
      call check_amplitudes(context, model, report)
      call check_starts(context, model, report)
      if (context%analyses_sound) call check_storage(context, model, report)
      if (context%analyses_sound) call check_continuations(cards, model, report)
      if (.not. report%has_errors()) then
         call check_usage(cards, context, model, report)
         call check_heat_paths(cards, model, report)
         call check_friction_heat(cards, context, model, report)
         call check_units(cards, model, report)
      end if
      call note_defaults(cards, context, model)
   end subroutine complete_model

   !> Gives a model what its deck asks for, and the places of the supports in words.
   subroutine take_requests(context, report, model)
      type(deck_context_type), intent(in) :: context
      type(deck_report_type), intent(in) :: report
      type(model_type), intent(inout) :: model
      integer :: i, n

      allocate (model%requests)
      model%requests%supports = context%boundaries
      model%requests%loads = context%loads
      model%requests%temperatures = context%temperatures
      call collect_fields(model)
      n = 0
      if (context%boundaries%count > 0) n = context%boundaries%items(context%boundaries%count)%card
      allocate (model%boundary_places(n))
      do i = 1, context%boundaries%count
         associate (request => context%boundaries%items(i))
            model%boundary_places(request%card)%value = report%source%words_of(request%place)
         end associate
      end do
   end subroutine take_requests

   !> Notes the defaults of what the deck does not say at all.
   subroutine note_defaults(cards, context, model)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context
      type(model_type), intent(in) :: model

      if (context%temperatures%count == 0) then
         call context%note('no initial temperature is given: it is 0')
      end if
      if (allocated(model%mesh%initial_stress) .and. .not. &
         any(solves_mechanics(model%steps%analysis))) then
         call context%note('initial stresses are ignored: no step solves equilibrium')
      end if
      if (.not. any(model%materials%has_expansion)) then
         call context%note('no *EXPANSION: temperatures do not strain the bodies')
      else if (.not. all(model%materials%has_expansion)) then
         call context%note('a material without *EXPANSION: coefficient 0')
      end if
      if (any(model%materials%has_specific_heat) .and. .not. any(model%steps%is_transient)) call &
         context%note('*SPECIFIC HEAT is ignored: no step stores heat')
      if (.not. any(solves_heat(model%steps%analysis))) return
      if (card_count(cards, 'THERMAL SCHEME') == 0) then
         if (any(model%steps%is_transient)) call context%note( &
            'no *THERMAL SCHEME: L-STABLE where heat is stored')
         if (any(solves_heat(model%steps%analysis) .and. .not. model%steps%is_transient)) call &
            context%note('no *THERMAL SCHEME: IMPLICIT')
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

end module deck_builder
