!> The rows of the contact system under one active set: which relative displacements are sought, and
!> what forces and displacements enter the row of each. A slipping pair's tangential row is lambda_t
!> + share lambda_n = 0, that of a pair which closes and sticks (contact_system), divided by f c_t,
!> own lambda_t + share lambda_n + spring d_t = 0.
module contact_rows
   use contact_states, only: closing_law_type, contact_state_type, status_open, status_slip
   use contact_system, only: contact_system_type
   use kinds, only: dp
   implicit none
   private
   public :: contact_rows_type, rows_of

   !> Rows of an active set.
   type :: contact_rows_type
      integer, allocatable :: free(:)        !! places on the tail that are sought
      integer, allocatable :: partner(:)     !! (tail) place of d_n whose force enters the row, or 0
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
      type(contact_state_type), intent(in) :: state       !! statuses and directions
      type(closing_law_type), intent(in) :: closing(:)    !! (m) laws of closing pairs
      type(contact_rows_type) :: rows
      logical :: sought(2, size(state%status))
      integer :: k, tail

      tail = size(system%schur, 1)
      allocate (rows%partner(tail), source=0)
      allocate (rows%share(tail), rows%spring(tail), source=0.0_dp)
      allocate (rows%own(tail), source=1.0_dp)
      sought(1, :) = state%status == status_open
      sought(2, :) = system%tangent > 0
      do k = 1, size(state%status)
         if (system%tangent(k) == 0) cycle
         associate (place => system%tangent(k), law => closing(k), gives => system%compliance(k))
            if (state%status(k) == status_open) then
               cycle
            else if (state%status(k) == status_slip) then
               rows%partner(place) = system%normal(k)
               rows%share(place) = state%direction(k)*system%friction(k)
            else if (law%acts) then
               rows%partner(place) = system%normal(k)
               associate (scale => law%compliance(2) + gives)
                  rows%own(place) = (law%fraction*law%compliance(2) + gives)/scale
                  rows%share(place) = law%fraction*law%compliance(1)/scale
                  rows%spring(place) = (1.0_dp - law%fraction)/scale
               end associate
            else if (gives > 0.0_dp) then
               rows%spring(place) = 1.0_dp/gives
            else
               sought(2, k) = .false.
            end if
         end associate
      end do
      rows%free = [pack(reshape([(system%normal(k), system%tangent(k), k=1, size(state%status))], &
         shape(sought)), sought), system%link]
   end function rows_of

   !> Forces, or columns of S, as they enter the rows.
   pure function combine(self, columns) result(rows)
      class(contact_rows_type), intent(in) :: self
      real(dp), intent(in) :: columns(:, :)           !! (tail, columns)
      real(dp) :: rows(size(columns, 1), size(columns, 2))
      integer :: i

      do i = 1, size(columns, 1)
         rows(i, :) = self%own(i)*columns(i, :)
         if (self%partner(i) == 0) cycle
         rows(i, :) = rows(i, :) + self%share(i)*columns(self%partner(i), :)
      end do
   end function combine

end module contact_rows
