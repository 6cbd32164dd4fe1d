!> Contact with friction on the reduced system, the partial solution of (2.4).
!>
!> Unknowns are the relative displacements d = u_xi - u_eta of the pairs, in their own frame; the
!> bodies behind them enter by the Schur complement S and the condensed load c, so that the contact
!> forces on xi are lambda = S d - c. Per pair and direction either the force is known and the
!> displacement sought, or the other way round:
!>
!>    open   lambda_n = 0                            lambda_t = 0
!>    stick  d_n = h                                 d_t = reference
!>    slip   d_n = h                                 lambda_t = direction mu (-lambda_n)
!>
!> A pair that closes within the increment sticks where it closed, a place that depends on its
!> forces (closing_instant):
!>
!>    stick  d_n = h           (1 - f) (d_t - d_t,i) + f (c_n lambda_n + c_t lambda_t) = 0
!>
!> The roles are found by an active set: solve, correct every pair that violates its condition,
!> solve again. A set that comes back is left by correcting only the last offending pair (Murty's
!> least-index rule), which cannot cycle on the P-matrix of a frictionless problem.
!>
!> Where contact alone holds a body, a set may leave it loose. A first guess that does is given up
!> for all pairs closed. A correction that does is taken back, and fewer pairs, the worst ones, are
!> corrected. If even a single pair cannot be taken, the body moves on until another pair stops it: an
!> open one that closes, or a slipping one whose slip would turn. If none does, the body is loose.
module contact_system
   use dense, only: lu_type
   use errors, only: error_type, set_error, status_no_convergence
   use friction, only: next_status
   use kinds, only: dp
   use records, only: status_open, status_slip, status_stick
   implicit none
   private
   public :: contact_system_type, contact_state_type, closing_law_type

   integer, parameter :: most_sets = 200   !! active sets tried before giving up
   real(dp), parameter :: least_motion = 1.0e-8_dp !! part of a motion that is more than rounding

   !> Contact state of all pairs.
   type :: contact_state_type
      integer, allocatable :: status(:)       !! (m) status_open, status_slip or status_stick
      integer, allocatable :: direction(:)    !! (m) sign of the friction force where it slips
      real(dp), allocatable :: reference(:)   !! (m) d_t from which friction counts [length]
      real(dp), allocatable :: gap(:)         !! (m) gamma = h - d_n [length]
      real(dp), allocatable :: tangential(:)  !! (m) d_t [length]
      real(dp), allocatable :: force(:)       !! (m) -lambda_n, positive in compression [force]
      real(dp), allocatable :: shear_force(:) !! (m) lambda_t [force]
   end type contact_state_type

   !> Where a pair that closes within the increment sticks: at the reference d_t - slip, where slip
   !> is the left-hand side of the condition above.
   type :: closing_law_type
      logical :: acts = .false.                !! whether the pair closes in this increment
      real(dp) :: start = 0.0_dp               !! d_t,i [length]
      real(dp) :: fraction = 0.0_dp            !! f, the instant of closing
      real(dp) :: compliance(2) = 0.0_dp       !! c_n, c_t [length/force]
   end type closing_law_type

   !> The reduced system, and the factors for the active set of its last solution.
   type :: contact_system_type
      integer, allocatable :: normal(:)           !! (m) place of d_n on the tail
      integer, allocatable :: tangent(:) !! (m) place of d_t, 0 without friction or held
      real(dp), allocatable :: schur(:, :)        !! (tail, tail) S [force/length]
      real(dp), allocatable :: initial_gap(:)     !! (m) h [length]
      real(dp), allocatable :: friction(:)        !! (m) mu [-]
      type(closing_law_type), allocatable :: closing(:) !! (m) laws of closing pairs
      integer, allocatable :: free(:)             !! places on the tail that are sought
      integer, allocatable :: partner(:) !! (tail) place of d_n whose force enters the row, or 0
      real(dp), allocatable :: share(:)           !! (tail) factor of that force
      real(dp), allocatable :: own(:)             !! (tail) factor of the row's own force
      real(dp), allocatable :: spring(:)          !! (tail) factor of the row's displacement
      type(lu_type) :: lu                         !! factors on the free places
      integer, allocatable :: factored(:)         !! (m) status*3 + direction of the factors
      logical :: loose = .false.                  !! the set factored last leaves a body loose
   contains
      procedure :: solve
      procedure :: solve_free
      procedure :: stiffness
      procedure :: friction_rows
      procedure :: slip
      procedure :: factor_set
      procedure :: forget_factors
   end type contact_system_type

