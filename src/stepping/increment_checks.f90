!> Checks that a solved increment must pass before it is accepted, and what it is warned of:
!> choices that the loads leave open; temperatures that jump where a step that stores heat begins,
!> on a mesh that is too coarse for its increments. Beside these temperatures overshoot until the
!> heat has crossed an element.
module increment_checks
   use contact_system, only: contact_open
   use contact_workspace, only: contact_workspace_type
   use element_kinds, only: element_node_count
   use errors, only: check_finite, error_type, set_error, status_no_convergence
   use kinds, only: dp
   use materials, only: heat_capacity
   use model, only: model_type
   use records, only: increment_record_type
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, solves_mechanics
   use text, only: counted, to_text
   use unconstrained_bodies, only: unconstrained_now, undetermined_now
   implicit none
   private
   public :: check_balance, check_heat, check_record, check_values
   public :: note_shock, warn_of_choices

   real(dp), parameter :: sound_violation = 1.0e-6_dp !! largest violation of a sound state
   real(dp), parameter :: sound_imbalance = 1.0e-6_dp !! of heat and forces in discrete equations
   real(dp), parameter :: shock = 0.01_dp   !! part of the range of temperatures that is a jump
   real(dp), parameter :: crossing = 4.0_dp !! least useful increment: rho c h^2/(4 k)

