!> An increment in which heat and mechanics are solved together: where its fixed point starts, and
!> what is said of the solution.
module coupled_increment
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use arnoldi, only: arnoldi_type
   use contact_heat, only: jump_derivatives, jump_derivatives_type
   use controls, only: method_picard, start_both, start_closed, start_given, start_open, &
      start_previous
   use coupling_gains, only: find_gains, is_one_of_several
   use errors, only: error_type
   use fixed_point, only: predicted_conductance
   use gap_temperatures, only: derivative_by_temperature
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: increment_data_type, increment_workspace_type
   use increment_iteration, only: iterate
   use kinds, only: dp
   use opening_derivatives, only: make_graph, opening_derivative
   use reduced_bodies, only: reduced_bodies_type
   use resting_points, only: contact_scales
   use solution_report, only: solution_report_type
   use solution_state, only: solution_state_type
   use text, only: append
   implicit none
   private
   public :: solve_coupled

   real(dp), parameter :: end_conductance(2) = [1.0e-8_dp, 1.0e8_dp] !! of the starts open and
   !! closed, in the conductance of the bodies about the contact point
   real(dp), parameter :: different = 1.0e-3_dp !! in omega, relative: more than residuals explain
   real(dp), parameter :: near_turning_point = 0.1_dp !! distance of the largest real eigenvalue
   !! from 1

