!> The instants at which contact points close within an increment, from which their slip counts.
!>
!> Let all contact points that close in the increment be relieved of their forces, and all others
!> that are closed hold their positions. Along the straight way from the start of the increment to
!> where they then would end, one closes first: there its slip starts to count. From there on it
!> holds its position; the others go on the straight way to where they would end now; and so on,
!> until all have closed. Contact points that reach the other face together close together: so a
!> face that closes as a whole does not tilt about one of its points.
!>
!> Let y be the positions d less those at the end of the increment, C_R the compliance of the
!> contact points that are still open, and phi the part of the remaining way after which the next
!> one closes. They would end at y = -C_R lambda, so that at each event
!>
!>    y := (1 - phi) y - phi C_R lambda,   1 - f := (1 - phi) (1 - f),
!>
!> and slip = -y_t = (1 - f) (d_t - d_t,i) + a.lambda is linear once f and the row a of A are
!> frozen, A := (1 - phi) A + phi C_R. Both are computed anew from each solution, until they stay.
!> They follow the load alone where all closed contact points stick, whatever their friction.
!>
!> Soft faces that close count with their overlap: y is that of their bodies and their overlap
!> together, C_R their compliance likewise, and other soft faces that are closed give way.
!>
!> A body that nothing else holds goes straight to where it touches, in no time: f = 0, and d_t,i is
!> where it then is.
!>
!> Where the contact points that hold go on changing, every one that was closed on the way counts as
!> one that holds. Then C stays, and only f can go on swinging; of each change half is made in the
!> end.
!>
!> While all contact points keep their conditions, the instants follow the load. The row of a
!> contact point that closes and sticks, r = (1 - f) (d_t - d_t,i) + a.lambda, has the derivative
!>
!>    dr = (1 - f) dd_t + (a + b).dlambda,
!>
!> with b the derivative of r by lambda through f(lambda) and a(lambda).
module closing_instant
   use active_set, only: solve_contact
   use contact_system, only: closing_law_type, contact_open, contact_state_type, contact_stick, &
      contact_system_type
   use contact_workspace, only: contact_workspace_type
   use dense, only: product_of
   use errors, only: error_type
   use kinds, only: dp
   implicit none
   private
   public :: contact_change_type, contact_response, make_tangent, solve_increment

   integer, parameter :: most_passes = 60  !! passes over the closing laws
   !> of these, with the contact points holding that are closed
   integer, parameter :: free_passes = 10
   integer, parameter :: plain_passes = 15 !! of these, going all the way to the new laws
   integer, parameter :: few_halves = 8    !! halves of changes after which it shows if they end
   real(dp), parameter :: lasting = 0.1_dp !! part of the changes that is left then if they do not
   real(dp), parameter :: settled = 1.0e-13_dp !! relative change of a law that counts as none
   real(dp), parameter :: rounding = 1.0e-10_dp   !! the same where it does not come down to that
   real(dp), parameter :: nothing = 1.0e-12_dp !! part of a compliance or of a motion that is none
   real(dp), parameter :: undriven = 1.0e-10_dp !! part of the forces that drives no motion
   real(dp), parameter :: together = 1.0e-12_dp !! part of the largest gap that is none at an event

   !> Changes of a contact state, a column for each change of its load.
   type :: contact_change_type
      real(dp), allocatable :: gap(:, :)      !! (m, n) of the gaps [length]
      real(dp), allocatable :: force(:, :)    !! (m, n) of the compressive forces [force]
      !> (m, n) of the shear forces, and of the slip in the increment; where they are asked for
      real(dp), allocatable :: shear(:, :), slip(:, :)
      real(dp), allocatable :: motion(:, :)   !! (tail, n) of the unknowns, where slip is asked for
   end type contact_change_type

   !> Contact points on their way through the increment, 2n rows: n normal, then n tangential ones.
   type :: closing_path_type
      integer, allocatable :: point(:)       !! (n) the contact points
      logical, allocatable :: is_open(:)     !! (n) whether it has not closed so far
      real(dp), allocatable :: last_gap(:)   !! (n) gap at the end of the increment [length]
      real(dp) :: least_gap = 0.0_dp         !! a gap that is none [length]
      real(dp) :: left = 1.0_dp              !! 1 - f
      real(dp), allocatable :: y(:)          !! (2n) position less that at the end [length]
      real(dp), allocatable :: lambda(:)     !! (2n) forces at the end [force]
      real(dp), allocatable :: compliance(:, :) !! (2n, 2n) C_R [length/force]
      real(dp), allocatable :: own(:)        !! (2n) diagonal of the first C_R [length/force]
      real(dp), allocatable :: law(:, :)     !! (2n, 2n) A [length/force]
      real(dp), allocatable :: rate(:, :)    !! (2n, 2n) dy/dlambda through all phi [length/force]
   end type closing_path_type