contains

   !> Contact state under a condensed load, the references of friction being given.
   !> Errors: no active set satisfies all conditions; the bodies are not held, and then loose is set
   !> and the status is the one to which all corrections together led.
   subroutine solve(self, load, state, error)
      class(contact_system_type), intent(inout) :: self   !! the reduced system
      real(dp), intent(in) :: load(:)                     !! (tail) c [force]
      type(contact_state_type), intent(inout) :: state    !! guess of the status in, solution out
      type(error_type), allocatable, intent(out) :: error !! see above
      integer :: visited(size(state%status), most_sets)
      real(dp) :: excess(size(state%status))
      integer, allocatable :: loosest(:)
      integer :: next(2, size(state%status)), k, set
      logical :: one_at_a_time

      one_at_a_time = .false.
      call solve_set(self, load, state, error)
      if (allocated(error)) then
         state%status = merge(status_stick, status_slip, self%tangent > 0)
         state%direction = 0
         call solve_set(self, load, state, error)
      end if
      do set = 1, most_sets
         if (allocated(error)) exit
         visited(:, set) = code(state)
         do k = 1, set - 1
            one_at_a_time = one_at_a_time .or. all(visited(:, k) == visited(:, set))
         end do
         call judge(self, load, state, next, excess)
         if (all(excess <= 0.0_dp)) return
         call correct(self, load, next, excess, one_at_a_time, loosest, state, error)
      end do
      if (allocated(loosest)) state%status = loosest
      if (allocated(error)) return
      call set_error(error, status_no_convergence, 'the contact zones do not settle')
   end subroutine solve

   !> Corrects the offending pairs, all of them or one at a time, and solves; as few as it takes to
   !> leave the bodies held.
   !> Error: every correction leaves a body loose.
   subroutine correct(self, load, next, excess, one_at_a_time, loosest, state, error)
      class(contact_system_type), intent(inout) :: self
      real(dp), intent(in) :: load(:)
      integer, intent(in) :: next(:, :)
      real(dp), intent(in) :: excess(:)
      logical, intent(inout) :: one_at_a_time
      integer, allocatable, intent(inout) :: loosest(:) !! status that all corrections would give
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      type(contact_state_type) :: sound
      logical :: chosen(size(excess))
      integer :: k, n

      sound = state
      if (.not. one_at_a_time) then
         n = count(excess > 0.0_dp)
         do while (n > 1)
            chosen = excess > 0.0_dp
            do k = n + 1, count(excess > 0.0_dp)
               chosen(minloc(excess, dim=1, mask=chosen)) = .false.
            end do
            call solve_corrected(self, load, sound, next, chosen, state, error)
            if (.not. allocated(error)) then
               if (count(chosen) == count(excess > 0.0_dp) .and. allocated(loosest)) &
                  deallocate (loosest)
               return
            end if
            if (.not. allocated(loosest)) loosest = state%status
            n = n/2
         end do
      end if
      one_at_a_time = one_at_a_time .or. allocated(error)
      do k = size(excess), 1, -1
         if (excess(k) <= 0.0_dp) cycle
         call solve_corrected(self, load, sound, next, [(n == k, n=1, size(excess))], state, error)
         if (allocated(error)) call stop_motion(self, load, k, state, error)
         if (.not. allocated(error)) return
      end do
      if (.not. allocated(loosest)) loosest = merge(next(1, :), sound%status, excess > 0.0_dp)
   end subroutine correct

   !> Solution with some pairs corrected.
   subroutine solve_corrected(self, load, sound, next, corrected, state, error)
      class(contact_system_type), intent(inout) :: self
      real(dp), intent(in) :: load(:)
      type(contact_state_type), intent(in) :: sound
      integer, intent(in) :: next(:, :)
      logical, intent(in) :: corrected(:)
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error

      state = sound
      where (corrected)
         state%status = next(1, :)
         state%direction = next(2, :)
      end where
      call solve_set(self, load, state, error)
   end subroutine solve_corrected

   !> Lets a body that is loose since a pair was taken from it move on until other pairs hold it.
   !> Error: none does.
   subroutine stop_motion(self, load, taken, state, error)
      class(contact_system_type), intent(inout) :: self
      real(dp), intent(in) :: load(:)
      integer, intent(in) :: taken
      type(contact_state_type), intent(inout) :: state   !! the loose set, values of the one before
      type(error_type), allocatable, intent(inout) :: error
      integer :: k, n

      do n = 1, size(state%status)
         k = stopping_pair(self, state, taken)
         if (k == 0) return
         state%status(k) = merge(status_stick, status_slip, self%tangent(k) > 0)
         state%direction(k) = 0
         call solve_set(self, load, state, error)
         if (.not. allocated(error)) return
      end do
   end subroutine stop_motion

   !> The pair that first stops the motion on which a body sets out when a pair is taken from it; 0
   !> where none does. The motion is the null vector of the set that was factored last.
   pure function stopping_pair(self, state, taken) result(first)
      class(contact_system_type), intent(in) :: self
      type(contact_state_type), intent(in) :: state   !! the loose set, values of the one before it
      integer, intent(in) :: taken                    !! the pair
      integer :: first
      real(dp) :: motion(size(self%schur, 1)), sense, way, nearest, distance
      integer :: k

      first = 0
      motion = 0.0_dp
      motion(self%free) = self%lu%null_vector()
      if (state%status(taken) == status_open) then
         sense = -motion(self%normal(taken))
      else if (self%tangent(taken) == 0) then
         return
      else
         sense = -state%direction(taken)*motion(self%tangent(taken))
      end if
      if (abs(sense) <= least_motion*maxval(abs(motion))) return
      motion = sign(1.0_dp, sense)*motion/maxval(abs(motion))
      nearest = huge(1.0_dp)
      do k = 1, size(state%status)
         if (k == taken .or. state%status(k) == status_stick) cycle
         if (state%status(k) == status_open) then
            way = motion(self%normal(k))
            distance = max(state%gap(k), 0.0_dp)
         else
            if (self%tangent(k) == 0) cycle
            way = state%direction(k)*motion(self%tangent(k))
            distance = abs(self%slip(state, k))
         end if
         if (way <= least_motion .or. distance >= nearest*way) cycle
         nearest = distance/way
         first = k
      end do
   end function stopping_pair

   !> What status each pair should have, and by how much it violates the present one.
   subroutine judge(self, load, state, next, excess)
      class(contact_system_type), intent(in) :: self
      real(dp), intent(in) :: load(:)
      type(contact_state_type), intent(in) :: state
      integer, intent(out) :: next(:, :)
      real(dp), intent(out) :: excess(:)
      real(dp) :: gap_tolerance, force_tolerance
      integer :: k

      gap_tolerance = 1.0e-13_dp*max(maxval(abs(state%gap)), maxval(abs(self%initial_gap)), &
         maxval(abs(state%tangential))) + tiny(1.0_dp)
      force_tolerance = max(1.0e-12_dp*maxval(abs(state%force)), &
         1.0e-13_dp*largest_term(self, load, state)) + tiny(1.0_dp)
      next(1, :) = state%status
      next(2, :) = state%direction
      do k = 1, size(state%status)
         call next_status(next(1, k), next(2, k), state%gap(k), state%force(k), &
            state%shear_force(k), self%slip(state, k), self%friction(k), &
            self%tangent(k) > 0, gap_tolerance, force_tolerance, excess(k))
      end do
   end subroutine judge

   !> Largest sum of the terms of which a contact force is made, S d - c, without their signs: what
   !> its rounding goes by where the terms cancel, as in a body that contact moves as a whole.
   pure function largest_term(self, load, state) result(force)
      class(contact_system_type), intent(in) :: self
      real(dp), intent(in) :: load(:)
      type(contact_state_type), intent(in) :: state
      real(dp) :: force
      real(dp) :: terms(size(load))
      integer :: k

      terms = abs(load)
      do k = 1, size(state%status)
         terms = terms + abs(self%schur(:, self%normal(k))*(self%initial_gap(k) - state%gap(k)))
         if (self%tangent(k) == 0) cycle
         terms = terms + abs(self%schur(:, self%tangent(k))*state%tangential(k))
      end do
      force = maxval(terms)
   end function largest_term

   !> Tangential motion of a pair since friction acts on it in this increment.
   pure function slip(self, state, k)
      class(contact_system_type), intent(in) :: self    !! the reduced system
      type(contact_state_type), intent(in) :: state     !! contact state
      integer, intent(in) :: k                          !! the pair
      real(dp) :: slip                                  !! [length]

      associate (law => self%closing(k))
         if (law%acts) then
            slip = (1.0_dp - law%fraction)*(state%tangential(k) - law%start) + law%fraction* &
               dot_product(law%compliance, [-state%force(k), state%shear_force(k)])
         else
            slip = state%tangential(k) - state%reference(k)
         end if
      end associate
   end function slip

   !> Solution for one active set.
   subroutine solve_set(self, load, state, error)
      class(contact_system_type), intent(inout) :: self
      real(dp), intent(in) :: load(:)
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: d(size(load)), lambda(size(load)), residual(size(load), 1)
      integer :: k

      call factor_set(self, state, error)
      if (allocated(error)) return
      d = 0.0_dp
      do k = 1, size(state%status)
         if (state%status(k) == status_open) cycle
         d(self%normal(k)) = self%initial_gap(k)
         if (self%tangent(k) == 0 .or. state%status(k) /= status_stick) cycle
         d(self%tangent(k)) = merge(self%closing(k)%start, state%reference(k), self%closing(k)%acts)
      end do
      residual(:, 1) = load - matmul(self%schur, d)
      call self%solve_free(residual)
      d(self%free) = d(self%free) + residual(self%free, 1)
      lambda = matmul(self%schur, d) - load
      do k = 1, size(state%status)
         state%gap(k) = self%initial_gap(k) - d(self%normal(k))
         state%force(k) = -lambda(self%normal(k))
         if (state%status(k) == status_open) then
            state%force(k) = 0.0_dp
         else
            state%gap(k) = 0.0_dp
         end if
         if (self%tangent(k) == 0) cycle
         state%tangential(k) = d(self%tangent(k))
         select case (state%status(k))
         case (status_open)
            state%shear_force(k) = 0.0_dp
         case (status_slip)
            state%shear_force(k) = state%direction(k)*self%friction(k)*state%force(k)
         case default
            state%shear_force(k) = lambda(self%tangent(k))
         end select
      end do
   end subroutine solve_set

   !> Factors the system of an active set, unless that is the set factored last.
   !> Error: the bodies are not held.
   subroutine factor_set(self, state, error)
      class(contact_system_type), intent(inout) :: self   !! the reduced system
      type(contact_state_type), intent(in) :: state       !! statuses and directions
      type(error_type), allocatable, intent(out) :: error !! see above
      real(dp), allocatable :: rows(:, :)
      integer :: i

      if (allocated(self%factored)) then
         if (all(self%factored == code(state))) return
      end if
      self%factored = code(state)
      call list_free(self, state)
      rows = self%friction_rows(self%schur(:, self%free))
      rows = rows(self%free, :)
      do i = 1, size(self%free)
         rows(i, i) = rows(i, i) + self%spring(self%free(i))
      end do
      call self%lu%factor(rows, self%loose)
      if (.not. self%loose) return
      call self%forget_factors()
      call set_error(error, status_no_convergence, &
         'the bodies are not held by their supports and the pairs that are in contact')
   end subroutine factor_set

   !> Makes the next solution factor anew, because a closing law has changed.
   pure subroutine forget_factors(self)
      class(contact_system_type), intent(inout) :: self  !! the reduced system

      if (allocated(self%factored)) deallocate (self%factored)
   end subroutine forget_factors

   !> Lists the relative displacements that are sought, and what forces and displacements enter the
   !> row of each.
   subroutine list_free(self, state)
      class(contact_system_type), intent(inout) :: self
      type(contact_state_type), intent(in) :: state
      integer :: places(2*size(state%status)), k, n

      self%partner = [(0, k=1, size(self%schur, 1))]
      self%share = [(0.0_dp, k=1, size(self%schur, 1))]
      self%own = 1.0_dp + self%share
      self%spring = self%share
      n = 0
      do k = 1, size(state%status)
         if (state%status(k) == status_open) call seek(self%normal(k))
         if (self%tangent(k) == 0) cycle
         associate (place => self%tangent(k), law => self%closing(k))
            if (state%status(k) == status_open) then
               call seek(place)
            else if (state%status(k) == status_slip) then
               call seek(place)
               self%partner(place) = self%normal(k)
               self%share(place) = state%direction(k)*self%friction(k)
            else if (law%acts) then
               call seek(place)
               self%partner(place) = self%normal(k)
               self%own(place) = law%fraction
               self%share(place) = law%fraction*law%compliance(1)/law%compliance(2)
               self%spring(place) = (1.0_dp - law%fraction)/law%compliance(2)
            end if
         end associate
      end do
      self%free = places(:n)
   contains
      subroutine seek(place)
         integer, intent(in) :: place

         n = n + 1
         places(n) = place
      end subroutine seek
   end subroutine list_free

   !> Forces, or columns of S, as they enter the rows of the active set: a slipping pair's
   !> tangential row is lambda_t + share*lambda_n = 0.
   pure function friction_rows(self, columns) result(rows)
      class(contact_system_type), intent(in) :: self  !! the reduced system
      real(dp), intent(in) :: columns(:, :)           !! (tail, columns)
      real(dp) :: rows(size(columns, 1), size(columns, 2))
      integer :: i

      do i = 1, size(columns, 1)
         rows(i, :) = self%own(i)*columns(i, :)
         if (self%partner(i) == 0) cycle
         rows(i, :) = rows(i, :) + self%share(i)*columns(self%partner(i), :)
      end do
   end function friction_rows

   !> Free displacements that take up forces, with the factors of the last active set.
   pure subroutine solve_free(self, x)
      class(contact_system_type), intent(in) :: self  !! the reduced system
      real(dp), intent(inout) :: x(:, :) !! (tail, columns) forces; displacements in free rows
      real(dp), allocatable :: rows(:, :)

      if (size(self%free) == 0) return
      rows = self%friction_rows(x)
      rows = rows(self%free, :)
      call self%lu%solve(rows)
      x(self%free, :) = rows
   end subroutine solve_free

   !> Forces at some places of the tail for unit displacements there, the free ones following; with
   !> the factors of the last active set. Source: (2.4), statically condensed.
   pure function stiffness(self, places) result(forces)
      class(contact_system_type), intent(in) :: self        !! the reduced system
      integer, intent(in) :: places(:)                      !! (n) places that are not free
      real(dp) :: forces(size(places), size(places))        !! (n, n) [force/length]
      real(dp) :: response(size(self%schur, 1), size(places))

      response = -self%schur(:, places)
      call self%solve_free(response)
      forces = self%schur(places, places) + &
         matmul(self%schur(places, self%free), response(self%free, :))
   end function stiffness

   !> One number per pair for its contact condition.
   pure function code(state) result(codes)
      type(contact_state_type), intent(in) :: state
      integer :: codes(size(state%status))

      codes = 3*state%status
      where (state%status == status_slip) codes = codes + state%direction
   end function code

end module contact_system
