!> The tree of fronts of a sparse matrix: nested dissection by METIS, the elimination tree of this
!> order with the columns of its factors (J. W. H. Liu, SIAM J. Matrix Anal. Appl. 11 (1990) 134),
!> and one front for the unknowns of a chain of columns with the same rows. Small fronts are
!> joined, since a front costs something by itself. Each front is joined only to fronts above it or
!> below it.
module front_tree
   use errors, only: error_type
   use ordering, only: nested_dissection
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: front_tree_type, set_front_tree

   integer, parameter :: smallest = 16   !! unknowns of a front that is not joined to a small one

   !> Fronts from the outermost ones to the last, which holds no vertex and is above all.
   type :: front_tree_type
      integer, allocatable :: parent(:)        !! (fronts) the next one above, 0 for the last
      integer, allocatable :: front(:)         !! (vertices) in which each is eliminated
      !> Fronts of edges of vertex i, the lower one of both ends: touched(start(i):start(i + 1) - 1)
      integer, allocatable :: start(:), touched(:)
   contains
      procedure :: front_above
   end type front_tree_type

contains

   !> The tree of a graph.
   !> Error: METIS fails.
   subroutine set_front_tree(graph, tree, error)
      type(sparse_matrix_type), intent(in) :: graph   !! pattern, both triangles, no diagonal
      type(front_tree_type), intent(out) :: tree
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: position(:)
      integer, dimension(graph%row_count) :: above, below, head
      integer :: i, n

      call nested_dissection(graph, position, error)
      if (allocated(error)) return
      call eliminate(graph, position, above, below)
      call join(above, below, head)
      ! Fronts are numbered in the order of the vertices that they eliminate last.
      n = 0
      do i = 1, size(head)
         if (head(i) /= i) cycle
         n = n + 1
         below(i) = n
      end do
      allocate (tree%parent(n + 1), source=n + 1)
      tree%parent(n + 1) = 0
      do i = 1, size(head)
         if (head(i) == i .and. above(i) > 0) tree%parent(below(i)) = below(head(above(i)))
      end do
      tree%front = below(head(position))
      call find_touched(graph, tree)
   end subroutine set_front_tree

   !> The first front that is above all of some vertices, or is theirs.
   pure integer function front_above(self, vertices) result(front)
      class(front_tree_type), intent(in) :: self
      integer, intent(in) :: vertices(:)
      integer :: i, other

      front = self%front(vertices(1))
      do i = 2, size(vertices)
         other = self%front(vertices(i))
         do while (front /= other)
            if (front < other) then
               front = self%parent(front)
            else
               other = self%parent(other)
            end if
         end do
      end do
   end function front_above

   !> The elimination tree, and how many rows each column has below its diagonal.
   pure subroutine eliminate(graph, position, above, below)
      type(sparse_matrix_type), intent(in) :: graph
      integer, intent(in) :: position(:)              ! (vertices) of each in the order
      integer, intent(out) :: above(:), below(:)      ! (positions) next one above, 0 for none; rows
      integer :: i, j, k, reached(size(position)), vertex(size(position))

      vertex(position) = [(i, i=1, size(position))]
      above = 0
      below = 0
      reached = 0
      do i = 1, size(position)
         reached(i) = i
         do k = graph%row_start(vertex(i)), graph%row_start(vertex(i) + 1) - 1
            j = position(graph%column(k))
            if (j > i) cycle
            do while (reached(j) /= i)
               reached(j) = i
               below(j) = below(j) + 1
               if (above(j) == 0) above(j) = i
               j = above(j)
            end do
         end do
      end do
   end subroutine eliminate

   !> Joins columns to the front above: those with the same rows, and fronts that both are small.
   pure subroutine join(above, below, head)
      integer, intent(in) :: above(:), below(:)
      integer, intent(out) :: head(:)      ! (positions) the last one of the same front
      integer :: i, unknowns(size(head))

      unknowns = 0
      do i = size(head), 1, -1
         head(i) = i
         if (above(i) > 0) then
            if (below(i) == below(above(i)) + 1) head(i) = head(above(i))
         end if
         unknowns(head(i)) = unknowns(head(i)) + 1
      end do
      do i = 1, size(head)
         if (head(i) /= i .or. above(i) == 0) cycle
         associate (upper => head(above(i)))
            if (max(unknowns(i), unknowns(upper)) >= smallest) cycle
            unknowns(upper) = unknowns(upper) + unknowns(i)
            head(i) = upper
         end associate
      end do
      do i = size(head), 1, -1
         head(i) = head(head(i))
      end do
   end subroutine join

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

end module front_tree
