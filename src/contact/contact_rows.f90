!> The rows of the contact system under one active set: which relative displacements are sought, and
!> what forces and displacements enter the row of each. A slipping contact point's tangential row is
!> lambda_t + share lambda_n = 0, or without a share the largest friction for 0; that of a contact
!> point which closes and sticks (contact_system), divided by f c_t,
!> own lambda_t + share lambda_n + spring d_t = 0.
module contact_rows
   use contact_states, only: closing_law_type, contact_open, contact_slip, contact_state_type, &
      is_capped
   use contact_system, only: contact_system_type
   use kinds, only: dp
   implicit none
   private
   public :: contact_rows_type, rows_of

   !> Rows of an active set.
   type :: contact_rows_type
      integer, allocatable :: free(:)        !! rows on the tail that are sought
      integer, allocatable :: partner(:)     !! (tail) row of d_n whose force enters the row, or 0
      real(dp), allocatable :: share(:)      !! (tail) factor of that force
      real(dp), allocatable :: own(:)        !! (tail) factor of the row's own force
      real(dp), allocatable :: spring(:)     !! (tail) factor of the row's displacement
   contains
      procedure :: combine
   end type contact_rows_type

contains

   !> The rows of an active set.
   pure function rows_of(system, state, closing) result(rows)
      type(contact_system_type), intent(in) :: system     !! the reduced system
      type(contact_state_type), intent(in) :: state       !! states and directions
      type(closing_law_type), intent(in) :: closing(:)    !! (m) laws of closing contact points
      type(contact_rows_type) :: rows
      logical :: sought(2, size(state%contact_state))
      integer :: k, tail

      tail = size(system%schur, 1)
      allocate (rows%partner(tail), source=0)
      allocate (rows%share(tail), rows%spring(tail), source=0.0_dp)
      allocate (rows%own(tail), source=1.0_dp)
      sought(1, :) = state%contact_state == contact_open
      sought(2, :) = system%tangent > 0
      do k = 1, size(state%contact_state)
         if (system%tangent(k) == 0) cycle
         associate (row => system%tangent(k), law => closing(k), compliance => system%compliance(k))
            if (state%contact_state(k) == contact_open) then
               cycle
            else if (state%contact_state(k) == contact_slip) then
               if (is_capped(state%direction(k))) cycle
               rows%partner(row) = system%normal(k)
               rows%share(row) = state%direction(k)*system%friction(k)
            else if (law%acts) then
               rows%partner(row) = system%normal(k)
               associate (scale => law%compliance(2) + compliance)
                  rows%own(row) = (law%fraction*law%compliance(2) + compliance)/scale
                  rows%share(row) = law%fraction*law%compliance(1)/scale
                  rows%spring(row) = (1.0_dp - law%fraction)/scale
               end associate
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
   end function combine

end module contact_rows
