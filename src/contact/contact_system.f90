!> Contact with friction on the reduced system, the partial solution of (2.4).
!>
!> Unknowns are the relative displacements d = u_xi - u_eta of the contact points, in their own
!> frame; the bodies behind them enter by the Schur complement S and the condensed load c, so that
!> the contact forces on xi are lambda = S d - c. Per contact point and direction either the force
!> is known and the displacement sought, or the other way round:
!>
!>    open   lambda_n = 0                            lambda_t = 0
!>    stick  d_n = h                                 d_t = reference
!>    slip   d_n = h                                 lambda_t = direction mu (-lambda_n)
!>    capped d_n = h                                 lambda_t = direction times the largest shear
!>
!> On soft faces (pressure_overclosure) d_n is sought where a contact point is closed, too, and its
!> row is
!>
!>    lambda_n + stiffness (d_n - h) = 0,
!>
!> h being the distance to where the tangent of its law begins to press.
!>
!> A contact point that closes within the increment sticks where it closed, a position that depends
!> on forces (closing_instant):
!>
!>    stick  d_n = h           (1 - f) (d_t - d_t,i) + a.lambda = 0,
!>
!> lambda being the forces of the contact points of its interface that close in the increment.
!>
!> Contact points that form cycles have the forces of their links (linear_constraints) among the
!> unknowns, on which nothing else acts; where such a contact point sticks it has a small
!> compliance: d_t + compliance lambda_t replaces d_t.
!>
!> Supports may leave bodies free to move as rigid ones: S has these motions as null vectors. Where
!> an active set does not hold them either, the system is solved beside the motions, bordered by
!> them. A load that drives one of them has no solution; without such a load the least motion is
!> taken. Which motions a set leaves free is told by the rows that it holds, not by a pivot:
!> stiffness against bending may be as small as rounding.
!>
!> The rows of an active set say which of d are sought, and what forces and displacements enter the
!> row of each. A slipping contact point's tangential row is lambda_t + direction mu lambda_n = 0,
!> or lambda_t = the largest friction; that of a contact point which closes and sticks, times a
!> stiffness, compliance lambda_t + a.lambda + spring d_t = 0.
!>
!> Its solutions, and all of it that changes, are in contact_workspace.
!>
!> The answer of a single contact point is here too: contact states, Coulomb's law, eq. (1.6), with
!> a largest friction, in increments, and the law of one that closes within an increment.
module contact_system
   use errors, only: error_type
   use friction_laws, only: friction_bound, friction_law_type
   use front_tree, only: front_tree_type, set_front_tree
   use kinds, only: dp
   use pressure_overclosure, only: pressure_overclosure_type
   use sparse_matrix, only: have_same_pattern, sparse_matrix_type, triplet_list_type
   use sum_lists, only: sum_list_type
   use tail_matrix, only: tail_matrix_type
   use tail_motions, only: tail_motions_type
   implicit none
   private
   public :: contact_system_type, contact_rows_type, rows_of, differ, &
      contact_state_type, closing_law_type, is_capped, slip_force, &
      state_code, with_cap, contact_open, contact_slip, contact_stick, next_contact_state, &
      response_type, rounding_type

   !> Spring of a row, as part of the contact point's stiffness, that does not hold a body.
   real(dp), parameter :: slack = 1.0e-9_dp

   !> The reduced system, which no increment changes.
   type :: contact_system_type
      !> (interfaces + 1) first contact point of each, and behind the last one
      integer, allocatable :: interface_start(:)
      integer, allocatable :: normal(:)           !! (m) row of d_n on the tail
      integer, allocatable :: tangent(:) !! (m) row of d_t, 0 without friction or held
      type(tail_matrix_type) :: schur             !! (tail, tail) S [force/length]
      real(dp), allocatable :: own(:)             !! (tail) its diagonal [force/length]
      !> Of a sparse tail: its fronts, the largest entry of each row, and that of each column as a
      !> part of its row
      type(front_tree_type) :: tree
      real(dp), allocatable :: row_size(:), column_size(:)
      !> (m) of stuck contact points, not zero in cycles [length/force]
      real(dp), allocatable :: compliance(:)
      !> (m) normal stiffness of a contact point alone [force/length]
      real(dp), allocatable :: alone(:)
      !> (m) stiffness of the bodies at its nodes, the same for every tail [force/length]
      real(dp), allocatable :: nodal_stiffness(:)
      !> Rows of unknowns that no contact point acts on: forces of links, and face nodes
      integer, allocatable :: link(:)
      integer :: links = 0                        !! how many of them are forces of links
      type(tail_motions_type) :: motions          !! that supports leave free
      real(dp) :: least_length = 0.0_dp           !! rounding of the coordinates [length]
   contains
      procedure :: set_fronts
      procedure :: on_tail
      procedure :: add_closing
      procedure :: least_force
      procedure :: free_motions
   end type contact_system_type

   !> Rows of an active set.
   type :: contact_rows_type
      integer, allocatable :: free(:)        !! rows on the tail that are sought
      type(sum_list_type) :: forces          !! (tail, tail) factors of forces in each free row
      real(dp), allocatable :: spring(:)     !! (tail) factor of the row's displacement
   contains
      procedure :: combine
      procedure :: is_free
   end type contact_rows_type

   integer, parameter :: contact_open = 0   !! gap, zone I
   integer, parameter :: contact_slip = 1   !! closed, slipping or frictionless, zone II
   integer, parameter :: contact_stick = 2  !! closed and stuck, zone III

   integer, parameter :: capped = 2   !! magnitude of a direction whose friction is the largest

   !> Contact state of all contact points.
   type :: contact_state_type
      integer, allocatable :: contact_state(:) !! (m) contact_open, contact_slip or contact_stick
      !> (m) sign of the friction force where it slips, 0 where it is not known; times `capped`
      !> where the force is the largest that friction has, whatever the pressure
      integer, allocatable :: direction(:)
      real(dp), allocatable :: reference(:)   !! (m) d_t from which friction counts [length]
      real(dp), allocatable :: gap(:)         !! (m) gamma = h - d_n [length]
      !> (m) d_n, with the digits that it loses in h; unallocated before a solution [length]
      real(dp), allocatable :: approach(:)
      real(dp), allocatable :: tangential(:)  !! (m) d_t [length]
      !> (m) d_t at which a contact point last closed [length]
      real(dp), allocatable :: slip_origin(:)
      real(dp), allocatable :: force(:)       !! (m) -lambda_n, positive in compression [force]
      real(dp), allocatable :: shear_force(:) !! (m) lambda_t [force]
      real(dp), allocatable :: link(:)        !! (links) what holds cycles together [length]
   end type contact_state_type

   !> Where a contact point that closes within the increment sticks: at the reference d_t - slip,
   !> where slip is the left-hand side of the condition in contact_system. Forces are lambda_n and
   !> lambda_t of the contact points of its interface; of those that do not close in the increment
   !> the factors are zero.
   type :: closing_law_type
      logical :: acts = .false.                !! whether the contact point closes in this increment
      real(dp) :: start = 0.0_dp               !! d_t,i [length]
      real(dp) :: fraction = 0.0_dp            !! f, the instant of closing
      integer :: first = 1                     !! first contact point of the interface
      real(dp), allocatable :: compliance(:, :) !! (2, n) a, factors of the forces [length/force]
      !> (2, n) derivative of the slip by the forces through the instants [length/force]
      real(dp), allocatable :: rate(:, :)
   contains
      procedure :: lag
   end type closing_law_type

   !> Answer of a contact point under its present condition.
   type :: response_type
      real(dp) :: gap = 0.0_dp           !! gamma [length]
      real(dp) :: force = 0.0_dp         !! normal force, positive in compression [force]
      real(dp) :: shear_force = 0.0_dp   !! tangential force on the slave [force]
      real(dp) :: slip = 0.0_dp          !! tangential motion since the increment began [length]
   end type response_type

   !> Thresholds of zero.
   type :: rounding_type
      real(dp) :: gap = 0.0_dp           !! of gap and slip [length]
      real(dp) :: force = 0.0_dp         !! of both forces [force]
   end type rounding_type

