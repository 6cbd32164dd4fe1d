!> Cards -> model. The cards are read by theme, so their order matters only where the dialect
!> says so.
module deck_builder
   use mesh_bodies, only: find_bodies
   use cards, only: cards_type
   use controls, only: default_solver, method_names, mumps_from, solver_by_size, solver_mumps
   use deck_builder_accuracy, only: build_accuracy
   use deck_builder_contact, only: build_contacts, build_ties
   use deck_builder_couplings, only: apply_couplings, build_couplings
   use deck_builder_equations, only: build_equations
   use deck_builder_histories, only: build_amplitudes, build_temperatures
   use deck_builder_interactions, only: build_interactions
   use deck_builder_lines, only: build_lines, split_line_sets
   use deck_builder_materials, only: build_materials
   use deck_builder_mesh, only: build_elements, build_nodes
   use deck_builder_options, only: build_load_axis, build_options
   use deck_builder_order, only: apply_order, find_dropped
   use deck_builder_refinement, only: build_regions, refine_model
   use deck_builder_sections, only: build_orientations, build_sections
   use deck_builder_sets, only: build_sets
   use deck_builder_steps, only: build_steps
   use deck_builder_stresses, only: build_initial_stresses
   use deck_builder_surfaces, only: build_surfaces
   use deck_builder_transforms, only: apply_transforms, build_transforms, turn_equations
   use deck_builder_verify, only: build_verifications, check_heat_quantities, heatless
   use deck_checks, only: check_model
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use deck_structure, only: card_count, check_structure
   use errors, only: error_type
   use heat_checks, only: check_constants, check_heat_paths, check_starts
   use shape_checks, only: check_folds
   use load_application, only: apply_boundaries, apply_loads, apply_temperatures
   use load_checks, only: first_heat
   use kinds, only: dp
   use mesh, only: mesh_type, set_type
   use model, only: model_type
   use quantity_types, only: quantity_type
   use steps, only: analysis_coupled, analysis_static, solves_heat, solves_mechanics
   use text, only: to_text
   use touch_checks, only: check_touches
   use usage_checks, only: check_usage
   use variations, only: add_contact_levels, apply_variation, variation_type
   implicit none
   private
   public :: build_model

