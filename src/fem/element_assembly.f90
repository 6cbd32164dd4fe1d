!> Sums of element matrices. Which entries they have is known from the nodes of the elements, so
!> each element adds to its places, and nothing is sorted but the neighbours of a node.
module element_assembly
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use mesh, only: mesh_type
   use sorting, only: invert_lists
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: element_assembly_type

   !> A matrix with a block of rows and columns for every two nodes of an element.
   type :: element_assembly_type
      type(sparse_matrix_type) :: matrix             !! the sum so far
      integer, private :: rows = 0, columns = 0      !! of a block
      integer, allocatable, private :: start(:)      !! (nodes + 1) first neighbour of each node
      integer, allocatable, private :: neighbour(:)  !! the node itself among them, ascending
      integer, allocatable, private :: position(:)   !! (nodes) of each in the row that is filled
   contains
      procedure :: begin
      procedure :: add
   end type element_assembly_type

contains

   !> Zero, with a place for every block.
   pure subroutine begin(self, mesh, rows, columns)
      class(element_assembly_type), intent(inout) :: self   !! fresh
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: rows                    !! of each node
      integer, intent(in) :: columns                 !! of each node
      integer :: a, b, i, nodes

      self%rows = rows
      self%columns = columns
      call find_neighbours(mesh, self%start, self%neighbour)
      nodes = size(self%start) - 1
      allocate (self%position(nodes))
      associate (matrix => self%matrix, start => self%start, neighbour => self%neighbour)
         matrix%row_count = rows*nodes
         matrix%column_count = columns*nodes
         matrix%in_pairs = rows == 2 .and. columns == 2
         allocate (matrix%row_start(rows*nodes + 1), matrix%column(rows*columns*size(neighbour)))
         allocate (matrix%value(rows*columns*size(neighbour)), source=0.0_dp)
         matrix%row_start(1) = 1
         do i = 1, nodes
            associate (beside => neighbour(start(i):start(i + 1) - 1))
               do a = rows*(i - 1) + 1, rows*i
                  matrix%row_start(a + 1) = matrix%row_start(a) + columns*size(beside)
                  do b = 1, columns
                     matrix%column(matrix%row_start(a) + b - 1:matrix%row_start(a + 1) - 1: &
                        columns) = columns*(beside - 1) + b
                  end do
               end do
            end associate
         end do
      end associate
   end subroutine begin

   !> Adds the matrix of an element.
   pure subroutine add(self, nodes, block)
      class(element_assembly_type), intent(inout) :: self
      integer, intent(in) :: nodes(:)                !! (n) nodes of the element
      real(dp), intent(in) :: block(:, :)            !! (rows*n, columns*n)
      integer :: a, b, k, p, place(size(nodes)), q

      associate (rows => self%rows, columns => self%columns)
         do p = 1, size(nodes)
            do k = self%start(nodes(p)), self%start(nodes(p) + 1) - 1
               self%position(self%neighbour(k)) = columns*(k - self%start(nodes(p)))
            end do
            place = self%position(nodes)
            do a = 1, rows
               associate (first => self%matrix%row_start(rows*(nodes(p) - 1) + a) - 1)
                  do q = 1, size(nodes)
                     k = first + place(q)
                     do b = 1, columns
                        self%matrix%value(k + b) = self%matrix%value(k + b) + &
                           block(rows*(p - 1) + a, columns*(q - 1) + b)
                     end do
                  end do
               end associate
            end do
         end do
      end associate
   end subroutine add

   !> The nodes of all elements at each node, ascending.
   pure subroutine find_neighbours(mesh, start, neighbour)
      type(mesh_type), intent(in) :: mesh
      integer, allocatable, intent(out) :: start(:), neighbour(:)
      integer :: last_of(size(mesh%node_number)), e, first, i, k, last, q
      integer, allocatable :: element(:), first_element(:)

      call invert_lists(mesh%element_nodes, element_node_count(mesh%element_kind), &
         size(mesh%node_number), first_element, element)
      allocate (start(size(last_of) + 1), neighbour(sum(element_node_count(mesh%element_kind)**2)))
      last_of = 0
      start(1) = 1
      do i = 1, size(last_of)
         first = start(i)
         last = first - 1
         do e = first_element(i), first_element(i + 1) - 1
            do q = 1, element_node_count(mesh%element_kind(element(e)))
               associate (node => mesh%element_nodes(q, element(e)))
                  if (last_of(node) == i) cycle
                  last_of(node) = i
                  do k = last, first, -1
                     if (neighbour(k) < node) exit
                     neighbour(k + 1) = neighbour(k)
                  end do
                  neighbour(k + 1) = node
                  last = last + 1
               end associate
            end do
         end do
         start(i + 1) = last + 1
      end do
      neighbour = neighbour(:last)
   end subroutine find_neighbours

end module element_assembly
