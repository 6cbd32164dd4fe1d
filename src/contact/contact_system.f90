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
!> A contact point that closes within the increment sticks where it closed, a position that depends
!> on forces (closing_instant):
!>
!>    stick  d_n = h           (1 - f) (d_t - d_t,i) + a.lambda = 0,
!>
!> lambda being the forces of all contact points that close in the increment.
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
!> row of each. A slipping contact point's tangential row is lambda_t + share lambda_n = 0, or
!> without a share the largest friction for 0; that of a contact point which closes and sticks,
!> times a stiffness, own lambda_t + arm.lambda + spring d_t = 0.
!>
!> What is solved with it, and what of it changes, is in contact_workspace.
module contact_system
   use contact_states, only: closing_law_type, contact_open, contact_slip, contact_state_type, &
      contact_stick, is_capped
   use dense, only: least_squares, null_space, product_of
   use kinds, only: dp
   implicit none
   private
   public :: contact_system_type, contact_rows_type, rows_of
   public :: free_motions, is_driven, balanced_load, least_drive

   !> Spring of a row, as part of the contact point's stiffness, that does not hold a body.
   real(dp), parameter :: slack = 1.0e-9_dp
   !> Force along a motion that is rounding, as part of the terms that it is the sum of.
   real(dp), parameter :: rounding = 1.0e-13_dp
   !> Part of the applied forces that cancel which coordinates and loads of a deck leave over.
   real(dp), parameter :: cancelled = 1.0e-10_dp

   !> The reduced system, which no increment changes.
   type :: contact_system_type
      integer, allocatable :: normal(:)           !! (m) row of d_n on the tail
      integer, allocatable :: tangent(:) !! (m) row of d_t, 0 without friction or held
      real(dp), allocatable :: schur(:, :)        !! (tail, tail) S [force/length]
      !> (m) of stuck contact points, not zero in cycles [length/force]
      real(dp), allocatable :: compliance(:)
      !> (m) normal stiffness of a contact point alone [force/length]
      real(dp), allocatable :: alone(:)
      integer, allocatable :: link(:)             !! (links) rows of the links' forces
      real(dp), allocatable :: rigid(:, :)  !! (tail, q) unsupported rigid motions
      real(dp), allocatable :: motion(:, :) !! (tail, q) the same, orthonormal
      real(dp) :: least_length = 0.0_dp           !! rounding of the coordinates [length]
   contains
      procedure :: on_tail
   end type contact_system_type

   !> Rows of an active set.
   type :: contact_rows_type
      integer, allocatable :: free(:)        !! rows on the tail that are sought
      integer, allocatable :: partner(:)     !! (tail) row of d_n whose force enters the row, or 0
      real(dp), allocatable :: share(:)      !! (tail) factor of that force
      real(dp), allocatable :: own(:)        !! (tail) factor of the row's own force
      real(dp), allocatable :: spring(:)     !! (tail) factor of the row's displacement
      integer, allocatable :: closing(:)     !! (c) rows of contact points that close and stick
      real(dp), allocatable :: arm(:, :)     !! (c, tail) factors of all forces in them
   contains
      procedure :: combine
   end type contact_rows_type

