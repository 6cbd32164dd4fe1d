!> Bodies reduced to the nodes of their faces, piece by piece: the first of two stages where many
!> interfaces join many bodies, or where faces slide. Nodes that no constraint binds and that belong
!> to one piece only are inside; the others are kept: nodes of faces, supports, ties, equations, and
!> those at which a long body is cut. With i for the inside of a piece and k for the kept nodes
!> around it, the pieces leave of K u = f
!>
!>    K' = K_kk - sum K_ki K_ii^-1 K_ik,   f' = f_k - sum K_ki K_ii^-1 f_i.
!>
!> Nothing here knows which slave lies where on which master.
module body_pieces
   use controls, only: solver_mumps
   use errors, only: error_type
   use kinds, only: dp
   use ordering, only: profile_order
   use linear_solver, only: linear_solver_type
   use mumps_solver, only: mumps_solver_type
   use skyline_solver, only: skyline_solver_type
   use sorting, only: invert_lists
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: body_pieces_type, body_division_type

   integer, parameter :: most_around = 20   !! kept nodes around a piece of a sparse tail, about

   integer, parameter :: fixed = -1   !! piece of a prescribed degree of freedom

   !> Which piece each degree of freedom is inside of.
   type :: body_division_type
      !> (nodes, nodes) joined by elements; without values where bodies are not divided
      type(sparse_matrix_type) :: graph
      !> (dofs) 0 for kept ones; unallocated likewise. Where faces slide, prescribed ones are below
      !> 0 and no part of what is left; else these are kept
      integer, allocatable :: piece(:)
      !> (nodes) nodes of faces that slide, kept whichever contact points bind them; unallocated
      !> where none does. What is left of such bodies, which are not cut, goes to a solver; else it
      !> is a sparse tail
      logical, allocatable :: is_on_face(:)
      integer :: version = 0                         !! which division, counted
      !> (nodes), (dofs) that it was made for
      logical, allocatable, private :: is_bound(:), is_prescribed(:)
   contains
      procedure :: cuts_bodies
      procedure :: is_tail
      procedure :: keeps
      procedure :: divide
   end type body_division_type

   !> The inside of a piece, with its factors.
   type :: piece_type
      integer, allocatable :: inside(:), around(:)   !! degrees of freedom
      class(linear_solver_type), allocatable :: solver   !! those inside leading, around its tail
   end type piece_type

   !> All pieces of a field.
   type :: body_pieces_type
      type(piece_type), allocatable :: piece(:)
   contains
      procedure :: reduce
      procedure :: condense
      procedure :: fill
      procedure :: release
   end type body_pieces_type

