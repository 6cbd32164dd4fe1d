!> Why a number has no bound of its error: all reasons, in the order in which one is told where
!> several hold. Who computes a number says what holds of it; who prints it takes the words.
module no_estimates
   use materials, only: has_law
   use model, only: follows_temperatures, model_type
   implicit none
   private
   public :: first_reason, mark_of, reason_inside_step, reason_of_deck, reason_of_run, remains, &
      words_of_reason

   integer, parameter, public :: no_reason = 0            !! there is a bound, or no value
   ! Of the whole run.
   integer, parameter, public :: of_pre_tension = 1, of_branches = 2, of_stored_heat = 3, &
      of_tables = 4, errors_off = 5
   integer, parameter, public :: inside_step = 6          !! bounds are made at the ends of steps
   integer, parameter, public :: slides_far = 7           !! of all that an interface has
   integer, parameter, public :: out_of_equilibrium = 8   !! of maxima of bodies
   ! Of a peak pressure.
   integer, parameter, public :: at_corner = 9, turns_round = 10, grows = 11
   ! Of the increments.
   integer, parameter, public :: single_increment = 12, not_doubled = 13, no_doubled_edge = 14
   ! Of the mesh.
   integer, parameter, public :: not_on_finer_mesh = 15, no_finer_edge = 16
   integer, parameter, public :: of_history = 17          !! of the whole run, too
   integer, parameter, public :: reason_count = 17

   character(*), parameter :: words(reason_count) = [character(36) :: 'pre-tension', 'branches', &
      'stored heat', 'tables over temperature', 'ERRORS=NO', 'inside a step', &
      'slides beyond its contact points', 'heat out of equilibrium', 'peak at a corner', &
      'friction turns round at the peak', 'peak grows with the mesh', 'single increment', &
      'doubled increments have no solution', 'no such edge with doubled increments', &
      'no solution on a finer mesh', 'no such edge on a finer mesh', 'plasticity and creep']

contains

   !> The reason that is told of those that hold.
   pure integer function first_reason(holds) result(reason)
      logical, intent(in) :: holds(reason_count)

      reason = findloc(holds, .true., dim=1)
   end function first_reason

   !> Why nothing in a deck can have a bound, whatever its options; no_reason for one that can.
   pure integer function reason_of_deck(model) result(reason)
      type(model_type), intent(in) :: model
      logical :: holds(reason_count)

      holds = .false.
      if (allocated(model%couplings)) holds(of_pre_tension) = any(model%couplings%is_section())
      holds(of_branches) = any(model%steps%continuation%is_on)
      holds(of_stored_heat) = any(model%steps%is_transient)
      holds(of_tables) = follows_temperatures(model)
      holds(of_history) = any(has_law(model%materials))
      reason = first_reason(holds)
   end function reason_of_deck

   !> Why nothing in a run has a bound.
   pure integer function reason_of_run(model) result(reason)
      type(model_type), intent(in) :: model

      reason = reason_of_deck(model)
      if (reason == no_reason .and. .not. model%estimates_errors) reason = errors_off
   end function reason_of_run

   !> Why nothing has a bound in an increment that ends no step.
   pure integer function reason_inside_step(model) result(reason)
      type(model_type), intent(in) :: model

      reason = reason_of_run(model)
      if (reason == no_reason) reason = inside_step
   end function reason_inside_step

   !> Whether finer meshes and shorter increments leave a reason as it is.
   elemental logical function remains(reason)
      integer, intent(in) :: reason

      remains = reason > no_reason .and. reason <= grows .or. reason == of_history
   end function remains

   !> A reason in words; nothing for none.
   pure function words_of_reason(reason) result(string)
      integer, intent(in) :: reason
      character(:), allocatable :: string

      string = ''
      if (reason /= no_reason) string = trim(words(reason))
   end function words_of_reason

   !> What stands behind a number in place of its bound.
   pure function mark_of(reason) result(mark)
      integer, intent(in) :: reason          !! not no_reason
      character(:), allocatable :: mark      !! with a blank before it

      mark = ' (no estimate: '//words_of_reason(reason)//')'
   end function mark_of

end module no_estimates
