!> Profile order for the skyline: reverse Cuthill-McKee from a pseudo-peripheral start.
!>
!> Source: A. George and J. W. H. Liu, Computer Solution of Large Sparse Positive Definite Systems,
!> 1981, ch. 4.
module ordering
   use kinds, only: dp, long
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: adjacency, alike_unknowns, positions_by_rank, profile_order, permuted_lower, &
      profile_length

contains

   !> Groups of neighbouring leading unknowns that are joined to the same ones, such as those of a
   !> node: a fill-reducing order keeps them together, and their graph is a fraction of the whole.
   !> Their rows hold the same columns, and their columns as many entries.
   pure function alike_unknowns(lower, leading) result(group)
      type(sparse_matrix_type), intent(in) :: lower !! lower triangle by rows
      integer, intent(in) :: leading                !! number of leading rows
      integer :: group(leading)                     !! group of each of them, ascending
      integer :: below(leading), i, k, n

      below = 0
      do i = 1, leading
         do k = lower%row_start(i), lower%row_start(i + 1) - 1
            below(lower%column(k)) = below(lower%column(k)) + 1
         end do
      end do
      group(:min(leading, 1)) = 1
      do i = 2, leading
         group(i) = group(i - 1) + 1
         if (below(i) /= below(i - 1) - 1) cycle
         associate (before => lower%row_start(i - 1), first => lower%row_start(i))
            n = first - before
            if (lower%row_start(i + 1) - first /= n + 1) cycle
            if (any(lower%column(first:first + n - 1) /= lower%column(before:first - 1))) cycle
            group(i) = group(i - 1)
         end associate
      end do
   end function alike_unknowns

   !> Graph of groups of the leading rows of a symmetric matrix: both triangles, without the
   !> diagonal.
   pure function adjacency(lower, group) result(graph)
      type(sparse_matrix_type), intent(in) :: lower !! lower triangle by rows
      integer, intent(in) :: group(:)               !! (leading) as from alike_unknowns
      type(sparse_matrix_type) :: graph             !! pattern; the values mean nothing
      type(triplet_list_type) :: list
      integer :: before, i, k, last

      call list%reserve(2*(lower%row_start(size(group) + 1) - 1))
      before = 0
      do i = 1, size(group)
         if (group(i) == before) cycle
         before = group(i)
         last = group(i)
         do k = lower%row_start(i), lower%row_start(i + 1) - 1
            associate (other => group(lower%column(k)))
               if (other == group(i) .or. other == last) cycle
               last = other
               call list%add(group(i), other, 1.0_dp)
               call list%add(other, group(i), 1.0_dp)
            end associate
         end do
      end do
      graph = list%compress(maxval([0, group]), maxval([0, group]))
   end function adjacency

   !> Positions of all unknowns in the order of elimination: the leading ones by rank, those of one
   !> rank in their own order, and the tail behind them.
   pure function positions_by_rank(rank, order) result(position)
      integer, intent(in) :: rank(:)                !! (leading) 1 or more, several may be the same
      integer, intent(in) :: order                  !! number of unknowns
      integer :: position(order)
      integer :: before(maxval([0, rank]) + 1), i

      before = 0
      do i = 1, size(rank)
         before(rank(i) + 1) = before(rank(i) + 1) + 1
      end do
      do i = 2, size(before)
         before(i) = before(i) + before(i - 1)
      end do
      do i = 1, size(rank)
         before(rank(i)) = before(rank(i)) + 1
         position(i) = before(rank(i))
      end do
      position(size(rank) + 1:) = [(i, i=size(rank) + 1, order)]
   end function positions_by_rank

   !> Order that keeps the profile short: reverse Cuthill-McKee, each connected part from a
   !> pseudo-peripheral vertex.
   pure function profile_order(graph) result(position)
      type(sparse_matrix_type), intent(in) :: graph !! as from adjacency
      integer :: position(graph%row_count)          !! new position of each vertex
      integer, allocatable :: level(:), order(:)
      integer :: start, placed, first

      allocate (level(graph%row_count), order(graph%row_count), source=0)
      placed = 0
      do first = 1, graph%row_count
         if (level(first) /= 0) cycle
         start = pseudo_peripheral(graph, first)
         call breadth_first(graph, start, level, order(placed + 1:))
         placed = count(level /= 0)
      end do
      do placed = 1, graph%row_count
         position(order(placed)) = graph%row_count + 1 - placed
      end do
   end function profile_order

   !> A vertex almost as far from some other as the graph allows.
   pure function pseudo_peripheral(graph, first) result(vertex)
      type(sparse_matrix_type), intent(in) :: graph
      integer, intent(in) :: first
      integer :: vertex
      integer :: level(graph%row_count), order(graph%row_count)
      integer :: depth, reached, candidate

      vertex = first
      depth = 0
      do
         level = 0
         call breadth_first(graph, vertex, level, order)
         if (maxval(level) <= depth) exit
         depth = maxval(level)
         reached = count(level /= 0)
         candidate = order(reached)
         vertex = candidate
      end do
   end function pseudo_peripheral

   !> Cuthill-McKee: vertices by distance from the start, in each front those of low degree first.
   pure subroutine breadth_first(graph, start, level, order)
      type(sparse_matrix_type), intent(in) :: graph
      integer, intent(in) :: start
      integer, intent(inout) :: level(:)   !! 0 where not yet reached; 1 + distance on exit
      integer, intent(inout) :: order(:)   !! vertices in the order of their visit
      integer :: head, tail, front, k, neighbour

      order(1) = start
      level(start) = 1
      head = 0
      tail = 1
      do while (head < tail)
         head = head + 1
         front = tail
         do k = graph%row_start(order(head)), graph%row_start(order(head) + 1) - 1
            neighbour = graph%column(k)
            if (level(neighbour) /= 0) cycle
            level(neighbour) = level(order(head)) + 1
            tail = tail + 1
            order(tail) = neighbour
         end do
         call sort_by_degree(graph, order(front + 1:tail))
      end do
   end subroutine breadth_first

   !> Insertion sort of a short list by degree.
   pure subroutine sort_by_degree(graph, list)
      type(sparse_matrix_type), intent(in) :: graph
      integer, intent(inout) :: list(:)
      integer :: i, j, vertex

      do i = 2, size(list)
         vertex = list(i)
         j = i - 1
         do while (j >= 1)
            if (degree(graph, list(j)) <= degree(graph, vertex)) exit
            list(j + 1) = list(j)
            j = j - 1
         end do
         list(j + 1) = vertex
      end do
   end subroutine sort_by_degree

   pure function degree(graph, vertex) result(neighbours)
      type(sparse_matrix_type), intent(in) :: graph
      integer, intent(in) :: vertex
      integer :: neighbours

      neighbours = graph%row_start(vertex + 1) - graph%row_start(vertex)
   end function degree

   !> The lower triangle in a new order.
   pure function permuted_lower(lower, position) result(permuted)
      type(sparse_matrix_type), intent(in) :: lower !! lower triangle by rows
      integer, intent(in) :: position(:)            !! (rows) new position of each old index
      type(sparse_matrix_type) :: permuted          !! lower triangle by rows
      type(triplet_list_type) :: list
      integer :: i, j, k

      call list%reserve(size(lower%value))
      do i = 1, lower%row_count
         do k = lower%row_start(i), lower%row_start(i + 1) - 1
            j = lower%column(k)
            call list%add(max(position(i), position(j)), min(position(i), position(j)), &
               lower%value(k))
         end do
      end do
      permuted = list%compress(lower%row_count, lower%row_count)
   end function permuted_lower

   !> Stored entries of a skyline in the given order.
   pure function profile_length(lower) result(length)
      type(sparse_matrix_type), intent(in) :: lower !! lower triangle by rows
      integer(long) :: length !! entries from the first non-zero to the diagonal
      integer :: i

      length = 0
      do i = 1, lower%row_count
         length = length + i - lower%column(lower%row_start(i)) + 1
      end do
   end function profile_length

end module ordering
