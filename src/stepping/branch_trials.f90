!> Steps along a branch of steady solutions over the load factor: along the tangent, and by Newton's
!> corrections normal to it back to the branch (Allgower & Georg 1990; branch_path).
module branch_trials
   use branch_path, only: branch_measure_type, branch_point_type
   use contact_operator, only: make_graph, openings
   use contact_system, only: contact_state_type
   use controls, only: continuation_type
   use coupled_increment, only: contact_scales
   use errors, only: error_type, set_error, status_no_convergence
   use field_problem, only: solved_loads_type
   use fixed_point, only: pass_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: load_places, load_rate_type, trial_type
   use increment_iteration, only: pass_on_branch
   use increment_solution, only: begin_increment, load_points
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use loads, only: loads_type
   use model, only: model_type
   use path_steps, only: path_step_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   implicit none
   private
   public :: branch_type, is_found, is_sharp, is_lost, straight

   integer, parameter :: most_corrections = 12
   real(dp), parameter :: wanted_part = 0.5_dp       !! of the residual that an increment may leave
   real(dp), parameter :: nearest = 1.0e-10_dp       !! correction that is none, in lengths
   real(dp), parameter :: most_correction = 0.5_dp   !! over the step
   real(dp), parameter :: straight = 0.7_dp !! cosine below which a tangent turns too far in a step

   integer, parameter :: is_found = 1   !! a step leads to the branch
   integer, parameter :: is_sharp = 2   !! the branch turns too far, maybe in a kink
   integer, parameter :: is_lost = 3    !! the corrections fail

   !> The branch of a step, and steps from a point of it.
   type :: branch_type
      integer :: step = 0                      !! number of the step of the deck
      type(step_clock_type) :: start           !! its start
      type(continuation_type) :: asked         !! its *CONTINUATION
      logical :: is_followed = .false.         !! whether points are found by arc length
      integer :: points = 0                    !! so far
      type(branch_point_type) :: first, base   !! first and last point
      integer, allocatable :: direction(:)     !! (m) of slip so far, 0 where there was none
      logical :: is_last = .false.             !! whether the branch ends at the point
      character(:), allocatable :: ending      !! why
      logical :: is_fold = .false.             !! whether the load factor turns there
      real(dp) :: length = 0.0_dp              !! of the next step
      real(dp) :: tried = 0.0_dp               !! of the one that led to the point
      type(branch_point_type) :: from          !! where steps begin
      type(branch_point_type) :: point         !! where the last one ended, on the branch if found
      integer :: fixed_coordinate = 0          !! what corrections leave: a contact point, or m + 1
      integer :: outcome = is_lost             !! of the last step
      logical :: has_converged = .false.       !! whether it led to the branch
      type(branch_measure_type) :: measure     !! of lengths along the branch
      type(contact_state_type) :: contact      !! of the last pass
      ! What it is a branch of, while a point is sought.
      type(model_type), pointer :: model => null()
      type(reduced_bodies_type), pointer :: bodies => null()
      type(heat_reduction_type), pointer :: heat => null()
      type(loads_type), pointer :: loads => null()   !! moved along
      type(solution_state_type) :: before   !! state at the last point of the branch
      type(load_rate_type), private :: rate
      type(solved_loads_type), allocatable, private :: known(:)
      type(pass_type), private :: pass
      real(dp), private :: residual = 0.0_dp   !! of the last pass, over the one wanted
      real(dp), private :: near = nearest      !! correction that is none after it
   contains
      procedure :: clock_at
      procedure :: begin
      procedure :: try_step
   end type branch_type