contains

   !> The rows of an active set.
   pure function rows_of(system, friction, state, closing, soft) result(rows)
      type(contact_system_type), intent(in) :: system     !! the reduced system
      real(dp), intent(in) :: friction(:)                 !! (m) mu [-]
      type(contact_state_type), intent(in) :: state       !! states and directions
      type(closing_law_type), intent(in) :: closing(:)    !! (m) laws of closing contact points
      type(pressure_overclosure_type), intent(in) :: soft           !! tangents of soft faces
      type(contact_rows_type) :: rows
      logical :: sought(2, size(state%contact_state))
      integer :: point(system%schur%order), i, k   ! point: whose tangential row it is, or 0

      allocate (rows%spring(size(point)), source=0.0_dp)
      sought(1, :) = state%contact_state == contact_open .or. soft%is_soft
      where (state%contact_state /= contact_open .and. soft%is_soft)
         rows%spring(system%normal) = soft%stiffness
      end where
      sought(2, :) = system%tangent > 0
      point = 0
      do k = 1, size(state%contact_state)
         if (system%tangent(k) == 0) cycle
         point(system%tangent(k)) = k
         if (state%contact_state(k) /= contact_stick) cycle
         associate (spring => rows%spring(system%tangent(k)), compliance => system%compliance(k))
            if (closing(k)%acts) then
               spring = system%alone(k)*(1.0_dp - closing(k)%fraction)
            else if (compliance > 0.0_dp) then
               spring = 1.0_dp/compliance
            else
               sought(2, k) = .false.
            end if
         end associate
      end do
      rows%free = [pack(reshape([(system%normal(k), system%tangent(k), k=1, &
         size(state%contact_state))], shape(sought)), sought), system%link]
      call rows%forces%reserve(size(point), 2*size(point))
      associate (is_free => rows%is_free())
         do i = 1, size(point)
            k = point(i)
            if (.not. is_free(i)) then
               call rows%forces%add([integer ::], [real(dp) ::])
            else if (k == 0) then
               call rows%forces%add_value(i)
            else if (state%contact_state(k) == contact_slip .and. .not. is_capped( &
               state%direction(k))) then
               call rows%forces%add([i, system%normal(k)], [1.0_dp, state%direction(k)*friction(k)])
            else if (state%contact_state(k) == contact_stick .and. closing(k)%acts) then
               call system%add_closing(k, closing(k)%first, closing(k)%compliance, rows%forces)
            else
               call rows%forces%add_value(i)
            end if
         end do
      end associate
   end function rows_of

   !> Sets the fronts of a sparse tail: those of a former one with the same unknowns and pattern.
   !> Error: METIS fails.
   subroutine set_fronts(self, former, error)
      class(contact_system_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: former         !! or an empty one
      type(error_type), allocatable, intent(out) :: error
      integer :: i, k

      allocate (self%row_size(self%schur%order), self%column_size(self%schur%order), source=0.0_dp)
      associate (s => self%schur%sparse)
         do i = 1, s%row_count
            associate (entries => abs(s%value(s%row_start(i):s%row_start(i + 1) - 1)))
               self%row_size(i) = maxval([tiny(1.0_dp), entries])
            end associate
            do k = s%row_start(i), s%row_start(i + 1) - 1
               self%column_size(s%column(k)) = max(self%column_size(s%column(k)), &
                  abs(s%value(k))/self%row_size(i))
            end do
         end do
      end associate
      if (have_same_pattern(self%schur%sparse, former%schur%sparse)) then
         if (all(self%interface_start == former%interface_start) .and. all(self%normal == &
            former%normal) .and. all(self%tangent == former%tangent)) then
            self%tree = former%tree
            return
         end if
      end if
      call set_front_tree(joined_unknowns(self), self%tree, error)
   end subroutine set_fronts

   !> Which unknowns of a sparse tail may be joined: by S, and in the row of a contact point that
   !> closes, to which forces on its interface belong, by what these depend on.
   pure function joined_unknowns(system) result(graph)
      type(contact_system_type), intent(in) :: system
      type(sparse_matrix_type) :: graph
      type(triplet_list_type) :: list
      integer, allocatable :: around(:)
      integer :: i, j, k, pass, total

      associate (s => system%schur%sparse, start => system%interface_start)
         do pass = 1, 2
            total = 0
            do i = 1, size(start) - 1
               associate (tangents => pack(system%tangent(start(i):start(i + 1) - 1), &
                  system%tangent(start(i):start(i + 1) - 1) > 0))
                  if (size(tangents) == 0) cycle
                  around = system%schur%neighbours([system%normal(start(i):start(i + 1) - 1), &
                     tangents])
                  total = total + 2*size(tangents)*size(around)
                  if (pass == 1) cycle
                  do k = 1, size(tangents)
                     do j = 1, size(around)
                        if (around(j) == tangents(k)) cycle
                        call list%add(tangents(k), around(j), 1.0_dp)
                        call list%add(around(j), tangents(k), 1.0_dp)
                     end do
                  end do
               end associate
            end do
            if (pass == 1) call list%reserve(total + size(s%value))
         end do
         do i = 1, s%row_count
            do k = s%row_start(i), s%row_start(i + 1) - 1
               if (s%column(k) /= i) call list%add(i, s%column(k), 1.0_dp)
            end do
         end do
         graph = list%compress(s%row_count, s%row_count)
      end associate
   end function joined_unknowns

   !> Values for normal and tangent of the contact points, on the tail; 0 elsewhere.
   pure function on_tail(self, values)
      class(contact_system_type), intent(in) :: self
      real(dp), intent(in) :: values(:, :)            !! (2, m)
      real(dp) :: on_tail(self%schur%order)        !! (tail)
      integer :: k

      on_tail = 0.0_dp
      do k = 1, size(values, 2)
         on_tail(self%normal(k)) = values(1, k)
         if (self%tangent(k) > 0) on_tail(self%tangent(k)) = values(2, k)
      end do
   end function on_tail

   !> Adds the factors of forces in the row of a contact point that closes and sticks, times its
   !> stiffness.
   pure subroutine add_closing(self, k, first, factors, forces)
      class(contact_system_type), intent(in) :: self
      integer, intent(in) :: k                        !! the contact point
      integer, intent(in) :: first                    !! first one of its interface
      real(dp), intent(in) :: factors(:, :)           !! (2, n) of its interface [length/force]
      type(sum_list_type), intent(inout) :: forces
      integer :: i

      associate (last => first + size(factors, 2) - 1)
         call forces%add([self%tangent(k), (self%normal(i), self%tangent(i), i=first, last)], &
            self%alone(k)*[self%compliance(k), factors])
      end associate
   end subroutine add_closing

   !> What the forces of a law add to the slip, a.lambda.
   pure real(dp) function lag(self, state)
      class(closing_law_type), intent(in) :: self
      type(contact_state_type), intent(in) :: state   !! [length]

      associate (last => self%first + size(self%compliance, 2) - 1)
         lag = dot_product(self%compliance(2, :), state%shear_force(self%first:last)) - &
            dot_product(self%compliance(1, :), state%force(self%first:last))
      end associate
   end function lag

   !> Force on a contact point that rounding of the coordinates makes, and that counts as none.
   !> Where contact points move a body without strain, their S is rounding of what they have alone.
   pure real(dp) function least_force(self)
      class(contact_system_type), intent(in) :: self  !! [force]

      least_force = self%least_length*maxval([0.0_dp, self%alone, self%own])
   end function least_force

   !> Forces, or columns of S, as they enter the free rows.
   pure function combine(self, columns) result(rows)
      class(contact_rows_type), intent(in) :: self
      real(dp), intent(in) :: columns(:, :)           !! (tail, columns)
      real(dp) :: rows(size(columns, 1), size(columns, 2))
      integer :: j

      rows = 0.0_dp
      do j = 1, size(columns, 2)
         call self%forces%add_totals(columns(:, j), rows(:, j))
      end do
   end function combine

   !> Which rows are sought.
   pure function is_free(self)
      class(contact_rows_type), intent(in) :: self
      logical :: is_free(size(self%spring))           !! (tail)

      is_free = .false.
      is_free(self%free) = .true.
   end function is_free

   !> Whether rows have other factors, or only one of both is free.
   pure function differ(a, b)
      type(contact_rows_type), intent(in) :: a, b
      logical :: differ(size(a%spring))
      integer :: i

      differ = (a%is_free() .neqv. b%is_free()) .or. (a%is_free() .and. &
         abs(a%spring - b%spring) > 0.0_dp)
      do i = 1, size(differ)
         if (.not. differ(i)) differ(i) = .not. a%forces%is_sum_of(i, b%forces, i)
      end do
   end function differ

   !> The unsupported motions that no row of the active set holds.
   pure function free_motions(self, rows) result(unheld)
      class(contact_system_type), intent(in) :: self
      type(contact_rows_type), intent(in) :: rows
      type(sum_list_type) :: unheld              !! (l, tail) as from tail_motions

      unheld = self%motions%unheld(rows%is_free(), .not. rows%is_free() .or. &
         rows%spring > slack*abs(self%own))
   end function free_motions

   !> Whether friction is the largest whatever the pressure.
   elemental logical function is_capped(direction)
      integer, intent(in) :: direction       !! as in the state

      is_capped = abs(direction) == capped
   end function is_capped

   !> A direction of friction with the same sign that is capped, or that is not.
   elemental integer function with_cap(direction, has_cap)
      integer, intent(in) :: direction       !! as in the state, not 0
      logical, intent(in) :: has_cap

      with_cap = sign(merge(capped, 1, has_cap), direction)
   end function with_cap

   !> Friction force on the slave at a contact point that slips.
   elemental function slip_force(direction, friction, force) result(shear_force)
      integer, intent(in) :: direction       !! as in the state
      type(friction_law_type), intent(in) :: friction   !! of nodal forces
      real(dp), intent(in) :: force          !! positive in compression [force]
      real(dp) :: shear_force                !! [force]

      if (is_capped(direction)) then
         shear_force = sign(friction%largest_shear, real(direction, dp))
      else
         shear_force = direction*friction%coefficient*force
      end if
   end function slip_force

   !> One number per contact point for its contact state.
   pure function state_code(state) result(codes)
      type(contact_state_type), intent(in) :: state   !! states and directions
      integer :: codes(size(state%contact_state))     !! (m)

      codes = 3*state%contact_state
      where (state%contact_state == contact_slip) codes = codes + state%direction
   end function state_code

   !> Contact state that a contact point must have, given what it did under its present one. A stuck
   !> contact point slips once its friction force would leave the cone; a slipping contact point
   !> sticks once friction would drive it instead of resisting, and slips with the largest friction
   !> once its pressure allows more. A contact point that closes first shows without friction (slip,
   !> direction 0) which way it slides.
   pure subroutine next_contact_state(contact_state, direction, response, friction, has_tangent, &
      rounding, excess)
      integer, intent(inout) :: contact_state !! contact_open, contact_slip or contact_stick
      integer, intent(inout) :: direction   !! of friction on the slave, as in contact_state_type
      type(response_type), intent(in) :: response
      type(friction_law_type), intent(in) :: friction   !! of nodal forces
      logical, intent(in) :: has_tangent    !! whether the contact point can move along its tangent
      type(rounding_type), intent(in) :: rounding
      real(dp), intent(out) :: excess       !! violation of the present condition, 0 for none
      real(dp) :: bound, over_largest

      excess = 0.0_dp
      over_largest = friction%coefficient*response%force - friction%largest_shear
      select case (contact_state)
      case (contact_open)
         if (response%gap >= -rounding%gap) return
         excess = -response%gap/rounding%gap
         contact_state = contact_slip
         direction = 0
      case default
         if (response%force < -rounding%force) then
            excess = -response%force/rounding%force
            contact_state = contact_open
         else if (contact_state == contact_stick .and. has_tangent) then
            bound = friction_bound(friction%coefficient, friction%largest_shear, response%force)
            if (abs(response%shear_force) <= bound + rounding%force) return
            excess = (abs(response%shear_force) - bound)/rounding%force
            contact_state = contact_slip
            direction = with_cap(merge(1, -1, response%shear_force > 0.0_dp), &
               over_largest > 0.0_dp)
         else if (contact_state == contact_slip .and. direction == 0 .and. &
            friction%coefficient > 0.0_dp) then
            excess = 1.0_dp
            if (has_tangent .and. abs(response%slip) > rounding%gap) then
               direction = merge(-1, 1, response%slip > 0.0_dp)
            else
               contact_state = contact_stick
            end if
         else if (contact_state == contact_slip .and. friction%coefficient > 0.0_dp) then
            if (direction*response%slip > rounding%gap) then
               excess = direction*response%slip/rounding%gap
               contact_state = contact_stick
               direction = 0
            else if (.not. is_capped(direction) .and. over_largest > rounding%force) then
               excess = over_largest/rounding%force
               direction = with_cap(direction, .true.)
            else if (is_capped(direction) .and. over_largest < -rounding%force) then
               excess = -over_largest/rounding%force
               direction = with_cap(direction, .false.)
            end if
         end if
      end select
   end subroutine next_contact_state

end module contact_system
