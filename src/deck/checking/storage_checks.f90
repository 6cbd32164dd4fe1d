!> Checks of steps that store heat: capacities, a start, and what DILATATION needs.
module storage_checks
   use card_places, only: place_type
   use deck_context, only: deck_type
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use materials, only: expansion_heat, follows_temperature, heat_capacity, least_heat_capacity, &
      of_density, of_elasticity, of_expansion, of_specific_heat
   use model, only: model_type
   use steps, only: solves_heat
   use text, only: to_text
   implicit none
   private
   public :: check_storage

contains

   !> Reports what the steps that store heat lack, each thing once, at the first of them.
   subroutine check_storage(deck, model)
      type(deck_type), intent(inout) :: deck   !! receives errors
      type(model_type), intent(in) :: model                !! with its initial temperatures
      logical :: is_used(size(model%materials))
      integer :: first, m

      first = findloc(model%steps%is_transient, .true., dim=1)
      if (first == 0) return
      is_used = [(any(model%sections%material == m), m=1, size(is_used))]
      do m = 1, size(is_used)
         associate (material => model%materials(m))
            if (.not. is_used(m) .or. .not. material%has_specific_heat) cycle
            if (material%has_density) cycle
            call deck%missing(deck%analysis_place(first), 'material '//material%name//' has '// &
               '*SPECIFIC HEAT, but no *DENSITY: its heat capacity is the product of both', &
               '*DENSITY')
            return
         end associate
      end do
      if (.not. any(is_used .and. heat_capacity(model%materials) > 0.0_dp)) call deck%missing( &
         deck%analysis_place(first), 'without STEADY STATE the bodies store heat, but no '// &
         'material of theirs has *SPECIFIC HEAT and *DENSITY; give them, or STEADY STATE', &
         '*SPECIFIC HEAT')
      if (deck%temperatures%count == 0 .and. &
         .not. any(solves_heat(model%steps(:first - 1)%analysis))) call deck%error( &
         deck%analysis_place(first), 'a step that stores heat needs temperatures to start '// &
         'from; give *INITIAL CONDITIONS, TYPE=TEMPERATURE, or a steady step before')
      call check_dilatation(deck, model)
   end subroutine check_storage

   !> DILATATION needs temperatures from absolute zero.
   subroutine check_dilatation(deck, model)
      type(deck_type), intent(inout) :: deck
      type(model_type), intent(in) :: model
      type(place_type) :: place
      integer :: n

      n = findloc(model%steps%dilates, .true., dim=1)
      if (n == 0) return
      place = deck%analysis_place(n)
      if (.not. model%constants%has_absolute_zero) then
         call deck%error(place, 'DILATATION needs absolute temperatures; give *PHYSICAL '// &
            'CONSTANTS, ABSOLUTE ZERO=')
         return
      end if
      if (any(follows_temperature(model%materials(model%sections%material), of_elasticity) .or. &
         follows_temperature(model%materials(model%sections%material), of_expansion))) then
         call deck%error(place, 'DILATATION needs *ELASTIC and *EXPANSION of one row: with '// &
            'tables over temperature the heat of strains is another one')
         return
      end if
      n = minloc(model%initial_temperature, dim=1, mask=model%mesh%node_body > 0)
      if (model%initial_temperature(n) > model%constants%absolute_zero) then
         call check_strained_capacity(place, model, deck)
         return
      end if
      call deck%error(place, 'DILATATION needs temperatures above absolute zero, '// &
         to_text(model%constants%absolute_zero)//', but node '// &
         to_text(model%mesh%node_number(n))//' starts at '//to_text(model%initial_temperature(n)))
   end subroutine check_dilatation

   !> The capacity at constant strain, rho c_p - T0 beta:alpha, must be positive, or heat would make
   !> bodies that cannot expand colder, without limit. What does not expand needs none.
   subroutine check_strained_capacity(place, model, deck)
      type(place_type), intent(in) :: place
      type(model_type), intent(in) :: model
      type(deck_type), intent(inout) :: deck
      real(dp) :: taken(size(model%materials)), here, least, row
      integer :: e, m, n, hottest(size(taken))
      character(:), allocatable :: at_row

      taken = 0.0_dp
      associate (mesh => model%mesh, start => model%initial_temperature, &
         zero => model%constants%absolute_zero)
         do e = 1, size(mesh%element_kind)
            m = model%sections(mesh%element_section(e))%material
            associate (nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
               n = nodes(maxloc(start(nodes), dim=1))
            end associate
            here = (start(n) - zero)*expansion_heat(model%materials(m), mesh%element_plane(e))
            if (here > taken(m)) hottest(m) = n
            taken(m) = max(taken(m), here)
         end do
         do m = 1, size(taken)
            if (taken(m) <= 0.0_dp) cycle
            call least_heat_capacity(model%materials(m), least, row)
            if (least > taken(m)) cycle
            at_row = ''
            if (any([follows_temperature(model%materials(m), of_density), &
               follows_temperature(model%materials(m), of_specific_heat)])) at_row = &
               ' at temperature '//to_text(row)
            call deck%error(place, 'DILATATION: the heat capacity of material '// &
               model%materials(m)%name//' at constant strain, rho c_p - T0 beta:alpha, is '// &
               to_text(least - taken(m))//', not positive: rho c_p is '//to_text(least)//at_row// &
               ', T0 is '//to_text(start(hottest(m)) - zero)//' at node '// &
               to_text(mesh%node_number(hottest(m)))//'; give *DENSITY and *SPECIFIC HEAT '// &
               'whose product is above '//to_text(taken(m))//', in the units of *ELASTIC')
         end do
      end associate
   end subroutine check_strained_capacity

end module storage_checks
