!> Linear constraints of supports, ties and contact points.
!>
!> At a contact point the slave's values are the master's plus its relative values in its own frame:
!> along normal and tangent; one jump of temperature. Where supports hold both nodes along an axis,
!> only the other axis has a row: the relative value along the normal is the part of it that the
!> motion along that axis makes. Contact points that form cycles, as where a block stands in an
!> inner corner, end with one whose rows follow from those of the others: they become links.
!>
!> Contact points of a cycle that all stick share their friction in a way that statics leaves open,
!> and their relations depend on each other. They therefore have a small part of the bodies'
!> compliance.
module contact_constraints
   use constraint_elimination, only: constraint_rows_type, eliminate
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use linear_constraints, only: linear_constraints_type, node_stiffness
   use all_contact_points, only: over_constrained, all_contact_points_type
   use sparse_matrix, only: sparse_matrix_type
   use tie_constraints, only: add_ties, most_rows
   implicit none
   private
   public :: constrain_displacements, constrain_temperatures, in_cycle, stiffness_alone, &
      cycle_compliance, first_tied

   !> Compliance of a stuck contact point of a cycle, as a part of the bodies' at its nodes.
   real(dp), parameter :: cycle_compliance = 1.0e-8_dp

   !> Part of the bodies' stiffness at its nodes below which a contact point's own is rounding.
   real(dp), parameter :: held_by_others = 1.0e-6_dp

