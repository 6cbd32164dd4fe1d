!> Continuation: the points of a branch of steady solutions over the load factor, through its
!> turning points (branch_turns).
!>
!> A point is found with the load factor as an unknown. It is then an increment like any other, with
!> the load factor given and the conductances of the point as its start.
module branch_steps
   use branch_trials, only: branch_type, is_found, straight
   use branch_turns, only: find_fold, make_step, same, shortest, turns, within
   use errors, only: error_type, set_error, status_no_convergence
   use heat_reduction, only: heat_reduction_type
   use kinds, only: dp
   use loads, only: loads_type
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   use text, only: to_text
   implicit none
   private
   public :: accept_point, find_point, shorten_step

   integer, parameter :: fewest_of_closed = 3     !! points before the first one can be met again
   real(dp), parameter :: aside = 0.1_dp          !! distance over a step that may be none

contains

   !> Finds the next point.
   !> Errors: the branch is lost, friction reverses, status_interrupted.
   subroutine find_point(self, model, bodies, heat, loads, state, error)
      type(branch_type), intent(inout) :: self         !! after the first point of its step
      type(model_type), intent(in), target :: model
      type(reduced_bodies_type), intent(in), target :: bodies
      type(heat_reduction_type), intent(in), target :: heat
      type(loads_type), intent(inout), target :: loads   !! moved along
      type(solution_state_type), intent(in) :: state   !! at the last point
      type(error_type), allocatable, intent(out) :: error

      if (.not. bodies%is_coupled) then
         call set_error(error, status_no_convergence, 'no conductance depends on gap or '// &
            'pressure, so states have no branch to follow; leave out *CONTINUATION')
         return
      end if
      self%model => model
      self%bodies => bodies
      self%heat => heat
      self%loads => loads
      call self%renew(state)
      self%is_last = .false.
      self%is_fold = .false.
      if (.not. self%is_followed) then
         call self%begin(self%base%factor, error)
         if (allocated(error)) return
         self%is_followed = .true.
         self%base = self%point
         self%first = self%point
         self%length = self%asked%longest_step
         self%direction = state%contact%direction
      end if
      self%from = self%base
      call close_branch(self, error)
      do while (.not. (self%is_last .or. allocated(error)))
         self%from = self%base
         self%is_fold = .false.
         call make_step(self, error)
         if (allocated(error)) return
         if (.not. self%is_fold .and. turns(self%from, self%point)) call find_fold(self, error)
         if (.not. allocated(error)) call stay_in_range(self, error)
         if (self%outcome == is_found) exit
         self%length = 0.5_dp*self%tried
      end do
      if (allocated(error)) return
      if (.not. self%is_last .and. self%points + 1 >= &
         self%asked%most_points) then
         self%is_last = .true.
         self%ending = 'it has as many points as POINTS= allows'
      end if
      call check_friction(self, error)
   end subroutine find_point

   !> Slip that reverses depends on the way to a point.
   !> Error: a contact point slips against its slip before.
   subroutine check_friction(self, error)
      type(branch_type), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error
      integer :: k

      k = findloc(self%contact%direction*self%direction < 0, .true., dim=1)
      if (k == 0) return
      call set_error(error, status_no_convergence, 'friction reverses in contact pair '// &
         self%bodies%interfaces(count(self%bodies%points%interface_start <= k))%name// &
         ' at load factor '//to_text(self%point%factor)//', and a solution behind that depends on the way to it; '// &
         'end the branch before, by HIGHEST= or LOWEST= of *CONTINUATION, or leave out friction')
   end subroutine check_friction

   !> Takes the point as the last one of the branch; the first one by its load factor.
   subroutine accept_point(self, factor)
      type(branch_type), intent(inout) :: self
      real(dp), intent(in) :: factor         !! of the point

      self%points = self%points + 1
      if (self%is_followed) then
         self%base = self%point
         where (self%contact%direction /= 0) self%direction = self%contact%direction
         if (.not. self%is_fold) self%length = min(2*self%tried, &
            self%asked%longest_step)
      else
         self%base%factor = factor
      end if
   end subroutine accept_point

   !> A shorter step, where the increment at the point failed, if there is one.
   subroutine shorten_step(self, possible)
      type(branch_type), intent(inout) :: self
      logical, intent(out) :: possible

      self%length = 0.25_dp*min(self%tried, self%length)
      possible = self%length > shortest .and. .not. self%is_last
   end subroutine shorten_step

   !> Ends the branch where it comes back to its first point.
   subroutine close_branch(self, error)
      type(branch_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: along, way(size(self%from%tangent))

      if (self%points < fewest_of_closed) return
      way = self%measure%way(self%from, self%first)
      along = dot_product(way, self%from%tangent)
      if (along <= 0.0_dp .or. along > self%length) return
      if (norm2(way) > 2*along) return
      call self%try_step(along, error)
      if (allocated(error) .or. self%outcome /= is_found) return
      way = self%measure%way(self%point, self%first)
      way = way - dot_product(way, self%first%tangent)*self%first%tangent
      if (norm2(way) > aside*along**2 .or. &
         dot_product(self%point%tangent, self%first%tangent) < straight) return
      self%point = self%first
      self%tried = along
      self%is_last = .true.
      self%ending = 'it comes back to its first point'
   end subroutine close_branch

   !> Ends the branch where the load factor leaves its range.
   subroutine stay_in_range(self, error)
      type(branch_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: bound, reached

      if (self%outcome /= is_found) return
      reached = self%point%factor
      bound = within(self)
      self%is_last = any(abs(reached - self%asked%range) <= same)
      if (abs(reached - bound) > same) then
         self%is_last = .true.
         self%is_fold = .false.
         self%fixed_coordinate = size(self%from%tangent)
         self%point%factor = bound
         call self%try_step(self%tried*(bound - self%from%factor)/ &
            (reached - self%from%factor), error)
         self%fixed_coordinate = 0
         self%is_last = self%outcome == is_found
      end if
      if (self%is_last) self%ending = 'the load factor is '//to_text(bound)
   end subroutine stay_in_range

end module branch_steps
