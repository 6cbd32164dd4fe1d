!> Linear constraints u = T v + B g of a field problem, T and B sparse and local.
!>
!> u are the degrees of freedom, g their prescribed values, v the unknowns: the degrees of freedom
!> that no constraint writes by others, the values that constraints introduce, such as relative
!> displacements of contact points, and the forces of links. A link is a constraint that says
!> nothing new of the degrees of freedom, or little, as where contact points form a cycle; it
!> relates introduced values to each other, G v + H g = 0. An unknown force, a Lagrange multiplier
!> mu, keeps it: rows k G v = -k H g, columns k G^T mu. k is the stiffness of the bodies there, so
!> that k mu is the force and mu compares with displacements.
!>
!> Ties are constraints of degrees of freedom alone, A u = 0; they have no unknowns. Their forces,
!> A^T lambda, follow from what the bodies leave out of balance at the degrees of freedom that ties
!> write. A tie that supports leave no degree of freedom is a condition on prescribed values.
!>
!> The last unknowns, the tail, are those that contact acts on, and the forces. With the former zero
!> the bodies are welded; the reduced problem on the tail is eq. (2.4) solved partially.
module linear_constraints
   use blas_lapack, only: dgemm, dsyr2k
   use constraint_rows, only: constraint_rows_type, elimination_type, largest, least_coefficients, &
      negligible, resolve, row_origin_type, write_values
   use kinds, only: dp
   use sparse_matrix, only: between_spaces, congruent, linear_combination, sparse_matrix_type, &
      triplet_list_type
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: linear_constraints_type, node_stiffness, eliminate

   !> The constraints, solved for the degrees of freedom.
   type :: linear_constraints_type
      integer :: equations = 0                      !! unknowns v
      integer :: tail = 0                           !! how many of them, the last, are the tail
      integer :: last = 0                           !! how many before it are eliminated last
      integer :: components = 1                     !! degrees of freedom of a node
      integer, allocatable :: introduced(:) !! unknowns of introduced values, 0 where none has them
      logical, allocatable :: acts(:)               !! (introduced) whether contact acts on them
      type(sum_list_type) :: by_unknowns            !! (dofs, equations) T
      type(sum_list_type) :: by_given               !! (dofs, dofs) B
      !> Degrees of freedom whose rows of T, and of B, have terms: where faces slide, few
      integer, allocatable, private :: with_unknowns(:), with_given(:)
      type(sum_list_type) :: link_unknowns          !! (links, equations) G
      type(sum_list_type) :: link_given             !! (links, dofs) H
      type(sum_list_type) :: link_dofs              !! (links, dofs) what the rows say of u itself
      integer, allocatable :: link_force(:)         !! (links) unknowns mu
      integer, allocatable :: tied(:) !! (tied) what ties write, in the order in which they do
      type(sum_list_type) :: tied_by                !! (tied, dofs) what they write it by
      type(row_origin_type), allocatable :: condition(:)   !! (conditions) what they come from
      type(sum_list_type) :: condition_given        !! (conditions, dofs) sums that must be 0
   contains
      procedure :: expand
      procedure :: supported
      procedure :: carried_along
      procedure :: restrict
      procedure :: carry_over
      procedure :: load
      procedure :: link_stiffness
      procedure :: transform
      procedure :: transform_kept
      procedure :: between
      procedure :: leading_nodes
      procedure :: tail_index
      procedure :: is_linked
      procedure :: is_given
      procedure :: moves
   end type linear_constraints_type

   integer, parameter :: most_terms = 16   !! of a row of T that is not full

