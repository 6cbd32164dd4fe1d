!> Unknowns of a field problem with contact: nodal values on one side, the pairs' relative values
!> last.
!>
!> At a pair the slave's values are the master's plus the relative value theta in the pair's own
!> frame (normal, tangent; one component for temperature). Nodes that pairs tie together, a node may
!> be in several, form a tree: each degree of freedom on it is written by the next one on the way to
!> the root, which is a prescribed one if there is any. The relative values that contact acts on
!> form the tail of the system: with them zero the bodies are welded, and the reduced problem on the
!> tail is eq. (2.4) solved partially.
module equation_map
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: equation_map_type, make_map

   real(dp), parameter :: aligned = 1.0_dp - 1.0e-9_dp !! cosine of an aligned frame

   !> Every degree of freedom as base value + sum of coefficient*unknown.
   type :: equation_map_type
      integer :: equations = 0                       !! unknowns
      integer :: tail = 0 !! relative unknowns that contact acts on, the last ones
      integer, allocatable :: term_count(:)          !! (dofs) terms of a degree of freedom
      integer, allocatable :: term(:, :)             !! (most, dofs) its unknowns
      real(dp), allocatable :: coefficient(:, :)     !! (most, dofs) their coefficients
      integer, allocatable :: base(:) !! (dofs) degree whose prescribed value it is based on, or 0
      integer, allocatable :: relative(:, :) !! (components, m) its unknowns, 0 if prescribed
   contains
      procedure :: expand
      procedure :: restrict
      procedure :: transform
      procedure :: tail_index
   end type equation_map_type

