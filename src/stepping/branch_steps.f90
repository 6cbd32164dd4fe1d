!> Continuation: the points of a branch of steady solutions over the load factor, through its
!> turning points. A step is halved where its corrections fail, or the tangent turns too far. A
!> corner, where it does however short a step is, is found by bisection, and so is a fold, where the
!> load factor turns.
!>
!> A point is found with the load factor as an unknown. It is then an increment like any other, with
!> the load factor given and the conductances of the point as its start.
module branch_steps
   use branch_path, only: branch_point_type
   use branch_trials, only: branch_trial_type, is_found, is_lost, is_sharp, straight
   use errors, only: error_type, set_error, status_no_convergence
   use heat_reduction, only: heat_reduction_type
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use loads, only: loads_type
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   use text, only: to_text
   implicit none
   private
   public :: branch_type

   integer, parameter :: fewest_of_closed = 3     !! points before the first one can be met again
   real(dp), parameter :: corner = 2.0e-8_dp      !! length within which a corner is found
   real(dp), parameter :: few = 8.0_dp            !! such lengths from which it is turned
   real(dp), parameter :: shortest = 1.0e-9_dp    !! step that is tried
   integer, parameter :: most_restarts = 40       !! of a step, before a corner
   real(dp), parameter :: fold_width = 1.0e-7_dp  !! part of the load in which a fold is found
   real(dp), parameter :: least_load = 1.0e-2_dp  !! load factor of which that is a part at least
   real(dp), parameter :: aside = 0.1_dp          !! distance over a step that may be none
   real(dp), parameter :: same = 1.0e-12_dp       !! difference of load factors that is none

   !> The branch of a step.
   type, extends(branch_trial_type) :: branch_type
      logical :: is_followed = .false.    !! whether points are found by arc length
      logical :: is_fold = .false.        !! whether the load factor turns at the point
      logical :: is_last = .false.        !! whether the branch ends there
      character(:), allocatable :: ending !! why
      integer :: points = 0               !! so far
      real(dp), private :: length = 0.0_dp   !! of the next step
      real(dp), private :: tried = 0.0_dp    !! of the one that led to the point
      type(branch_point_type), private :: first, base   !! first and last point
      integer, allocatable, private :: direction(:)     !! (m) of slip, 0 where there was none
   contains
      procedure :: begin_step
      procedure :: find_point
      procedure :: shorten
      procedure :: accept
   end type branch_type

