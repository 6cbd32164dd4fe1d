!> Unknowns of a field problem with contact: nodal values on one side, the pairs' relative values
!> last.
!>
!> At a pair the slave's values are the master's plus the relative value theta in the pair's own
!> frame (normal, tangent; one component for temperature). Nodes that pairs tie together, a node may
!> be in several, form a tree: each degree of freedom on it is written by the next one on the way to
!> the root, which is a prescribed one if there is any. A pair that would close a ring ties a twin
!> of its slave instead, which a force holds to the slave (ring_links). The relative values that
!> contact acts on and these forces form the tail of the system: with the former zero the bodies are
!> welded, and the reduced problem on the tail is eq. (2.4) solved partially.
module equation_map
   use kinds, only: dp
   use ring_links, only: add_links, link_entries, node_stiffness, ring_link_type, support_forces
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: equation_map_type

   !> Every degree of freedom as base value + sum of coefficient*unknown.
   type :: equation_map_type
      integer :: equations = 0                       !! unknowns
      integer :: tail = 0 !! last unknowns: relative ones that contact acts on, forces of links
      integer, allocatable :: term_count(:)          !! (dofs) terms of a degree of freedom
      integer, allocatable :: term(:, :)             !! (most, dofs) its unknowns
      real(dp), allocatable :: coefficient(:, :)     !! (most, dofs) their coefficients
      integer, allocatable :: base(:) !! (dofs) degree whose prescribed value it is based on, or 0
      integer, allocatable :: relative(:, :) !! (components, m) its unknowns, 0 if prescribed
      type(ring_link_type), allocatable :: links(:)  !! links of the pairs that close rings
      logical, allocatable :: in_ring(:)             !! (m) whether a pair is part of a ring
   contains
      procedure :: expand
      procedure :: restrict
      procedure :: support_load
      procedure :: stiffen_links
      procedure :: transform
      procedure :: tail_index
   end type equation_map_type

contains

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

   !> Scales the links by the stiffness of the bodies.
   pure subroutine stiffen_links(self, matrix)
      class(equation_map_type), intent(inout) :: self !! the numbering
      type(sparse_matrix_type), intent(in) :: matrix  !! (dofs, dofs) of the bodies
      integer :: i

      do i = 1, size(self%links)
         self%links(i)%stiffness = node_stiffness(matrix, self%links(i)%nodes, &
            size(self%relative, 1))
      end do
   end subroutine stiffen_links

   !> Right-hand side of the links, which prescribed values may stretch.
   pure function support_load(self, given) result(rhs)
      class(equation_map_type), intent(in) :: self  !! the numbering
      real(dp), intent(in) :: given(:)              !! (dofs) prescribed values, others not used
      real(dp) :: rhs(self%equations)               !! (equations)

      rhs = 0.0_dp
      call support_forces(self%links, given, rhs)
   end function support_load

   !> Lower triangle of the matrix on the unknowns, with the links.
   pure function transform(self, matrix) result(lower)
      class(equation_map_type), intent(in) :: self    !! the numbering
      type(sparse_matrix_type), intent(in) :: matrix  !! (dofs, dofs) symmetric, both triangles
      type(sparse_matrix_type) :: lower               !! (equations, equations) by rows
      type(triplet_list_type) :: list
      integer :: i, j, k, s, t, pass, entries

      entries = 0
      do pass = 1, 2
         if (pass == 2) call list%reserve(entries + link_entries(self%links))
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
      call add_links(self%links, list)
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