contains

   !> Values of all degrees of freedom, T v + B g, or T v alone.
   pure function expand(self, unknowns, given) result(values)
      class(linear_constraints_type), intent(in) :: self
      real(dp), intent(in) :: unknowns(:)           !! (equations) v
      real(dp), intent(in), optional :: given(:)    !! (dofs) prescribed values, others not used
      real(dp) :: values(self%by_unknowns%count)    !! (dofs)

      if (present(given)) then
         values = self%supported(given)
      else
         values = 0.0_dp
      end if
      call add_rows(self%by_unknowns, self%with_unknowns, unknowns, values)
   end function expand

   !> Degrees of freedom by prescribed values alone, B g.
   pure function supported(self, given) result(values)
      class(linear_constraints_type), intent(in) :: self
      real(dp), intent(in) :: given(:)              !! (dofs) prescribed values, others not used
      real(dp) :: values(size(given))               !! (dofs)

      values = 0.0_dp
      call add_rows(self%by_given, self%with_given, given, values)
   end function supported

   !> Adds the sums of some rows, which alone have terms.
   pure subroutine add_rows(sums, rows, x, totals)
      type(sum_list_type), intent(in) :: sums
      integer, intent(in) :: rows(:)
      real(dp), intent(in) :: x(:)
      real(dp), intent(inout) :: totals(:)
      integer :: i, k

      do i = 1, size(rows)
         do k = sums%start(rows(i)), sums%start(rows(i) + 1) - 1
            totals(rows(i)) = totals(rows(i)) + sums%coefficient(k)*x(sums%value(k))
         end do
      end do
   end subroutine add_rows

   !> Sums that have terms.
   pure function with_terms(sums) result(rows)
      type(sum_list_type), intent(in) :: sums
      integer, allocatable :: rows(:)
      integer :: found(sums%count), i, n

      n = 0
      do i = 1, sums%count
         if (sums%start(i + 1) == sums%start(i)) cycle
         n = n + 1
         found(n) = i
      end do
      rows = found(:n)
   end function with_terms

   !> Values with those that prescribed ones are part of made anew, while the others stay. Where an
   !> introduced value is part of one, it takes up the difference.
   pure function carried_along(self, values, given) result(carried)
      class(linear_constraints_type), intent(in) :: self
      real(dp), intent(in) :: values(:)             !! (dofs)
      real(dp), intent(in) :: given(:)              !! (dofs) prescribed values, others not used
      real(dp) :: carried(size(values))             !! (dofs)
      real(dp) :: unknowns(0:self%equations), whole(size(values))
      logical :: is_introduced(0:self%equations)
      integer :: dof

      is_introduced = .false.
      is_introduced(self%introduced) = .true.
      unknowns = 0.0_dp
      associate (by => self%by_unknowns)
         do dof = size(values), 1, -1
            if (by%start(dof + 1) - by%start(dof) /= 1 .or. self%is_given(dof)) cycle
            unknowns(by%value(by%start(dof))) = values(dof)/by%coefficient(by%start(dof))
         end do
         whole = self%expand(unknowns(1:), given)
         carried = values
         do dof = 1, size(values)
            if (any(is_introduced(by%values_of(dof)))) cycle
            if (self%is_given(dof)) carried(dof) = whole(dof)
         end do
      end associate
   end function carried_along

   !> Forces on the unknowns from forces on the degrees of freedom, T^T f.
   pure function restrict(self, forces) result(rhs)
      class(linear_constraints_type), intent(in) :: self
      real(dp), intent(in) :: forces(:)             !! (dofs)
      real(dp) :: rhs(self%equations)               !! (equations)
      integer :: i, t

      rhs = 0.0_dp
      associate (by => self%by_unknowns, dof => self%with_unknowns)
         do i = 1, size(dof)
            do t = by%start(dof(i)), by%start(dof(i) + 1) - 1
               rhs(by%value(t)) = rhs(by%value(t)) + by%coefficient(t)*forces(dof(i))
            end do
         end do
      end associate
   end function restrict

   !> Takes the forces of the ties from the forces on the degrees of freedom. Where a tie writes a
   !> degree of freedom, the tie's force alone keeps it in balance; the other ones that the tie
   !> joins receive the opposite, and so do supports behind a tie.
   pure subroutine carry_over(self, forces)
      class(linear_constraints_type), intent(in) :: self
      real(dp), intent(inout) :: forces(:)          !! (dofs) K u - f, or what is left of it
      integer :: k
      real(dp) :: force

      do k = 1, self%tied_by%count
         force = forces(self%tied(k))
         forces(self%tied(k)) = 0.0_dp
         associate (first => self%tied_by%start(k), last => self%tied_by%start(k + 1) - 1)
            forces(self%tied_by%value(first:last)) = forces(self%tied_by%value(first:last)) + &
               force*self%tied_by%coefficient(first:last)
         end associate
      end do
   end subroutine carry_over

   !> Right-hand side of the unknowns: of forces on the degrees of freedom, less what prescribed
   !> values take of them (K B g), and of links, which prescribed values may stretch.
   pure function load(self, forces, given, stiffness) result(rhs)
      class(linear_constraints_type), intent(in) :: self
      real(dp), intent(in) :: forces(:)             !! (dofs)
      real(dp), intent(in) :: given(:)              !! (dofs) prescribed values, others not used
      real(dp), intent(in) :: stiffness(:)          !! (links) k
      real(dp) :: rhs(self%equations)               !! (equations)
      real(dp) :: stretch(size(self%link_force))

      rhs = self%restrict(forces)
      stretch = 0.0_dp
      call self%link_given%add_totals(given, stretch)
      rhs(self%link_force) = -stiffness*stretch
   end function load

   !> Scale of the links, k: the smallest stiffness of the nodes that they join.
   pure function link_stiffness(self, matrix) result(stiffness)
      class(linear_constraints_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: matrix  !! (dofs, dofs) of the bodies
      real(dp) :: stiffness(size(self%link_force))    !! (links) in the unit of the matrix
      integer :: i

      do i = 1, size(stiffness)
         stiffness(i) = node_stiffness(matrix, (self%link_dofs%values_of(i) - 1)/ &
            self%components + 1, self%components)
      end do
   end function link_stiffness

   !> Stiffness of the bodies at some nodes: the smallest one's largest diagonal entry. Nodes
   !> without elements, such as those of a drawing, do not count.
   pure function node_stiffness(matrix, nodes, components) result(stiffness)
      type(sparse_matrix_type), intent(in) :: matrix      !! (dofs, dofs) of the bodies
      integer, intent(in) :: nodes(:)                     !! the nodes
      integer, intent(in) :: components                   !! degrees of freedom of a node
      real(dp) :: stiffness                               !! in the unit of the matrix
      real(dp) :: at_node(size(nodes))
      integer :: k, n, row

      at_node = 0.0_dp
      do n = 1, size(nodes)
         do row = components*(nodes(n) - 1) + 1, components*nodes(n)
            do k = matrix%row_start(row), matrix%row_start(row + 1) - 1
               if (matrix%column(k) == row) at_node(n) = max(at_node(n), matrix%value(k))
            end do
         end do
      end do
      stiffness = 0.0_dp
      if (any(at_node > 0.0_dp)) stiffness = minval(at_node, mask=at_node > 0.0_dp)
   end function node_stiffness

   !> Lower triangle of the matrix on the unknowns: T^T K T, with the links.
   pure function transform(self, matrix, stiffness) result(lower)
      class(linear_constraints_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: matrix  !! (dofs, dofs) K, symmetric, both triangles
      real(dp), intent(in) :: stiffness(:)            !! (links) k
      type(sparse_matrix_type) :: lower               !! (equations, equations) by rows

      lower = congruent(matrix, terms(self))
      if (size(self%link_force) > 0) lower = linear_combination(1.0_dp, lower, 1.0_dp, &
         links(self, stiffness))
   end function transform

   !> The same of a matrix that pieces of bodies leave between the nodes of faces, where it is full:
   !> T is full, too, where mortar points write the slave's values w by all others. With o for the
   !> rest
   !>
   !>    T^T A T = T_w^T Y + Y^T T_w + T_o^T A_oo T_o,   Y = A_ww T_w/2 + A_wo T_o.
   !>
   !> What no written value is joined to stays sparse.
   pure function transform_kept(self, matrix, stiffness) result(lower)
      class(linear_constraints_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: matrix  !! (dofs, dofs) K', symmetric, both triangles
      real(dp), intent(in) :: stiffness(:)            !! (links) k
      type(sparse_matrix_type) :: lower               !! (equations, equations) by rows
      real(dp), allocatable :: half(:, :), of_others(:, :), upper(:, :), written_by(:, :)
      integer, allocatable :: rows(:), unknown(:), written(:)
      integer :: column_of(self%equations), i, k, last, other, place(matrix%row_count), q, row, term
      logical, dimension(matrix%row_count) :: is_full, is_other

      rows = with_terms(self%by_unknowns)
      rows = pack(rows, matrix%row_start(rows + 1) > matrix%row_start(rows))
      call find_full(self, matrix, rows, is_full, unknown)
      column_of = 0
      column_of(unknown) = [(i, i=1, size(unknown))]
      associate (by => self%by_unknowns, n => size(unknown))
         written = pack(rows, is_full(rows) .and. by%start(rows + 1) - by%start(rows) > most_terms)
         place = 0
         place(written) = [(i, i=1, size(written))]
         allocate (half(size(written), size(written)), of_others(size(written), n), &
            written_by(size(written), n), source=0.0_dp)
         do q = 1, size(written)
            i = written(q)
            do term = by%start(i), by%start(i + 1) - 1
               written_by(q, column_of(by%value(term))) = by%coefficient(term)
            end do
            do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
               associate (j => matrix%column(k))
                  if (place(j) > 0) then
                     half(q, place(j)) = 0.5_dp*matrix%value(k)
                     cycle
                  end if
                  do term = by%start(j), by%start(j + 1) - 1
                     associate (entry => of_others(q, column_of(by%value(term))))
                        entry = entry + matrix%value(k)*by%coefficient(term)
                     end associate
                  end do
               end associate
            end do
         end do
         allocate (upper(n, n))
         associate (m => size(written), lead => max(size(written), 1))
            call dgemm('N', 'N', m, n, m, 1.0_dp, half, lead, written_by, lead, 1.0_dp, &
               of_others, lead)
            call dsyr2k('U', 'T', n, m, 1.0_dp, written_by, lead, of_others, lead, 0.0_dp, upper, &
               max(n, 1))
         end associate
         is_other = is_full
         is_other(written) = .false.
         do q = 1, size(rows)
            i = rows(q)
            if (.not. is_other(i)) cycle
            do term = by%start(i), by%start(i + 1) - 1
               last = column_of(by%value(term))
               associate (column => upper(:last, last), factor => by%coefficient(term))
                  do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
                     if (.not. is_other(matrix%column(k))) cycle
                     do other = by%start(matrix%column(k)), by%start(matrix%column(k) + 1) - 1
                        row = column_of(by%value(other))
                        if (row <= last) column(row) = column(row) + &
                           by%coefficient(other)*matrix%value(k)*factor
                     end do
                  end do
               end associate
            end do
         end do
      end associate
      lower = lower_of(upper, unknown, self%equations)
      if (all(is_full(rows)) .and. size(self%link_force) == 0) return
      lower = linear_combination(1.0_dp, lower, 1.0_dp, self%transform(outside(matrix, is_full), &
         stiffness))
   end function transform_kept

   !> The unknowns that written values of a matrix, and those joined to them, are made of, and the
   !> degrees of freedom that are made of these alone.
   pure subroutine find_full(self, matrix, rows, is_full, unknown)
      class(linear_constraints_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: matrix
      integer, intent(in) :: rows(:)                  ! those with entries
      logical, intent(out) :: is_full(:)              ! (dofs)
      integer, allocatable, intent(out) :: unknown(:) ! ascending
      logical :: is_joined(size(is_full)), is_part(self%equations)
      integer :: i, k, q

      is_joined = .false.
      is_part = .false.
      is_full = .false.
      associate (by => self%by_unknowns, start => matrix%row_start)
         do q = 1, size(rows)
            i = rows(q)
            if (by%start(i + 1) - by%start(i) <= 1) cycle
            do k = start(i), start(i + 1) - 1
               is_joined(matrix%column(k)) = .true.
            end do
         end do
         do q = 1, size(rows)
            i = rows(q)
            if (.not. is_joined(i)) cycle
            do k = by%start(i), by%start(i + 1) - 1
               is_part(by%value(k)) = .true.
            end do
         end do
         do q = 1, size(rows)
            i = rows(q)
            is_full(i) = .true.
            do k = by%start(i), by%start(i + 1) - 1
               is_full(i) = is_full(i) .and. is_part(by%value(k))
            end do
         end do
      end associate
      unknown = pack([(i, i=1, self%equations)], is_part)
   end subroutine find_full

   !> The entries of a matrix that are not in its full part.
   pure function outside(matrix, is_full) result(rest)
      type(sparse_matrix_type), intent(in) :: matrix
      logical, intent(in) :: is_full(:)               ! (dofs) rows and columns of the full part
      type(sparse_matrix_type) :: rest
      integer :: i, k, n

      rest%row_count = matrix%row_count
      rest%column_count = matrix%column_count
      allocate (rest%row_start, mold=matrix%row_start)
      allocate (rest%column, mold=matrix%column)
      allocate (rest%value, mold=matrix%value)
      n = 0
      do i = 1, matrix%row_count
         rest%row_start(i) = n + 1
         do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
            if (is_full(i) .and. is_full(matrix%column(k))) cycle
            n = n + 1
            rest%column(n) = matrix%column(k)
            rest%value(n) = matrix%value(k)
         end do
      end do
      rest%row_start(matrix%row_count + 1) = n + 1
      rest%column = rest%column(:n)
      rest%value = rest%value(:n)
   end function outside

   !> The lower triangle of a matrix that is full in some rows and columns and has no others.
   pure function lower_of(upper, places, order) result(lower)
      real(dp), intent(in) :: upper(:, :)             ! (n, n) upper triangle of what is full
      integer, intent(in) :: places(:)                ! (n) its rows and columns, ascending
      integer, intent(in) :: order
      type(sparse_matrix_type) :: lower
      integer :: filled, i, last, n

      lower%row_count = order
      lower%column_count = order
      n = size(places)
      allocate (lower%row_start(order + 1), lower%column(n*(n + 1)/2), lower%value(n*(n + 1)/2))
      filled = 0
      last = 0
      do i = 1, n
         lower%row_start(last + 1:places(i)) = filled + 1
         lower%column(filled + 1:filled + i) = places(:i)
         lower%value(filled + 1:filled + i) = upper(:i, i)
         filled = filled + i
         last = places(i)
      end do
      lower%row_start(last + 1:) = filled + 1
   end function lower_of

   !> T, its columns in any order.
   pure function terms(self)
      class(linear_constraints_type), intent(in) :: self
      type(sparse_matrix_type) :: terms               ! (dofs, equations)

      associate (by => self%by_unknowns)
         terms = sparse_matrix_type(by%count, self%equations, by%start(:by%count + 1), by%value, &
            by%coefficient)
      end associate
   end function terms

   !> Matrix between the unknowns of this field and those of another, T^T B T'.
   pure function between(self, matrix, other) result(coupling)
      class(linear_constraints_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: matrix  !! (dofs, other dofs) B
      type(linear_constraints_type), intent(in) :: other
      type(sparse_matrix_type) :: coupling            !! (equations, other equations)

      coupling = between_spaces(terms(self), matrix, terms(other))
   end function between

   !> The first node that each leading unknown moves, or whose temperature it changes; the first of
   !> all where there is none.
   pure function leading_nodes(self) result(node)
      class(linear_constraints_type), intent(in) :: self
      integer, allocatable :: node(:)               !! (leading)
      integer :: dof

      allocate (node(self%equations), source=1)
      associate (by => self%by_unknowns)
         do dof = by%count, 1, -1
            node(by%value(by%start(dof):by%start(dof + 1) - 1)) = (dof - 1)/self%components + 1
         end do
      end associate
      node = node(:self%equations - self%tail)
   end function leading_nodes

   !> The links in the lower triangle of the matrix on the unknowns.
   pure function links(self, stiffness) result(lower)
      class(linear_constraints_type), intent(in) :: self
      real(dp), intent(in) :: stiffness(:)
      type(sparse_matrix_type) :: lower               ! (equations, equations)
      type(triplet_list_type) :: list
      integer :: i, k

      call list%reserve(size(self%link_unknowns%value))
      do i = 1, size(self%link_force)
         associate (rows => self%link_unknowns, force => self%link_force(i))
            do k = rows%start(i), rows%start(i + 1) - 1
               call list%add(max(force, rows%value(k)), min(force, rows%value(k)), &
                  stiffness(i)*rows%coefficient(k))
            end do
         end associate
      end do
      lower = list%compress(self%equations, self%equations)
   end function links

   !> Position of an unknown on the tail, 0 where it is not there.
   elemental function tail_index(self, unknown) result(position)
      class(linear_constraints_type), intent(in) :: self
      integer, intent(in) :: unknown                !! an unknown, or 0
      integer :: position                           !! 1..tail or 0

      position = max(unknown - (self%equations - self%tail), 0)
   end function tail_index

   !> Whether a link acts on an unknown.
   elemental function is_linked(self, unknown) result(linked)
      class(linear_constraints_type), intent(in) :: self
      integer, intent(in) :: unknown                !! an unknown, or 0
      logical :: linked

      linked = any(self%link_unknowns%value == unknown)
   end function is_linked

   !> Whether unknowns are part of a degree of freedom.
   elemental function moves(self, dof)
      class(linear_constraints_type), intent(in) :: self
      integer, intent(in) :: dof                    !! a degree of freedom
      logical :: moves

      moves = self%by_unknowns%start(dof + 1) > self%by_unknowns%start(dof)
   end function moves

   !> Whether a prescribed value is part of a degree of freedom.
   elemental function is_given(self, dof) result(given)
      class(linear_constraints_type), intent(in) :: self
      integer, intent(in) :: dof                    !! a degree of freedom
      logical :: given

      given = self%by_given%start(dof + 1) > self%by_given%start(dof)
   end function is_given

   !> The constraints of these rows. Of the degrees of freedom that are left in a row it writes the
   !> row's choice, else the one that entered the rows last; of the values of one row the last
   !> enters first. Ties come before rows with introduced values.
   pure subroutine eliminate(rows, used, constraints)
      type(constraint_rows_type), intent(in) :: rows
      logical, intent(in) :: used(:)                !! (dofs) whether elements have them
      type(linear_constraints_type), intent(out) :: constraints
      type(elimination_type) :: found
      integer :: unknown(2*rows%dofs + size(rows%on_tail)), last

      last = rows%dofs + size(rows%on_tail)
      found%least = least_coefficients(rows)
      call write_values(rows, size(unknown), found)
      call number_unknowns(rows, found, used, constraints, unknown)
      constraints%components = rows%components
      constraints%introduced = unknown(rows%dofs + 1:last)
      constraints%acts = rows%on_tail
      call set_matrices(rows, found, unknown, constraints)
      call set_ties(rows, found, last, constraints)
   end subroutine eliminate

   !> Numbers the unknowns: degrees of freedom, introduced values off the tail, degrees of freedom
   !> that are eliminated last, then the tail. On it the forces of the links are behind the values
   !> that stiffness holds and before those that only the links hold: factors without pivoting then
   !> have no zero pivot.
   pure subroutine number_unknowns(rows, found, used, constraints, unknown)
      type(constraint_rows_type), intent(in) :: rows
      type(elimination_type), intent(in) :: found
      logical, intent(in) :: used(:)
      type(linear_constraints_type), intent(inout) :: constraints
      integer, intent(out) :: unknown(:)
      logical :: by_link(size(unknown)), enters(size(rows%on_tail)), free(size(used)), &
         is_last(size(used)), on_tail(size(used))
      integer :: i, before_last, before_tail

      by_link = .false.
      do i = 1, rows%count
         if (found%linked(i)) by_link(rows%value(rows%start(i):rows%start(i + 1) - 1)) = .true.
      end do
      unknown = 0
      associate (n => constraints%equations, first => rows%dofs + 1, &
         prescribed => by_link(rows%dofs + 1:rows%dofs + size(enters)))
         enters = found%entry(first:first + size(enters) - 1) > 0 .and. .not. prescribed
         free = used .and. found%writer(:rows%dofs) == 0
         is_last = .false.
         if (allocated(rows%last_dofs)) is_last(rows%last_dofs) = free(rows%last_dofs)
         free = free .and. .not. is_last
         on_tail = .false.
         if (allocated(rows%dof_on_tail)) on_tail = rows%dof_on_tail
         call number_chosen(1, free .and. .not. on_tail, unknown, n)
         call number_chosen(first, enters .and. .not. rows%on_tail, unknown, n)
         before_last = n
         call number_chosen(1, is_last, unknown, n)
         constraints%last = n - before_last
         before_tail = merge(0, n, rows%keeps_all)
         call number_chosen(1, free .and. on_tail, unknown, n)
         call number_chosen(first, enters .and. rows%on_tail, unknown, n)
         constraints%link_force = [(n + i, i=1, count(found%linked))]
         n = n + size(constraints%link_force)
         call number_chosen(first, prescribed, unknown, n)
         constraints%tail = n - before_tail
      end associate
   end subroutine number_unknowns

   !> Numbers some of the values from one on, behind what is numbered already.
   pure subroutine number_chosen(first, chosen, unknown, n)
      integer, intent(in) :: first
      logical, intent(in) :: chosen(:)
      integer, intent(inout) :: unknown(:), n
      integer :: i

      do i = 1, size(chosen)
         if (.not. chosen(i)) cycle
         n = n + 1
         unknown(first + i - 1) = n
      end do
   end subroutine number_chosen

   !> The constraints as matrices.
   pure subroutine set_matrices(rows, found, unknown, constraints)
      type(constraint_rows_type), intent(in) :: rows
      type(elimination_type), intent(inout) :: found
      integer, intent(in) :: unknown(:)
      type(linear_constraints_type), intent(inout) :: constraints
      type(sum_list_type) :: written, links, plain
      integer, allocatable :: value(:)
      real(dp), allocatable :: coefficient(:)
      integer :: dof(size(unknown)), given(size(unknown)), i

      associate (dofs => rows%dofs)
         dof = [(merge(i, 0, i <= dofs), i=1, size(dof))]
         given = cshift(dof, dofs)
         call written%reserve(dofs, dofs + size(rows%value))
         call links%reserve(size(constraints%link_force), 8*size(constraints%link_force))
         plain = links
         do i = 1, dofs
            if (found%writer(i) == 0 .and. unknown(i) == 0) then
               ! No sum that renumbered would keep: inside of pieces are many of these.
               written%count = i
               written%start(i + 1) = written%start(i)
            else if (found%writer(i) == 0) then
               call written%add_value(i)
            else
               call resolve(found, found%sums, found%writer(i), value, coefficient)
               call written%add(value, coefficient)
            end if
         end do
         do i = 1, rows%count
            if (.not. found%linked(i)) cycle
            call resolve(found, rows, i, value, coefficient)
            where (abs(coefficient) <= negligible*largest(rows, i)) coefficient = 0.0_dp
            call links%add(value, coefficient)
            call plain%add(rows%values_of(i), rows%coefficients_of(i))
         end do
         constraints%by_unknowns = written%renumbered(unknown)
         constraints%by_given = written%renumbered(given)
         constraints%with_unknowns = with_terms(constraints%by_unknowns)
         constraints%with_given = with_terms(constraints%by_given)
         constraints%link_unknowns = links%renumbered(unknown)
         constraints%link_given = links%renumbered(given)
         constraints%link_dofs = plain%renumbered(dof)
      end associate
   end subroutine set_matrices

   !> Rows of ties, and the conditions of those without rows. Prescribed values count as
   !> the degrees of freedom that have them.
   pure subroutine set_ties(rows, found, last, constraints)
      type(constraint_rows_type), intent(in) :: rows
      type(elimination_type), intent(inout) :: found
      integer, intent(in) :: last               ! value before the prescribed ones
      type(linear_constraints_type), intent(inout) :: constraints
      integer, allocatable :: value(:)
      real(dp), allocatable :: coefficient(:)
      integer :: dof_of(found%sums%count), i, k

      dof_of = 0
      do i = 1, rows%count
         if (found%written(i) > 0) dof_of(found%writer(found%written(i))) = found%written(i)
      end do
      constraints%tied = pack(dof_of, dof_of > 0)
      constraints%condition = pack(rows%origin(:rows%count), found%tie .and. found%written == 0)
      call constraints%tied_by%reserve(size(constraints%tied), 8*size(constraints%tied))
      call constraints%condition_given%reserve(size(constraints%condition), &
         8*size(constraints%condition))
      do k = 1, size(dof_of)
         if (dof_of(k) == 0) cycle
         value = found%sums%values_of(k)
         value = merge(value - last, value, value > last)
         call constraints%tied_by%add(value, found%sums%coefficients_of(k))
      end do
      do i = 1, rows%count
         if (.not. found%tie(i) .or. found%written(i) > 0) cycle
         call resolve(found, rows, i, value, coefficient)
         coefficient = pack(coefficient, value > last)
         value = pack(value, value > last) - last
         call constraints%condition_given%add(value, coefficient)
      end do
   end subroutine set_ties

end module linear_constraints
