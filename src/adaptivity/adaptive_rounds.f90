!> The rounds of a requested accuracy: each solves a variation of the deck and bounds its errors;
!> the next one divides elements and shortens increments where these are too large. A run without a
!> request is one round, and so is a row of a trade-off study.
module adaptive_rounds
   use accuracy_rounds, only: accuracy_rounds_type
   use error_estimator, only: error_estimator_type
   use errors, only: error_type
   use increments, only: simulation_type
   use kinds, only: dp
   use model, only: model_type
   use records, only: increment_record_type
   use round_indicators, only: round_indicators_type
   use variations, only: variation_type
   implicit none
   private
   public :: adaptive_rounds_type, increment_taker_type, round_solver_type

   !> The rounds so far, and the variation of the present one.
   type :: adaptive_rounds_type
      type(accuracy_rounds_type) :: accuracy            !! their findings
      type(variation_type), allocatable :: variation    !! of the deck; unallocated: none
      real(dp), private :: cpu_start = 0.0_dp           !! CPU seconds of the process before it [s]
   contains
      procedure :: solve
      procedure :: solve_increments
   end type adaptive_rounds_type

   !> Receives the increments of a round.
   type, abstract :: increment_taker_type
   contains
      procedure(take_increment), deferred :: take
   end type increment_taker_type

   !> Solves a round, with `solve_increments`.
   type, abstract, extends(increment_taker_type) :: round_solver_type
   contains
      procedure(solve_round), deferred :: solve_round
   end type round_solver_type

   abstract interface
      !> Takes an increment, with the bounds of its errors where a step ends.
      subroutine take_increment(self, simulation, record, error)
         import :: error_type, increment_record_type, increment_taker_type, simulation_type
         class(increment_taker_type), intent(inout) :: self
         type(simulation_type), intent(in) :: simulation           !! the run at its end
         type(increment_record_type), intent(inout) :: record      !! of a failed one its passes
         !> In: why the increment failed; out: why none follows
         type(error_type), allocatable, intent(inout) :: error
      end subroutine take_increment

      !> Solves the variation of the rounds; may find that no other round can follow.
      subroutine solve_round(self, rounds)
         import :: adaptive_rounds_type, round_solver_type
         class(round_solver_type), intent(inout) :: self
         type(adaptive_rounds_type), intent(inout) :: rounds
      end subroutine solve_round
   end interface

contains

   !> Solves round after round, until all targets are met or nothing more can be done.
   subroutine solve(self, solver)
      class(adaptive_rounds_type), intent(inout) :: self
      class(round_solver_type), intent(inout) :: solver

      do
         call cpu_time(self%cpu_start)
         self%accuracy%goes_on = .false.
         call solver%solve_round(self)
         if (.not. self%accuracy%goes_on) return
      end do
   end subroutine solve

   !> Solves the increments of a round and judges it.
   !> Errors: as simulation_type's advance, and those of the taker.
   subroutine solve_increments(self, model, simulation, taker, record, error)
      class(adaptive_rounds_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(inout) :: simulation      !! a fresh run, reduced
      class(increment_taker_type), intent(inout) :: taker
      type(increment_record_type), intent(out) :: record      !! the last
      !> In: allocated where not even the first can be solved
      type(error_type), allocatable, intent(inout) :: error
      type(error_estimator_type) :: estimator
      type(round_indicators_type) :: indicators

      call estimator%start(model, simulation)
      call self%accuracy%begin_round(model%accuracy, size(model%contacts), size(model%steps))
      call indicators%start(model)
      do while (.not. (allocated(error) .or. simulation%finished(model)))
         call estimator%begin_increment(simulation)
         call simulation%advance(model, record, error)
         if (.not. allocated(error)) then
            call estimator%end_increment(model, simulation, record, self%accuracy%histories)
            call self%accuracy%follow(simulation%bodies%interfaces, record)
            if (self%accuracy%is_on .and. record%last_of_step) call indicators%take(model, &
               simulation%bodies%interfaces, self%accuracy, record)
         end if
         call taker%take(simulation, record, error)
      end do
      call estimator%release()
      if (.not. self%accuracy%is_on) return
      if (allocated(error)) then
         call self%accuracy%drop_round()
      else
         call end_round(self, model, simulation, indicators)
      end if
   end subroutine solve_increments

   !> Adds up what a round cost, and plans the next one where one follows.
   subroutine end_round(self, model, simulation, indicators)
      type(adaptive_rounds_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(round_indicators_type), intent(in) :: indicators
      real(dp) :: now

      call cpu_time(now)
      associate (round => self%accuracy%rounds(size(self%accuracy%rounds)), &
         sizes => simulation%sizes)
         round%unknowns = sizes%equations_thermal + sizes%equations_mechanical + &
            sizes%contact_unknowns
         round%elements = size(model%mesh%element_kind)
         round%cpu_seconds = now - self%cpu_start
      end associate
      call self%accuracy%conclude(model%accuracy%rounds, indicators%asks_for_nothing())
      if (.not. self%accuracy%goes_on) return
      if (.not. allocated(self%variation)) allocate (self%variation)
      call indicators%add_to(self%variation)
   end subroutine end_round

end module adaptive_rounds
