!> A contact state by following a path: all gaps start so wide that nothing touches, and shrink to
!> their own size. The slow and sure way, for active sets that do not settle.
!>
!> With gaps h + t d the conditions (1.6) are piecewise linear in t and the displacements. For large
!> t the only state is the open one; along the path one contact point at a time changes its state,
!> and t may grow for a while before it falls again. Bodies that are held have bounded displacements
!> whatever the friction is, so that the path, which cannot return to where it began, arrives at
!> t = 0 (Lemke's method with its geometric covering vector).
module lemke_path
   use contact_system, only: contact_open, contact_slip, contact_state_type, contact_stick, &
      contact_system_type, is_capped, with_cap
   use contact_workspace, only: contact_workspace_type
   use errors, only: error_type, set_error, status_no_convergence
   use friction_laws, only: unlimited
   use kinds, only: dp
   implicit none
   private
   public :: follow_lemke_path

   integer, parameter :: pieces_per_point = 40  !! changes of state before giving up
   real(dp), parameter :: golden = 0.6180339887498949_dp !! spreads the widths, so that no two tie

   !> A straight piece of the path; columns are values at t = 0 and derivatives by t.
   type :: piece_type
      type(contact_state_type) :: base          !! state at t = 0
      real(dp), allocatable :: cover(:)         !! (m) d, 0 for those that do not follow [length]
      real(dp), allocatable :: slip(:, :)       !! (m, 2) slip [length]
      real(dp), allocatable :: slack(:, :, :)   !! (4, m, 2) what must not be negative
   end type piece_type

contains

   !> Contact state under a condensed load, the references of friction being given, of the contact
   !> points that follow the path. The others keep the rows of their states, whatever comes of it.
   !> Errors: supports and the others do not hold the bodies; the path does not arrive.
   subroutine follow_lemke_path(system, load, work, follows, state, error)
      type(contact_system_type), intent(in) :: system     !! the reduced system
      real(dp), intent(in) :: load(:)                     !! (tail) c [force]
      type(contact_workspace_type), intent(in) :: work    !! gaps, laws, hold
      logical, intent(in) :: follows(:)                   !! (m)
      type(contact_state_type), intent(inout) :: state    !! references in, solution out
      type(error_type), allocatable, intent(out) :: error
      type(contact_workspace_type) :: path
      type(piece_type) :: piece
      real(dp) :: step, t
      integer :: entering, event, k, n, sense

      path = work%another()
      path%hold = work%hold
      piece%cover = [(merge(1.0_dp + modulo(k*golden, 1.0_dp), 0.0_dp, follows(k)), &
         k=1, size(state%contact_state))]
      allocate (piece%slip(size(piece%cover), 2), piece%slack(4, size(piece%cover), 2))
      where (follows)
         state%contact_state = contact_open
         state%direction = 0
      end where
      call solve_piece(system, load, work, path, state, piece, error)
      if (allocated(error)) return
      t = max(maxval(-pack(piece%base%gap, follows)/pack(piece%cover, follows)), 0.0_dp)
      sense = -1
      do n = 1, pieces_per_point*max(count(follows), 1)
         call next_event(piece, t, sense, k, event, step)
         if (sense < 0 .and. step >= t) then
            state = piece%base
            where (state%contact_state == contact_stick) state%direction = 0
            return
         end if
         if (k == 0) exit
         t = t + sense*step
         call change_condition(system, dot_product([1.0_dp, t], piece%slip(k, :)), event, k, &
            state, entering)
         call solve_piece(system, load, work, path, state, piece, error)
         if (allocated(error)) return
         sense = merge(1, -1, piece%slack(entering, k, 2) > 0.0_dp)
      end do
      call set_error(error, status_no_convergence, 'the contact zones do not settle')
   end subroutine follow_lemke_path

   !> Both ends of a piece, with one factorisation.
   !> Error: as solve_set.
   subroutine solve_piece(system, load, work, path, state, piece, error)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: load(:)
      type(contact_workspace_type), intent(in) :: work
      type(contact_workspace_type), intent(inout) :: path
      type(contact_state_type), intent(in) :: state
      type(piece_type), intent(inout) :: piece
      type(error_type), allocatable, intent(out) :: error

      type(contact_state_type) :: rate

      piece%base = state
      path%initial_gap = work%initial_gap
      path%friction%largest_shear = work%friction%largest_shear
      path%closing%start = work%closing%start
      call path%solve_set(system, load, piece%base, error)
      if (allocated(error)) return
      call measure(system, path, work%friction%largest_shear < unlimited, piece%base, &
         piece%slip(:, 1), piece%slack(:, :, 1))
      rate = state
      rate%reference = 0.0_dp
      path%initial_gap = piece%cover
      path%friction%largest_shear = 0.0_dp
      path%closing%start = 0.0_dp
      call path%solve_set(system, 0.0_dp*load, rate, error)
      if (allocated(error)) return
      call measure(system, path, work%friction%largest_shear < unlimited, rate, piece%slip(:, 2), &
         piece%slack(:, :, 2))
   end subroutine solve_piece

   !> The contact point whose state ends first along a piece, 0 for none, and how far away that is.
   pure subroutine next_event(piece, t, sense, first, event, step)
      type(piece_type), intent(in) :: piece
      real(dp), intent(in) :: t
      integer, intent(in) :: sense
      integer, intent(out) :: first, event
      real(dp), intent(out) :: step
      real(dp) :: along, way
      integer :: i, k

      first = 0
      event = 0
      step = huge(1.0_dp)
      do k = 1, size(piece%slip, 1)
         if (piece%cover(k) <= 0.0_dp) cycle   ! it does not follow
         do i = 1, size(piece%slack, 1)
            along = sense*piece%slack(i, k, 2)
            if (along >= 0.0_dp) cycle
            way = max(piece%slack(i, k, 1) + t*piece%slack(i, k, 2), 0.0_dp)/(-along)
            if (way >= step) cycle
            step = way
            first = k
            event = i
         end do
      end do
   end subroutine next_event

   !> Slip, and what must not be negative under each contact point's state: the gap; or force and
   !> slip against friction, and the distance to the largest friction or back to the cone; or the
   !> distances to both sides of the cone and to the largest friction both ways. Those that are
   !> missing are zero.
   pure subroutine measure(system, path, is_limited, state, slip, slack)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(in) :: path
      logical, intent(in) :: is_limited(:)       ! whether friction has a largest force
      type(contact_state_type), intent(in) :: state
      real(dp), intent(out) :: slip(:)
      real(dp), intent(out) :: slack(:, :)
      real(dp) :: cone, largest
      integer :: k

      slack = 0.0_dp
      do k = 1, size(slip)
         slip(k) = path%slip(system, state, k)
         cone = path%friction(k)%coefficient*state%force(k)
         largest = path%friction(k)%largest_shear
         if (state%contact_state(k) == contact_open) then
            if (.not. path%removed(k)) slack(1, k) = state%gap(k)
         else if (state%contact_state(k) == contact_slip) then
            slack(:3, k) = [state%force(k), -state%direction(k)*slip(k), largest - cone]
            if (is_capped(state%direction(k))) slack(3, k) = -slack(3, k)
            if (.not. is_limited(k)) slack(3, k) = 0.0_dp
         else
            slack(:, k) = [cone - state%shear_force(k), cone + state%shear_force(k), &
               largest - state%shear_force(k), largest + state%shear_force(k)]
            if (.not. is_limited(k)) slack(3:, k) = 0.0_dp
         end if
      end do
   end subroutine measure

   !> Gives a contact point the state that follows on the end of its present one.
   pure subroutine change_condition(system, slip, event, k, state, entering)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: slip
      integer, intent(in) :: event
      integer, intent(in) :: k
      type(contact_state_type), intent(inout) :: state
      integer, intent(out) :: entering           !! which slack is zero and must grow

      entering = 1
      select case (state%contact_state(k))
      case (contact_open)
         state%contact_state(k) = contact_slip
         state%direction(k) = 0
         if (system%tangent(k) == 0) return
         state%direction(k) = merge(-1, 1, slip > 0.0_dp)
      case (contact_slip)
         select case (event)
         case (1)
            state%contact_state(k) = contact_open
         case (2)
            state%contact_state(k) = contact_stick
            entering = merge(1, 2, state%direction(k) > 0)
            if (is_capped(state%direction(k))) entering = entering + 2
         case default
            state%direction(k) = with_cap(state%direction(k), .not. is_capped(state%direction(k)))
            entering = 3
         end select
      case default
         state%contact_state(k) = contact_slip
         state%direction(k) = with_cap(merge(1, -1, mod(event, 2) == 1), event > 2)
         entering = 2
      end select
   end subroutine change_condition

end module lemke_path
