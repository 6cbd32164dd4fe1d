!> What rows of constraints say beside those before them.
module row_origins
   use constraint_rows, only: constraint_rows_type, elimination_type, largest, &
      least_coefficients, negligible_in_tie, resolve, row_origin_type, write_values
   use kinds, only: dp
   implicit none
   private
   public :: dependent_rows, origins_of

contains

   !> Rows of degrees of freedom alone to which those before leave less of any than a part of their
   !> largest coefficient. Each writes its choice, else one of the largest.
   pure function dependent_rows(rows, least) result(dependent)
      type(constraint_rows_type), intent(in) :: rows
      real(dp), intent(in) :: least             !! the part
      logical :: dependent(rows%count)
      type(elimination_type) :: found
      integer :: i

      found%least = [(least*largest(rows, i), i=1, rows%count)]
      call write_values(rows, 2*rows%dofs, found)
      dependent = found%written == 0
   end function dependent_rows

   !> The constraints before from which the rows of a constraint follow. Every row is marked by a
   !> value of its own, whose coefficient is its share in what is left of the row.
   pure function origins_of(rows, constraint) result(origins)
      type(constraint_rows_type), intent(in) :: rows
      type(row_origin_type), intent(in) :: constraint   !! one that is left no degree of freedom
      type(row_origin_type), allocatable :: origins(:)  !! constraints, in their order
      type(constraint_rows_type) :: marked
      type(elimination_type) :: found
      integer, allocatable :: value(:)
      real(dp), allocatable :: coefficient(:)
      logical :: is_origin(rows%count), of_part(rows%count), is_left
      integer :: i, k, last

      last = 2*rows%dofs + size(rows%on_tail)
      marked = rows
      call marked%reserve(rows%count, size(rows%value) + rows%count)
      do i = 1, rows%count
         call marked%add([rows%values_of(i), last + i], [rows%coefficients_of(i), 1.0_dp])
      end do
      found%least = least_coefficients(marked)
      call write_values(marked, last + rows%count, found)
      is_origin = .false.
      of_part = .false.
      do i = 1, rows%count
         if (.not. rows%origin(i) == constraint) cycle
         call resolve(found, marked, i, value, coefficient)
         coefficient = merge(coefficient, 0.0_dp, abs(coefficient) > &
            negligible_in_tie*largest(rows, i))
         is_left = any(value <= rows%dofs .and. abs(coefficient) > 0.0_dp)
         do k = 1, size(value)
            if (value(k) <= last .or. abs(coefficient(k)) <= 0.0_dp) cycle
            if (is_left) of_part(value(k) - last) = .true.
            if (.not. is_left) is_origin(value(k) - last) = .true.
         end do
      end do
      ! Where no row alone follows from others, the rows together do.
      if (.not. any(is_origin)) is_origin = of_part
      is_origin = is_origin .and. .not. rows%origin(:rows%count) == constraint
      origins = pack(rows%origin(:rows%count), is_origin)
   end function origins_of

end module row_origins