contains

   !> The values of an increment are numbers, its rates and forces balance, and contact keeps its
   !> conditions.
   !> Error: status_no_convergence, they do not.
   subroutine check_record(record, analysis, error)
      type(increment_record_type), intent(in) :: record
      integer, intent(in) :: analysis      !! one of the analysis_* constants of steps
      type(error_type), allocatable, intent(out) :: error

      call check_values(record, error)
      if (allocated(error)) return
      if (solves_heat(analysis)) call check_balance(record%heat_imbalance, 'heat rates', error)
      if (allocated(error) .or. .not. solves_mechanics(analysis)) return
      call check_balance(record%force_imbalance, 'forces', error)
      if (allocated(error) .or. record%contact_violation <= sound_violation) return
      call set_error(error, status_no_convergence, &
         'the recovered displacements violate the contact conditions by '// &
         to_text(record%contact_violation)//' of the largest displacement or force')
   end subroutine check_record

   !> The heat rates, or the forces, of the discrete equations balance.
   !> Error: they do not.
   subroutine check_balance(imbalance, what, error)
      real(dp), intent(in) :: imbalance    !! relative to the largest rate or force
      character(*), intent(in) :: what     !! 'heat rates' or 'forces'
      type(error_type), allocatable, intent(out) :: error

      if (imbalance <= sound_imbalance) return
      call set_error(error, status_no_convergence, 'the '//what//' are out of balance by '// &
         to_text(imbalance)//' of the largest: their rounding outweighs them; look for '// &
         'properties, sizes or values that are many orders of magnitude apart')
   end subroutine check_balance

   !> The fields and the contact state of an increment are numbers.
   !> Error: status_no_convergence, something overflowed.
   subroutine check_values(record, error)
      type(increment_record_type), intent(in) :: record
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      associate (fields => record%fields)
         call judge('temperatures', fields%temperature)
         call judge('heat fluxes', table=fields%heat_flux)
         if (allocated(fields%reaction_heat)) call judge('heat fluxes', [record%heat_imbalance])
         call judge('displacements and stresses', table=fields%stress)
         call judge('displacements and stresses', table=fields%displacement)
         call judge('displacements and stresses', table=fields%reaction)
      end associate
      do i = 1, size(record%contacts)
         associate (contact => record%contacts(i))
            call judge('gaps and pressures', [contact%gap, contact%pressure, contact%shear, &
               contact%slip])
         end associate
      end do
   contains
      !> Judges a list or a table; one that is not allocated is absent.
      subroutine judge(what, list, table)
         character(*), intent(in) :: what
         real(dp), intent(in), optional :: list(:), table(:, :)

         if (allocated(error)) return
         if (present(list)) call check_finite(list, what, status_no_convergence, error)
         if (present(table)) call check_finite([table], what, status_no_convergence, error)
      end subroutine judge
   end subroutine check_values

   !> Names the bodies whose temperature the conductances of an increment leave undetermined, in
   !> place of whatever error followed from it.
   !> Error: there are such bodies.
   subroutine check_heat(run, model, carries, error)
      type(simulation_type), intent(in) :: run                    !! with loads of the increment
      type(model_type), intent(in) :: model
      logical, intent(in) :: carries(:)                           !! (m) whether heat can cross
      type(error_type), allocatable, intent(inout) :: error
      character(:), allocatable :: words

      words = undetermined_now(model, run%bodies%points, run%loads%temperature%active, &
         run%control%step, carries)
      if (len(words) == 0) return
      if (allocated(error)) deallocate (error)
      call set_error(error, status_no_convergence, words)
   end subroutine check_heat

   !> Warns of what the loads leave open, once for as long as it stays: motions that nothing drives
   !> and nothing holds, contact states of which friction allows several.
   subroutine warn_of_choices(run, model, contact, next, undecided, record)
      type(simulation_type), intent(in) :: run                  !! with supports of the increment
      type(model_type), intent(in) :: model
      type(contact_workspace_type), intent(in) :: contact       !! of the solution
      type(solution_state_type), intent(in) :: next             !! state at its end
      character(:), allocatable, intent(inout) :: undecided     !! what was last warned of
      type(increment_record_type), intent(inout) :: record      !! receives the warning
      character(:), allocatable :: free, words

      words = ''
      if (contact%several) words = &
         'with so much friction other contact states satisfy all conditions, too'
      if (size(contact%unconstrained, 2) > 0 .or. any(next%idle)) then
         free = unconstrained_now(model, run%bodies%points, &
            run%bodies%laws%friction%coefficient > 0.0_dp, run%loads%displacement%active, &
            merge(contact_open, next%contact%contact_state, next%idle .or. next%resting))
         if (len(free) > 0) words = &
            free(3:)//'; no load drives it: the smallest movement is used'
      end if
      if (words /= undecided .and. len(words) > 0) call record%warn(words)
      undecided = words
   end subroutine warn_of_choices

   !> Notes the least increment that does not overshoot beside nodes whose temperature jumps, in the
   !> smallest elements there, and warns of nodes where elements need a longer one. Elements without
   !> midside nodes have lumped capacities and do not overshoot.
   pure subroutine note_shock(model, jump, increment_size, record)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: jump(:)              !! (nodes) of temperatures [temperature]
      real(dp), intent(in) :: increment_size       !! of the first increment [time]
      type(increment_record_type), intent(inout) :: record   !! of it; receives both
      logical :: jumps(size(jump)), is_coarse(size(jump))
      real(dp) :: least, largest, size_across
      integer :: e, i

      associate (temperature => record%fields%temperature, used => model%mesh%node_body > 0)
         jumps = abs(jump) > shock*max(maxval(abs(jump)), maxval(temperature, mask=used) - &
            minval(temperature, mask=used))
      end associate
      is_coarse = .false.
      largest = 0.0_dp
      do e = 1, size(model%mesh%element_kind)
         associate (nodes => model%mesh%element_nodes(:element_node_count( &
            model%mesh%element_kind(e)), e), x => model%mesh%coordinates, material => &
            model%materials(model%sections(model%mesh%element_section(e))%material))
            if (size(nodes) <= 4 .or. .not. any(jumps(nodes)) .or. all(jumps(nodes))) cycle
            size_across = maxval([(minval(norm2(x(:, nodes) - spread(x(:, nodes(i)), 2, &
               size(nodes)), dim=1), mask=jumps(nodes)), i=1, size(nodes))])
            least = heat_capacity(material)*size_across**2/(crossing*maxval(material%conductivity))
            if (record%useful_increment <= 0.0_dp) record%useful_increment = least
            record%useful_increment = min(record%useful_increment, least)
            if (increment_size >= least) cycle
            is_coarse(nodes) = is_coarse(nodes) .or. jumps(nodes)
            largest = max(largest, least)
         end associate
      end do
      if (.not. any(is_coarse)) return
      call record%warn('temperatures jump at '//counted(count(is_coarse), 'node')//', such as '// &
         to_text(model%mesh%node_number(findloc(is_coarse, .true., dim=1)))//', where elements '// &
         'are so large that temperatures beside them overshoot within '//to_text(largest)// &
         '; refine the mesh there, or take increments of at least this')
   end subroutine note_shock

end module increment_checks