contains

   !> The rows of an active set.
   pure function rows_of(system, friction, state, closing) result(rows)
      type(contact_system_type), intent(in) :: system     !! the reduced system
      real(dp), intent(in) :: friction(:)                 !! (m) mu [-]
      type(contact_state_type), intent(in) :: state       !! states and directions
      type(closing_law_type), intent(in) :: closing(:)    !! (m) laws of closing contact points
      type(contact_rows_type) :: rows
      logical :: sought(2, size(state%contact_state))
      integer :: c, k, tail

      tail = size(system%schur, 1)
      allocate (rows%partner(tail), source=0)
      allocate (rows%share(tail), rows%spring(tail), source=0.0_dp)
      allocate (rows%own(tail), source=1.0_dp)
      sought(1, :) = state%contact_state == contact_open
      sought(2, :) = system%tangent > 0
      rows%closing = pack(system%tangent, system%tangent > 0 .and. closing%acts .and. &
         state%contact_state == contact_stick)
      allocate (rows%arm(size(rows%closing), tail))
      c = 0
      do k = 1, size(state%contact_state)
         if (system%tangent(k) == 0) cycle
         associate (row => system%tangent(k), law => closing(k), compliance => system%compliance(k))
            if (state%contact_state(k) == contact_open) then
               cycle
            else if (state%contact_state(k) == contact_slip) then
               if (is_capped(state%direction(k))) cycle
               rows%partner(row) = system%normal(k)
               rows%share(row) = state%direction(k)*friction(k)
            else if (law%acts) then
               c = c + 1
               rows%own(row) = system%alone(k)*compliance
               rows%spring(row) = system%alone(k)*(1.0_dp - law%fraction)
               rows%arm(c, :) = system%alone(k)*system%on_tail(law%compliance)
            else if (compliance > 0.0_dp) then
               rows%spring(row) = 1.0_dp/compliance
            else
               sought(2, k) = .false.
            end if
         end associate
      end do
      rows%free = [pack(reshape([(system%normal(k), system%tangent(k), k=1, &
         size(state%contact_state))], shape(sought)), sought), system%link]
   end function rows_of

   !> Values for normal and tangent of the contact points, on the tail; 0 elsewhere.
   pure function on_tail(self, values)
      class(contact_system_type), intent(in) :: self
      real(dp), intent(in) :: values(:, :)            !! (2, m)
      real(dp) :: on_tail(size(self%schur, 1))        !! (tail)
      integer :: k

      on_tail = 0.0_dp
      do k = 1, size(values, 2)
         on_tail(self%normal(k)) = values(1, k)
         if (self%tangent(k) > 0) on_tail(self%tangent(k)) = values(2, k)
      end do
   end function on_tail

   !> Forces, or columns of S, as they enter the rows.
   pure function combine(self, columns) result(rows)
      class(contact_rows_type), intent(in) :: self
      real(dp), intent(in) :: columns(:, :)           !! (tail, columns)
      real(dp) :: rows(size(columns, 1), size(columns, 2))
      integer :: i, j

      do j = 1, size(columns, 2)
         rows(:, j) = self%own*columns(:, j)
         do i = 1, size(columns, 1)
            if (self%partner(i) > 0) rows(i, j) = rows(i, j) + &
               self%share(i)*columns(self%partner(i), j)
         end do
      end do
      if (size(self%closing) > 0) rows(self%closing, :) = rows(self%closing, :) + &
         product_of(self%arm, columns)
   end function combine

   !> The unsupported motions that no row of the active set holds, orthonormal on the free rows.
   pure function free_motions(motion, free, spring, schur) result(unheld)
      real(dp), intent(in) :: motion(:, :)   !! (tail, q) unsupported motions, orthonormal
      integer, intent(in) :: free(:)         !! (n) rows that are sought
      real(dp), intent(in) :: spring(:)      !! (tail) what holds free rows [force/length]
      real(dp), intent(in) :: schur(:, :)    !! (tail, tail) S [force/length]
      real(dp), allocatable :: unheld(:, :) !! (n, l)
      logical :: held(size(motion, 1))
      integer :: i

      if (size(motion, 2) == 0) then
         allocate (unheld(size(free), 0))
         return
      end if
      held = .true.
      do i = 1, size(free)
         held(free(i)) = spring(free(i)) > slack*abs(schur(free(i), free(i)))
      end do
      associate (tail_rows => pack([(i, i=1, size(held))], held))
         unheld = matmul(motion(free, :), null_space(motion(tail_rows, :)))
      end associate
   end function free_motions

   !> Whether forces drive the motions, by more than rounding. Each row is judged by the terms
   !> that its own motion collects: those of another body may be far larger.
   pure logical function is_driven(unheld, unbalanced, terms, least)
      real(dp), intent(in) :: unheld(:, :)   !! (n, l) orthonormal motions of the free rows
      real(dp), intent(in) :: unbalanced(:)  !! (l) forces along the motions [force]
      real(dp), intent(in) :: terms(:) !! (n) sums without signs of the forces' terms [force]
      real(dp), intent(in) :: least(:)       !! (n) drive that counts as none [force]

      is_driven = any(abs(matmul(unheld, unbalanced)) > least + &
         rounding*matmul(abs(matmul(unheld, transpose(unheld))), terms))
   end function is_driven

   !> A condensed load with the exact resultants along the unsupported motions. Temperatures and
   !> prescribed displacements have none; what the elimination makes of theirs is rounding.
   function balanced_load(load, rigid, motion, resultant) result(balanced)
      real(dp), intent(in) :: load(:)        !! (tail) c [force]
      real(dp), intent(in) :: rigid(:, :)    !! (tail, q) unsupported motions
      real(dp), intent(in) :: motion(:, :)   !! (tail, q) the same, orthonormal
      real(dp), intent(in) :: resultant(:)   !! (q) of the applied forces along `rigid` [force]
      real(dp) :: balanced(size(load))       !! (tail) [force]

      balanced = load
      if (size(motion, 2) == 0) return
      balanced = load - matmul(motion, matmul(load, motion)) + &
         least_squares(transpose(rigid), resultant)
   end function balanced_load

   !> Forces along the unsupported motions that count as none.
   pure function least_drive(rigid, sums) result(least)
      real(dp), intent(in) :: rigid(:, :) !! (tail, q) unsupported motions, each of one body
      real(dp), intent(in) :: sums(:)     !! (q) resultants of the forces without signs [force]
      real(dp) :: least(size(rigid, 1))   !! (tail) [force]
      integer :: q

      least = 0.0_dp
      do q = 1, size(sums)
         least = least + cancelled*sums(q)*abs(rigid(:, q))/max(sum(rigid(:, q)**2), tiny(1.0_dp))
      end do
   end function least_drive

end module contact_system