contains

   !> Conductances, jumps and contact state of an increment.
   !> Errors: no convergence of the fixed point or of the contact zones, unconstrained bodies.
   subroutine solve_coupled(bodies, heat, data, workspace, next, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(inout) :: data           !! receives scales
      type(increment_workspace_type), intent(inout) :: workspace !! loads in, the last pass out
      type(solution_state_type), intent(inout) :: next           !! guess in, solution out
      type(error_type), allocatable, intent(out) :: error

      data%scales = contact_scales(bodies, data)
      workspace%pass%graph = make_graph(bodies, heat, data%scales%length)
      workspace%cuts_hats = any(bodies%points%cuts_hats) .and. &
         .not. data%equation%takes_past_conductance()
      next%omega_before = data%equation%omega_old
      if (data%start%kind == start_both) then
         call solve_from_both(bodies, heat, data, workspace, next, error)
      else
         next%omega = starting_conductance(bodies, heat, data%start%kind, data)
         call iterate(bodies, heat, data%fixed_point, data, workspace, next, error)
      end if
      if (allocated(error) .or. .not. data%fixed_point%finds_gain) return
      call judge(bodies, heat, data, next, data%fixed_point%method == method_picard, workspace)
   end subroutine solve_coupled

   !> omega*^0 of a start.
   function starting_conductance(bodies, heat, kind, data) result(omega)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      integer, intent(in) :: kind
      type(increment_data_type), intent(in) :: data
      real(dp) :: omega(size(data%equation%omega_old))
      real(dp), allocatable :: conductor(:)
      integer :: i, k

      select case (kind)
      case (start_given)
         do i = 1, size(bodies%interfaces)
            omega(bodies%points%interface_start(i):bodies%points%interface_start(i + 1) - 1) = &
               data%start%conductance(i)
         end do
      case (start_open, start_closed)
         omega = data%equation%omega_old
         conductor = heat%conductors(bodies)
         do k = 1, size(omega)
            if (bodies%jump_index(k) == 0 .or. bodies%points%weight(k) <= 0.0_dp) cycle
            omega(k) = end_conductance(merge(1, 2, kind == start_open))*conductor(k)/ &
               bodies%points%weight(k)
         end do
      case default
         omega = predicted_conductance(data%equation%omega_old, data%omega_before, &
            data%size_ratio)
      end select
   end function starting_conductance

   !> The increment from the last ones, and from both ends of the conductance: do all lead to one
   !> solution? That of the first start that leads to any is the increment's. It is found last, for
   !> the factors to be its own.
   subroutine solve_from_both(bodies, heat, data, workspace, next, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(inout) :: workspace
      type(solution_state_type), intent(inout) :: next
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: kinds(3) = [start_open, start_closed, start_previous]
      character(*), parameter :: names(3) = [character(8) :: 'OPEN', 'CLOSED', 'PREVIOUS']
      type(solution_state_type) :: guess
      type(increment_workspace_type) :: fresh
      real(dp) :: omega(size(next%omega), 3)
      logical :: found(3)
      integer :: i

      guess = next
      fresh = workspace
      do i = 1, 3
         call try_start(i)
         found(i) = .not. allocated(error)
         omega(:, i) = next%omega
         if (allocated(error)) call append(fresh%record%notes, 'the start from '// &
            trim(names(i))//' finds no solution: '//error%message)
      end do
      if (.not. found(3) .and. any(found)) call try_start(findloc(found, .true., dim=1))
      if (allocated(fresh%record%notes)) workspace%record%notes = fresh%record%notes
      call compare(omega(:, 1), omega(:, 2), omega(:, 3), found, workspace%record)
   contains
      subroutine try_start(i)
         integer, intent(in) :: i

         next = guess
         next%omega = starting_conductance(bodies, heat, kinds(i), data)
         workspace = fresh
         call iterate(bodies, heat, data%fixed_point, data, workspace, next, error)
      end subroutine try_start
   end subroutine solve_from_both

   !> Says whether all starts lead to one solution.
   subroutine compare(from_open, from_closed, from_previous, found, record)
      real(dp), intent(in) :: from_open(:), from_closed(:), from_previous(:)
      logical, intent(in) :: found(:)
      type(solution_report_type), intent(inout) :: record

      if (found(1) .and. found(2) .and. differ(from_open, from_closed)) then
         call record%warn('the starts from OPEN and from CLOSED lead to different solutions; '// &
            'this is one of several')
      else if (found(3) .and. ((found(1) .and. differ(from_open, from_previous)) .or. &
         (found(2) .and. differ(from_closed, from_previous)))) then
         call record%warn('PREVIOUS leads to a different solution than OPEN and CLOSED; this '// &
            'is one of several')
      else if (found(1) .and. found(2)) then
         call append(record%notes, 'the starts from OPEN and from CLOSED lead to one solution')
      end if
   end subroutine compare

   !> Whether two conductances belong to different solutions.
   pure logical function differ(a, b)
      real(dp), intent(in) :: a(:), b(:)

      differ = any(abs(a - b) > different*max(a, b))
   end function differ

   !> The gain of the coupling, and what follows from it.
   subroutine judge(bodies, heat, data, next, is_plain, workspace)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      type(solution_state_type), intent(in) :: next
      logical, intent(in) :: is_plain                            !! whether the iteration is (4.1)
      type(increment_workspace_type), intent(inout) :: workspace
      type(arnoldi_type) :: gains

      workspace%record%coupling_gain = 0.0_dp
      workspace%record%coupling_gain_max = 0.0_dp
      associate (graph => workspace%pass%graph, opening => workspace%pass%opening)
         if (.not. (any(abs(graph%derivative(graph%coordinate_of_opening(opening))) > 0.0_dp) .or. &
            any(next%resting) .or. bodies%points%vary_with_temperature())) return
      end associate
      if (.not. all(next%resting)) then
         workspace%record%coupling_gain = ieee_value(1.0_dp, ieee_quiet_nan)
         workspace%record%coupling_gain_max = workspace%record%coupling_gain
         call find_gains(bodies, heat, data, workspace, next, gains)
         if (.not. gains%found) return
         workspace%record%coupling_gain = real(gains%largest, dp)
         if (gains%largest_real > -huge(1.0_dp)) workspace%record%coupling_gain_max = &
            gains%largest_real
      end if
      associate (record => workspace%record)
         if (record%coupling_gain < -1.0_dp .and. is_plain) call record%warn( &
            'the coupling gain is ', record%coupling_gain, &
            ', below -1: plain iteration (4.1) would diverge')
         if (is_near_turning_point(record%coupling_gain_max)) call record%warn( &
            'the largest real gain is ', record%coupling_gain_max, ', near 1: a turning point, '// &
            'where solutions meet and small changes of the load have large effects', &
            severity=-abs(record%coupling_gain_max - 1.0_dp))
         ! Where all gains are below 1 in modulus, det(I - U') is positive.
         if (any(next%resting) .or. abs(gains%largest) >= 1.0_dp) then
            if (is_unstable(bodies, heat, data, workspace, next)) call record%warn( &
               'det(I - U'') is negative: the branch is unstable, and there are at least two '// &
               'other solutions')
         end if
      end associate
   end subroutine judge

   !> Whether the largest real gain is near 1; there may be none.
   pure logical function is_near_turning_point(gain)
      real(dp), intent(in) :: gain    ! NaN for none

      is_near_turning_point = .not. ieee_is_nan(gain)
      if (is_near_turning_point) is_near_turning_point = abs(gain - 1.0_dp) <= near_turning_point
   end function is_near_turning_point

   !> Whether det(I - U') < 0.
   logical function is_unstable(bodies, heat, data, workspace, next)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      type(solution_state_type), intent(in) :: next
      real(dp), allocatable :: derivative(:, :), body(:), by_temperature(:, :)
      type(jump_derivatives_type) :: by_omega

      is_unstable = .false.
      call jump_derivatives(bodies, data, workspace, next%jump, by_omega)
      call opening_derivative(bodies, heat, workspace, by_omega, next%contact, derivative, body)
      if (.not. allocated(derivative)) return
      associate (graph => workspace%pass%graph, opening => workspace%pass%opening)
         if (bodies%points%vary_with_temperature()) by_temperature = derivative_by_temperature( &
            bodies, heat, workspace, graph%coordinate_of_opening(opening), by_omega)
         is_unstable = is_one_of_several(graph, opening, derivative, next%resting, by_temperature)
      end associate
   end function is_unstable

end module coupled_increment