contains

   !> Numbers the unknowns. Degree of freedom c of node i is components*(i - 1) + c.
   !> Error: a pair whose normal motion, component 1, is prescribed on both nodes, or whose motion
   !> is prescribed on both nodes along a direction that is neither normal nor tangent; pairs that
   !> tie two prescribed nodes together over a third one; pairs that form a ring of nodes.
   subroutine make_map(used, prescribed, slave, master, frame, on_tail, map, error)
      logical, intent(in) :: used(:)                      !! (nodes) whether a node carries unknowns
      logical, intent(in) :: prescribed(:)                !! (dofs) prescribed values
      integer, intent(in) :: slave(:)                     !! (m) slave nodes of the pairs
      integer, intent(in) :: master(:)                    !! (m) master nodes of the pairs
      real(dp), intent(in) :: frame(:, :, :) !! (components, components, m) columns: unit vectors
      logical, intent(in) :: on_tail(:, :) !! (components, m) relative values that contact acts on
      type(equation_map_type), intent(out) :: map         !! the numbering
      type(error_type), allocatable, intent(out) :: error !! see above
      integer :: order(size(slave), size(frame, 1)), length(size(prescribed))
      logical :: from_slave(size(slave), size(frame, 1)), follows(size(prescribed))
      integer :: c, components, dof, node

      components = size(frame, 1)
      follows = prescribed
      length = 0
      do c = 1, components
         call order_pairs(components, c, prescribed, slave, master, order(:, c), &
            from_slave(:, c), follows, length, error)
         if (allocated(error)) return
      end do
      associate (dofs => size(prescribed), most_terms => 1 + components*maxval([0, length]))
         allocate (map%term_count(dofs), map%base(dofs), source=0)
         allocate (map%term(most_terms, dofs), source=0)
         allocate (map%coefficient(most_terms, dofs), source=0.0_dp)
         allocate (map%relative(components, size(slave)), source=0)
      end associate
      do node = 1, size(used)
         do dof = components*(node - 1) + 1, components*node
            if (prescribed(dof)) map%base(dof) = dof
            if (.not. (follows(dof) .or. .not. used(node))) call own_unknown(map, dof)
         end do
      end do
      call number_relative(map, prescribed, slave, master, frame, on_tail, error)
      if (allocated(error)) return
      do c = 1, components
         call relate_all(map, components, c, slave, master, frame, order(:, c), from_slave(:, c))
      end do
   end subroutine make_map

   !> Puts the pairs in an order in which each one's leading node, of one component, comes before
   !> the following one. Prescribed nodes lead; where there is none, the master that comes first.
   !> Pairs that are prescribed on both nodes come last, as order 0.
   subroutine order_pairs(components, c, prescribed, slave, master, order, from_slave, follows, &
      length, error)
      integer, intent(in) :: components, c
      logical, intent(in) :: prescribed(:)
      integer, intent(in) :: slave(:), master(:)
      integer, intent(out) :: order(:)
      logical, intent(out) :: from_slave(:)
      logical, intent(inout) :: follows(:)
      integer, intent(inout) :: length(:)
      type(error_type), allocatable, intent(out) :: error
      logical :: placed(size(slave)), reached(size(prescribed)/components)
      integer :: first, found, k, leader, follower, s, m

      reached = prescribed(c::components)
      placed = reached(slave) .and. reached(master)
      from_slave = .false.
      order = 0
      found = 0
      do while (.not. all(placed))
         first = found
         do k = 1, size(slave)
            if (placed(k)) cycle
            s = slave(k)
            m = master(k)
            if (reached(s) .and. reached(m)) then
               call set_error(error, status_deck, 'contact pairs tie two prescribed nodes '// &
                  'together over a third one, or form a ring of nodes')
               return
            end if
            if (.not. (reached(s) .or. reached(m))) cycle
            from_slave(k) = reached(s)
            leader = merge(s, m, reached(s))
            follower = merge(m, s, reached(s))
            reached(follower) = .true.
            found = found + 1
            order(found) = k
            placed(k) = .true.
            follows(components*(follower - 1) + c) = .true.
            length(components*(follower - 1) + c) = length(components*(leader - 1) + c) + 1
         end do
         if (found == first) reached(master(findloc(placed, .false., dim=1))) = .true.
      end do
   end subroutine order_pairs

   !> Writes one component of all following nodes by the leading ones.
   subroutine relate_all(map, components, c, slave, master, frame, order, from_slave)
      type(equation_map_type), intent(inout) :: map
      integer, intent(in) :: components, c
      integer, intent(in) :: slave(:), master(:)
      real(dp), intent(in) :: frame(:, :, :)
      integer, intent(in) :: order(:)
      logical, intent(in) :: from_slave(:)
      integer :: i, k, slave_dof, master_dof

      do i = 1, size(order)
         k = order(i)
         if (k == 0) return
         slave_dof = components*(slave(k) - 1) + c
         master_dof = components*(master(k) - 1) + c
         if (from_slave(k)) then
            call relate(map, slave_dof, master_dof, -frame(c, :, k), map%relative(:, k))
         else
            call relate(map, master_dof, slave_dof, frame(c, :, k), map%relative(:, k))
         end if
      end do
   end subroutine relate_all

   subroutine own_unknown(map, dof)
      type(equation_map_type), intent(inout) :: map
      integer, intent(in) :: dof

      map%equations = map%equations + 1
      map%term_count(dof) = 1
      map%term(1, dof) = map%equations
      map%coefficient(1, dof) = 1.0_dp
   end subroutine own_unknown

   !> Numbers the relative values: first those that stay free, then the tail.
   subroutine number_relative(map, prescribed, slave, master, frame, on_tail, error)
      type(equation_map_type), intent(inout) :: map
      logical, intent(in) :: prescribed(:)
      integer, intent(in) :: slave(:), master(:)
      real(dp), intent(in) :: frame(:, :, :)
      logical, intent(in) :: on_tail(:, :)
      type(error_type), allocatable, intent(out) :: error
      logical :: held(size(frame, 1), size(slave))
      integer :: c, components, k, pass

      components = size(frame, 1)
      held = .false.
      do k = 1, size(slave)
         do c = 1, components
            if (.not. (prescribed(components*(slave(k) - 1) + c) .and. &
               prescribed(components*(master(k) - 1) + c))) cycle
            held(:, k) = held(:, k) .or. abs(frame(c, :, k)) > aligned
            if (components > 1 .and. (held(1, k) .or. .not. held(components, k))) then
               call set_error(error, status_deck, &
                  'a contact pair whose normal motion is prescribed on both nodes')
               return
            end if
         end do
      end do
      do pass = 1, 2
         do k = 1, size(slave)
            do c = 1, components
               if (held(c, k) .or. (on_tail(c, k) .neqv. pass == 2)) cycle
               map%equations = map%equations + 1
               map%relative(c, k) = map%equations
               if (pass == 2) map%tail = map%tail + 1
            end do
         end do
      end do
   end subroutine number_relative

   !> Writes the following degree of freedom of a pair by the leading one and the relative values.
   subroutine relate(map, leader, follower, direction, relative)
      type(equation_map_type), intent(inout) :: map
      integer, intent(in) :: leader, follower
      real(dp), intent(in) :: direction(:)
      integer, intent(in) :: relative(:)
      integer :: c, n

      map%base(follower) = map%base(leader)
      n = map%term_count(leader)
      map%term(:n, follower) = map%term(:n, leader)
      map%coefficient(:n, follower) = map%coefficient(:n, leader)
      do c = 1, size(relative)
         if (relative(c) == 0 .or. abs(direction(c)) <= 0.0_dp) cycle
         n = n + 1
         map%term(n, follower) = relative(c)
         map%coefficient(n, follower) = direction(c)
      end do
      map%term_count(follower) = n
   end subroutine relate

   !> Values of all degrees of freedom.
   pure function expand(self, unknowns, given) result(values)
      class(equation_map_type), intent(in) :: self  !! the numbering
      real(dp), intent(in) :: unknowns(:)           !! (equations)
      real(dp), intent(in) :: given(:)              !! (dofs) prescribed values, others not used
      real(dp) :: values(size(given))               !! (dofs)
      integer :: dof, t

      do dof = 1, size(given)
         values(dof) = 0.0_dp
         if (self%base(dof) > 0) values(dof) = given(self%base(dof))
         do t = 1, self%term_count(dof)
            values(dof) = values(dof) + self%coefficient(t, dof)*unknowns(self%term(t, dof))
         end do
      end do
   end function expand

   !> Forces on the unknowns from forces on the degrees of freedom.
   pure function restrict(self, forces) result(rhs)
      class(equation_map_type), intent(in) :: self  !! the numbering
      real(dp), intent(in) :: forces(:)             !! (dofs)
      real(dp) :: rhs(self%equations)               !! (equations)
      integer :: dof, t

      rhs = 0.0_dp
      do dof = 1, size(forces)
         do t = 1, self%term_count(dof)
            rhs(self%term(t, dof)) = rhs(self%term(t, dof)) + self%coefficient(t, dof)*forces(dof)
         end do
      end do
   end function restrict

   !> Lower triangle of the matrix on the unknowns.
   pure function transform(self, matrix) result(lower)
      class(equation_map_type), intent(in) :: self    !! the numbering
      type(sparse_matrix_type), intent(in) :: matrix  !! (dofs, dofs) symmetric, both triangles
      type(sparse_matrix_type) :: lower               !! (equations, equations) by rows
      type(triplet_list_type) :: list
      integer :: i, j, k, s, t, pass, entries

      entries = 0
      do pass = 1, 2
         if (pass == 2) call list%reserve(entries)
         do i = 1, matrix%row_count
            do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
               j = matrix%column(k)
               do s = 1, self%term_count(i)
                  do t = 1, self%term_count(j)
                     if (self%term(t, j) > self%term(s, i)) cycle
                     if (pass == 1) then
                        entries = entries + 1
                     else
                        call list%add(self%term(s, i), self%term(t, j), &
                           self%coefficient(s, i)*self%coefficient(t, j)*matrix%value(k))
                     end if
                  end do
               end do
            end do
         end do
      end do
      lower = list%compress(self%equations, self%equations)
   end function transform

   !> Place of a relative value on the tail, 0 where it is not there.
   elemental function tail_index(self, unknown) result(place)
      class(equation_map_type), intent(in) :: self  !! the numbering
      integer, intent(in) :: unknown                !! an unknown
      integer :: place                              !! 1..tail or 0

      place = max(unknown - (self%equations - self%tail), 0)
   end function tail_index

end module equation_map
