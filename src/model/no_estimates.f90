!> Why a number has no uncertainty: all reasons, in the order in which one is told where several
!> hold. Who computes a number says what holds of it; who prints it takes the words.
module no_estimates
   use materials, only: has_law
   use model, only: follows_temperatures, model_type, uncertainty_full, uncertainty_last, &
      uncertainty_no
   implicit none
   private
   public :: first_reason, mark_of, reason_inside_step, reason_of_run, reason_without_check, &
      remains, words_of_reason

   integer, parameter, public :: no_reason = 0            !! there is one, or no value
   ! Of the whole run.
   integer, parameter, public :: of_branches = 1, errors_off = 2
   integer, parameter, public :: slides_far = 3           !! of all that an interface has
   integer, parameter, public :: not_unique = 4           !! two states satisfy all conditions
   ! Of a peak pressure.
   integer, parameter, public :: at_corner = 5, grows = 6
   ! What a finer run of the last increment alone does not tell.
   integer, parameter, public :: of_path = 7, of_step = 8
   ! Of the finer mesh.
   integer, parameter, public :: not_on_finer_mesh = 9, no_finer_value = 10
   integer, parameter, public :: of_sliding = 11   !! of contact points that follow sliding: of_path
   integer, parameter, public :: of_points = 12    !! single nodes or points, not on both meshes
   integer, parameter, public :: of_axis = 13      !! of a peak pressure there on linear elements
   integer, parameter, public :: interrupted = 14  !! by a signal, before the finer mesh was solved
   integer, parameter, public :: reason_count = 14
   ! Of what checks alone compare, and only with ERRORS=FULL; in no file.
   integer, parameter :: of_full_checks = 15, of_checks = 16

   character(*), parameter :: words(of_checks) = [character(32) :: 'branches', 'ERRORS=NO', &
      'slides beyond its contact points', 'not unique', 'at a corner', &
      'peak grows with the mesh', 'path; ERRORS=FULL', 'needs ERRORS=FULL', &
      'no solution on a finer mesh', 'not there on a finer mesh', 'SLIDING=FINITE; ERRORS=FULL', &
      'single points', 'axis', 'interrupted', '*VERIFY; ERRORS=FULL', 'only for *VERIFY']

contains

   !> The reason that is told of those that hold.
   pure integer function first_reason(holds) result(reason)
      logical, intent(in) :: holds(reason_count)

      reason = findloc(holds, .true., dim=1)
   end function first_reason

   !> Why nothing in a run has an uncertainty. Where heat is stored, materials remember, faces
   !> wear, properties follow temperatures or bolts are tightened, errors of the mesh build up along
   !> the path.
   pure integer function reason_of_run(model) result(reason)
      type(model_type), intent(in) :: model
      logical :: follows_path, holds(reason_count)

      follows_path = any(model%steps%is_transient) .or. follows_temperatures(model) .or. &
         any(has_law(model%materials)) .or. any(model%interactions%wear%wears())
      if (allocated(model%couplings)) follows_path = follows_path .or. &
         any(model%couplings%is_section())
      holds = .false.
      holds(of_branches) = any(model%steps%continuation%is_on)
      holds(errors_off) = model%uncertainty == uncertainty_no
      holds(of_sliding) = model%uncertainty == uncertainty_last .and. &
         any(model%contacts%follows_sliding)
      holds(of_path) = model%uncertainty == uncertainty_last .and. follows_path
      reason = first_reason(holds)
   end function reason_of_run

   !> Why nothing has an uncertainty in an increment that ends no step.
   pure integer function reason_inside_step(model) result(reason)
      type(model_type), intent(in) :: model

      reason = reason_of_run(model)
      if (reason == no_reason .and. model%uncertainty /= uncertainty_full) reason = of_step
   end function reason_inside_step

   !> Why what checks alone compare has no uncertainty outside of them.
   pure integer function reason_without_check(model) result(reason)
      type(model_type), intent(in) :: model

      reason = merge(of_checks, of_full_checks, model%uncertainty == uncertainty_full)
      if (model%uncertainty == uncertainty_no) reason = errors_off
   end function reason_without_check

   !> Whether finer meshes and shorter increments leave a reason as it is.
   elemental logical function remains(reason)
      integer, intent(in) :: reason

      remains = reason > no_reason .and. reason <= grows
   end function remains

   !> A reason in words; nothing for none.
   pure function words_of_reason(reason) result(string)
      integer, intent(in) :: reason
      character(:), allocatable :: string

      string = ''
      if (reason /= no_reason) string = trim(words(reason))
   end function words_of_reason

   !> What stands behind a number in place of its uncertainty.
   pure function mark_of(reason) result(mark)
      integer, intent(in) :: reason          !! not no_reason
      character(:), allocatable :: mark      !! with a blank before it

      mark = ' (no estimate: '//words_of_reason(reason)//')'
   end function mark_of

end module no_estimates