contains

   !> Contact state at the end of an increment, with the references of the contact points that close
   !> in it. Only the states of the guess count: where bodies are unconstrained, the motion is the
   !> least one from the start of the increment. The workspace may have laws of an earlier pass; a
   !> pass that fails leaves none.
   !> Error: as solve_contact.
   subroutine solve_increment(system, previous, load, work, sticking, state, error)
      type(contact_system_type), intent(in) :: system     !! the reduced system
      type(contact_state_type), intent(in) :: previous    !! state at the start of the increment
      real(dp), intent(in) :: load(:)                     !! (tail) condensed load [force]
      type(contact_workspace_type), intent(inout) :: work !! laws and factors of the solution out
      !> Factors of the set whose closed contact points all hold their positions: a fresh one, or
      !> that of an earlier pass of the increment.
      type(contact_workspace_type), intent(inout) :: sticking
      type(contact_state_type), intent(inout) :: state    !! guess in, solution out
      type(error_type), allocatable, intent(out) :: error

      call settle_laws(system, previous, load, work, sticking, state, error)
      if (.not. allocated(error)) return
      work%closing = closing_law_type()
      work%keeps_laws = .false.
   end subroutine solve_increment

   !> Solves with frozen closing laws until they stay.
   subroutine settle_laws(system, previous, load, work, sticking, state, error)
      type(contact_system_type), intent(in) :: system
      type(contact_state_type), intent(in) :: previous
      real(dp), intent(in) :: load(:)
      type(contact_workspace_type), intent(inout) :: work, sticking
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      type(closing_law_type) :: laws(size(state%contact_state))
      logical :: holds(size(state%contact_state))
      real(dp) :: change, swing   ! of the last pass, of the last one before changes are halved
      integer :: k, pass

      if (.not. allocated(sticking%closing)) then
         sticking = work%another()
         sticking%closing = closing_law_type()
      end if
      holds = .false.
      swing = 0.0_dp
      do pass = 1, most_passes
         state%gap = previous%gap
         state%tangential = previous%tangential
         call solve_contact(system, load, work, state, error)
         if (allocated(error)) return
         if (work%keeps_laws) exit
         holds = state%contact_state /= contact_open .or. (holds .and. pass > free_passes)
         sticking%soft = work%soft
         laws = work%closing
         call find_laws(system, previous, state, holds, sticking, laws, error)
         if (allocated(error)) return
         change = maxval([0.0_dp, law_change(work%closing, laws, system%alone)])
         if (pass > plain_passes) then
            do k = 1, size(laws)
               if (.not. (work%closing(k)%acts .and. laws(k)%acts)) cycle
               laws(k)%fraction = 0.5_dp*(laws(k)%fraction + work%closing(k)%fraction)
               laws(k)%compliance = 0.5_dp*(laws(k)%compliance + work%closing(k)%compliance)
            end do
         end if
         if (change <= merge(settled, rounding, pass <= free_passes)) exit
         if (pass == plain_passes) swing = change
         work%keeps_laws = pass == plain_passes + few_halves .and. change > lasting*swing .or. &
            pass == most_passes
         if (work%keeps_laws) exit
         work%closing = laws   ! laws that stay keep the factors
      end do
      ! Laws that never settle belong to states that call for each other. The last ones are kept,
      ! for other conductances, too: else the fixed point would go from the one to the other.
      work%several = work%several .or. work%keeps_laws
      do k = 1, size(state%contact_state)
         if (work%closing(k)%acts .and. state%contact_state(k) /= contact_open) then
            state%reference(k) = state%tangential(k) - work%slip(system, state, k)
         end if
      end do
      ! An active set satisfies its conditions to rounding.
      where (.not. work%removed) state%gap = max(state%gap, 0.0_dp)
   end subroutine settle_laws

   !> Closing laws of the contact points that are closed now and were open at the start of the
   !> increment. A contact point that has opened again keeps its law, on which nothing depends:
   !> without it the contact point might close, with it open, for ever.
   !> Error: a singular system.
   subroutine find_laws(system, previous, state, holds, sticking, laws, error)
      type(contact_system_type), intent(in) :: system
      type(contact_state_type), intent(in) :: previous
      type(contact_state_type), intent(in) :: state
      logical, intent(in) :: holds(:)
      type(contact_workspace_type), intent(inout) :: sticking
      type(closing_law_type), intent(inout) :: laws(:)
      type(error_type), allocatable, intent(out) :: error
      type(contact_state_type) :: sticking_state
      type(closing_path_type) :: path
      logical :: closes(size(state%contact_state))
      integer :: k

      closes = previous%contact_state == contact_open .and. holds
      if (.not. any(closes .and. system%tangent > 0)) return
      sticking_state = state
      sticking_state%contact_state = merge(contact_stick, contact_open, holds .and. &
         previous%contact_state /= contact_open)
      path%point = pack([(k, k=1, size(closes))], closes)
      allocate (path%is_open(size(path%point)), source=.true.)
      path%last_gap = merge(max(state%gap(path%point), 0.0_dp), 0.0_dp, &
         state%contact_state(path%point) == contact_open)
      path%y = [path%last_gap - max(previous%gap(path%point), 0.0_dp), &
         previous%tangential(path%point) - state%tangential(path%point)]
      path%lambda = [-state%force(path%point), state%shear_force(path%point)]
      path%least_gap = together*max(maxval(previous%gap(path%point)), 0.0_dp) + system%least_length
      do k = 1, size(path%point)
         associate (law => laws(path%point(k)))
            law = closing_law_type(acts=.true., start=previous%tangential(path%point(k)))
            allocate (law%compliance(2, size(closes)), law%rate(2, size(closes)), source=0.0_dp)
         end associate
      end do
      call go_freely(system, sticking, sticking_state, path, laws, error)
      if (allocated(error)) return
      if (.not. any(path%is_open)) return
      call find_compliance(system, sticking, path)
      do while (any(path%is_open))
         call go_to_event(path, laws)
      end do
   end subroutine find_laws

   !> Bodies that nothing holds go where their forces drive them, until they touch, in no time.
   !> Error: a singular system.
   subroutine go_freely(system, sticking, sticking_state, path, laws, error)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(inout) :: sticking  !! factors at the end of the way out
      type(contact_state_type), intent(inout) :: sticking_state
      type(closing_path_type), intent(inout) :: path
      type(closing_law_type), intent(inout) :: laws(:)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: forces(2, size(laws)), on_tail(size(system%schur, 1))
      real(dp) :: motion(size(path%y)), length
      real(dp), allocatable :: drive(:)
      integer :: i, n

      n = size(path%point)
      do
         call sticking%factor_set(system, sticking_state, error)
         if (allocated(error)) return
         if (size(sticking%unconstrained, 2) == 0 .or. .not. any(path%is_open)) return
         forces = 0.0_dp
         forces(1, path%point) = path%lambda(:n)
         forces(2, path%point) = path%lambda(n + 1:)
         on_tail = system%on_tail(forces)
         associate (free => sticking%rows%free, unheld => sticking%unconstrained)
            drive = matmul(on_tail(free), unheld)
            if (norm2(drive) <= undriven*norm2(on_tail)) return
            on_tail = 0.0_dp
            on_tail(free) = -matmul(unheld, drive)/norm2(drive)
         end associate
         motion(:n) = on_tail(system%normal(path%point))
         motion(n + 1:) = 0.0_dp
         do i = 1, n
            if (system%tangent(path%point(i)) > 0) motion(n + i) = &
               on_tail(system%tangent(path%point(i)))
         end do
         associate (reaches => path%is_open .and. motion(:n) > nothing)
            if (.not. any(reaches)) return
            length = max(minval((path%last_gap - path%y(:n))/motion(:n), mask=reaches), 0.0_dp)
         end associate
         path%y = path%y + length*motion
         do i = 1, n
            if (.not. path%is_open(i)) cycle
            laws(path%point(i))%start = laws(path%point(i))%start + length*motion(n + i)
            if (path%last_gap(i) - path%y(i) > path%least_gap) cycle
            path%is_open(i) = .false.
            sticking_state%contact_state(path%point(i)) = contact_stick
         end do
      end do
   end subroutine go_freely

   !> Compliance of the contact points on their way, while all others that are closed hold their
   !> positions.
   pure subroutine find_compliance(system, sticking, path)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(inout) :: sticking   !! factors
      type(closing_path_type), intent(inout) :: path
      integer :: i, j, n, rows(2, size(path%point))
      real(dp) :: response(size(system%schur, 1), 2)

      n = size(path%point)
      rows(1, :) = system%normal(path%point)
      rows(2, :) = system%tangent(path%point)
      allocate (path%compliance(2*n, 2*n), path%law(2*n, 2*n), path%rate(2*n, 2*n), source=0.0_dp)
      if (.not. allocated(sticking%point_compliance)) allocate ( &
         sticking%point_compliance(size(system%normal)))
      do j = 1, n
         if (.not. path%is_open(j)) cycle
         associate (point_compliance => sticking%point_compliance(path%point(j)))
            if (.not. allocated(point_compliance%response)) then
               response = 0.0_dp
               response(rows(1, j), 1) = 1.0_dp
               if (rows(2, j) > 0) response(rows(2, j), 2) = 1.0_dp
               call sticking%solve_free(response)
               point_compliance%response = response
               sticking%compliances_found = sticking%compliances_found + 1
            end if
            do i = 1, n
               if (.not. path%is_open(i)) cycle
               path%compliance(i, [j, n + j]) = point_compliance%response(rows(1, i), :)
               if (rows(2, i) > 0) path%compliance(n + i, [j, n + j]) = &
                  point_compliance%response(rows(2, i), :)
            end do
            path%compliance(j, j) = path%compliance(j, j) + &
               sticking%soft%compliance(path%point(j), -path%lambda(j))
         end associate
      end do
      path%own = [(path%compliance(i, i), i=1, 2*n)]
   end subroutine find_compliance

   !> Goes on until the next contact points close, which have their laws then.
   pure subroutine go_to_event(path, laws)
      type(closing_path_type), intent(inout) :: path
      type(closing_law_type), intent(inout) :: laws(:)
      real(dp) :: ends(size(path%y)), slope(size(path%y)), gap(size(path%point)), part, trial
      integer :: first, i, n

      n = size(path%point)
      ends = -matmul(path%compliance, path%lambda)
      gap = max(path%last_gap - path%y(:n), 0.0_dp)
      first = 0
      part = 1.0_dp
      do i = 1, n
         if (.not. path%is_open(i) .or. ends(i) <= path%last_gap(i)) cycle
         trial = gap(i)/(gap(i) + (ends(i) - path%last_gap(i)))
         if (trial >= part) cycle
         part = trial
         first = i
      end do
      slope = 0.0_dp
      if (first > 0) slope = (part*path%compliance(first, :) + (1.0_dp - part)* &
         (path%law(first, :) - path%rate(first, :)))/(ends(first) - path%y(first))
      do i = 1, 2*n
         path%rate(:, i) = (1.0_dp - part)*path%rate(:, i) + (ends - path%y)*slope(i)
      end do
      path%law = (1.0_dp - part)*path%law + part*path%compliance
      path%y = (1.0_dp - part)*path%y + part*ends
      path%left = (1.0_dp - part)*path%left
      do i = 1, n
         if (.not. path%is_open(i)) cycle
         if (first > 0 .and. i /= first .and. path%last_gap(i) - path%y(i) > path%least_gap) cycle
         associate (law => laws(path%point(i)))
            law%fraction = 1.0_dp - path%left
            law%compliance(1, path%point) = path%law(n + i, :n)
            law%compliance(2, path%point) = path%law(n + i, n + 1:)
            law%rate(1, path%point) = -path%rate(n + i, :n)
            law%rate(2, path%point) = -path%rate(n + i, n + 1:)
         end associate
         path%is_open(i) = .false.
         call hold(path, i)
         call hold(path, n + i)
      end do
   end subroutine go_to_event

   !> Holds a row where it is. One that the others hold has no compliance left.
   pure subroutine hold(path, row)
      type(closing_path_type), intent(inout) :: path
      integer, intent(in) :: row
      real(dp) :: column(size(path%y)), line(size(path%y))
      integer :: j

      column = path%compliance(:, row)
      line = path%compliance(row, :)
      if (column(row) > nothing*path%own(row)) then
         do j = 1, size(line)
            if (abs(line(j)) > 0.0_dp) path%compliance(:, j) = path%compliance(:, j) - &
               column*(line(j)/column(row))
         end do
      end if
      path%compliance(:, row) = 0.0_dp
      path%compliance(row, :) = 0.0_dp
   end subroutine hold

   !> Change from one law to another; of compliances beside that of the contact point alone.
   elemental function law_change(old, new, alone) result(change)
      type(closing_law_type), intent(in) :: old, new
      real(dp), intent(in) :: alone      !! stiffness of the contact point [force/length]
      real(dp) :: change

      change = 0.0_dp
      if (old%acts .neqv. new%acts) change = 1.0_dp
      if (.not. (old%acts .and. new%acts)) return
      change = max(abs(new%fraction - old%fraction), &
         alone*maxval(abs(new%compliance - old%compliance)))
   end function law_change

   !> Changes of the contact with the condensed load, one column a change of load.
   pure subroutine contact_response(system, tangent, state, load, change, with_slip)
      type(contact_system_type), intent(in) :: system !! the reduced system
      type(contact_workspace_type), intent(in) :: tangent !! of the state, as make_tangent left it
      type(contact_state_type), intent(in) :: state   !! a solution
      real(dp), intent(in) :: load(:, :)              !! (tail, n) changes of c [force]
      type(contact_change_type), intent(out) :: change
      logical, intent(in) :: with_slip                !! whether shear and slip are asked for
      real(dp), dimension(size(load, 1), size(load, 2)) :: taken_up, motion
      integer :: k

      taken_up = load
      call tangent%solve_free(taken_up)
      motion = 0.0_dp
      motion(tangent%rows%free, :) = taken_up(tangent%rows%free, :)
      taken_up = load - product_of(system%schur, motion)
      associate (m => size(state%contact_state), n => size(load, 2))
         allocate (change%gap(m, n), change%force(m, n), source=0.0_dp)
         do k = 1, m
            associate (row => system%normal(k))
               if (state%contact_state(k) == contact_open) then
                  change%gap(k, :) = -motion(row, :)
               else
                  change%force(k, :) = taken_up(row, :)
               end if
            end associate
         end do
      end associate
      if (.not. with_slip) return
      call add_slip(system, tangent, state, motion, -taken_up, change)
      change%motion = motion
   end subroutine contact_response

   !> Changes of shear and slip.
   pure subroutine add_slip(system, tangent, state, motion, lambda, change)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(in) :: tangent
      type(contact_state_type), intent(in) :: state
      real(dp), intent(in) :: motion(:, :), lambda(:, :)   ! (tail, n) changes of d and of forces
      type(contact_change_type), intent(inout) :: change
      integer :: k

      allocate (change%shear, change%slip, source=0.0_dp*change%gap)
      do k = 1, size(state%contact_state)
         if (state%contact_state(k) == contact_open .or. system%tangent(k) == 0) cycle
         associate (row => system%tangent(k), law => tangent%closing(k))
            change%shear(k, :) = lambda(row, :)
            change%slip(k, :) = motion(row, :)
            if (law%acts) change%slip(k, :) = (1.0_dp - law%fraction)*motion(row, :) + &
               matmul(system%on_tail(law%compliance + law%rate), lambda)
            change%slip(k, :) = change%slip(k, :) + system%compliance(k)*lambda(row, :)
         end associate
      end do
   end subroutine add_slip

   !> The factors of a solution, the instants of closing following its load.
   pure subroutine make_tangent(system, work, state, tangent, sound)
      type(contact_system_type), intent(in) :: system !! the reduced system
      type(contact_workspace_type), intent(in) :: work !! as its last solution left it
      type(contact_state_type), intent(in) :: state   !! that solution
      type(contact_workspace_type), intent(out) :: tangent
      logical, intent(out) :: sound                   !! whether the derivative exists
      logical :: moves(size(state%contact_state)), singular
      integer :: c, k

      tangent = work
      sound = .true.
      moves = work%closing%acts .and. state%contact_state == contact_stick .and. system%tangent > 0
      if (.not. any(moves)) return
      do k = 1, size(moves)
         if (.not. moves(k)) cycle
         c = findloc(tangent%rows%closing, system%tangent(k), dim=1)
         tangent%rows%arm(c, :) = tangent%rows%arm(c, :) + system%alone(k)*system%on_tail( &
            work%closing(k)%rate)
      end do
      call tangent%factor_rows(system, singular)
      sound = .not. singular
   end subroutine make_tangent

end module closing_instant
