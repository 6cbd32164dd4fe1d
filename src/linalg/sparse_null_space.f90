!> Null space of a matrix whose rows have few entries, by elimination.
module sparse_null_space
   use kinds, only: dp
   use sorting, only: sort_order
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: null_space_of

   !> What rows leave, beside the largest entry of all, that makes them pivots in each round: the
   !> better pivots come first. Less is rounding.
   real(dp), parameter :: left(4) = [1.0e-1_dp, 1.0e-3_dp, 1.0e-6_dp, 1.0e-9_dp]

   !> A row on its way through the elimination.
   type :: row_type
      real(dp), allocatable :: entry(:)                  !! (columns)
      integer :: count = 0                               !! columns that have been filled
      integer, allocatable :: filled(:)                  !! (columns) which, each once
      logical, allocatable :: is_filled(:)               !! (columns)
   end type row_type

contains

   !> Basis of the vectors that all rows map to zero: each has a component 1 that the others have
   !> not, and those that the rows do not join have zeros.
   pure function null_space_of(rows, columns, counts) result(basis)
      type(sum_list_type), intent(in) :: rows            !! (m, columns)
      integer, intent(in) :: columns                     !! n
      logical, intent(in), optional :: counts(:)         !! (m) absent where all rows do
      real(dp), allocatable :: basis(:, :)               !! (n, n - rank)
      type(sum_list_type) :: kept
      type(row_type) :: row
      integer :: i, j, k, pass, pivot(columns), rank
      integer :: turn(columns)                           ! in which a column got its pivot, or 0
      logical :: remains(rows%count)
      real(dp) :: largest, largest_left

      remains = .true.
      if (present(counts)) remains = counts
      largest = 0.0_dp
      do i = 1, rows%count
         if (.not. remains(i)) cycle
         do k = rows%start(i), rows%start(i + 1) - 1
            largest = max(largest, abs(rows%coefficient(k)))
         end do
      end do
      call kept%reserve(columns, 4*columns)
      allocate (row%entry(columns), source=0.0_dp)
      allocate (row%is_filled(columns), source=.false.)
      allocate (row%filled(columns))
      rank = 0
      turn = 0
      do pass = 1, size(left)
         do i = 1, rows%count
            if (.not. remains(i)) cycle
            if (rank == columns) exit
            call add(row, rows, i, 1.0_dp)
            j = 0
            do
               associate (own => row%filled(:row%count))
                  j = minval(turn(own), mask=turn(own) > j .and. abs(row%entry(own)) > 0.0_dp)
               end associate
               if (j > rank) exit
               call add(row, kept, j, -row%entry(pivot(j)))
               row%entry(pivot(j)) = 0.0_dp
            end do
            associate (own => row%filled(:row%count))
               own = own(sort_order(own))
               largest_left = maxval(abs(row%entry(own)))
               remains(i) = largest_left > left(size(left))*largest
               if (largest_left > left(pass)*largest) then
                  remains(i) = .false.
                  rank = rank + 1
                  pivot(rank) = own(maxloc(abs(row%entry(own)), dim=1))
                  turn(pivot(rank)) = rank
                  call kept%add(own, row%entry(own)/row%entry(pivot(rank)))
               end if
               row%entry(own) = 0.0_dp
               row%is_filled(own) = .false.
            end associate
            row%count = 0
         end do
      end do
      allocate (basis(columns, columns - rank), source=0.0_dp)
      i = 0
      do j = 1, columns
         if (turn(j) > 0) cycle
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

   !> Adds a multiple of a sum to a row.
   pure subroutine add(row, sums, i, factor)
      type(row_type), intent(inout) :: row
      type(sum_list_type), intent(in) :: sums
      integer, intent(in) :: i                           ! the sum
      real(dp), intent(in) :: factor
      integer :: k

      do k = sums%start(i), sums%start(i + 1) - 1
         associate (column => sums%value(k))
            if (.not. row%is_filled(column)) then
               row%count = row%count + 1
               row%filled(row%count) = column
               row%is_filled(column) = .true.
            end if
            row%entry(column) = row%entry(column) + factor*sums%coefficient(k)
         end associate
      end do
   end subroutine add

end module sparse_null_space
