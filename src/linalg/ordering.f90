!> Orders of elimination. For a skyline: reverse Cuthill-McKee from a pseudo-peripheral start
!> (A. George and J. W. H. Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981,
!> ch. 4). For MUMPS and for fronts: nested dissection by METIS.
module ordering
   use, intrinsic :: iso_c_binding, only: c_int
   use errors, only: error_type, set_error, status_internal
   use kinds, only: dp
   use sorting, only: sort_order
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: adjacency, alike_unknowns, first_rows, nested_dissection, positions_by_rank, &
      profile_order

   interface
      !> METIS_NodeND while SIGTERM waits.
      function order_graph(vertices, start, neighbour, order, position) result(status) &
         bind(c, name='thercon_order_graph')
         import :: c_int
         integer(c_int), value :: vertices
         integer(c_int), intent(in) :: start(*), neighbour(*)   ! from 0
         integer(c_int), intent(out) :: order(*), position(*)
         integer(c_int) :: status
      end function order_graph
   end interface

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
      integer :: depth

      vertex = first
      depth = 0
      do
         level = 0
         call breadth_first(graph, vertex, level, order)
         if (maxval(level) <= depth) exit
         depth = maxval(level)
         vertex = order(count(level /= 0))
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
         if (tail <= front + 1) cycle
         associate (beside => order(front + 1:tail))
            beside = beside(sort_order(graph%row_start(beside + 1) - graph%row_start(beside)))
         end associate
      end do
   end subroutine breadth_first

   !> Fill-reducing position of each vertex of a graph. METIS's default options fix its random seed.
   !> Error: METIS fails, and there are no positions.
   subroutine nested_dissection(graph, position, error)
      type(sparse_matrix_type), intent(in) :: graph !! both triangles without the diagonal
      integer, allocatable, intent(out) :: position(:)    !! (rows) new position of each vertex
      type(error_type), allocatable, intent(out) :: error
      integer(c_int), allocatable :: order(:)
      integer(c_int) :: status
      integer(c_int), parameter :: metis_ok = 1, metis_has_no_memory = -3

      allocate (order(graph%row_count), position(graph%row_count))
      ! METIS divides by the number of vertices.
      if (graph%row_count == 0) return
      status = order_graph(int(graph%row_count, c_int), graph%row_start - 1, graph%column - 1, &
         order, position)
      position(:) = position + 1
      if (status == metis_ok) return
      deallocate (position)
      call set_error(error, status_internal, 'METIS could not order the unknowns')
      if (status == metis_has_no_memory) error%message = error%message//': memory ran out'
   end subroutine nested_dissection

   !> First row of each column of a symmetric matrix in another order, the skyline.
   pure function first_rows(lower, position) result(first)
      type(sparse_matrix_type), intent(in) :: lower !! lower triangle by rows
      integer, intent(in) :: position(:)            !! (rows) new position of each row
      integer :: first(size(position))              !! (new positions)
      integer :: i, j, k, row

      first = [(j, j=1, size(first))]
      do row = 1, size(position)
         do k = lower%row_start(row), lower%row_start(row + 1) - 1
            i = min(position(row), position(lower%column(k)))
            j = max(position(row), position(lower%column(k)))
            first(j) = min(first(j), i)
         end do
      end do
   end function first_rows

end module ordering