contains

   !> The instant at which loads have a load factor.
   pure function clock_at(self, factor) result(clock)
      class(branch_type), intent(in) :: self
      real(dp), intent(in) :: factor               !! [-]
      type(step_clock_type) :: clock

      clock = self%start
      clock%step_time = factor*clock%period
      clock%total_time = clock%total_time + clock%step_time
   end function clock_at

   !> Begins at a solution, the first point: measures lengths and finds the way of the branch.
   !> Errors: as a pass; there is no way.
   subroutine begin(self, factor, error)
      class(branch_type), intent(inout) :: self
      real(dp), intent(in) :: factor                   !! load factor of the solution
      type(error_type), allocatable, intent(out) :: error
      type(trial_type) :: loaded
      type(path_step_type) :: step
      integer :: k, m

      allocate (self%known(load_places))
      call load_increment(self, loaded, error)
      if (allocated(error)) return
      self%rate = load_rate_type(loaded%data%heat%condensed, loaded%data%no_jump_load)
      if (allocated(loaded%data%welded_mean)) self%rate%mean = loaded%data%welded_mean
      self%point%factor = 1.0_dp
      call load_increment(self, loaded, error)
      if (allocated(error)) return
      self%rate%heat = loaded%data%heat%condensed - self%rate%heat
      self%rate%force = loaded%data%no_jump_load - self%rate%force
      if (allocated(loaded%data%welded_mean)) self%rate%mean = loaded%data%welded_mean - &
         self%rate%mean
      m = size(self%before%omega)
      associate (measure => self%measure, weight => max(self%bodies%points%weight, 0.0_dp))
         measure%length = loaded%data%scales%length
         measure%graph = make_graph(self%bodies, self%heat, measure%length)
         measure%part = sqrt(weight/sum(weight))
         allocate (measure%body(m), source=1.0_dp)
         self%point%coordinate = measure%graph%coordinate_of_omega(self%before%omega, &
            openings(self%bodies, measure%graph, self%before%contact))
      end associate
      self%point%factor = factor
      self%point%tangent = [(0.0_dp, k=1, m), merge(1.0_dp, -1.0_dp, self%asked%rises)]
      self%from = self%point
      call find_pass(self, error)
      if (allocated(error)) return
      if (allocated(self%pass%body)) self%measure%body = self%pass%body
      call self%measure%correction(self%point, self%pass, 0, step)
      if (.not. step%sound) then
         call set_error(error, status_no_convergence, 'the first point of the branch has no '// &
            'tangent; begin at another load')
         return
      end if
      self%point%tangent = step%tangent
      self%point%omega = self%before%omega
      self%from = self%point
   end subroutine begin

   !> An increment with the load factor of the point.
   !> Error: its loads overflow.
   subroutine load_increment(self, loaded, error)
      type(branch_type), intent(inout) :: self
      type(trial_type), intent(inout) :: loaded
      type(error_type), allocatable, intent(out) :: error

      call self%loads%move_to(self%clock_at(self%point%factor), self%model)
      loaded%next = self%before
      loaded%next%sources%load = self%loads%heat_load()
      loaded%next%sources%film = self%loads%film_matrix()
      loaded%next%force_load = self%loads%nodal_forces()
      call begin_increment(self%bodies, self%model%steps(self%step), self%before, loaded)
      call move_alloc(self%known, loaded%known)
      call load_points(self%bodies, self%heat, self%loads, loaded, error)
      call move_alloc(loaded%known, self%known)
      if (.not. allocated(error)) loaded%data%scales = contact_scales(self%bodies, loaded%data)
   end subroutine load_increment

   !> The pass at the point, with its derivatives.
   !> Errors: as a pass.
   subroutine find_pass(self, error)
      type(branch_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      type(trial_type) :: loaded

      call load_increment(self, loaded, error)
      if (allocated(error)) return
      associate (data => loaded%data, workspace => loaded%workspace, next => loaded%next)
         data%rate = self%rate
         workspace%pass%graph = self%measure%graph
         workspace%pass%coordinate = self%point%coordinate
         self%contact%reference = next%contact%reference
         next%contact = self%contact
         call pass_on_branch(self%bodies, self%heat, loaded, self%residual, error)
         if (allocated(error)) return
         self%contact = next%contact
         self%near = max(nearest, workspace%record%residual_floor)
         self%point%omega = next%omega
         self%pass = workspace%pass
         self%measure%graph = self%pass%graph
      end associate
   end subroutine find_pass

   !> A pass at the point, and the correction that it asks for; the tangent there is the point's.
   !> Not sound where contact zones are not found or derivatives do not exist.
   !> Error: status_interrupted.
   subroutine correct_once(self, correction, error)
      type(branch_type), intent(inout) :: self
      type(path_step_type), intent(out) :: correction
      type(error_type), allocatable, intent(out) :: error
      integer :: k

      call find_pass(self, error)
      if (allocated(error)) then
         if (error%status == status_no_convergence) deallocate (error)
         return
      end if
      self%point%tangent = self%from%tangent
      call self%measure%correction(self%point, self%pass, self%fixed_coordinate, correction)
      if (.not. correction%sound) return
      ! The coordinate that passes a kink goes on in its sense.
      k = self%measure%kinked(self%from, self%point)
      if (k > 0) then
         if (correction%tangent(k)*self%from%tangent(k) < 0.0_dp) correction%tangent = &
            -correction%tangent
      end if
      self%point%tangent = correction%tangent
   end subroutine correct_once

   !> A step of a length along the tangent, and back to the branch. With an unknown held it ends
   !> where that has the value of the point before.
   !> Error: status_interrupted.
   subroutine try_step(self, length, error)
      class(branch_type), intent(inout) :: self   !! receives point and outcome
      real(dp), intent(in) :: length
      type(error_type), allocatable, intent(out) :: error
      type(branch_point_type) :: trial
      type(path_step_type) :: correction
      integer :: i

      trial = self%measure%moved(self%from, length*self%from%tangent)
      if (self%fixed_coordinate == size(trial%tangent)) then
         trial%factor = self%point%factor
      else if (self%fixed_coordinate > 0) then
         trial%coordinate(self%fixed_coordinate) = self%point%coordinate(self%fixed_coordinate)
      end if
      self%point = trial
      self%has_converged = .false.
      do i = 1, most_corrections
         call correct_once(self, correction, error)
         if (allocated(error)) return
         if (.not. correction%sound) exit
         self%has_converged = self%residual <= wanted_part .and. norm2(correction%change) <= &
            self%near
         if (self%has_converged .or. (self%fixed_coordinate == 0 .and. norm2(correction%change) > &
            most_correction*length)) exit
         self%point = self%measure%moved(self%point, correction%change)
      end do
      if (self%has_converged .and. self%fixed_coordinate == 0 .and. &
         self%measure%is_caught(self%from, trial, self%point)) then
         self%has_converged = .false.
         self%outcome = is_sharp
      else if (self%has_converged) then
         self%outcome = merge(is_found, is_sharp, dot_product(self%point%tangent, &
            self%from%tangent) >= straight)
      else
         self%outcome = merge(is_sharp, is_lost, self%measure%kinked(self%from, trial) > 0)
      end if
   end subroutine try_step

end module branch_trials
