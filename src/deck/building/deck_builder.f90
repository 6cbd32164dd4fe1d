!> Cards -> model. They are read by theme: their order matters only where the dialect says so.
module deck_builder
   use materials, only: melts, of_expansion, of_specific_heat
   use mesh_bodies, only: find_bodies
   use cards, only: cards_type
   use step_checks, only: check_continuations, check_laws, check_storage
   use controls, only: method_names
   use deck_builder_verify, only: build_accuracy, build_verifications, check_heat_quantities
   use deck_builder_contact, only: build_contacts, build_ties
   use deck_builder_axes, only: build_orientations, build_transforms
   use deck_builder_bars, only: build_bars
   use deck_builder_equations, only: build_couplings, build_equations, build_pre_tensions
   use deck_builder_gap_laws, only: check_friction_heat
   use deck_builder_histories, only: build_amplitudes, build_initial_stresses, build_temperatures, &
      build_time_points
   use deck_builder_interactions, only: build_interactions
   use deck_builder_materials, only: build_materials, build_sections
   use deck_builder_mesh, only: build_elements, build_nodes
   use deck_builder_options, only: build_load_axis, build_options, build_regions
   use deck_builder_sets, only: build_node_surfaces, build_sets, build_surfaces
   use deck_builder_steps, only: build_steps
   use deck_checks, only: check_model, check_usage
   use deck_context, only: deck_type
   use deck_report, only: deck_report_type, heatless
   use deck_structure, only: cards_of, check_structure
   use heat_checks, only: check_heat_paths, check_starts
   use mesh_checks, only: check_folds
   use load_application, only: apply_requests, collect_fields, turn_equations
   use load_checks, only: check_amplitudes, first_heat
   use model, only: model_type
   use quantity_types, only: quantity_type
   use order_reduction, only: side_corners
   use steps, only: analysis_coupled, analysis_static, solves_heat, solves_mechanics
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
      type(cards_type), intent(in), target :: cards       !! the cards, as read_deck left them
      type(quantity_type), intent(in) :: verifiable(:)    !! what *VERIFY may name
      type(quantity_type), intent(in) :: estimated(:)     !! what *ACCURACY may name
      type(model_type), intent(out), target :: model
      type(deck_report_type), intent(inout) :: report     !! what is wrong with the deck
      type(deck_type) :: deck

      if (size(cards%keywords) == 0) return
      deck%deck_report_type = report
      deck%cards => cards
      deck%model => model
      deck%mesh => model%mesh
      deck%verifiable = verifiable
      if (allocated(cards%notes)) deck%notes = cards%notes
      call check_structure(cards, deck)
      call build_options(deck)
      call build_mesh(deck)
      call build_regions(deck)
      call build_materials(deck)
      call build_orientations(deck)
      call build_sections(deck)
      call build_amplitudes(deck)
      call build_time_points(deck)
      call build_temperatures(deck)
      call build_initial_stresses(deck)
      call build_interactions(deck)
      call build_contacts(deck)
      call build_ties(deck)
      call build_transforms(deck)
      call build_bars(deck)
      call build_equations(deck)
      call build_couplings(deck)
      call build_pre_tensions(deck)
      call build_steps(deck)
      call build_verifications(deck)
      call build_accuracy(estimated, deck)
      if (allocated(model%accuracy%targets) .and. any(model%steps%restart_frequency > 0)) then
         call deck%note('*RESTART is ignored: each round of *ACCURACY solves the deck anew')
         model%steps%restart_frequency = 0
      end if
      call build_load_axis(deck)
      call check_model(deck)
      if (.not. deck%has_errors()) call complete_model(deck)
      if (deck%analyses_sound) call check_units(deck)
      if (.not. allocated(deck%notes)) allocate (deck%notes(0))
      call move_alloc(deck%notes, model%notes)
      model%warnings = deck%warnings()
      report = deck%deck_report_type
   end subroutine build_model

   !> Builds nodes and elements, their sets and surfaces. The sets of nodes come last: they may
   !> consist of the nodes of the others.
   subroutine build_mesh(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: corners(:, :)
      integer :: errors

      call build_nodes(deck)
      call build_elements(deck)
      ! ORDER=1 drops nodes between corners; refined elements have those of the deck at corners.
      allocate (corners(2, size(deck%mesh%node_number)), source=0)
      if (deck%order == 1 .and. deck%levels == 0) corners = side_corners(deck%mesh)
      deck%dropped = corners(1, :) > 0
      errors = deck%error_count()
      call build_sets('element', deck)
      if (deck%error_count() > errors .or. deck%has_lost('element')) call deck%lose('set')
      call build_surfaces(deck)
      errors = deck%error_count()
      call build_sets('node', deck)
      call build_node_surfaces(deck)
      if (deck%error_count() > errors .or. deck%has_lost('node set')) call deck%lose('set')
   end subroutine build_mesh

   !> Puts the loads and supports of a sound deck on its mesh, and checks what that shows.
   subroutine complete_model(deck)
      type(deck_type), intent(inout) :: deck
      integer :: n, s

      call find_bodies(deck%mesh)
      call check_folds(deck)
      call check_touches(deck)
      do s = 1, first_heat(deck) - 1
         if (deck%model%steps(s)%is_transient) exit
         if (deck%model%steps(s)%analysis /= analysis_coupled) cycle
         deck%model%steps(s)%analysis = analysis_static
         call deck%warning(deck%step_place(s), 'step '//to_text(s)//' solves no heat: nothing '// &
            'prescribes a temperature and nothing heats the bodies; give *BOUNDARY with degree '// &
            'of freedom 11, or take *STATIC', heatless)
      end do
      call check_heat_quantities(deck)
      call turn_equations(deck%model)
      deck%model%deck_equations = size(deck%model%equations)
      deck%model%written_levels = deck%levels
      deck%model%written_order = deck%order
      allocate (deck%model%requests)
      deck%model%requests%supports = deck%boundaries
      deck%model%requests%loads = deck%loads
      deck%model%requests%temperatures = deck%temperatures
      call collect_fields(deck%model)
      n = 0
      if (deck%boundaries%count > 0) n = deck%boundaries%items(deck%boundaries%count)%card
      allocate (deck%model%boundary_places(n))
      do n = 1, deck%boundaries%count
         associate (request => deck%boundaries%items(n))
            deck%model%boundary_places(request%card)%value = deck%source%words_of(request%place)
         end associate
      end do
      call apply_requests(deck%model)
      call check_amplitudes(deck)
      call check_starts(deck)
      if (deck%analyses_sound) call check_storage(deck)
      if (deck%analyses_sound) call check_laws(deck)
      if (deck%analyses_sound) call check_continuations(deck)
      if (.not. deck%has_errors()) then
         call check_usage(deck)
         call check_heat_paths(deck)
         call check_friction_heat(deck)
      end if
      call note_defaults(deck)
   end subroutine complete_model

   !> Notes the defaults of what the deck does not say at all.
   subroutine note_defaults(deck)
      type(deck_type), intent(inout) :: deck

      if (deck%temperatures%count == 0) call deck%note('no initial temperature is given: it is 0')
      if (allocated(deck%mesh%initial_stress) .and. .not. &
         any(solves_mechanics(deck%model%steps%analysis))) then
         call deck%note('initial stresses are ignored: no step solves equilibrium')
      end if
      if (.not. any(deck%model%materials%has(of_expansion))) then
         call deck%note('no *EXPANSION: temperatures do not strain the bodies')
      else if (.not. all(deck%model%materials%has(of_expansion))) then
         call deck%note('a material without *EXPANSION: coefficient 0')
      end if
      if (any(deck%model%materials%has(of_specific_heat)) .and. .not. &
         any(deck%model%steps%is_transient .or. deck%model%steps%stability_frequency > 0)) call &
         deck%note('*SPECIFIC HEAT is ignored: no step stores heat')
      if (any(melts(deck%model%materials)) .and. .not. all(deck%model%steps%is_transient)) call &
         deck%note('*LATENT HEAT does nothing in steps that store no heat, such as step '// &
         to_text(findloc(deck%model%steps%is_transient, .false., dim=1)))
      if (.not. any(solves_heat(deck%model%steps%analysis))) return
      if (size(cards_of(deck%cards, 'THERMAL SCHEME')) == 0) then
         if (any(deck%model%steps%is_transient)) call deck%note('no *THERMAL SCHEME: L-STABLE '// &
            'where heat is stored')
         if (any(solves_heat(deck%model%steps%analysis) .and. .not. &
            deck%model%steps%is_transient)) call deck%note('no *THERMAL SCHEME: IMPLICIT')
      end if
      if (size(deck%model%contacts) == 0) return
      if (.not. any(deck%model%steps%analysis == analysis_coupled)) return
      associate (fixed_point => deck%model%steps(1)%fixed_point)
         call deck%note('*FIXED POINT in step 1: METHOD='// &
            trim(method_names(fixed_point%method))//', TOL='//to_text(fixed_point%tolerance)// &
            ', MAXITER='//to_text(fixed_point%max_iterations)//', G='//to_text(fixed_point%g)// &
            ', CONSTANT='//to_text(fixed_point%constant))
      end associate
   end subroutine note_defaults

end module deck_builder
