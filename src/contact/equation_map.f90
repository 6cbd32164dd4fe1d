!> Unknowns of a field problem with contact: nodal values on one side, the pairs' relative values
!> last.
!>
!> At a pair the slave's values are written as the master's plus the relative value theta in the
!> pair's own frame (normal, tangent; one component for temperature). The relative values that
!> contact acts on form the tail of the system: with them zero the bodies are welded, and the
!> reduced problem on the tail is eq. (2.4) solved partially.
module equation_map
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: equation_map_type, make_map

   integer, parameter :: most_terms = 3                 !! own value, two relative ones
   real(dp), parameter :: aligned = 1.0_dp - 1.0e-9_dp !! cosine of an aligned frame

   !> Every degree of freedom as base value + sum of coefficient*unknown.
   type :: equation_map_type
      integer :: equations = 0                       !! unknowns
      integer :: tail = 0 !! relative unknowns that contact acts on, the last ones
      integer, allocatable :: term_count(:)          !! (dofs) terms of a degree of freedom
      integer, allocatable :: term(:, :)             !! (3, dofs) its unknowns
      real(dp), allocatable :: coefficient(:, :)     !! (3, dofs) their coefficients
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
   !> is prescribed on both nodes along a direction that is neither normal nor tangent.
   subroutine make_map(used, prescribed, slave, master, frame, on_tail, map, error)
      logical, intent(in) :: used(:)                      !! (nodes) whether a node carries unknowns
      logical, intent(in) :: prescribed(:)                !! (dofs) prescribed values
      integer, intent(in) :: slave(:)                     !! (m) slave nodes of the pairs
      integer, intent(in) :: master(:)                    !! (m) master nodes of the pairs
      real(dp), intent(in) :: frame(:, :, :) !! (components, components, m) columns: unit vectors
      logical, intent(in) :: on_tail(:, :) !! (components, m) relative values that contact acts on
      type(equation_map_type), intent(out) :: map         !! the numbering
      type(error_type), allocatable, intent(out) :: error !! see above
      logical, allocatable :: follows(:)
      integer :: components, c, dof, k, node

      components = size(frame, 1)
      associate (dofs => size(prescribed))
         allocate (map%term(most_terms, dofs), map%term_count(dofs), map%base(dofs), source=0)
         allocate (map%coefficient(most_terms, dofs), source=0.0_dp)
         allocate (map%relative(components, size(slave)), source=0)
         allocate (follows(dofs))
      end associate
      follows = prescribed
      do k = 1, size(slave)
         do c = 1, components
            call lead(components*(slave(k) - 1) + c, components*(master(k) - 1) + c)
         end do
      end do
      do node = 1, size(used)
         do dof = components*(node - 1) + 1, components*node
            if (prescribed(dof)) map%base(dof) = dof
            if (.not. (follows(dof) .or. .not. used(node))) call own_unknown(map, dof)
         end do
      end do
      call number_relative(map, prescribed, slave, master, frame, on_tail, error)
      if (allocated(error)) return
      do k = 1, size(slave)
         do c = 1, components
            call relate(map, components*(slave(k) - 1) + c, components*(master(k) - 1) + c, &
               prescribed, frame(c, :, k), map%relative(:, k))
         end do
      end do
   contains
      !> Of the two nodes of a pair the slave follows the master, unless only the slave is
      !> prescribed.
      subroutine lead(slave_dof, master_dof)
         integer, intent(in) :: slave_dof, master_dof

         if (prescribed(slave_dof)) then
            follows(master_dof) = .true.
         else
            follows(slave_dof) = .true.
         end if
      end subroutine lead
   end subroutine make_map

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
   subroutine relate(map, slave_dof, master_dof, prescribed, direction, relative)
      type(equation_map_type), intent(inout) :: map
      integer, intent(in) :: slave_dof, master_dof
      logical, intent(in) :: prescribed(:)
      real(dp), intent(in) :: direction(:)
      integer, intent(in) :: relative(:)
      integer :: c, leader, follower, n
      real(dp) :: side

      if (prescribed(slave_dof) .and. prescribed(master_dof)) return
      leader = merge(slave_dof, master_dof, prescribed(slave_dof))
      follower = merge(master_dof, slave_dof, prescribed(slave_dof))
      side = merge(-1.0_dp, 1.0_dp, prescribed(slave_dof))
      map%base(follower) = map%base(leader)
      n = map%term_count(leader)
      map%term(:n, follower) = map%term(:n, leader)
      map%coefficient(:n, follower) = map%coefficient(:n, leader)
      do c = 1, size(relative)
         if (relative(c) == 0 .or. abs(direction(c)) <= 0.0_dp) cycle
         n = n + 1
         map%term(n, follower) = relative(c)
         map%coefficient(n, follower) = side*direction(c)
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
