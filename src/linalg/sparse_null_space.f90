!> Null space of a matrix whose rows have few entries, by elimination.
module sparse_null_space
   use kinds, only: dp
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: null_space_of

   !> What rows leave, beside the largest entry of all, that makes them pivots in each round: the
   !> better pivots come first. Less is rounding.
   real(dp), parameter :: left(4) = [1.0e-1_dp, 1.0e-3_dp, 1.0e-6_dp, 1.0e-9_dp]

contains

   !> Basis of the vectors that all rows map to zero: each has a component 1 that the others have
   !> not, and those that the rows do not join have zeros.
   pure function null_space_of(rows, columns, counts) result(basis)
      type(sum_list_type), intent(in) :: rows            !! (m, columns)
      integer, intent(in) :: columns                     !! n
      logical, intent(in), optional :: counts(:)         !! (m) absent where all rows do
      real(dp), allocatable :: basis(:, :)               !! (n, n - rank)
      type(sum_list_type) :: kept
      real(dp) :: row(columns)
      integer :: pivot(columns), i, j, k, rank, pass
      logical :: is_pivot(columns), remains(rows%count)
      real(dp) :: largest

      remains = .true.
      if (present(counts)) remains = counts
      largest = 0.0_dp
      do i = 1, rows%count
         if (remains(i)) largest = maxval([largest, abs(rows%coefficients_of(i))])
      end do
      call kept%reserve(columns, 4*columns)
      rank = 0
      is_pivot = .false.
      do pass = 1, size(left)
         do i = 1, rows%count
            if (.not. remains(i)) cycle
            if (rank == columns) exit
            row = 0.0_dp
            row(rows%values_of(i)) = rows%coefficients_of(i)
            do j = 1, rank
               if (abs(row(pivot(j))) <= 0.0_dp) cycle
               associate (factor => row(pivot(j)))
                  do k = kept%start(j), kept%start(j + 1) - 1
                     if (kept%value(k) /= pivot(j)) row(kept%value(k)) = row(kept%value(k)) - &
                        factor*kept%coefficient(k)
                  end do
               end associate
               row(pivot(j)) = 0.0_dp
            end do
            remains(i) = maxval(abs(row)) > left(size(left))*largest
            if (maxval(abs(row)) <= left(pass)*largest) cycle
            remains(i) = .false.
            rank = rank + 1
            pivot(rank) = maxloc(abs(row), dim=1)
            is_pivot(pivot(rank)) = .true.
            call kept%add([(k, k=1, columns)], row/row(pivot(rank)))
         end do
      end do
      allocate (basis(columns, columns - rank), source=0.0_dp)
      i = 0
      do j = 1, columns
         if (is_pivot(j)) cycle
         i = i + 1
         basis(j, i) = 1.0_dp
      end do
      do j = rank, 1, -1
         do k = kept%start(j), kept%start(j + 1) - 1
            if (kept%value(k) /= pivot(j)) basis(pivot(j), :) = basis(pivot(j), :) - &
               kept%coefficient(k)*basis(kept%value(k), :)
         end do
      end do
   end function null_space_of

end module sparse_null_space
