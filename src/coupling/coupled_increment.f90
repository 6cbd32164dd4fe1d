!> An increment in which heat and mechanics are solved together: where its fixed point starts, and
!> what the derivative U' of the contact operator of section 2 says of the solution omega =
!> U(omega): the gain of the coupling, and whether the solution is one of several.
module coupled_increment
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use arnoldi, only: arnoldi_type
   use closing_instant, only: contact_change_type, make_tangent
   use conductance_graph, only: conductance_graph_type
   use contact_heat, only: changes_by_temperature, derivative_by_temperature, heat_by_omega, &
      jump_derivatives, jump_derivatives_type, tail_of_heats
   use contact_operator, only: make_graph, opening_changes, opening_derivative
   use contact_system, only: contact_open, contact_state_type
   use contact_workspace, only: contact_workspace_type
   use controls, only: method_picard, start_both, start_closed, start_given, start_open, &
      start_previous
   use dense, only: lu_type, product_of
   use errors, only: error_type
   use fixed_point, only: predicted_conductance
   use friction_tangent, only: friction_tangent_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: contact_scales_type, increment_data_type, increment_workspace_type, &
      trial_type
   use increment_iteration, only: iterate
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   use solution_report, only: solution_report_type
   use solution_state, only: solution_state_type
   use text, only: append
   implicit none
   private
   public :: solve_coupled, judge_solution, contact_scales, differ, find_gains, is_one_of_several

   real(dp), parameter :: end_conductance(2) = [1.0e-8_dp, 1.0e8_dp] !! of the starts open and
   !! closed, in the conductance of the bodies about the contact point
   real(dp), parameter :: different = 1.0e-3_dp !! in omega, relative: more than residuals explain
   real(dp), parameter :: disturbed = 0.5_dp    !! of log omega at a start that is turned over
   real(dp), parameter :: near_turning_point = 0.1_dp !! distance of the largest real eigenvalue
   !! from 1
   real(dp), parameter :: same = 1.0e3_dp       !! times the rounding of coordinates: equal gaps
   real(dp), parameter :: no_gain = 1.0e-6_dp      !! a largest real gain that is none beside 1
   !> Residual of the gains of many interfaces, beside 1: where many parts are alike so are their
   !> gains, and to tell these apart takes hundreds of products. Where laws vary with temperatures,
   !> or friction makes heat, the matrix is less normal, and errors of the gains may be larger than
   !> residuals.
   real(dp), parameter :: known_of_many = 3.0e-4_dp
   real(dp), parameter :: least_part = 1.0e-12_dp  !! of the largest factor, that counts in scales

