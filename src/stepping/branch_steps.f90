!> Continuation: the points of a branch of steady solutions over the load factor, through its
!> turning points.
!>
!> A point is found with the load factor as an unknown. It is then an increment like any other, with
!> the load factor given and the conductances of the point as its start.
!>
!> A branch has folds, where the load factor turns, and corners, where the tangent turns too far
!> however short a step is. A step is halved where its corrections fail, or the tangent turns too
!> far. Folds and corners are found by bisection; a fold in a corner is where the coordinate of a
!> contact point has the value of the kink that it passes.
module branch_steps
   use branch_path, only: branch_point_type
   use branch_trials, only: branch_type, is_found, is_lost, is_sharp, straight
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
   real(dp), parameter :: corner = 2.0e-8_dp      !! length within which a corner is looked for
   real(dp), parameter :: few = 8.0_dp            !! such lengths from which it is turned
   real(dp), parameter :: shortest = 1.0e-9_dp    !! step that is tried
   integer, parameter :: most_restarts = 40       !! of a step, before a corner
   real(dp), parameter :: fold_width = 1.0e-7_dp  !! part of the load in which a fold is found
   real(dp), parameter :: least_load = 1.0e-2_dp  !! load factor of which that is a part at least
   real(dp), parameter :: same = 1.0e-12_dp       !! difference of load factors that is none

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
      integer :: k

      if (.not. bodies%is_coupled) then
         call set_error(error, status_no_convergence, 'no conductance depends on gap or '// &
            'pressure, so states have no branch to follow; leave out *CONTINUATION')
         return
      end if
      self%model => model
      self%bodies => bodies
      self%heat => heat
      self%loads => loads
      self%before = state
      self%contact = state%contact
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
      if (.not. self%is_last .and. self%points + 1 >= self%asked%most_points) then
         self%is_last = .true.
         self%ending = 'it has as many points as POINTS= allows'
      end if
      ! Slip that reverses depends on the way to a point.
      k = findloc(self%contact%direction*self%direction < 0, .true., dim=1)
      if (k > 0) call set_error(error, status_no_convergence, &
         'friction reverses in contact pair '//bodies%interfaces( &
         bodies%points%interface(k))%name//' at load factor '//to_text( &
         self%point%factor)//', and a solution behind that depends on the way to it; end '// &
         'the branch before, by HIGHEST= or LOWEST= of *CONTINUATION, or leave out friction')
   end subroutine find_point

   !> Takes the point as the last one of the branch; the first one by its load factor.
   subroutine accept_point(self, factor)
      type(branch_type), intent(inout) :: self
      real(dp), intent(in) :: factor         !! of the point

      self%points = self%points + 1
      if (self%is_followed) then
         self%base = self%point
         where (self%contact%direction /= 0) self%direction = self%contact%direction
         if (.not. self%is_fold) self%length = min(2*self%tried, self%asked%longest_step)
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

   !> Whether the load factor turns between two points.
   pure logical function turns(from, to)
      type(branch_point_type), intent(in) :: from, to

      turns = from%tangent(size(from%tangent))*to%tangent(size(to%tangent)) < 0.0_dp
   end function turns

   !> The next point, no farther than the step of arc length. Before a corner the steps go on from
   !> points ever nearer to it: those of a long one end apart where the corner lies between them.
   !> Error: the branch is lost.
   subroutine make_step(self, error)
      type(branch_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      type(branch_point_type) :: behind, low
      real(dp) :: reach
      integer :: i

      self%tried = min(self%length, self%measure%longest(self%from%tangent))
      do i = 1, most_restarts
         call bisect(self, low, error)
         if (allocated(error) .or. self%outcome == is_found) return
         if (self%outcome == is_lost) exit
         behind = self%point
         self%point = low
         self%outcome = is_found
         if (turns(self%from, low) .or. abs(within(self) - low%factor) > same) return
         self%from = low
         reach = reach_of_kink(self)
         if (reach <= few*corner) then
            call turn_corner(self, reach, error)
            return
         else if (reach > self%length) then
            ! No law has a kink there, but a contact point begins to slip, or stops.
            if (.not. self%has_converged) exit
            self%point = behind
            self%tried = corner
            return
         end if
         self%tried = 2*reach
      end do
      call lose(self, error)
   end subroutine make_step

   !> A step of at most the length tried; halved where it is lost. Where the branch turns too far
   !> even in the shortest one, the outcome says so, the point is the one behind the turn.
   subroutine bisect(self, low, error)
      type(branch_type), intent(inout) :: self
      type(branch_point_type), intent(out) :: low   ! the last point before the turn
      type(error_type), allocatable, intent(out) :: error
      type(branch_point_type) :: behind
      real(dp) :: ends(2)             ! longest step that was found, shortest one that was not
      integer :: last                 ! outcome of the latter
      logical :: is_behind            ! whether it led to the branch

      low = self%from
      ends = [0.0_dp, huge(1.0_dp)]
      last = is_lost
      is_behind = .false.
      do
         call self%try_step(self%tried, error)
         if (allocated(error)) return
         if (self%outcome == is_found) then
            if (last == is_lost) return
            if (is_behind) then
               if (dot_product(self%point%tangent, behind%tangent) >= straight) return
            end if
            low = self%point
            ends(1) = self%tried
         else
            last = self%outcome
            is_behind = self%has_converged
            behind = self%point
            ends(2) = self%tried
         end if
         if (ends(2) - ends(1) <= merge(corner, shortest, last == is_sharp)) exit
         self%tried = sum(ends)/2
      end do
      self%outcome = last
      self%has_converged = is_behind
      self%point = behind
      self%tried = ends(1)
   end subroutine bisect

   !> How long a step is that passes a kink; beyond any length where none is near.
   real(dp) function reach_of_kink(self) result(reach)
      type(branch_type), intent(in) :: self

      reach = corner
      do while (reach <= self%length)
         if (self%measure%kinked(self%from, self%measure%moved(self%from, &
            reach*self%from%tangent)) > 0) return
         reach = 2*reach
      end do
   end function reach_of_kink

   !> The load factor of the point, within its range.
   pure real(dp) function within(self)
      type(branch_type), intent(in) :: self

      within = min(max(self%point%factor, self%asked%range(1)), self%asked%range(2))
   end function within

   subroutine lose(self, error)
      type(branch_type), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error

      call set_error(error, status_no_convergence, 'the branch is lost at load factor '// &
         to_text(self%base%factor)//': no step along it converges')
   end subroutine lose

   !> The first point behind a corner, from a point just before it; the corner itself, where the
   !> load factor turns there. The way round it leads over a point where the coordinate that passes
   !> the kink is held: from a guess in which all that pass one at once have done so, lest they part
   !> into a pattern.
   !> Error: the branch is lost.
   subroutine turn_corner(self, reach, error)
      type(branch_type), intent(inout) :: self
      real(dp), intent(in) :: reach         ! of the kink
      type(error_type), allocatable, intent(out) :: error
      type(branch_point_type) :: behind

      self%point = self%measure%moved(self%from, 2*reach*self%from%tangent)
      self%fixed_coordinate = self%measure%kinked(self%from, self%point)
      call self%try_step(2*reach, error)
      self%fixed_coordinate = 0
      if (allocated(error)) return
      self%tried = self%length
      if (self%has_converged) then
         self%is_fold = turns(self%from, self%point)
         if (self%is_fold) then
            ! The branch goes on from the corner as behind it.
            behind = self%point
            self%fixed_coordinate = self%measure%kinked(self%from, behind)
            self%point = self%measure%at_kink(self%from, behind)
            call self%try_step(0.0_dp, error)
            self%fixed_coordinate = 0
            self%outcome = merge(is_found, is_lost, self%has_converged)
            self%point%tangent = behind%tangent
            self%from = self%base
            if (allocated(error) .or. self%outcome == is_found) return
         else
            self%from = self%point
            do while (self%tried > shortest)
               self%tried = 0.5_dp*self%tried
               call self%try_step(self%tried, error)
               if (allocated(error) .or. self%outcome == is_found) return
            end do
         end if
      end if
      call lose(self, error)
   end subroutine turn_corner

   !> The fold between the start of the last step and its end; where the coordinate of a contact
   !> point passes a kink there, it is a corner.
   subroutine find_fold(self, error)
      type(branch_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      type(branch_point_type) :: low, behind
      real(dp) :: ends(2), rates(2), reach
      integer :: n

      n = size(self%from%tangent)
      low = self%from
      behind = self%point
      ends = [0.0_dp, self%tried]
      rates = abs([self%from%tangent(n), behind%tangent(n)])
      do while (sum(rates)*(ends(2) - ends(1)) > fold_width*max(abs(behind%factor), least_load) &
         .and. ends(2) - ends(1) > shortest)
         call self%try_step(sum(ends)/2, error)
         if (allocated(error) .or. self%outcome /= is_found) return
         if (turns(self%from, self%point)) then
            behind = self%point
            ends(2) = sum(ends)/2
            rates(2) = abs(behind%tangent(n))
         else
            low = self%point
            ends(1) = sum(ends)/2
            rates(1) = abs(low%tangent(n))
         end if
      end do
      self%outcome = is_lost
      if (self%measure%kinked(low, behind) > 0) then
         self%from = low
         reach = reach_of_kink(self)
         if (reach <= self%length) call turn_corner(self, reach, error)
      else
         self%point = behind
         self%outcome = is_found
         self%is_fold = .true.
      end if
   end subroutine find_fold

end module branch_steps
