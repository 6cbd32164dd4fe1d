!> The instants at which contact points close within an increment, from which their slip counts.
!>
!> The contact points of an interface are ordered by themselves. Let those that close in the
!> increment be relieved of their forces, and all others that are closed in the end hold their
!> positions; those that are part of cycles, whose friction statics leaves open, along the normal.
!> Along the straight way from the start of the increment to where they then would end, one closes
!> first: there its slip starts to count. From there on it holds its position; the others go on the
!> straight way to where they would end now; and so on, until all have closed. Contact points that
!> reach the other face together close together: so a face that closes as a whole does not tilt
!> about one of its points.
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
!> end. Where faces slide they count soon, and for all passes of the solution: pairs of states call
!> for each other more often, and the conductances would swing with them.
!>
!> While all contact points keep their conditions, the instants follow the load. The row of a
!> contact point that closes and sticks, r = (1 - f) (d_t - d_t,i) + a.lambda, has the derivative
!>
!>    dr = (1 - f) dd_t + (a + b).dlambda,
!>
!> with b the derivative of r by lambda through f(lambda) and a(lambda).
module closing_instant
   use active_set, only: solve_contact
   use contact_system, only: closing_law_type, contact_open, contact_slip, contact_state_type, &
      contact_stick, contact_system_type
   use contact_workspace, only: contact_workspace_type
   use dense, only: lu_type, null_space
   use errors, only: error_type
   use kinds, only: dp
   implicit none
   private
   public :: contact_change_type, contact_response, make_tangent, solve_increment

   integer, parameter :: most_passes = 60  !! passes over the closing laws
   !> of these, with the contact points holding that are closed
   integer, parameter :: free_passes = 10
   integer, parameter :: free_placed = 3   !! of these where faces slide
   integer, parameter :: plain_passes = 15 !! of these, going all the way to the new laws
   integer, parameter :: few_halves = 8    !! halves of changes after which it shows if they end
   real(dp), parameter :: lasting = 0.1_dp !! part of the changes that is left then if they do not
   real(dp), parameter :: nothing = 1.0e-12_dp !! part of a compliance or of a motion that is none
   real(dp), parameter :: cancelled = 1.0e-13_dp !! part of a stiffness that is rounding
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

   !> Contact points of an interface on their way through the increment, 2n rows: n normal, then n
   !> tangential ones.
   type :: closing_path_type
      integer :: first = 1                   !! first contact point of the interface
      integer, allocatable :: point(:)       !! (n) the contact points
      logical, allocatable :: is_open(:)     !! (n) whether it has not closed so far
      real(dp), allocatable :: last_gap(:)   !! (n) gap at the end of the increment [length]
      real(dp) :: least_gap = 0.0_dp         !! a gap that is none [length]
      real(dp) :: left = 1.0_dp              !! 1 - f
      real(dp), allocatable :: y(:)          !! (2n) position less that at the end [length]
      real(dp), allocatable :: lambda(:)     !! (2n) forces at the end [force]
      integer, allocatable :: held(:), free(:)  !! h and s: which of the 2n rows
      !> (h, h) K, (s, h) D, (s, s) F and (s) springs that F has
      real(dp), allocatable :: stiffness(:, :), lever(:, :), flexibility(:, :), spring(:)
      logical :: is_loose = .false.          !! whether they alone may hold a body
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
      type(closing_law_type), allocatable :: laws(:)
      logical :: holds(size(state%contact_state))
      real(dp) :: change, swing   ! of the last pass, of the last one before changes are halved
      integer :: free, k, pass

      if (.not. allocated(sticking%closing)) then
         sticking = work%another()
         sticking%closing = closing_law_type()
      end if
      holds = .false.
      free = merge(free_placed, free_passes, work%same_slip > 0.0_dp)
      if (sticking%goes_on_changing) then
         holds = sticking%kept%holds
         free = 0
      end if
      swing = 0.0_dp
      do pass = 1, most_passes
         state%gap = previous%gap
         state%tangential = previous%tangential
         if (allocated(previous%link)) state%link = previous%link
         call solve_contact(system, load, work, state, error)
         if (allocated(error)) return
         if (work%keeps_laws) exit
         holds = state%contact_state /= contact_open .or. (holds .and. pass > free)
         sticking%goes_on_changing = sticking%goes_on_changing .or. (work%same_slip > 0.0_dp .and. &
            any(holds .and. state%contact_state == contact_open))
         sticking%soft = work%soft
         laws = work%closing
         call find_laws(system, previous, state, holds, sticking, laws, error)
         if (allocated(error)) return
         change = maxval([0.0_dp, (law_change(work%closing(k), laws(k), state, k), k=1, &
            size(laws))])
         if (pass > plain_passes) then
            do k = 1, size(laws)
               if (.not. (work%closing(k)%acts .and. laws(k)%acts)) cycle
               laws(k)%fraction = 0.5_dp*(laws(k)%fraction + work%closing(k)%fraction)
               laws(k)%compliance = 0.5_dp*(laws(k)%compliance + work%closing(k)%compliance)
            end do
         end if
         if (change <= max(work%same_slip, work%gap_rounding(system, state))) exit
         if (pass == plain_passes) swing = change
         work%keeps_laws = pass == plain_passes + few_halves .and. change > lasting*swing .or. &
            pass == most_passes
         if (work%keeps_laws) exit
         call move_alloc(laws, work%closing)   ! laws that stay keep the factors
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

   !> Closing laws of the contact points that are closed in the end and were open at the start of
   !> the increment, each interface by itself. A contact point that has opened again keeps its law,
   !> on which nothing depends: without it the contact point might close, with it open, for ever.
   !> Error: a singular system.
   subroutine find_laws(system, previous, state, holds, sticking, laws, error)
      type(contact_system_type), intent(in) :: system
      type(contact_state_type), intent(in) :: previous
      type(contact_state_type), intent(in) :: state
      logical, intent(in) :: holds(:)
      type(contact_workspace_type), intent(inout) :: sticking
      type(closing_law_type), intent(inout) :: laws(:)
      type(error_type), allocatable, intent(out) :: error
      logical :: closes(size(state%contact_state)), is_held(0:system%schur%order)
      integer :: i, k

      closes = previous%contact_state == contact_open .and. holds
      ! The springs of soft faces would seem to hold a body that goes freely until it touches.
      where (closes .and. sticking%soft%stiffness > 0.0_dp .and. system%motions%moves( &
         system%normal)) sticking%soft%is_soft = .false.
      call sticking%keep_holding(holds, size(system%interface_start) - 1)
      if (.not. any(closes .and. system%tangent > 0)) return
      call hold_closed(system, state, sticking, is_held, error)
      if (allocated(error)) return
      do i = 1, size(system%interface_start) - 1
         associate (first => system%interface_start(i), last => system%interface_start(i + 1) - 1)
            if (.not. any(closes(first:last) .and. system%tangent(first:last) > 0)) cycle
            call find_path(system, previous, state, pack([(k, k=first, last)], &
               closes(first:last)), i, is_held, sticking, laws)
         end associate
      end do
   end subroutine find_laws

   !> Factors the set in which all closed contact points hold their positions.
   !> Error: a singular system.
   subroutine hold_closed(system, state, sticking, is_held, error)
      type(contact_system_type), intent(in) :: system
      type(contact_state_type), intent(in) :: state
      type(contact_workspace_type), intent(inout) :: sticking
      logical, intent(out) :: is_held(0:)          ! (tail) whether the set holds a row
      type(error_type), allocatable, intent(out) :: error
      type(contact_state_type) :: holding

      holding = state
      holding%direction = 0
      holding%contact_state = merge(contact_stick, contact_open, sticking%kept%holds)
      where (sticking%kept%holds .and. system%compliance > 0.0_dp) &
         holding%contact_state = contact_slip
      call sticking%factor_set(system, holding, error)
      if (allocated(error)) return
      is_held = [.false., .not. sticking%rows%is_free()]
   end subroutine hold_closed

   !> Closing laws of one interface.
   subroutine find_path(system, previous, state, points, number, is_held, sticking, laws)
      type(contact_system_type), intent(in) :: system
      type(contact_state_type), intent(in) :: previous, state
      integer, intent(in) :: points(:)         ! that close
      integer, intent(in) :: number            ! of the interface
      logical, intent(in) :: is_held(0:)       ! (tail) as from hold_closed
      type(contact_workspace_type), intent(inout) :: sticking
      type(closing_law_type), intent(inout) :: laws(:)
      type(closing_path_type) :: path
      integer :: k

      path%first = system%interface_start(number)
      path%point = points
      allocate (path%is_open(size(path%point)), source=.true.)
      path%last_gap = merge(max(state%gap(path%point), 0.0_dp), 0.0_dp, &
         state%contact_state(path%point) == contact_open)
      path%y = [path%last_gap - max(previous%gap(path%point), 0.0_dp), &
         previous%tangential(path%point) - state%tangential(path%point)]
      path%lambda = [-state%force(path%point), state%shear_force(path%point)]
      path%least_gap = together*max(maxval(previous%gap(path%point)), 0.0_dp) + system%least_length
      associate (n => system%interface_start(number + 1) - path%first)
         do k = 1, size(path%point)
            associate (law => laws(path%point(k)))
               law = closing_law_type(acts=.true., start=previous%tangential(path%point(k)), &
                  first=path%first)
               allocate (law%compliance(2, n), law%rate(2, n), source=0.0_dp)
            end associate
         end do
      end associate
      associate (kept => sticking%kept%compliance(number))
         if (.not. allocated(kept%matrix)) then
            call find_stiffness(system, is_held, sticking, path)
            call go_freely(system, path, laws)
            call find_compliance(path)
            if (all(path%is_open) .and. .not. path%is_loose) kept%matrix = path%compliance
         else
            path%compliance = kept%matrix
         end if
      end associate
      call go_closing(sticking, path, laws)
   end subroutine find_path

   !> From event to event, until all have closed.
   pure subroutine go_closing(sticking, path, laws)
      type(contact_workspace_type), intent(in) :: sticking
      type(closing_path_type), intent(inout) :: path
      type(closing_law_type), intent(inout) :: laws(:)
      integer :: i

      associate (n => size(path%point))
         do i = 1, n
            if (path%is_open(i)) path%compliance(i, i) = path%compliance(i, i) + &
               sticking%soft%compliance(path%point(i), -path%lambda(i))
         end do
         path%own = [(path%compliance(i, i), i=1, 2*n)]
         allocate (path%law(2*n, 2*n), path%rate(2*n, 2*n), source=0.0_dp)
      end associate
      do while (any(path%is_open))
         call go_to_event(path, laws)
      end do
   end subroutine go_closing

   !> Forces and motions of the contact points on their way beside what holds all others. With h the
   !> rows that the set of all holds and s those that it leaves free, of cycles and of soft faces,
   !> unit displacements of h need the forces K and move s by D, unit forces on s move s by F.
   subroutine find_stiffness(system, is_held, sticking, path)
      type(contact_system_type), intent(in) :: system
      logical, intent(in) :: is_held(0:)           ! (tail) as from hold_closed
      type(contact_workspace_type), intent(in) :: sticking
      type(closing_path_type), intent(inout) :: path
      integer, allocatable :: free(:), held(:), near(:)
      real(dp), allocatable :: columns(:, :), forces(:, :), response(:, :)
      integer :: i
      integer :: place(system%schur%order)         ! of near rows; others have none

      path%is_loose = .false.
      associate (rows => [system%normal(path%point), system%tangent(path%point)])
         path%held = pack([(i, i=1, size(rows))], is_held(rows))
         path%free = pack([(i, i=1, size(rows))], rows > 0 .and. .not. is_held(rows))
         held = rows(path%held)
         free = rows(path%free)
      end associate
      near = system%schur%neighbours([held, free])
      place(near) = [(i, i=1, size(near))]
      columns = system%schur%block(near, held)
      allocate (forces(size(near), size(held) + size(free)), source=0.0_dp)
      forces(:, :size(held)) = -columns
      do i = 1, size(free)
         forces(place(free(i)), size(held) + i) = 1.0_dp
      end do
      response = sticking%factors%solve_part(near, forces)
      path%stiffness = columns(place(held), :) + matmul(transpose(columns), &
         response(:, :size(held)))
      ! What is left where stiffnesses cancel is none.
      where (abs(path%stiffness) <= cancelled*maxval([0.0_dp, abs(columns)]))
         path%stiffness = 0.0_dp
      end where
      path%lever = response(place(free), :size(held))
      path%flexibility = response(place(free), size(held) + 1:)
      path%spring = sticking%rows%spring(free)
      if (size(held) > 0) path%is_loose = any(system%motions%moves(held))
   end subroutine find_stiffness

   !> Bodies that nothing else holds go where their forces drive them, until they touch, in no time.
   pure subroutine go_freely(system, path, laws)
      type(contact_system_type), intent(in) :: system
      type(closing_path_type), intent(inout) :: path
      type(closing_law_type), intent(inout) :: laws(:)
      real(dp) :: motion(size(path%y)), length
      real(dp), allocatable :: drive(:), forces(:), unheld(:, :)
      integer, allocatable :: open(:)
      integer :: i, n

      n = size(path%point)
      do while (path%is_loose .and. any(path%is_open))
         open = open_rows(path)
         unheld = null_space(path%stiffness(open, open))
         path%is_loose = size(unheld, 2) > 0
         if (.not. path%is_loose) return
         forces = path%lambda(path%held(open))
         drive = matmul(forces, unheld)
         if (norm2(drive) <= undriven*norm2(forces)) return
         motion = 0.0_dp
         motion(path%held(open)) = -matmul(unheld, drive)/norm2(drive)
         motion(path%free) = matmul(path%lever, motion(path%held))
         associate (reaches => path%is_open .and. motion(:n) > nothing)
            if (.not. any(reaches)) return
            length = max(minval((path%last_gap - path%y(:n))/motion(:n), mask=reaches), 0.0_dp)
         end associate
         path%y = path%y + length*motion
         do i = 1, n
            if (.not. path%is_open(i)) cycle
            if (system%tangent(path%point(i)) > 0) laws(path%point(i))%start = &
               laws(path%point(i))%start + length*motion(n + i)
            if (path%last_gap(i) - path%y(i) <= path%least_gap) path%is_open(i) = .false.
         end do
      end do
   end subroutine go_freely

   !> Those of the held rows whose contact points are open.
   pure function open_rows(path) result(open)
      type(closing_path_type), intent(in) :: path
      integer, allocatable :: open(:)
      integer :: i

      associate (n => size(path%point))
         open = pack([(i, i=1, size(path%held))], [(path%is_open(modulo(path%held(i) - 1, n) + 1), &
            i=1, size(path%held))])
      end associate
   end function open_rows

   !> Compliance of the contact points that are open, relieved of all springs: K^-1 on h, D K^-1
   !> between both, F + D K^-1 D^T on s. Motions that nothing holds or drives do not count.
   subroutine find_compliance(path)
      type(closing_path_type), intent(inout) :: path
      real(dp), allocatable :: inverse(:, :)
      integer, allocatable :: open(:), h(:)
      real(dp) :: relieved(size(path%y), size(path%y))
      integer :: i, n

      n = size(path%point)
      open = open_rows(path)
      inverse = inverse_without(path%stiffness(open, open), path%is_loose)
      relieved = 0.0_dp
      h = path%held(open)
      relieved(h, h) = inverse
      associate (s => path%free, d => path%lever(:, open))
         relieved(s, h) = matmul(d, inverse)
         relieved(h, s) = transpose(relieved(s, h))
         relieved(s, s) = path%flexibility + matmul(relieved(s, h), transpose(d))
         do i = 1, size(s)
            if (.not. path%is_open(modulo(s(i) - 1, n) + 1)) then
               relieved(s(i), :) = 0.0_dp
               relieved(:, s(i)) = 0.0_dp
            else if (path%spring(i) > 0.0_dp) then
               ! What is left of the compliance of the spring, where the spring alone holds a body,
               ! is rounding: the contact point closes at once.
               relieved = relieved + spread(relieved(:, s(i)), 2, 2*n)*spread(relieved(s(i), :), &
                  1, 2*n)/max(1.0_dp/path%spring(i) - relieved(s(i), s(i)), &
                  epsilon(1.0_dp)/path%spring(i))
            end if
         end do
      end associate
      path%compliance = relieved
   end subroutine find_compliance

   !> Inverse of a stiffness, on what its null space leaves where it has one.
   function inverse_without(stiffness, is_loose) result(inverse)
      real(dp), intent(in) :: stiffness(:, :)      ! (n, n)
      logical, intent(in) :: is_loose
      real(dp), allocatable :: inverse(:, :)       ! (n, n)
      real(dp), allocatable :: motions(:, :), rows(:, :), unit(:, :)
      type(lu_type) :: lu
      logical :: singular
      integer :: i, l, n

      n = size(stiffness, 1)
      allocate (motions(n, 0))
      if (is_loose .and. n > 0) motions = null_space(stiffness)
      l = size(motions, 2)
      if (l == n) then
         allocate (inverse(n, n), source=0.0_dp)
         return
      end if
      allocate (rows(n + l, n + l), unit(n + l, n), source=0.0_dp)
      rows(:n, :n) = stiffness
      rows(:n, n + 1:) = motions*maxval([tiny(1.0_dp), abs(stiffness)])
      rows(n + 1:, :n) = transpose(rows(:n, n + 1:))
      do i = 1, n
         unit(i, i) = 1.0_dp
      end do
      call lu%factor(rows, singular)
      call lu%solve(unit)
      inverse = unit(:n, :)
   end function inverse_without

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
         associate (law => laws(path%point(i)), place => path%point - path%first + 1)
            law%fraction = 1.0_dp - path%left
            ! Where nothing but the contact point holds a body, and nothing drives it, it stays.
            if (.not. any(abs(path%law(n + i, :)) > 0.0_dp)) law%fraction = 0.0_dp
            law%compliance(1, place) = path%law(n + i, :n)
            law%compliance(2, place) = path%law(n + i, n + 1:)
            law%rate(1, place) = -path%rate(n + i, :n)
            law%rate(2, place) = -path%rate(n + i, n + 1:)
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

   !> What the change from one law to another makes of a slip.
   pure real(dp) function law_change(old, new, state, k) result(change)
      type(closing_law_type), intent(in) :: old, new
      type(contact_state_type), intent(in) :: state
      integer, intent(in) :: k           !! the contact point

      change = 0.0_dp
      if (old%acts .neqv. new%acts) change = huge(1.0_dp)
      if (.not. (old%acts .and. new%acts)) return
      change = abs(new%fraction - old%fraction)*abs(state%tangential(k) - new%start) + &
         (1.0_dp - new%fraction)*abs(new%start - old%start) + &
         abs(new%lag(state) - old%lag(state))
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
      taken_up = load - system%schur%times(motion)
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
      integer :: i, k

      allocate (change%shear, change%slip, source=0.0_dp*change%gap)
      do k = 1, size(state%contact_state)
         if (state%contact_state(k) == contact_open .or. system%tangent(k) == 0) cycle
         associate (row => system%tangent(k), law => tangent%closing(k))
            change%shear(k, :) = lambda(row, :)
            change%slip(k, :) = motion(row, :)
            if (law%acts) then
               change%slip(k, :) = (1.0_dp - law%fraction)*motion(row, :)
               do i = 1, size(law%rate, 2)
                  associate (factor => law%compliance(:, i) + law%rate(:, i), other => law%first + &
                     i - 1)
                     change%slip(k, :) = change%slip(k, :) + factor(1)*lambda( &
                        system%normal(other), :)
                     if (system%tangent(other) > 0) change%slip(k, :) = change%slip(k, :) + &
                        factor(2)*lambda(system%tangent(other), :)
                  end associate
               end do
            end if
            change%slip(k, :) = change%slip(k, :) + system%compliance(k)*lambda(row, :)
         end associate
      end do
   end subroutine add_slip

   !> The factors of a solution, the instants of closing following its load.
   subroutine make_tangent(system, work, state, tangent, sound)
      type(contact_system_type), intent(in) :: system !! the reduced system
      type(contact_workspace_type), intent(in) :: work !! as its last solution left it
      type(contact_state_type), intent(in) :: state   !! that solution
      type(contact_workspace_type), intent(out) :: tangent
      logical, intent(out) :: sound                   !! whether the derivative exists
      logical :: moves(size(state%contact_state)), singular
      integer :: point(system%schur%order), i, k   ! point: that moves by the row, or 0

      tangent = work
      sound = .true.
      moves = work%closing%acts .and. state%contact_state == contact_stick .and. system%tangent > 0
      if (.not. any(moves)) return
      point = 0
      point(pack(system%tangent, moves)) = pack([(k, k=1, size(moves))], moves)
      associate (forces => tangent%rows%forces, frozen => work%rows%forces)
         call forces%reserve(frozen%count, size(frozen%value))
         do i = 1, size(point)
            if (point(i) == 0) then
               call forces%add(frozen%values_of(i), frozen%coefficients_of(i))
            else
               associate (law => work%closing(point(i)))
                  call system%add_closing(point(i), law%first, law%compliance + law%rate, forces)
               end associate
            end if
         end do
      end associate
      call tangent%factor_rows(system, singular)
      sound = .not. singular
   end subroutine make_tangent

end module closing_instant
