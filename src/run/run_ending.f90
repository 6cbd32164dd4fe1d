!> A run that ends early: what is prepared for it, and how it is told.
module run_ending
   use command_line, only: command_type
   use deck_outcomes, only: deck_outcome_type
   use errors, only: error_type, set_error, status_deck, status_interrupted, status_no_convergence
   use increments, only: simulation_type
   use interruption, only: caught_signal, run_end_type
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use messages, only: print_error
   use model, only: model_type
   use round_indicators, only: round_indicators_type
   use run_output, only: run_output_type
   use text, only: to_text
   use utf8, only: printable
   implicit none
   private
   public :: run_type, prepare_end, say_when, check_signals, report_failure

   !> The run of a deck, or one round of it. What it points to is the round's: held by value, the
   !> copying and freeing of all of it, which nothing calls, would be most of the code of deck_run.
   type :: run_type
      character(:), allocatable :: path       !! the deck as given
      type(command_type) :: command           !! options of the command line
      type(model_type), pointer :: model => null()
      type(simulation_type), pointer :: simulation => null()
      type(run_output_type), pointer :: output => null()
      type(run_end_type) :: end               !! of an increment that takes too long
      type(round_indicators_type) :: indicators   !! what another round should vary
      real(dp) :: cpu_start = 0.0_dp          !! CPU seconds of the process at its start [s]
   end type run_type

contains

   !> Prepares the end of the run from here on: within an increment that takes too long after a
   !> signal, or where there is no memory left.
   subroutine prepare_end(self, when)
      type(run_type), intent(inout) :: self
      integer, intent(in) :: when   !! one of the end_* constants

      self%end%when = when
      self%end%shows_progress = self%output%progress%is_on_line()
      self%end%deck = printable(self%path)
      self%end%where = where_words(self)
      self%end%listing = self%output%listing_path()
      self%end%working = self%output%working_path()
      self%end%kept = self%output%kept()
      self%end%holds = kept_words(self)
      ! Increments that wait for their publication are lost with the process.
      if (self%output%kept_round == 0 .and. self%output%published() < self%output%accepted()) then
         self%end%holds = '; the results hold those up to number '// &
            to_text(self%output%published())
      end if
      call self%end%prepare()
   end subroutine prepare_end

   !> Puts the increment that was tried before what went wrong.
   subroutine say_when(self, error)
      type(run_type), intent(in) :: self
      type(error_type), intent(inout) :: error   !! receives it in its message
      type(step_clock_type) :: clock

      clock = self%simulation%control%next_instant(self%model)
      error%message = 'increment '//to_text(self%simulation%control%increments + 1)//' (time '// &
         to_text(clock%total_time)//'): '//error%message
   end subroutine say_when

   !> A signal ends the run between two increments.
   !> Error: status_interrupted.
   subroutine check_signals(self, error)
      type(run_type), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error

      if (caught_signal() /= '') call set_error(error, status_interrupted, 'ended by '// &
         caught_signal()//where_words(self))
   end subroutine check_signals

   !> In which later round and behind which increment a run ends.
   function where_words(self) result(words)
      type(run_type), intent(in) :: self
      character(:), allocatable :: words   !! with a blank before them

      words = ''
      if (self%output%kept_round > 0) words = ' in round '//to_text(self%output%kept_round + 1)
      associate (control => self%simulation%control)
         if (control%increments > 0) then
            words = words//' after increment '//to_text(control%increments)//' (time '// &
               to_text(control%step_start + control%step_time)//')'
         else
            words = words//' before the first increment'
         end if
      end associate
   end function where_words

   !> Where a later round ends early: which round the files are of.
   pure function kept_words(self) result(words)
      type(run_type), intent(in) :: self
      character(:), allocatable :: words   !! with a semicolon before them

      words = ''
      associate (kept_round => self%output%kept_round)
         if (kept_round > 0 .and. self%output%published() == 0) words = &
            '; the results are those of round '//to_text(kept_round)
      end associate
   end function kept_words

   !> Prints why a run ended early. That a later round did is no mistake of the deck.
   subroutine report_failure(self, error, outcome, is_told)
      type(run_type), intent(inout) :: self
      type(error_type), intent(inout) :: error           !! in: what went wrong; out: as in outcome
      type(deck_outcome_type), intent(inout) :: outcome  !! receives it
      logical, intent(in) :: is_told                     !! whether the reason is printed already
      character(:), allocatable :: words

      words = error%message
      if (error%status == status_no_convergence) words = words//'; the listing shows the iterations'
      associate (kept_round => self%output%kept_round)
         if (kept_round > 0) then
            if (error%status /= status_interrupted) words = ': '//words
            if (is_told) words = ' cannot begin'
            if (error%status /= status_interrupted) words = 'round '//to_text(kept_round + 1)//words
            words = words//kept_words(self)
            error%message = error%message//kept_words(self)
            if (error%status == status_deck) error%status = status_no_convergence
         end if
         call outcome%fail(error)
         call self%output%progress%clear()
         if (kept_round > 0 .or. .not. is_told) call print_error(self%path, words)
      end associate
   end subroutine report_failure

end module run_ending
