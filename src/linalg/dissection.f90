!> Nested dissection of a graph by levels (A. George and J. W. H. Liu, Computer Solution of Large
!> Sparse Positive Definite Systems, 1981, ch. 8): the vertices at one distance from an outer vertex
!> that are joined to the next distance separate what is nearer from what is farther. Assemblies are
!> long and narrow, and so are their graphs. Halving the levels again and again, where few vertices
!> separate them, makes a tree of fronts: each is joined only to fronts above it or below it.
module dissection
   use ordering, only: find_levels
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: front_tree_type, dissected

   integer, parameter :: smallest = 16   !! vertices that are not divided further

   !> Fronts from the outermost ones to the last, which holds no vertex and is above all.
   type :: front_tree_type
      integer, allocatable :: parent(:)        !! (fronts) the next one above, 0 for the last
      integer, allocatable :: front(:)         !! (vertices) in which each is eliminated
      !> Fronts of edges of vertex i, the lower one of both ends: touched(start(i):start(i + 1) - 1)
      integer, allocatable :: start(:), touched(:)
   end type front_tree_type

contains

   !> The tree of a graph.
   pure function dissected(graph) result(tree)
      type(sparse_matrix_type), intent(in) :: graph   !! pattern, both triangles
      type(front_tree_type) :: tree
      integer, dimension(graph%row_count) :: level
      integer, allocatable :: before(:), cut(:), first(:), rest(:), separator(:), top(:)
      logical :: separates(graph%row_count)
      integer :: i, n

      call find_levels(graph, level, first)
      allocate (rest(maxval([0, level])), separator(maxval([0, level])), source=0)
      do i = 1, size(separates)
         separates(i) = any(level(graph%column(graph%row_start(i):graph%row_start(i + 1) - 1)) == &
            level(i) + 1)
      end do
      allocate (before(size(rest) + 1), source=0)
      do i = 1, size(level)
         before(level(i) + 1) = before(level(i) + 1) + 1
      end do
      do i = 2, size(before)
         before(i) = before(i) + before(i - 1)
      end do
      allocate (cut(size(rest)), source=0)
      do i = 1, size(level)
         if (separates(i)) cut(level(i)) = cut(level(i)) + 1
      end do
      allocate (tree%parent(2*size(rest) + 1), source=0)
      n = 0
      allocate (top(size(first) - 1))
      do i = 1, size(top)
         call halve(before, cut, first(i), first(i + 1) - 1, n, rest, separator, tree%parent)
         top(i) = n
      end do
      n = n + 1
      tree%parent(top) = n
      tree%parent = tree%parent(:n)
      tree%front = merge(separator(level), rest(level), separates)
      call find_touched(graph, tree)
   end function dissected

   !> Numbers the fronts of some levels, those below before those above.
   pure recursive subroutine halve(before, cut, first, last, n, rest, separator, parent)
      integer, intent(in) :: before(:)             ! (levels + 1) vertices up to each
      integer, intent(in) :: cut(:)               ! (levels) vertices that separate it from the next
      integer, intent(in) :: first, last           ! levels
      integer, intent(inout) :: n                  ! last number given
      !> (levels) Numbers of what separates a level from the next, and of the rest of it
      integer, intent(inout) :: rest(:), separator(:)
      integer, intent(inout) :: parent(:)
      integer :: left, middle, quarter

      if (first == last .or. before(last + 1) - before(first) <= smallest) then
         n = n + 1
         rest(first:last) = n
         separator(first:last - 1) = n
         return
      end if
      quarter = (last - first)/4
      middle = first + quarter - 1 + minloc(cut(first + quarter:last - 1 - quarter), dim=1)
      call halve(before, cut, first, middle, n, rest, separator, parent)
      left = n
      call halve(before, cut, middle + 1, last, n, rest, separator, parent)
      parent(n) = n + 1
      parent(left) = n + 1
      n = n + 1
      separator(middle) = n
   end subroutine halve

   !> The fronts that hold the entries of each vertex.
   pure subroutine find_touched(graph, tree)
      type(sparse_matrix_type), intent(in) :: graph
      type(front_tree_type), intent(inout) :: tree
      integer :: i, k, n, last(size(tree%parent))

      allocate (tree%start(graph%row_count + 1), tree%touched(size(graph%column) + graph%row_count))
      last = 0
      n = 0
      do i = 1, graph%row_count
         tree%start(i) = n + 1
         last(tree%front(i)) = i
         n = n + 1
         tree%touched(n) = tree%front(i)
         do k = graph%row_start(i), graph%row_start(i + 1) - 1
            associate (front => min(tree%front(i), tree%front(graph%column(k))))
               if (last(front) == i) cycle
               last(front) = i
               n = n + 1
               tree%touched(n) = front
            end associate
         end do
      end do
      tree%start(graph%row_count + 1) = n + 1
      tree%touched = tree%touched(:n)
   end subroutine find_touched

end module dissection