contains

   !> Begins a step of which a branch is followed.
   subroutine begin_step(self, step, start)
      class(branch_type), intent(out) :: self          !! a new branch
      integer, intent(in) :: step                      !! number of the step
      type(step_clock_type), intent(in) :: start       !! its start

      self%step = step
      self%start = start
   end subroutine begin_step

   !> Finds the next point.
   !> Errors: the branch is lost, friction reverses, status_interrupted.
   subroutine find_point(self, model, bodies, heat, loads, state, error)
      class(branch_type), intent(inout) :: self        !! after the first point of its step
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(inout) :: loads         !! moved along
      type(solution_state_type), intent(in) :: state   !! at the last point
      type(error_type), allocatable, intent(out) :: error

      if (.not. bodies%is_coupled) then
         call set_error(error, status_no_convergence, 'no conductance depends on gap or '// &
            'pressure, so states have no branch to follow; leave out *CONTINUATION')
         return
      end if
      call self%renew(state)
      self%is_last = .false.
      self%is_fold = .false.
      if (.not. self%is_followed) then
         call self%begin(model, bodies, heat, loads, self%base%factor, error)
         if (allocated(error)) return
         self%is_followed = .true.
         self%base = self%point
         self%first = self%point
         self%length = model%steps(self%step)%continuation%longest_step
         self%direction = state%contact%direction
      end if
      self%from = self%base
      call close_branch(self, model, bodies, heat, loads, error)
      do while (.not. (self%is_last .or. allocated(error)))
         self%from = self%base
         self%is_fold = .false.
         call make_step(self, model, bodies, heat, loads, error)
         if (allocated(error)) return
         if (.not. self%is_fold .and. turns(self%from, self%point)) call find_fold(self, model, &
            bodies, heat, loads, error)
         if (.not. allocated(error)) call stay_in_range(self, model, bodies, heat, loads, error)
         if (self%outcome == is_found) exit
         self%length = 0.5_dp*self%tried
      end do
      if (allocated(error)) return
      if (.not. self%is_last .and. self%points + 1 >= &
         model%steps(self%step)%continuation%most_points) then
         self%is_last = .true.
         self%ending = 'it has as many points as POINTS= allows'
      end if
      call check_friction(self, bodies, error)
   end subroutine find_point

   !> Whether the load factor turns between two points.
   pure logical function turns(from, to)
      type(branch_point_type), intent(in) :: from, to

      turns = from%tangent(size(from%tangent))*to%tangent(size(to%tangent)) < 0.0_dp
   end function turns

   !> Slip that reverses depends on the way to a point.
   !> Error: a contact point slips against its slip before.
   subroutine check_friction(self, bodies, error)
      type(branch_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(error_type), allocatable, intent(out) :: error
      integer :: k

      k = findloc(self%contact%direction*self%direction < 0, .true., dim=1)
      if (k == 0) return
      call set_error(error, status_no_convergence, 'friction reverses in contact pair '// &
         bodies%interfaces(count(bodies%points%interface_start <= k))%name//' at load factor '// &
         to_text(self%point%factor)//', and a solution behind that depends on the way to it; '// &
         'end the branch before, by HIGHEST= or LOWEST= of *CONTINUATION, or leave out friction')
   end subroutine check_friction

   !> Takes the point as the last one of the branch; the first one by its load factor.
   subroutine accept(self, model, factor)
      class(branch_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: factor         !! of the point

      self%points = self%points + 1
      if (self%is_followed) then
         self%base = self%point
         where (self%contact%direction /= 0) self%direction = self%contact%direction
         if (.not. self%is_fold) self%length = min(2*self%tried, &
            model%steps(self%step)%continuation%longest_step)
      else
         self%base%factor = factor
      end if
   end subroutine accept

   !> A shorter step, where the increment at the point failed, if there is one.
   subroutine shorten(self, possible)
      class(branch_type), intent(inout) :: self
      logical, intent(out) :: possible

      self%length = 0.25_dp*min(self%tried, self%length)
      possible = self%length > shortest .and. .not. self%is_last
   end subroutine shorten

   !> Ends the branch where it comes back to its first point.
   subroutine close_branch(self, model, bodies, heat, loads, error)
      type(branch_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(inout) :: loads
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: along, way(size(self%from%tangent))

      if (self%points < fewest_of_closed) return
      way = self%measure%way(self%from, self%first)
      along = dot_product(way, self%from%tangent)
      if (along <= 0.0_dp .or. along > self%length) return
      if (norm2(way) > 2*along) return
      call self%try_step(model, bodies, heat, loads, along, error)
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

   !> The next point, no farther than the step of arc length. Before a corner the steps go on from
   !> points ever nearer to it: those of a long one end apart where the corner lies between them.
   !> Error: the branch is lost.
   subroutine make_step(self, model, bodies, heat, loads, error)
      type(branch_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(inout) :: loads
      type(error_type), allocatable, intent(out) :: error
      type(branch_point_type) :: behind, low
      real(dp) :: reach
      integer :: i

      self%tried = min(self%length, self%measure%longest(self%from%tangent))
      do i = 1, most_restarts
         call bisect(self, model, bodies, heat, loads, low, error)
         if (allocated(error) .or. self%outcome == is_found) return
         if (self%outcome == is_lost) exit
         behind = self%point
         self%point = low
         self%outcome = is_found
         if (turns(self%from, low) .or. abs(within(self, model) - low%factor) > same) return
         self%from = low
         reach = reach_of_kink(self)
         if (reach <= few*corner) then
            call turn_corner(self, model, bodies, heat, loads, reach, error)
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
   subroutine bisect(self, model, bodies, heat, loads, low, error)
      type(branch_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(inout) :: loads
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
         call self%try_step(model, bodies, heat, loads, self%tried, error)
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
   pure real(dp) function within(self, model)
      type(branch_type), intent(in) :: self
      type(model_type), intent(in) :: model

      associate (range => model%steps(self%step)%continuation%range)
         within = min(max(self%point%factor, range(1)), range(2))
      end associate
   end function within

   subroutine lose(self, error)
      type(branch_type), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error

      call set_error(error, status_no_convergence, 'the branch is lost at load factor '// &
         to_text(self%base%factor)//': no step along it converges')
   end subroutine lose

   !> The first point behind a corner, from a point just before it; the corner itself, where the
   !> load factor turns there. The way round it leads over a point where the coordinate that passes
   !> the kink is held.
   !> Error: the branch is lost.
   subroutine turn_corner(self, model, bodies, heat, loads, reach, error)
      type(branch_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(inout) :: loads
      real(dp), intent(in) :: reach         ! of the kink
      type(error_type), allocatable, intent(out) :: error

      self%held = self%measure%kinked(self%from, self%measure%moved(self%from, &
         reach*self%from%tangent))
      call self%try_step(model, bodies, heat, loads, 2*reach, error)
      self%held = 0
      if (allocated(error)) return
      self%tried = self%length
      if (self%has_converged) then
         self%is_fold = turns(self%from, self%point)
         self%from = self%point
         if (self%is_fold) self%from = self%base
         self%outcome = is_found
         if (self%is_fold) return
         do while (self%tried > shortest)
            self%tried = 0.5_dp*self%tried
            call self%try_step(model, bodies, heat, loads, self%tried, error)
            if (allocated(error) .or. self%outcome == is_found) return
         end do
      end if
      call lose(self, error)
   end subroutine turn_corner

   !> The fold between the start of the last step and its end.
   subroutine find_fold(self, model, bodies, heat, loads, error)
      type(branch_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(inout) :: loads
      type(error_type), allocatable, intent(out) :: error
      type(branch_point_type) :: behind
      real(dp) :: ends(2), rates(2)
      integer :: n

      n = size(self%from%tangent)
      behind = self%point
      ends = [0.0_dp, self%tried]
      rates = abs([self%from%tangent(n), behind%tangent(n)])
      do while (sum(rates)*(ends(2) - ends(1)) > fold_width*max(abs(behind%factor), least_load) &
         .and. ends(2) - ends(1) > shortest)
         call self%try_step(model, bodies, heat, loads, sum(ends)/2, error)
         if (allocated(error) .or. self%outcome /= is_found) return
         if (turns(self%from, self%point)) then
            behind = self%point
            ends(2) = sum(ends)/2
            rates(2) = abs(behind%tangent(n))
         else
            ends(1) = sum(ends)/2
            rates(1) = abs(self%point%tangent(n))
         end if
      end do
      self%point = behind
      self%outcome = is_found
      self%is_fold = .true.
   end subroutine find_fold

   !> Ends the branch where the load factor leaves its range.
   subroutine stay_in_range(self, model, bodies, heat, loads, error)
      type(branch_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(inout) :: loads
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: bound, reached

      if (self%outcome /= is_found) return
      reached = self%point%factor
      bound = within(self, model)
      self%is_last = any(abs(reached - model%steps(self%step)%continuation%range) <= same)
      if (abs(reached - bound) > same) then
         self%is_last = .true.
         self%is_fold = .false.
         self%held = size(self%from%tangent)
         self%point%factor = bound
         call self%try_step(model, bodies, heat, loads, self%tried*(bound - self%from%factor)/ &
            (reached - self%from%factor), error)
         self%held = 0
         self%is_last = self%outcome == is_found
      end if
      if (self%is_last) self%ending = 'the load factor is '//to_text(bound)
   end subroutine stay_in_range

end module branch_steps
