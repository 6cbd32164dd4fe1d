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
!>
!> Supports may leave bodies free to move as rigid ones: S has these motions as null vectors. Where
!> an active set does not hold them either, the system is solved beside the motions, bordered by
!> them. A load that drives one of them has no solution; without such a load the least motion is
!> taken.
module contact_system
   use contact_states, only: closing_law_type, condition_code, contact_state_type
   use dense, only: lu_type
   use errors, only: error_type, set_error, status_no_convergence
   use finite_values, only: check_finite
   use kinds, only: dp
   use loose_motions, only: free_motions, is_driven
   use records, only: status_open, status_slip, status_stick
   implicit none
   private
   public :: contact_system_type

   real(dp), parameter :: rounding = 1.0e-12_dp !! of the forces that a load is condensed of
   !> Part of the rounding of coordinates: a load that moves a pair no farther is a remainder of
   !> loads that were taken off.
   real(dp), parameter :: unresolved = 1.0e-3_dp

   !> The reduced system, and the factors for the active set of its last solution.
   type :: contact_system_type
      integer, allocatable :: normal(:)           !! (m) place of d_n on the tail
      integer, allocatable :: tangent(:) !! (m) place of d_t, 0 without friction or held
      real(dp), allocatable :: schur(:, :)        !! (tail, tail) S [force/length]
      !> (m) h less the part of d_n that supports prescribe, which is no part of d_n here [length]
      real(dp), allocatable :: initial_gap(:)
      real(dp), allocatable :: friction(:)        !! (m) mu [-]
      type(closing_law_type), allocatable :: closing(:) !! (m) laws of closing pairs
      real(dp), allocatable :: give(:) !! (m) of stuck pairs, not zero in rings [length/force]
      real(dp), allocatable :: alone(:) !! (m) normal stiffness of a pair alone [force/length]
      integer, allocatable :: link(:)             !! (links) places of the links' forces
      real(dp), allocatable :: rigid(:, :)  !! (tail, q) unsupported rigid motions
      real(dp), allocatable :: motion(:, :) !! (tail, q) the same, orthonormal
      !> (tail) relative displacements that loose motions are least from; set by solve_contact
      real(dp), allocatable :: anchor(:)
      real(dp) :: least_length = 0.0_dp           !! rounding of the coordinates [length]
      real(dp) :: load_scale = 0.0_dp !! largest force that the load is condensed of [force]
      real(dp), allocatable :: least_drive(:) !! (tail) resultants that count as none [force]
      integer, allocatable :: free(:)             !! places on the tail that are sought
      integer, allocatable :: partner(:) !! (tail) place of d_n whose force enters the row, or 0
      real(dp), allocatable :: share(:)           !! (tail) factor of that force
      real(dp), allocatable :: own(:)             !! (tail) factor of the row's own force
      real(dp), allocatable :: spring(:)          !! (tail) factor of the row's displacement
      type(lu_type) :: lu                         !! factors on the free places, bordered
      real(dp) :: border = 1.0_dp                 !! scale of the border [force/length]
      real(dp), allocatable :: scale(:) !! (free) factor of the rows, 1 in those with a border
      integer, allocatable :: factored(:)         !! (m) status*3 + direction of the factors
      real(dp), allocatable :: loose(:, :)        !! (free, l) motions that the set leaves free
      real(dp), allocatable :: drive(:)           !! (l) forces along them that nothing takes up
      logical :: driven = .false.                 !! whether these are more than rounding
      logical, allocatable :: idle(:)   !! (m) closed pairs that carry nothing (idle_pairs)
      logical :: several = .false.                !! whether other states under the load are proven
   contains
      procedure :: solve_set
      procedure :: solve_free
      procedure :: stiffness
      procedure :: turns_back
      procedure :: least_force
      procedure :: friction_rows
      procedure :: slip
      procedure :: factor_set
      procedure :: factor_rows
      procedure :: drop_laws
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

   !> Solution for one active set. Where the load drives a body that the set leaves loose, driven
   !> is set, and the values stay as they are.
   !> Errors: as factor_set; a body is driven away; forces overflow.
   subroutine solve_set(self, load, state, error)
      class(contact_system_type), intent(inout) :: self   !! the reduced system
      real(dp), intent(in) :: load(:)                     !! (tail) c [force]
      type(contact_state_type), intent(inout) :: state    !! its statuses in, the values out
      type(error_type), allocatable, intent(out) :: error !! see above
      real(dp) :: d(size(load)), lambda(size(load)), residual(size(load), 1)
      real(dp), allocatable :: unbalanced(:, :)
      integer :: k

      self%driven = .false.
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
      call self%solve_free(residual, unbalanced)
      d(self%free) = d(self%free) + residual(self%free, 1)
      if (size(self%loose, 2) > 0) then
         self%drive = unbalanced(:, 1)
         call check_balance(self, load, d, error)
         if (allocated(error)) return
         call move_least(self, state, d)
      end if
      lambda = matmul(self%schur, d) - load
      call check_finite([d, lambda], 'displacements and forces of the contact', &
         status_no_convergence, error)
      if (allocated(error)) return
      state%link = d(self%link)
      state%approach = d(self%normal)
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

   !> Whether the load drives the loose motions, by more than rounding.
   !> Error: it does.
   subroutine check_balance(self, load, d, error)
      class(contact_system_type), intent(inout) :: self
      real(dp), intent(in) :: load(:), d(:)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: least(size(d)), terms(size(d))
      integer :: i

      terms = abs(load) + matmul(abs(self%schur), abs(d))
      least = self%least_drive + [(unresolved*self%least_length*abs(self%schur(i, i)), &
         i=1, size(d))]
      self%driven = is_driven(self%loose, self%drive, terms(self%free), least(self%free))
      if (self%driven) call set_error(error, status_no_convergence, &
         'the bodies are not held by their supports and the pairs that are in contact')
   end subroutine check_balance

   !> Moves loose bodies so that pairs slip least, and open ones stay at the anchor.
   pure subroutine move_least(self, state, d)
      class(contact_system_type), intent(in) :: self
      type(contact_state_type), intent(in) :: state
      real(dp), intent(inout) :: d(:)
      real(dp) :: way(size(d))
      integer :: k

      way = 0.0_dp
      do k = 1, size(state%status)
         if (state%status(k) == status_open) way(self%normal(k)) = d(self%normal(k)) - &
            self%anchor(self%normal(k))
         if (self%tangent(k) == 0) cycle
         way(self%tangent(k)) = d(self%tangent(k)) - self%anchor(self%tangent(k))
         if (state%status(k) == status_slip) way(self%tangent(k)) = d(self%tangent(k)) - &
            merge(self%closing(k)%start, state%reference(k), self%closing(k)%acts)
      end do
      d(self%free) = d(self%free) - matmul(self%loose, matmul(way(self%free), self%loose))
   end subroutine move_least

   !> Factors the system of an active set, unless that is the set factored last.
   !> Error: the system is singular.
   subroutine factor_set(self, state, error)
      class(contact_system_type), intent(inout) :: self   !! the reduced system
      type(contact_state_type), intent(in) :: state       !! statuses and directions
      type(error_type), allocatable, intent(out) :: error !! see above
      logical :: singular

      if (allocated(self%factored)) then
         if (all(self%factored == condition_code(state))) return
      end if
      self%factored = condition_code(state)
      call list_free(self, state)
      self%loose = free_motions(self%motion, self%free, self%spring, self%schur)
      call self%factor_rows(singular)
      if (.not. singular) return
      call self%forget_factors()
      call set_error(error, status_no_convergence, 'the contact system is singular')
   end subroutine factor_set

   !> Factors the rows that are listed, bordered by the loose motions.
   pure subroutine factor_rows(self, singular)
      class(contact_system_type), intent(inout) :: self   !! the reduced system
      logical, intent(out) :: singular                    !! the rows depend on each other
      real(dp) :: rows(size(self%free) + size(self%loose, 2), size(self%free) + &
         size(self%loose, 2))
      integer :: i

      rows = 0.0_dp
      associate (f => size(self%free), of_tail => self%friction_rows(self%schur(:, self%free)))
         rows(:f, :f) = of_tail(self%free, :)
         do i = 1, f
            rows(i, i) = rows(i, i) + self%spring(self%free(i))
         end do
         ! Rows of slipping pairs are mu times as large, those of stuck ones in rings 1e8 times.
         self%scale = [(1.0_dp, i=1, f)]
         if (size(self%loose, 2) == 0) self%scale = 1.0_dp/max(maxval(abs(rows(:f, :f)), dim=2), &
            tiny(1.0_dp))
         do i = 1, f
            rows(i, :f) = self%scale(i)*rows(i, :f)
         end do
         self%border = max(maxval(abs(rows)), tiny(1.0_dp))
         rows(:f, f + 1:) = self%border*self%loose
         rows(f + 1:, :f) = self%border*transpose(self%loose)
      end associate
      call self%lu%factor(rows, singular)
   end subroutine factor_rows

   !> Drops the closing laws, of an earlier increment or another start.
   pure subroutine drop_laws(self)
      class(contact_system_type), intent(inout) :: self  !! the reduced system

      if (.not. any(self%closing%acts)) return
      self%closing = closing_law_type()
      call self%forget_factors()
   end subroutine drop_laws

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
         associate (place => self%tangent(k), law => self%closing(k), give => self%give(k))
            if (state%status(k) == status_open) then
               call seek(place)
            else if (state%status(k) == status_slip) then
               call seek(place)
               self%partner(place) = self%normal(k)
               self%share(place) = state%direction(k)*self%friction(k)
            else if (law%acts) then
               call seek(place)
               self%partner(place) = self%normal(k)
               associate (scale => law%compliance(2) + give)
                  self%own(place) = (law%fraction*law%compliance(2) + give)/scale
                  self%share(place) = law%fraction*law%compliance(1)/scale
                  self%spring(place) = (1.0_dp - law%fraction)/scale
               end associate
            else if (give > 0.0_dp) then
               call seek(place)
               self%spring(place) = 1.0_dp/give
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
   pure subroutine solve_free(self, x, unbalanced)
      class(contact_system_type), intent(in) :: self  !! the reduced system
      real(dp), intent(inout) :: x(:, :) !! (tail, columns) forces; displacements in free rows
      !> (l, columns) forces along the loose motions that nothing takes up.
      real(dp), allocatable, intent(out), optional :: unbalanced(:, :)
      real(dp) :: rows(size(self%free) + size(self%loose, 2), size(x, 2))

      associate (f => size(self%free))
         rows = 0.0_dp
         associate (of_tail => self%friction_rows(x))
            rows(:f, :) = spread(self%scale, 2, size(x, 2))*of_tail(self%free, :)
         end associate
         if (size(rows, 1) > 0) call self%lu%solve(rows)
         x(self%free, :) = rows(:f, :)
         if (present(unbalanced)) unbalanced = self%border*rows(f + 1:, :)
      end associate
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

   !> Force that rounding leaves of what the load is made of, and of coordinates.
   pure real(dp) function least_force(self)
      class(contact_system_type), intent(in) :: self  !! the reduced system
      integer :: i

      least_force = rounding*self%load_scale + self%least_length* &
         maxval([0.0_dp, (self%schur(i, i), i=1, size(self%schur, 1))])
   end function least_force

   !> Whether the set factored last turns the path of contact states back: its determinant is
   !> negative, which needs friction. The signs at all states under one load add up to one, so that
   !> then there are others. Closing laws, frozen in the set, are no part of that: with them none is
   !> seen to turn.
   pure logical function turns_back(self)
      class(contact_system_type), intent(in) :: self  !! the reduced system

      turns_back = .false.
      if (any(self%closing%acts)) return
      ! Every link and every loose motion borders a positive matrix, which turns its sign.
      turns_back = self%lu%negative_determinant() .neqv. &
         (mod(size(self%link) + size(self%loose, 2), 2) == 1)
   end function turns_back

end module contact_system
