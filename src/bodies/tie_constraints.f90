!> Linear constraints of ties: relative displacements and jumps of temperature that are zero.
!>
!> A tie has a row for every point of its slave face. On sides without midside nodes the rows would
!> be too many where the faces end at supports or at other ties: there the slave's end node follows
!> from these, and the row would bind the master's inner nodes in its place. Such a point has no row
!> of its own; its hat function goes to its neighbour's (Bernardi, Maday and Patera's multipliers,
!> constant on the last side).
module tie_constraints
   use constraint_rows, only: constraint_rows_type, of_tie, row_origin_type
   use kinds, only: dp
   use sum_lists, only: add_terms
   use all_contact_points, only: tie_points_type
   implicit none
   private
   public :: add_ties, most_rows

contains

   !> Upper bound of the rows of all ties.
   pure integer function most_rows(ties, components)
      type(tie_points_type), intent(in) :: ties
      integer, intent(in) :: components             !! degrees of freedom of a node

      most_rows = 2*components*ties%difference%count
   end function most_rows

   !> Adds the rows of all ties. Two nodes face to face that are both prescribed have a row of their
   !> own: what prescribes them must agree there.
   pure subroutine add_ties(ties, held, rows)
      type(tie_points_type), intent(in) :: ties
      logical, intent(in) :: held(:)                !! (dofs) prescribed values
      type(constraint_rows_type), intent(inout) :: rows
      logical :: determined(ties%difference%count), shared(size(held)/rows%components)
      integer :: owner(ties%difference%count)
      integer :: c, k, slave_dof, master_dof

      shared = in_several(ties, size(shared))
      do c = 1, rows%components
         associate (of_component => held(c::rows%components))
            do k = 1, size(determined)
               associate (ends => [ties%slave(k), ties%master(k)])
                  determined(k) = ties%is_linear(k) .and. all(of_component(ends) .or. &
                     shared(ends)) .and. .not. all(of_component(ties%difference%values_of(k)))
               end associate
            end do
         end associate
         owner = owners(ties, determined)
         do k = 1, size(determined)
            slave_dof = rows%components*(ties%slave(k) - 1) + c
            master_dof = rows%components*(ties%master(k) - 1) + c
            if (ties%is_opposite(k) .and. held(slave_dof) .and. held(master_dof)) then
               call add_row([slave_dof, master_dof], [1.0_dp, -1.0_dp], k, slave_dof, rows)
            end if
            if (owner(k) == k) call add_point(ties, owner, k, c, rows)
         end do
      end do
   end subroutine add_ties

   !> Nodes that several ties act on.
   pure function in_several(ties, nodes) result(several)
      type(tie_points_type), intent(in) :: ties
      integer, intent(in) :: nodes
      logical :: several(nodes)
      integer :: first(nodes), k

      several = .false.
      first = 0
      do k = 1, ties%difference%count
         associate (own => ties%difference%values_of(k))
            several(own) = several(own) .or. (first(own) > 0 .and. first(own) /= ties%tie(k))
            first(own) = ties%tie(k)
         end associate
      end do
   end function in_several

   !> The point whose row takes each point's hat function: its own, or the nearest one of the same
   !> tie along the face that is not determined.
   pure function owners(ties, determined) result(owner)
      type(tie_points_type), intent(in) :: ties
      logical, intent(in) :: determined(:)
      integer :: owner(size(determined))
      integer :: distance, k, side

      owner = [(k, k=1, size(owner))]
      do k = 1, size(owner)
         if (.not. determined(k)) cycle
         search: do distance = 1, size(owner)
            do side = -1, 1, 2
               associate (other => k + side*distance)
                  if (other < 1 .or. other > size(owner)) cycle
                  if (determined(other) .or. ties%tie(other) /= ties%tie(k)) cycle
                  owner(k) = other
                  exit search
               end associate
            end do
         end do search
      end do
   end function owners

   !> Adds the row of one component of a point, the mean over the hat functions that it takes.
   pure subroutine add_point(ties, owner, k, component, rows)
      type(tie_points_type), intent(in) :: ties
      integer, intent(in) :: owner(:)
      integer, intent(in) :: k, component
      type(constraint_rows_type), intent(inout) :: rows
      integer, allocatable :: nodes(:)
      real(dp), allocatable :: share(:)
      integer :: other

      nodes = ties%difference%values_of(k)
      share = ties%difference%coefficients_of(k)
      if (count(owner == k) > 1) share = share*ties%weight(k)
      do other = 1, size(owner)
         if (owner(other) /= k .or. other == k) cycle
         associate (more => ties%difference%values_of(other), &
            part => ties%weight(other)*ties%difference%coefficients_of(other))
            call add_terms(more, part, nodes, share)
         end associate
      end do
      if (count(owner == k) > 1) share = share/sum(ties%weight, mask=owner == k)
      call add_row(rows%components*(nodes - 1) + component, share, k, &
         rows%components*(ties%slave(k) - 1) + component, rows)
   end subroutine add_point

   !> Adds a row.
   pure subroutine add_row(dofs, share, point, choice, rows)
      integer, intent(in) :: dofs(:)
      real(dp), intent(in) :: share(:)
      integer, intent(in) :: point, choice
      type(constraint_rows_type), intent(inout) :: rows

      call rows%add(dofs, share)
      rows%origin(rows%count) = row_origin_type(of_tie, point)
      rows%choice(rows%count) = choice
   end subroutine add_row

end module tie_constraints