contains

   !> Divides the bodies.
   pure subroutine divide(self, is_bound, is_prescribed, components)
      class(body_division_type), intent(inout) :: self   !! its graph in
      logical, intent(in) :: is_bound(:)                !! (nodes) kept, since constraints bind them
      logical, intent(in) :: is_prescribed(:)           !! (dofs) no part of what is left
      integer, intent(in) :: components                  !! degrees of freedom of a node
      integer, allocatable :: piece(:)
      logical :: is_kept(size(is_bound))
      integer :: i

      is_kept = is_bound
      if (allocated(self%is_on_face)) is_kept = is_bound .or. self%is_on_face
      if (allocated(self%is_bound)) then
         if (all(is_kept .eqv. self%is_bound) .and. all(is_prescribed .eqv. &
            self%is_prescribed)) return
      end if
      self%is_bound = is_kept
      self%is_prescribed = is_prescribed
      self%version = self%version + 1
      if (self%cuts_bodies()) then
         piece = divided_bodies(self%graph, is_kept)
      else
         piece = whole_bodies(self%graph, is_kept)
      end if
      self%piece = [(spread(piece(i), 1, components), i=1, size(piece))]
      where (is_prescribed) self%piece = fixed
   end subroutine divide

   !> Whether bodies are cut, into small pieces.
   pure logical function cuts_bodies(self)
      class(body_division_type), intent(in) :: self

      cuts_bodies = .not. allocated(self%is_on_face)
   end function cuts_bodies

   !> Whether what is left of the bodies is a tail.
   pure logical function is_tail(self)
      class(body_division_type), intent(in) :: self

      is_tail = allocated(self%piece) .and. self%cuts_bodies()
   end function is_tail

   !> Whether a degree of freedom is inside of no piece.
   pure logical function keeps(self, dof)
      class(body_division_type), intent(in) :: self
      integer, intent(in) :: dof

      keeps = .not. allocated(self%piece)
      if (.not. keeps) keeps = self%piece(dof) == 0
   end function keeps

   !> The piece inside of which each node is, 0 for kept ones.
   pure function divided_bodies(graph, is_bound) result(piece)
      type(sparse_matrix_type), intent(in) :: graph   !! (nodes, nodes) joined by elements
      logical, intent(in) :: is_bound(:)              !! (nodes)
      integer, allocatable :: piece(:)                !! (nodes)
      integer :: around(size(is_bound))               ! the last piece that a kept node is around
      integer, allocatable :: order(:)
      integer :: i, k, n, pieces
      logical :: is_joined

      allocate (piece(size(is_bound)), source=0)
      around = 0
      order = in_fronts(graph, .not. is_bound)
      pieces = 0
      n = 0
      do i = 1, size(order)
         is_joined = .false.
         do k = graph%row_start(order(i)), graph%row_start(order(i) + 1) - 1
            if (piece(graph%column(k)) > 0) is_joined = .true.
         end do
         if (.not. is_joined .or. n > most_around) then
            pieces = pieces + 1
            n = 0
         end if
         piece(order(i)) = pieces
         do k = graph%row_start(order(i)), graph%row_start(order(i) + 1) - 1
            associate (other => graph%column(k))
               if (.not. is_bound(other) .or. around(other) == pieces) cycle
               around(other) = pieces
               n = n + 1
            end associate
         end do
      end do
      ! A cut goes through the nodes of the later piece.
      do i = size(order), 1, -1
         do k = graph%row_start(order(i)), graph%row_start(order(i) + 1) - 1
            associate (other => piece(graph%column(k)))
               if (other > 0 .and. other < piece(order(i))) piece(order(i)) = 0
            end associate
         end do
      end do
   end function divided_bodies

   !> The same of bodies that are not cut: nodes that are joined without a kept one between them are
   !> of one piece.
   pure function whole_bodies(graph, is_bound) result(piece)
      type(sparse_matrix_type), intent(in) :: graph
      logical, intent(in) :: is_bound(:)              ! (nodes)
      integer, allocatable :: piece(:)                ! (nodes)
      integer :: first, i, k, last, of_piece(size(is_bound))

      allocate (piece(size(is_bound)), source=0)
      do i = 1, size(piece)
         if (is_bound(i) .or. piece(i) > 0) cycle
         piece(i) = maxval(piece) + 1
         of_piece(1) = i
         first = 1
         last = 1
         do while (first <= last)
            do k = graph%row_start(of_piece(first)), graph%row_start(of_piece(first) + 1) - 1
               associate (other => graph%column(k))
                  if (is_bound(other) .or. piece(other) > 0) cycle
                  piece(other) = piece(i)
                  last = last + 1
                  of_piece(last) = other
               end associate
            end do
            first = first + 1
         end do
      end do
   end function whole_bodies

   !> The free nodes, each part of the graph from one of its ends on.
   pure function in_fronts(graph, is_free) result(order)
      type(sparse_matrix_type), intent(in) :: graph
      logical, intent(in) :: is_free(:)
      integer, allocatable :: order(:)
      type(triplet_list_type) :: list
      integer, allocatable :: free(:), position(:)
      integer :: i, k, number(size(is_free))

      free = pack([(i, i=1, size(is_free))], is_free)
      number = 0
      number(free) = [(i, i=1, size(free))]
      call list%reserve(size(graph%column))
      do i = 1, size(free)
         do k = graph%row_start(free(i)), graph%row_start(free(i) + 1) - 1
            associate (other => number(graph%column(k)))
               if (other > 0 .and. other /= i) call list%add(i, other, 1.0_dp)
            end associate
         end do
      end do
      position = size(free) + 1 - profile_order(list%compress(size(free), size(free)))
      allocate (order(size(free)))
      order(position) = free
   end function in_fronts

   !> Factors the pieces of a matrix, and what they leave of it on the kept degrees of freedom.
   !> Error: the inside of a piece is singular.
   subroutine reduce(self, matrix, piece, solver_kind, kept, error)
      class(body_pieces_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: matrix   !! (dofs, dofs) K, both triangles
      integer, intent(in) :: piece(:)                  !! (dofs) as from divided_bodies
      integer, intent(in) :: solver_kind               !! solver_skyline or solver_mumps
      type(sparse_matrix_type), intent(out) :: kept    !! (dofs, dofs) K', both triangles
      type(error_type), allocatable, intent(out) :: error
      type(triplet_list_type) :: left
      type(sparse_matrix_type) :: lower
      integer, allocatable :: rank(:)
      integer :: i, k, n
      integer :: place(size(piece))   ! of a degree of freedom in the present piece

      if (.not. allocated(self%piece)) call find_pieces(self, matrix, piece)
      place = 0
      n = 0
      do i = 1, size(self%piece)
         n = n + size(self%piece(i)%around)**2
      end do
      call left%reserve(size(matrix%value) + n)
      do i = 1, matrix%row_count
         if (piece(i) /= 0) cycle
         do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
            if (piece(matrix%column(k)) == 0) call left%add(i, matrix%column(k), matrix%value(k))
         end do
      end do
      do i = 1, size(self%piece)
         associate (own => self%piece(i))
            call take_part(matrix, own, place, lower)
            if (.not. allocated(own%solver)) then
               if (solver_kind == solver_mumps) then
                  allocate (mumps_solver_type :: own%solver)
               else
                  allocate (skyline_solver_type :: own%solver)
               end if
               if (allocated(rank)) deallocate (rank)
               call own%solver%analyse(lower, size(own%around), rank, error)
               if (allocated(error)) return
            end if
            call own%solver%factor(lower, error)
            if (allocated(error)) return
            call left%add_block(own%around, own%around, own%solver%schur)
            deallocate (own%solver%schur)
         end associate
      end do
      kept = left%compress(matrix%row_count, matrix%row_count)
   end subroutine reduce

   !> The degrees of freedom of each piece, and those around it; none where all are prescribed.
   pure subroutine find_pieces(self, matrix, piece)
      type(body_pieces_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: matrix
      integer, intent(in) :: piece(:)
      integer, allocatable :: inside(:), start(:)
      integer :: around(size(piece)), i, j, k, last(size(piece)), m, n

      call invert_lists(reshape(piece, [1, size(piece)]), merge(1, 0, piece > 0), &
         maxval([0, piece]), start, inside)
      allocate (self%piece(count(start(2:) > start(:size(start) - 1))))
      last = 0
      m = 0
      do i = 1, size(start) - 1
         if (start(i + 1) == start(i)) cycle
         m = m + 1
         self%piece(m)%inside = inside(start(i):start(i + 1) - 1)
         n = 0
         do j = start(i), start(i + 1) - 1
            do k = matrix%row_start(inside(j)), matrix%row_start(inside(j) + 1) - 1
               associate (other => matrix%column(k))
                  if (piece(other) /= 0 .or. last(other) == i) cycle
                  last(other) = i
                  n = n + 1
                  around(n) = other
               end associate
            end do
         end do
         self%piece(m)%around = around(:n)
      end do
   end subroutine find_pieces

   !> What a matrix has inside of a piece and between that and the nodes around it, lower triangle.
   pure subroutine take_part(matrix, own, place, lower)
      type(sparse_matrix_type), intent(in) :: matrix
      type(piece_type), intent(in) :: own
      integer, intent(inout) :: place(:)           ! (dofs) room
      type(sparse_matrix_type), intent(out) :: lower
      type(triplet_list_type) :: list
      integer :: i, k

      associate (n => size(own%inside))
         place(own%inside) = [(i, i=1, n)]
         place(own%around) = [(n + i, i=1, size(own%around))]
         call list%reserve(sum(matrix%row_start(own%inside + 1) - matrix%row_start(own%inside)))
         do i = 1, n
            do k = matrix%row_start(own%inside(i)), matrix%row_start(own%inside(i) + 1) - 1
               associate (j => place(matrix%column(k)))
                  if (j == 0) cycle   ! prescribed
                  if (j <= i .or. j > n) call list%add(max(i, j), min(i, j), matrix%value(k))
               end associate
            end do
         end do
         lower = list%compress(n + size(own%around), n + size(own%around))
      end associate
   end subroutine take_part

   !> Forces on the kept degrees of freedom; those inside stay as they are, for fill.
   subroutine condense(self, forces)
      class(body_pieces_type), intent(in) :: self    !! reduced, or without any
      real(dp), intent(inout) :: forces(:)           !! (dofs) f
      real(dp), allocatable :: condensed(:, :), rhs(:, :)
      integer :: i

      if (.not. allocated(self%piece)) return
      do i = 1, size(self%piece)
         associate (own => self%piece(i))
            allocate (rhs(own%solver%order, 1), condensed(size(own%around), 1))
            rhs = 0.0_dp
            rhs(:size(own%inside), 1) = forces(own%inside)
            if (any(abs(rhs) > 0.0_dp)) then
               call own%solver%condense(rhs, condensed)
               forces(own%around) = forces(own%around) + condensed(:, 1)
            end if
            deallocate (rhs, condensed)
         end associate
      end do
   end subroutine condense

   !> Values inside of the pieces, from those of the kept degrees of freedom and the forces inside.
   subroutine fill(self, values, forces)
      class(body_pieces_type), intent(in) :: self    !! reduced, or without any
      real(dp), intent(inout) :: values(:)           !! (dofs) u_k in, u out
      real(dp), intent(in), optional :: forces(:)    !! (dofs) f, absent for none
      real(dp), allocatable :: on_tail(:, :), rhs(:, :), solution(:, :)
      integer :: i

      if (.not. allocated(self%piece)) return
      do i = 1, size(self%piece)
         associate (own => self%piece(i))
            on_tail = reshape(values(own%around), [size(own%around), 1])
            allocate (rhs(own%solver%order, 1), solution(own%solver%order, 1))
            if (present(forces)) then
               rhs = 0.0_dp
               rhs(:size(own%inside), 1) = forces(own%inside)
               call own%solver%recover(on_tail, solution, rhs)
            else
               call own%solver%recover(on_tail, solution)
            end if
            values(own%inside) = solution(:size(own%inside), 1)
            deallocate (rhs, solution)
         end associate
      end do
   end subroutine fill

   !> Frees the pieces.
   subroutine release(self)
      class(body_pieces_type), intent(inout) :: self
      integer :: i

      if (.not. allocated(self%piece)) return
      do i = 1, size(self%piece)
         if (allocated(self%piece(i)%solver)) call self%piece(i)%solver%release()
      end do
      deallocate (self%piece)
   end subroutine release

end module body_pieces
