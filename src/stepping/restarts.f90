!> The whole of a run that changes, kept in a table, and a run that goes on from there.
!>
!> Operators, factors and the order of their unknowns follow from the deck: a run that goes on
!> enters all steps up to its own and reduces their bodies as the first one did. Loads that were
!> solved earlier change last digits, so both runs forget them where a restart is written.
module restarts
   use due_output, only: is_nth
   use errors, only: error_type
   use kinds, only: dp
   use load_histories, only: end_of_step
   use model, only: model_type
   use records, only: increment_record_type
   use simulation, only: simulation_type
   use solution_state, only: exchange_state
   use state_tables, only: integers, logicals, reals, state_table_type, words
   use steps, only: solves_heat
   implicit none
   private
   public :: keep_restart, bring_to, exchange_run

contains

   !> Keeps a run at the end of an increment, where a restart is due.
   subroutine keep_restart(model, simulation, record)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(inout) :: simulation     !! the run, which forgets solved loads
      type(increment_record_type), intent(inout) :: record   !! receives the table

      if (.not. is_nth(model%steps(record%step)%restart_frequency, record)) return
      allocate (record%restart)
      call record%restart%begin()
      call exchange_run(simulation, record%restart)
   end subroutine keep_restart

   !> Brings a run to where its arrays in a table were kept.
   !> Errors: as simulation_type's take_back.
   subroutine bring_to(model, simulation, table, error)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(inout) :: simulation     !! a fresh run, started
      type(state_table_type), intent(inout) :: table         !! which is restoring
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: step(:)

      call integers(table, 'step', step)
      do
         call simulation%reduce(model, error)
         if (allocated(error) .or. simulation%control%step == step(1)) exit
         call simulation%loads%move_to(end_of_step(model%steps, simulation%control%step), model)
         call simulation%enter_step(model)
      end do
      if (allocated(error)) return
      call exchange_run(simulation, table)
      associate (loads => simulation%loads, state => simulation%state, &
         control => simulation%control)
         call loads%move_to(control%instant_at(model, control%step_time), model)
         if (any(solves_heat(model%steps%analysis))) then
            state%sources%load = loads%heat_load()
            state%sources%film = loads%film_matrix()
         end if
         state%force_load = loads%nodal_forces()
      end associate
      call simulation%take_back(model, error)
   end subroutine bring_to

   !> All of a run, in either direction; it forgets the loads that it has solved.
   subroutine exchange_run(simulation, table)
      type(simulation_type), intent(inout) :: simulation     !! in the step of the table
      type(state_table_type), intent(inout) :: table
      integer, allocatable :: step(:)
      real(dp), allocatable :: told(:)

      step = [simulation%control%step]
      told = [simulation%pivot_told, simulation%runaway_time]
      call integers(table, 'step', step)
      call simulation%control%exchange(table)
      call simulation%loads%exchange(table)
      call exchange_state(table, simulation%state)
      call exchange_cycle(simulation, table)
      call words(table, 'undecided', simulation%undecided)
      call logicals(table, 'is_beyond', simulation%is_beyond)
      call logicals(table, 'sliding_told', simulation%sliding_told)
      call words(table, 'runaway', simulation%runaway)
      call reals(table, 'told', told)
      simulation%pivot_told = told(1)
      simulation%runaway_time = told(2)
      if (allocated(simulation%known)) deallocate (simulation%known)
   end subroutine exchange_run

   !> What the next cycle is compared with, and where its first step began: steps of cycles may have
   !> been left out.
   subroutine exchange_cycle(simulation, table)
      type(simulation_type), intent(inout) :: simulation
      type(state_table_type), intent(inout) :: table
      real(dp), allocatable :: start(:), displacement(:), force(:), history(:)

      if (allocated(simulation%cycle_before)) then
         displacement = simulation%cycle_before%displacement
         force = simulation%cycle_before%contact%force
         if (allocated(simulation%cycle_before%history)) history = simulation%cycle_before%history
      end if
      start = [simulation%control%step_start]
      call reals(table, 'step_start', start)
      call reals(table, 'cycle_displacement', displacement)
      call reals(table, 'cycle_force', force)
      call reals(table, 'cycle_history', history)
      simulation%control%step_start = start(1)
      if (.not. (table%restores .and. allocated(displacement))) return
      simulation%cycle_before = simulation%state
      simulation%cycle_before%displacement = displacement
      simulation%cycle_before%contact%force = force
      if (allocated(history)) simulation%cycle_before%history = history
   end subroutine exchange_cycle

end module restarts