contains

   !> Constraints of the displacements; the normal ones, and with friction the tangential ones, are
   !> on the tail.
   !> Error: a contact point whose normal motion is prescribed on both nodes.
   subroutine constrain_displacements(used, held, points, slave_leads, constraints, error)
      logical, intent(in) :: used(:)                !! (nodes) whether elements have them
      logical, intent(in) :: held(:)                !! (2 nodes) prescribed displacements
      type(all_contact_points_type), intent(in) :: points !! contact points, their held axes found
      !> (m) whether the slave is to lead where neither node is prescribed; else the master does
      logical, intent(in) :: slave_leads(:)
      type(linear_constraints_type), intent(out) :: constraints
      type(error_type), allocatable, intent(out) :: error
      type(constraint_rows_type) :: rows
      integer :: axis, c, k

      if (any(over_constrained(points, held))) then
         call set_error(error, status_deck, &
            'a contact pair whose normal motion is prescribed on both nodes')
         return
      end if
      call begin_rows(held, 2, points, rows)
      call add_ties(points%ties, held, rows)
      do k = 1, size(points%slave)
         rows%on_tail(2*k - 1:2*k) = [.true., points%friction(k) > 0.0_dp]
         axis = points%held_axis(k)
         do c = 1, 2
            if (c == axis) cycle
            if (axis > 0) then
               call relate(points, k, c, slave_leads, [1.0_dp/points%normal(c, k)], rows)
            else
               call relate(points, k, c, slave_leads, [points%normal(c, k), &
                  points%tangent(c, k)], rows)
            end if
         end do
      end do
      call eliminate(rows, reshape(spread(used, 1, 2), [size(held)]), constraints)
   end subroutine constrain_displacements

   !> Constraints of the temperatures; all jumps are on the tail.
   pure subroutine constrain_temperatures(used, held, points, slave_leads, constraints)
      logical, intent(in) :: used(:)                !! (nodes) whether elements have them
      logical, intent(in) :: held(:)                !! (nodes) prescribed temperatures
      type(all_contact_points_type), intent(in) :: points !! contact points
      logical, intent(in) :: slave_leads(:)         !! (m) as above
      type(linear_constraints_type), intent(out) :: constraints
      type(constraint_rows_type) :: rows
      integer :: k

      call begin_rows(held, 1, points, rows)
      call add_ties(points%ties, held, rows)
      rows%on_tail = .true.
      do k = 1, size(points%slave)
         if (all(held(points%nodes_of(k)))) cycle
         call relate(points, k, 1, slave_leads, [1.0_dp], rows)
      end do
      call eliminate(rows, used, constraints)
   end subroutine constrain_temperatures

   !> The rows of the supports, u - g = 0.
   pure subroutine begin_rows(held, components, points, rows)
      logical, intent(in) :: held(:)
      integer, intent(in) :: components
      type(all_contact_points_type), intent(in) :: points
      type(constraint_rows_type), intent(out) :: rows
      integer :: dof, introduced, most

      rows%components = components
      rows%dofs = size(held)
      introduced = components*size(points%slave)
      most = count(held) + most_rows(points%ties, components) + introduced
      allocate (rows%on_tail(introduced), rows%constraint(most), rows%choice(most))
      call rows%reserve(most, 2*count(held) + components*(introduced + &
         size(points%difference%value)*merge(2, 1, points%turns())))
      do dof = 1, size(held)
         if (.not. held(dof)) cycle
         call rows%add([dof, size(held) + introduced + dof], [1.0_dp, -1.0_dp])
         rows%constraint(rows%count) = dof
         rows%choice(rows%count) = dof
      end do
   end subroutine begin_rows

   !> Adds the row of one component of a contact point: direction*relative - (slave - master) = 0.
   !> The slave's own node is to be written by the others, or the master's; on faces that do not
   !> match always the slave's.
   pure subroutine relate(points, k, component, slave_leads, direction, rows)
      type(all_contact_points_type), intent(in) :: points
      integer, intent(in) :: k, component
      logical, intent(in) :: slave_leads(:)
      real(dp), intent(in) :: direction(:)
      type(constraint_rows_type), intent(inout) :: rows
      integer, allocatable :: nodes(:), dofs(:)
      real(dp), allocatable :: share(:)
      integer :: i

      nodes = points%nodes_of(k)
      share = points%difference%coefficients_of(k)
      if (slave_leads(k) .and. size(nodes) == 2) then
         nodes = nodes([2, 1])
         share = share([2, 1])
      end if
      dofs = rows%components*(nodes - 1) + component
      if (rows%components == 2 .and. points%turns()) then
         dofs = [2*(points%along%values_of(k) - 1) + component, &
            2*(points%across%values_of(k) - 1) + 3 - component]
         share = [points%along%coefficients_of(k), &
            (3 - 2*component)*points%across%coefficients_of(k)]
      end if
      call rows%add([dofs, (rows%dofs + rows%components*(k - 1) + i, i=1, size(direction))], &
         [-share, direction])
      rows%constraint(rows%count) = rows%dofs + k
      rows%choice(rows%count) = rows%components*(nodes(1) - 1) + component
   end subroutine relate

   !> The first contact point whose relative motion ties and supports prescribe; 0 where there is
   !> none. A link then relates nothing but its own values.
   pure integer function first_tied(constraints, points)
      type(linear_constraints_type), intent(in) :: constraints !! of the displacements
      type(all_contact_points_type), intent(in) :: points      !! all contact points
      integer :: i, k

      do i = 1, constraints%link_unknowns%count
         associate (linked => constraints%link_unknowns%values_of(i))
            if (size(linked) == 0) cycle
            do k = 1, size(points%slave)
               first_tied = k
               if (all(linked == constraints%introduced(2*k - 1) .or. &
                  linked == constraints%introduced(2*k))) return
            end do
         end associate
      end do
      first_tied = 0
   end function first_tied

   !> Contact points that are part of a cycle.
   pure function in_cycle(constraints, points) result(cyclic)
      type(linear_constraints_type), intent(in) :: constraints
      integer, intent(in) :: points                 !! m, their number
      logical :: cyclic(points)                     !! (m)

      cyclic = any(reshape(constraints%is_linked(constraints%introduced), &
         [constraints%components, points]), dim=1)
   end function in_cycle

   !> Stiffness, or conductance, of a contact point of a cycle alone. That of the one that closes
   !> the cycle, which only the others hold, is the bodies' at its nodes.
   pure function stiffness_alone(own, matrix, nodes, components) result(stiffness)
      real(dp), intent(in) :: own                         !! diagonal entry on the tail
      type(sparse_matrix_type), intent(in) :: matrix      !! (dofs, dofs) of the bodies
      integer, intent(in) :: nodes(:)                     !! those that it takes its values of
      integer, intent(in) :: components                   !! degrees of freedom of a node
      real(dp) :: stiffness                               !! in the unit of the matrix

      stiffness = node_stiffness(matrix, nodes, components)
      if (own >= held_by_others*stiffness) stiffness = own
   end function stiffness_alone

end module contact_constraints
