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
!> Pairs that form rings have the forces of their links (ring_links) among the unknowns, on which
!> nothing else acts; where such a pair sticks it gives a little: d_t + give lambda_t takes the
!> place of d_t.
module contact_system
   use dense, only: lu_type
   use errors, only: error_type, set_error, status_no_convergence
   use kinds, only: dp
   use records, only: status_open, status_slip, status_stick
   implicit none
   private
   public :: contact_system_type, contact_state_type, closing_law_type, condition_code

   !> Contact state of all pairs.
   type :: contact_state_type
      integer, allocatable :: status(:)       !! (m) status_open, status_slip or status_stick
      integer, allocatable :: direction(:)    !! (m) sign of the friction force where it slips
      real(dp), allocatable :: reference(:)   !! (m) d_t from which friction counts [length]
      real(dp), allocatable :: gap(:)         !! (m) gamma = h - d_n [length]
      real(dp), allocatable :: tangential(:)  !! (m) d_t [length]
      real(dp), allocatable :: force(:)       !! (m) -lambda_n, positive in compression [force]
      real(dp), allocatable :: shear_force(:) !! (m) lambda_t [force]
      real(dp), allocatable :: link(:)        !! (links) what holds rings together [length]
   end type contact_state_type

   !> Where a pair that closes within the increment sticks: at the reference d_t - slip, where slip
   !> is the left-hand side of the condition above.
   type :: closing_law_type
      logical :: acts = .false.                !! whether the pair closes in this increment
      real(dp) :: start = 0.0_dp               !! d_t,i [length]
      real(dp) :: fraction = 0.0_dp            !! f, the instant of closing
      real(dp) :: compliance(2) = 0.0_dp       !! c_n, c_t [length/force]
      real(dp) :: rate(2) = 0.0_dp             !! derivative of f by lambda_n, lambda_t [1/force]
   end type closing_law_type

   !> The reduced system, and the factors for the active set of its last solution.
   type :: contact_system_type
      integer, allocatable :: normal(:)           !! (m) place of d_n on the tail
      integer, allocatable :: tangent(:) !! (m) place of d_t, 0 without friction or held
      real(dp), allocatable :: schur(:, :)        !! (tail, tail) S [force/length]
      real(dp), allocatable :: initial_gap(:)     !! (m) h [length]
      real(dp), allocatable :: friction(:)        !! (m) mu [-]
      type(closing_law_type), allocatable :: closing(:) !! (m) laws of closing pairs
      real(dp), allocatable :: give(:) !! (m) of stuck pairs, not zero in rings [length/force]
      integer, allocatable :: link(:)             !! (links) places of the links' forces
      integer, allocatable :: free(:)             !! places on the tail that are sought
      integer, allocatable :: partner(:) !! (tail) place of d_n whose force enters the row, or 0
      real(dp), allocatable :: share(:)           !! (tail) factor of that force
      real(dp), allocatable :: own(:)             !! (tail) factor of the row's own force
      real(dp), allocatable :: spring(:)          !! (tail) factor of the row's displacement
      type(lu_type) :: lu                         !! factors on the free places
      integer, allocatable :: factored(:)         !! (m) status*3 + direction of the factors
      logical :: loose = .false.                  !! the set factored last leaves a body loose
   contains
      procedure :: solve_set
      procedure :: solve_free
      procedure :: stiffness
      procedure :: friction_rows
      procedure :: slip
      procedure :: factor_set
      procedure :: factor_rows
      procedure :: forget_factors
   end type contact_system_type

contains

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
         slip = slip + self%give(k)*state%shear_force(k)
      end associate
   end function slip

   !> Solution for one active set. Where that leaves a body loose, the values stay as they are.
   !> Error: as factor_set.
   subroutine solve_set(self, load, state, error)
      class(contact_system_type), intent(inout) :: self   !! the reduced system
      real(dp), intent(in) :: load(:)                     !! (tail) c [force]
      type(contact_state_type), intent(inout) :: state    !! its statuses in, the values out
      type(error_type), allocatable, intent(out) :: error !! see above
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
      state%link = d(self%link)
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

      if (allocated(self%factored)) then
         if (all(self%factored == condition_code(state))) return
      end if
      self%factored = condition_code(state)
      call list_free(self, state)
      call self%factor_rows()
      if (.not. self%loose) return
      call self%forget_factors()
      call set_error(error, status_no_convergence, &
         'the bodies are not held by their supports and the pairs that are in contact')
   end subroutine factor_set

   !> Factors the rows that are listed.
   pure subroutine factor_rows(self)
      class(contact_system_type), intent(inout) :: self   !! the reduced system
      real(dp), allocatable :: rows(:, :)
      integer :: i

      rows = self%friction_rows(self%schur(:, self%free))
      rows = rows(self%free, :)
      do i = 1, size(self%free)
         rows(i, i) = rows(i, i) + self%spring(self%free(i))
      end do
      call self%lu%factor(rows, self%loose)
   end subroutine factor_rows

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
      integer :: places(2*size(state%status) + size(self%link)), k, n

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
               associate (scale => law%compliance(2) + self%give(k))
                  self%own(place) = (law%fraction*law%compliance(2) + self%give(k))/scale
                  self%share(place) = law%fraction*law%compliance(1)/scale
                  self%spring(place) = (1.0_dp - law%fraction)/scale
               end associate
            else if (self%give(k) > 0.0_dp) then
               call seek(place)
               self%spring(place) = 1.0_dp/self%give(k)
            end if
         end associate
      end do
      do k = 1, size(self%link)
         call seek(self%link(k))
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
   pure function condition_code(state) result(codes)
      type(contact_state_type), intent(in) :: state   !! statuses and directions
      integer :: codes(size(state%status))            !! (m)

      codes = 3*state%status
      where (state%status == status_slip) codes = codes + state%direction
   end function condition_code

end module contact_system