contains

   !> Conductances, jumps and contact state of an increment.
   !> Errors: no convergence of the fixed point or of the contact zones, unconstrained bodies.
   subroutine solve_coupled(bodies, heat, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(inout) :: trial   !! loaded, with a guess; the last pass out
      type(error_type), allocatable, intent(out) :: error

      associate (data => trial%data, workspace => trial%workspace, next => trial%next)
         data%scales = contact_scales(bodies, data)
         workspace%pass%graph = make_graph(bodies, heat, data%scales%length)
         ! Where the edge goes over a contact point U jumps, and there is no branch.
         workspace%resolves_edge = any(bodies%points%resolves_edge) .and. &
            .not. (data%equation%takes_past_conductance() .or. data%follows_branch)
         next%omega_before = data%equation%omega_old
         if (allocated(data%omega_start)) then
            next%omega = data%omega_start
            call iterate(bodies, heat, trial, error)
         else if (data%start%kind == start_both) then
            call solve_from_both(bodies, heat, trial, error)
         else
            next%omega = starting_conductance(bodies, heat, data%start%kind, data)
            call iterate(bodies, heat, trial, error)
         end if
         if (allocated(error) .or. .not. data%fixed_point%finds_gain) return
         call judge_solution(bodies, heat, trial)
      end associate
   end subroutine solve_coupled

   !> Largest values that are known at the start of an increment. Its load counts by the overlap
   !> that it makes at a contact point alone.
   pure function contact_scales(bodies, data) result(scales)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(contact_scales_type) :: scales                     !! largest values, length > 0

      scales%force = maxval(data%previous%force)
      associate (alone => bodies%equilibrium%contact%alone, &
         normal_load => abs(data%no_jump_load(bodies%equilibrium%contact%normal)))
         scales%length = max(data%displacement_scale, maxval(abs(data%previous%gap)), &
            maxval(pack(normal_load, alone > 0.0_dp)/pack(alone, alone > 0.0_dp)))
      end associate
      if (scales%length <= 0.0_dp) scales%length = 1.0_dp
   end function contact_scales

   !> omega*^0 of a start.
   function starting_conductance(bodies, heat, kind, data) result(omega)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      integer, intent(in) :: kind
      type(increment_data_type), intent(in) :: data
      real(dp) :: omega(size(data%equation%omega_old))
      real(dp), allocatable :: conductor(:)
      integer :: k

      select case (kind)
      case (start_given)
         omega = data%start%conductance(bodies%points%interface)
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

   !> The increment from the last ones, from both ends of the conductance, and from what was found
   !> there, turned over and disturbed: do all lead to one solution? That of the first start that
   !> leads to any is the increment's. It is found last, for the factors to be its own.
   subroutine solve_from_both(bodies, heat, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(inout) :: trial
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: kinds(3) = [start_open, start_closed, start_previous]
      character(*), parameter :: names(3) = [character(8) :: 'OPEN', 'CLOSED', 'PREVIOUS']
      type(contact_state_type) :: guess
      type(increment_workspace_type) :: fresh
      real(dp), dimension(size(trial%next%omega)) :: turned
      real(dp) :: omega(size(turned), 3)
      logical :: found(3), has_other
      integer :: i

      guess = trial%next%contact
      fresh = trial%workspace
      has_other = .false.
      found = .false.
      do i = 1, 3
         if (i == 3 .and. any(found(:2))) then
            turned = turned_over(bodies, omega(:, findloc(found(:2), .true., dim=1)))
            call try_from(turned)
            has_other = .not. allocated(error)
            turned = trial%next%omega
         end if
         call try_start(i)
         found(i) = .not. allocated(error)
         omega(:, i) = trial%next%omega
         if (allocated(error)) call append(fresh%record%notes, 'the start from '// &
            trim(names(i))//' finds no solution: '//error%message)
      end do
      if (.not. found(3) .and. any(found)) call try_start(findloc(found, .true., dim=1))
      if (allocated(fresh%record%notes)) trial%workspace%record%notes = fresh%record%notes
      call compare(omega(:, 1), omega(:, 2), omega(:, 3), found, trial%workspace%record)
      if (has_other) has_other = any(differ(turned, omega(:, findloc(found, .true., dim=1))))
      if (has_other) call trial%workspace%record%warn('a start with conductances turned over '// &
         'leads to a different solution; this is one of several')
   contains
      subroutine try_start(i)
         integer, intent(in) :: i

         call try_from(starting_conductance(bodies, heat, kinds(i), trial%data))
      end subroutine try_start

      subroutine try_from(omega_start)
         real(dp), intent(in) :: omega_start(:)

         trial%next%contact = guess
         trial%next%omega = omega_start
         trial%workspace = fresh
         call iterate(bodies, heat, trial, error)
      end subroutine try_from
   end subroutine solve_from_both

   !> Conductances high where they are low and the other way round, and a little more so at every
   !> other contact point: what leads out of a state in which all of a face do the same.
   pure function turned_over(bodies, omega) result(turned)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: omega(:)
      real(dp) :: turned(size(omega))
      integer :: i, k

      turned = omega
      do i = 1, size(bodies%interfaces)
         associate (first => bodies%points%interface_start(i), &
            last => bodies%points%interface_start(i + 1) - 1)
            if (last < first) cycle
            if (any(omega(first:last) <= 0.0_dp)) cycle
            associate (mean => sum(log(omega(first:last)))/(last - first + 1))
               turned(first:last) = exp([(2.0_dp*mean - log(omega(k)) + merge(disturbed, &
                  -disturbed, modulo(k, 2) == 0), k=first, last)])
            end associate
         end associate
      end do
   end function turned_over

   !> Says whether all starts lead to one solution.
   subroutine compare(from_open, from_closed, from_previous, found, record)
      real(dp), intent(in) :: from_open(:), from_closed(:), from_previous(:)
      logical, intent(in) :: found(:)
      type(solution_report_type), intent(inout) :: record

      if (found(1) .and. found(2) .and. any(differ(from_open, from_closed))) then
         call record%warn('the starts from OPEN and from CLOSED lead to different solutions; '// &
            'this is one of several')
      else if (found(3) .and. ((found(1) .and. any(differ(from_open, from_previous))) .or. &
         (found(2) .and. any(differ(from_closed, from_previous))))) then
         call record%warn('PREVIOUS leads to a different solution than OPEN and CLOSED; this '// &
            'is one of several')
      else if (found(1) .and. found(2)) then
         call append(record%notes, 'the starts from OPEN and from CLOSED lead to one solution')
      end if
   end subroutine compare

   !> Whether two conductances belong to different solutions.
   elemental logical function differ(a, b)
      real(dp), intent(in) :: a, b

      differ = abs(a - b) > different*max(a, b)
   end function differ

   !> The gain of the coupling at a solution, and what follows from it.
   subroutine judge_solution(bodies, heat, trial)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(inout) :: trial   !! a solution, as its last pass left it; its record
      type(arnoldi_type) :: gains
      logical :: is_negative                                     ! det(I - U')

      associate (data => trial%data, workspace => trial%workspace, next => trial%next, &
         record => trial%workspace%record, graph => trial%workspace%pass%graph, &
         opening => trial%workspace%pass%opening)
         record%coupling_gain = 0.0_dp
         record%coupling_gain_max = 0.0_dp
         if (.not. (any(abs(graph%derivative(graph%coordinate_of_opening(opening))) > 0.0_dp) .or. &
            any(next%resting) .or. bodies%points%vary_with_temperature() .or. &
            allocated(workspace%friction%heat))) return
         if (.not. all(next%resting) .or. allocated(workspace%friction%heat)) then
            record%coupling_gain = ieee_value(1.0_dp, ieee_quiet_nan)
            record%coupling_gain_max = record%coupling_gain
            call find_gains(bodies, heat, data, workspace, next, gains)
            if (.not. gains%found) return
            record%coupling_gain = real(gains%largest, dp)
            if (gains%largest_real > -huge(1.0_dp)) record%coupling_gain_max = gains%largest_real
         end if
         ! Where all gains are below 1 in modulus, det(I - U') is positive.
         is_negative = any(next%resting) .or. abs(gains%largest) >= 1.0_dp
         if (is_negative) is_negative = is_unstable(bodies, heat, trial)
         record%is_unstable = is_negative .and. data%equation%duration <= 0.0_dp
         ! The points of a branch say so themselves.
         if (data%follows_branch) return
         if (record%coupling_gain < -1.0_dp .and. data%fixed_point%method == method_picard) then
            call record%warn('the coupling gain is ', record%coupling_gain, &
               ', below -1: plain iteration (4.1) would diverge')
         end if
         if (.not. ieee_is_nan(record%coupling_gain_max)) then
            if (abs(record%coupling_gain_max - 1.0_dp) <= near_turning_point) call record%warn( &
               'the largest real gain is ', record%coupling_gain_max, &
               ', near 1: near a turning point or the limit of stability, where small changes '// &
               'of the load have large effects', severity=-abs(record%coupling_gain_max - 1.0_dp))
         end if
         if (alternates(bodies, next)) call record%warn('closed and open contact points '// &
            'alternate in a uniform face: unless the shape of its bodies makes ridges so '// &
            'near each other, a pattern, which is not the only solution; *START, FROM=BOTH or '// &
            'FROM=GIVEN may find others')
         if (any(next%resting) .or. abs(gains%largest) >= 1.0_dp) then
            if (.not. is_negative) then
               if (record%coupling_gain_max > 1.0_dp + near_turning_point) call record%warn( &
                  'the largest real gain is ', record%coupling_gain_max, trim(merge( &
                  ', above 1: modes may grow, which *STABILITY counts                           ', &
                  ', above 1: the solution may be one of several; *START, FROM=BOTH tries others', &
                  allocated(workspace%friction%heat))))
            else
               if (data%equation%duration > 0.0_dp) then
                  call record%warn('det(I - U'') is negative: the increment is too long to '// &
                     'show a mode that grows, the state does not last; take shorter increments')
               else if (allocated(workspace%friction%heat)) then
                  ! Heat of friction has no bound: the other solutions may be at infinity.
                  call record%warn('det(I - U'') is negative: the state is unstable, an odd '// &
                     'number of modes grows')
               else
                  call record%warn('det(I - U'') is negative: the state is unstable, and '// &
                     'there are at least two other solutions')
               end if
            end if
         end if
      end associate
   end subroutine judge_solution

   !> Whether closed and open contact points alternate along a face whose gap is the same
   !> everywhere: more than half of those between two others differ from both. Wider zones have
   !> their reason in the bodies, as the ridges at both ends and the middle of a hot pellet.
   pure logical function alternates(bodies, next)
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: next
      logical, allocatable :: is_open(:)
      integer :: i

      alternates = .false.
      do i = 1, size(bodies%interfaces)
         associate (first => bodies%points%interface_start(i), &
            last => bodies%points%interface_start(i + 1) - 1)
            if (last - first < 2) cycle
            associate (gap => bodies%points%initial_gap(first:last))
               if (maxval(abs(gap - gap(1))) > same*bodies%equilibrium%contact%least_length) cycle
            end associate
            is_open = next%contact%contact_state(first:last) == contact_open
            associate (m => size(is_open))
               alternates = alternates .or. 2*count((is_open(2:m - 1) .neqv. is_open(:m - 2)) &
                  .and. (is_open(2:m - 1) .neqv. is_open(3:))) > m - 2
            end associate
         end associate
      end do
   end function alternates

   !> Whether det(I - U') < 0.
   logical function is_unstable(bodies, heat, trial)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(in) :: trial                    !! as the last pass left it
      real(dp), allocatable :: derivative(:, :), body(:), by_temperature(:, :)
      type(jump_derivatives_type) :: by_omega
      type(friction_tangent_type) :: of_friction

      is_unstable = .false.
      if (heat%schur%is_sparse()) return
      associate (workspace => trial%workspace, next => trial%next, &
         graph => trial%workspace%pass%graph, opening => trial%workspace%pass%opening)
         call jump_derivatives(bodies, trial%data, workspace, next%jump, by_omega)
         call opening_derivative(bodies, heat, workspace, by_omega, next%contact, derivative, body)
         if (.not. allocated(derivative)) return
         if (bodies%points%vary_with_temperature()) by_temperature = derivative_by_temperature( &
            bodies, heat, workspace, graph%coordinate_of_opening(opening), by_omega)
         is_unstable = is_one_of_several(graph, opening, derivative, next%resting, by_temperature)
         if (.not. allocated(workspace%friction%heat)) return
         ! The determinant is that of I - U' with the heat of friction following, times that of the
         ! heat at constant conductances.
         call of_friction%make(bodies, heat, workspace, next%contact)
      end associate
      if (of_friction%exists) is_unstable = is_unstable .neqv. of_friction%lu%negative_determinant()
   end function is_unstable

   !> The gains of a solution: eigenvalues of U', of which only the outer ones are found. The
   !> conductance of a contact point that rests is no variable of U'; the heat that friction makes
   !> at a contact point is one.
   !>
   !> Laws and jumps make rows and columns of U' differ by orders of magnitude. The method works on
   !> a similar matrix without that, which is nearly normal: its eigenvalues are as sharp as their
   !> residuals.
   subroutine find_gains(bodies, heat, data, workspace, solution, gains)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      type(solution_state_type), intent(in) :: solution        !! that the last pass found
      type(arnoldi_type), intent(out) :: gains                 !! none found where U' does not exist
      type(contact_workspace_type) :: tangent
      type(contact_change_type) :: of_contact
      real(dp), dimension(size(solution%jump)) :: coordinate, heats, rate, scale, slope
      real(dp), allocatable :: change(:, :), friction_heat(:, :), of_tail(:, :)
      real(dp) :: heat_scale
      integer, allocatable :: free(:), heated(:)
      integer :: k
      logical :: sound

      free = pack([(k, k=1, size(rate))], .not. solution%resting)
      heated = [integer ::]
      if (allocated(workspace%friction%heat)) heated = pack([(k, k=1, &
         size(workspace%friction%heat))], workspace%friction%parts(2, :) > 0.0_dp)
      if (size(free) + size(heated) == 0) return
      call make_tangent(bodies%equilibrium%contact, workspace%contact, solution%contact, tangent, &
         sound)
      if (.not. sound) return
      associate (graph => workspace%pass%graph)
         coordinate = graph%coordinate_of_opening(workspace%pass%opening)
         slope = graph%derivative(coordinate)
         rate = heat_by_omega(bodies, data, workspace, solution%jump)
         scale = sqrt(of_largest(slope)/of_largest(rate))
         allocate (change(size(rate), 1))
         if (size(heated) > 0) call find_heat_scale()
         call gains%begin(size(free) + size(heated), no_gain, &
            enough=merge(known_of_many, 0.0_dp, heat%schur%is_sparse() .and. size(heated) == 0 &
            .and. .not. bodies%points%vary_with_temperature()))
         do while (gains%wants_product)
            heats = 0.0_dp
            heats(free) = rate(free)*scale(free)*gains%vector(:size(free))
            if (size(heated) > 0) then
               call find_heated_product(gains%vector(size(free) + 1:))
               call gains%take([change(free, 1)/scale(free), &
                  friction_heat(heated, 1)/heat_scale])
               cycle
            end if
            of_tail = tail_of_heats(bodies, workspace, heats)
            call opening_changes(bodies, graph, tangent, solution%contact, &
               heat%loads_of_tail(bodies, of_tail), change)
            change(:, 1) = slope*change(:, 1)
            if (bodies%points%vary_with_temperature()) change = change + &
               changes_by_temperature(bodies, heat, workspace, coordinate, of_tail)
            call gains%take(change(free, 1)/scale(free))
         end do
      end associate
   contains
      !> Heats that change conductances as much as conductances change heats.
      subroutine find_heat_scale()
         real(dp) :: by_heat, by_omega

         allocate (friction_heat(size(workspace%friction%heat), 1))
         heat_scale = 1.0_dp
         heats = 0.0_dp
         call find_heated_product([(1.0_dp, k=1, size(heated))])
         by_heat = norm2(change(free, 1)/scale(free))
         heats(free) = rate(free)*scale(free)
         call find_heated_product([(0.0_dp, k=1, size(heated))])
         by_omega = norm2(friction_heat(heated, 1))
         if (min(by_heat, by_omega) > 0.0_dp) heat_scale = sqrt(by_omega/by_heat)
      end subroutine find_heat_scale

      !> The same with heats of friction behind the conductances.
      subroutine find_heated_product(vector)
         real(dp), intent(in) :: vector(:)            ! (heated)
         real(dp), allocatable :: entering(:, :), load(:, :)

         associate (friction => workspace%friction)
            friction_heat = 0.0_dp
            friction_heat(heated, 1) = heat_scale*vector
            entering = friction%entering_part(friction_heat)
            of_tail = tail_of_heats(bodies, workspace, heats, heat%friction_on_tail(bodies, &
               entering(:, 1)))
            load = heat%loads_of_tail(bodies, of_tail)
            if (.not. heat%schur%is_sparse()) load = load + product_of(heat%friction_load, entering)
            call opening_changes(bodies, workspace%pass%graph, tangent, solution%contact, load, &
               change, of_contact)
            change(:, 1) = slope*change(:, 1)
            if (bodies%points%vary_with_temperature()) change = change + &
               changes_by_temperature(bodies, heat, workspace, coordinate, of_tail, friction_heat)
            friction_heat = friction%changes(bodies, solution%contact, of_contact)
         end associate
      end subroutine find_heated_product
   end subroutine find_gains

   !> Moduli in the largest one, none of them 0.
   pure function of_largest(values) result(part)
      real(dp), intent(in) :: values(:)
      real(dp) :: part(size(values))

      part = max(abs(values)/max(maxval(abs(values)), tiny(1.0_dp)), least_part)
   end function of_largest

   !> Whether det(I - U') < 0. The degree of I - U over all solutions is 1, as U is bounded: then
   !> there are at least two others. The conductance of a contact point that rests is that of a law
   !> which is all but vertical there.
   pure logical function is_one_of_several(graph, opening, derivative, resting, by_temperature)
      type(conductance_graph_type), intent(in) :: graph(:)  !! (m) graphs of the conductance
      real(dp), intent(in) :: opening(:)                    !! (m) openings [length]
      !> (m, m) derivative of the openings by the conductances
      real(dp), intent(in) :: derivative(:, :)
      logical, intent(in) :: resting(:)                     !! (m) contact points that rest
      !> (m, m) derivative of the conductances by each other at constant openings, by way of the
      !> temperatures; absent where no law varies with these
      real(dp), intent(in), optional :: by_temperature(:, :)
      real(dp) :: matrix(size(opening), size(opening))
      type(lu_type) :: lu
      logical :: singular
      integer :: k

      do k = 1, size(opening)
         if (resting(k)) then
            matrix(k, :) = -sign(1.0_dp, graph(k)%derivative(-0.5_dp*graph(k)%width))* &
               derivative(k, :)
         else
            matrix(k, :) = -graph(k)%derivative(graph(k)%coordinate_of_opening(opening(k)))* &
               derivative(k, :)
            if (present(by_temperature)) matrix(k, :) = matrix(k, :) - by_temperature(k, :)
            matrix(k, k) = matrix(k, k) + 1.0_dp
         end if
      end do
      call lu%factor(matrix, singular)
      is_one_of_several = .not. singular
      if (is_one_of_several) is_one_of_several = lu%negative_determinant()
   end function is_one_of_several

end module coupled_increment