contains

   !> Builds the model that a deck describes; it is usable only if the report then has no errors.
   !> Error: status_internal, when a run would need more memory than there is.
   subroutine build_model(cards, verifiable, estimated, model, report, error, variation)
      type(cards_type), intent(in) :: cards               !! the cards, as read_deck left them
      type(quantity_type), intent(in) :: verifiable(:)    !! what *VERIFY may name
      type(quantity_type), intent(in) :: estimated(:)     !! what *ACCURACY may name
      type(model_type), intent(out) :: model
      type(deck_report_type), intent(inout) :: report     !! what is wrong with the deck
      type(error_type), allocatable, intent(out) :: error
      !> Overrides of the cards, once they are found sound
      type(variation_type), intent(in), optional :: variation
      type(deck_context_type) :: context
      integer :: i

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
      call build_regions(cards, context, model%mesh, report)
      call build_materials(cards, context, model, report)
      call build_orientations(cards, model, report)
      call build_sections(cards, context, model, report)
      call build_amplitudes(cards, model, report)
      call build_temperatures(cards, context, model, report)
      call build_initial_stresses(cards, context, model%mesh, report)
      call build_interactions(cards, context, model, report)
      call build_contacts(cards, context, model, report)
      call build_ties(cards, context, model, report)
      call build_equations(cards, context, model, report)
      call build_couplings(cards, context, model, report)
      call build_transforms(cards, model, report)
      call build_steps(cards, context, model, report)
      call build_verifications(cards, context, model, report)
      call build_accuracy(cards, estimated, model, report)
      call build_load_axis(cards%last, context, model, report)
      call check_model(context, model, report)
      if (.not. report%has_errors()) then
         if (present(variation)) then
            call apply_variation(variation, context%order, context%levels, model)
            call add_contact_levels(variation, model, context%regions)
            if (allocated(variation%divisions)) context%divisions = variation%divisions
         end if
         call complete_model(cards, context, model, report, error)
         if (allocated(error)) return
      end if
      if (.not. allocated(context%notes)) allocate(context%notes(0))
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
      integer :: errors

      call build_nodes(cards, context, mesh, report)
      call build_lines(cards, context, report)
      call build_elements(cards, context, mesh, report)
      call find_dropped(context, mesh)
      errors = report%error_count()
      call build_sets('element', cards, context, mesh, report, sets)
      call split_line_sets(size(mesh%element_number), sets, context%line_sets)
      call move_alloc(sets, mesh%element_sets)
      context%sets_sound = report%error_count() == errors .and. .not. report%has_lost('element')
      call build_surfaces(cards, context, mesh, report)
      errors = report%error_count()
      call build_sets('node', cards, context, mesh, report, sets)
      call move_alloc(sets, mesh%node_sets)
      context%sets_sound = context%sets_sound .and. report%error_count() == errors .and. &
         .not. report%has_lost('node set')
   end subroutine build_mesh

   !> Refines the sound model of a deck, and puts its loads on the mesh.
   !> Error: as refine_model.
   subroutine complete_model(cards, context, model, report, error)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context
      type(model_type), intent(inout) :: model
      type(deck_report_type), intent(inout) :: report
      type(error_type), allocatable, intent(out) :: error
      integer :: deck_nodes

      call find_bodies(model%mesh)
      call check_folds(context, model%mesh, report)
      call check_touches(context, model, report)
      call drop_idle_heat(context, model, report)
      call check_heat_quantities(context%verifiable, model, report)
      call apply_loads(context, model, report)
      call turn_equations(model)
      deck_nodes = size(model%mesh%node_number)
      call apply_temperatures(context, deck_nodes, .true., model)
      call check_starts(context, model, report)
      call refine_model(context, model, report, error)
      if (allocated(error)) return
      call apply_temperatures(context, deck_nodes, .false., model)
      call apply_couplings(model)
      call apply_boundaries(context, model, report)
      call apply_order(context, model, report)
      call apply_transforms(model)
      if (.not. report%has_errors()) then
         call check_usage(cards, context, model, report)
         call check_heat_paths(cards, model, report)
         call check_constants(cards, model, report)
      end if
      call find_bodies(model%mesh)
      if (model%solver == solver_by_size) call choose_solver(context, model)
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
         call report%suspect(context%step_place(s), 'step '//to_text(s)//' solves no heat: '// &
            'nothing prescribes a temperature and nothing heats the bodies; give *BOUNDARY '// &
            'with degree of freedom 11, or take *STATIC', heatless)
      end do
   end subroutine drop_idle_heat

   !> Chooses the solver of a deck without *SOLVER by the size of its model, and notes why.
   subroutine choose_solver(context, model)
      type(deck_context_type), intent(inout) :: context
      type(model_type), intent(inout) :: model
      character(:), allocatable :: reason
      integer :: unknowns

      unknowns = size(model%mesh%node_number)
      reason = ' temperatures'
      if (any(solves_mechanics(model%steps%analysis))) then
         unknowns = 2*unknowns
         reason = ' displacements'
      end if
      reason = ', because the nodes have '//to_text(unknowns)//reason
      model%solver = default_solver(real(unknowns, dp))
      if (model%solver == solver_mumps) then
         call context%note('no *SOLVER: MUMPS'//reason//' (SKYLINE below '// &
            to_text(mumps_from)//')')
      else
         call context%note('no *SOLVER: SKYLINE'//reason//' (MUMPS from '// &
            to_text(mumps_from)//' on)')
      end if
   end subroutine choose_solver

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

end module deck_builder
