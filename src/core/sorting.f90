!> Sorting of integers, and the way from a number to its position in a list.
module sorting
   implicit none
   private
   public :: sort_order, unique_sorted, repeated, invert_lists, number_index_type

   !> Finds where a number is in a list that need not be sorted.
   type :: number_index_type
      private
      integer, allocatable :: sorted(:)   !! the numbers, ascending
      integer, allocatable :: position(:) !! where each is in the list
   contains
      procedure :: build
      procedure :: find
      procedure :: is_empty
      procedure :: largest
   end type number_index_type

contains

   !> The order that sorts a list; equal numbers keep their order (merge sort).
   pure function sort_order(numbers) result(order)
      integer, intent(in) :: numbers(:)            !! (n) numbers in any order
      integer :: order(size(numbers))              !! numbers(order) ascends
      integer :: merged(size(numbers)), i, n, width, first, middle, last

      n = size(numbers)
      order = [(i, i=1, n)]
      if (all(numbers(2:) >= numbers(:n - 1))) return
      width = 1
      do while (width < n)
         do first = 1, n, 2*width
            middle = min(first + width - 1, n)
            last = min(first + 2*width - 1, n)
            call merge_runs(numbers, order(first:middle), order(middle + 1:last), &
               merged(first:last))
         end do
         order = merged
         width = 2*width
      end do
   end function sort_order

   !> Merges two sorted runs of positions.
   pure subroutine merge_runs(numbers, left, right, merged)
      integer, intent(in) :: numbers(:), left(:), right(:)
      integer, intent(out) :: merged(:)
      integer :: i, j, k

      i = 1
      j = 1
      do k = 1, size(merged)
         if (i > size(left)) then
            merged(k) = right(j)
            j = j + 1
         else if (j > size(right)) then
            merged(k) = left(i)
            i = i + 1
         else if (numbers(right(j)) < numbers(left(i))) then
            merged(k) = right(j)
            j = j + 1
         else
            merged(k) = left(i)
            i = i + 1
         end if
      end do
   end subroutine merge_runs

   !> The numbers of a list in ascending order, each once.
   pure function unique_sorted(numbers) result(members)
      integer, intent(in) :: numbers(:)        !! (n) numbers in any order
      integer, allocatable :: members(:)       !! ascending, each once
      integer :: sorted(size(numbers))
      logical :: first(size(numbers))

      sorted = numbers(sort_order(numbers))
      if (size(sorted) > 0) first(1) = .true.
      first(2:) = sorted(2:) /= sorted(:size(sorted) - 1)
      members = pack(sorted, first)
   end function unique_sorted

   !> Positions of the numbers that are in the list before.
   pure function repeated(numbers) result(positions)
      integer, intent(in) :: numbers(:)        !! (n) numbers in any order
      integer, allocatable :: positions(:)     !! positions of the second and later ones of equals
      integer :: order(size(numbers)), n

      n = size(numbers)
      order = sort_order(numbers)
      positions = pack(order(2:), numbers(order(2:)) == numbers(order(:n - 1)))
   end function repeated

   !> The lists that hold each of the numbers from 1 to n.
   pure subroutine invert_lists(lists, counts, n, start, holders)
      integer, intent(in) :: lists(:, :)                  !! (most numbers, lists)
      integer, intent(in) :: counts(:)                    !! (lists) numbers in each
      integer, intent(in) :: n                            !! largest number
      integer, allocatable, intent(out) :: start(:)       !! (n + 1) first holder of each
      integer, allocatable, intent(out) :: holders(:)     !! ascending for each number
      integer :: i, k

      allocate (start(n + 1), source=0)
      do i = 1, size(counts)
         do k = 1, counts(i)
            start(lists(k, i)) = start(lists(k, i)) + 1
         end do
      end do
      start(1) = start(1) + 1
      do i = 2, size(start)
         start(i) = start(i) + start(i - 1)
      end do
      allocate (holders(start(size(start)) - 1))
      do i = size(counts), 1, -1
         do k = 1, counts(i)
            start(lists(k, i)) = start(lists(k, i)) - 1
            holders(start(lists(k, i))) = i
         end do
      end do
   end subroutine invert_lists

   !> Makes the index of a list; of equal numbers the first is found.
   pure subroutine build(self, numbers)
      class(number_index_type), intent(inout) :: self
      integer, intent(in) :: numbers(:)                !! (n) the list

      self%position = sort_order(numbers)
      self%sorted = numbers(self%position)
   end subroutine build

   !> Position of a number in the list by bisection; 0 where the list does not hold it.
   pure function find(self, number) result(position)
      class(number_index_type), intent(in) :: self
      integer, intent(in) :: number                 !! number that is looked for
      integer :: position                           !! its position, the first of equals
      integer :: low, high, middle

      position = 0
      if (.not. allocated(self%sorted)) return
      low = 1
      high = size(self%sorted)
      do while (low < high)
         middle = (low + high)/2
         if (self%sorted(middle) < number) then
            low = middle + 1
         else
            high = middle
         end if
      end do
      if (low > size(self%sorted)) return
      if (self%sorted(low) == number) position = self%position(low)
   end function find

   !> Whether the list holds nothing.
   pure logical function is_empty(self)
      class(number_index_type), intent(in) :: self

      is_empty = .true.
      if (allocated(self%sorted)) is_empty = size(self%sorted) == 0
   end function is_empty

   !> The largest number of a list that is not empty.
   pure integer function largest(self)
      class(number_index_type), intent(in) :: self

      largest = self%sorted(size(self%sorted))
   end function largest

end module sorting
