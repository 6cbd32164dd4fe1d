!> Linear constraints of supports, hanging nodes, equations, ties and contact points.
!>
!> At a contact point the slave's values are the master's plus its relative values in its own frame:
!> along normal and tangent; one jump of temperature. Where supports hold both nodes along an axis
!> there is only the row of the normal. Contact points that form cycles, as where a block is in an
!> inner corner, end with one whose rows follow from those of the others: they become links. So do
!> the rows of a contact point whose motion is prescribed.
!>
!> Contact points of a cycle that all stick share their friction in a way that statics leaves open,
!> and their relations depend on each other. They therefore have a small part of the bodies'
!> compliance.
!>
!> A tie has a row for every point of its slave face. On sides without midside nodes the rows would
!> be too many where the faces end at supports or at other ties: there the slave's end node follows
!> from these, and the row would bind the master's inner nodes in its place. Such a point has no row
!> of its own; its hat function goes to its neighbour's (Bernardi, Maday and Patera's multipliers,
!> constant on the last side).
module field_constraints
   use body_pieces, only: body_division_type
   use constraint_rows, only: constraint_rows_type, of_contact, of_equation, of_hanging, &
      of_support, of_tie, row_origin_type
   use equations, only: equation_type
   use kinds, only: dp
   use linear_constraints, only: eliminate, linear_constraints_type, node_stiffness
   use connections, only: connections_type, tie_points_type
   use held_points, only: held_directions, least_slant
   use sparse_matrix, only: sparse_matrix_type
   use sum_lists, only: add_terms
   implicit none
   private
   public :: constrain_displacements, constrain_temperatures, in_cycle, stiffness_alone, &
      cycle_compliance, find_prescribed, displacement_rows, temperature_rows, add_ties

   !> Compliance of a stuck contact point of a cycle, as a part of the bodies' at its nodes.
   real(dp), parameter :: cycle_compliance = 1.0e-8_dp

   !> Part of the bodies' stiffness at its nodes below which a contact point's own is rounding.
   real(dp), parameter :: held_by_others = 1.0e-6_dp

contains

   !> Constraints of the displacements; the normal ones, and with friction the tangential ones, are
   !> on the tail.
   pure subroutine constrain_displacements(used, prescribed, points, has_friction, slave_leads, &
      constraints, division)
      logical, intent(in) :: used(:)                !! (nodes) whether elements have them
      logical, intent(in) :: prescribed(:)                !! (2 nodes) prescribed displacements
      type(connections_type), intent(in) :: points !! contact points
      logical, intent(in) :: has_friction(:)        !! (m)
      !> (m) whether the slave is to lead where neither node is prescribed; else the master does
      logical, intent(in) :: slave_leads(:)
      type(linear_constraints_type), intent(out) :: constraints
      type(body_division_type), intent(inout), optional :: division   !! of bodies that are divided
      type(constraint_rows_type) :: rows

      rows = displacement_rows(prescribed, points, slave_leads)
      rows%on_tail(2::2) = has_friction
      if (allocated(points%along_z)) rows%last_dofs = points%along_z
      call eliminate_divided(rows, in_use(used, points, .false.), constraints, division)
   end subroutine constrain_displacements

   !> The rows of the displacements.
   pure function displacement_rows(prescribed, points, slave_leads) result(rows)
      logical, intent(in) :: prescribed(:)                !! (2 nodes) prescribed displacements
      type(connections_type), intent(in) :: points !! as above
      logical, intent(in) :: slave_leads(:)         !! (m) as above
      type(constraint_rows_type) :: rows
      real(dp) :: directions(2, size(slave_leads))
      integer :: k

      directions = held_directions(points, prescribed)
      call begin_rows(prescribed, 2, points, rows)
      call add_equations(points%equations, .false., rows)
      call add_ties(points%ties, prescribed, rows)
      do k = 1, size(points%slave)
         associate (n => points%normal(:, k), t => points%tangent(:, k), &
            across => abs(directions([2, 1], k)))
            if (any(across > 0.0_dp)) then
               call relate(points, k, maxloc(across, dim=1), n, [1.0_dp], slave_leads, rows)
            else
               call relate(points, k, 1, [1.0_dp, 0.0_dp], [n(1), t(1)], slave_leads, rows)
               call relate(points, k, 2, [0.0_dp, 1.0_dp], [n(2), t(2)], slave_leads, rows)
            end if
         end associate
      end do
   end function displacement_rows

   !> Constraints of the temperatures; all jumps are on the tail, and the nodes of faces
   !> whose heat is integrated to the edge of contact.
   pure subroutine constrain_temperatures(used, prescribed, points, slave_leads, &
      constraints, division)
      logical, intent(in) :: used(:)                !! (nodes) whether elements have them
      logical, intent(in) :: prescribed(:)                !! (nodes) prescribed temperatures
      type(connections_type), intent(in) :: points !! contact points
      logical, intent(in) :: slave_leads(:)         !! (m) as above
      type(linear_constraints_type), intent(out) :: constraints
      type(body_division_type), intent(inout), optional :: division   !! of bodies that are divided
      type(constraint_rows_type) :: rows

      rows = temperature_rows(prescribed, points, slave_leads)
      call eliminate_divided(rows, in_use(used, points, .true.), constraints, division)
   end subroutine constrain_temperatures

   !> The constraints of rows. Nodes that no row binds are inside of the pieces of divided bodies,
   !> and all others on the tail.
   pure subroutine eliminate_divided(rows, used, constraints, division)
      type(constraint_rows_type), intent(inout) :: rows
      logical, intent(in) :: used(:)
      type(linear_constraints_type), intent(out) :: constraints
      type(body_division_type), intent(inout), optional :: division
      logical :: is_bound(rows%dofs/rows%components), is_divided, is_prescribed(rows%dofs)
      integer :: i

      is_divided = .false.
      if (present(division)) is_divided = allocated(division%graph%value)
      if (.not. is_divided) then
         call eliminate(rows, used, constraints)
         return
      end if
      is_bound = .not. used(rows%components::rows%components)
      if (allocated(rows%last_dofs)) is_bound((rows%last_dofs + 1)/2) = .true.
      is_prescribed = .false.
      do i = 1, rows%count
         associate (values => rows%values_of(i))
            if (rows%origin(i)%kind == of_support .and. .not. division%cuts_bodies()) then
               is_prescribed(values(1)) = .true.
            else
               is_bound((pack(values, values <= rows%dofs) - 1)/rows%components + 1) = .true.
            end if
         end associate
      end do
      call division%divide(is_bound, is_prescribed, rows%components)
      rows%keeps_all = division%is_tail()
      call eliminate(rows, used .and. division%piece == 0, constraints)
   end subroutine eliminate_divided

   !> The rows of the temperatures.
   pure function temperature_rows(prescribed, points, slave_leads) result(rows)
      logical, intent(in) :: prescribed(:)                !! (nodes) prescribed temperatures
      type(connections_type), intent(in) :: points !! contact points
      logical, intent(in) :: slave_leads(:)         !! (m) as above
      type(constraint_rows_type) :: rows
      integer :: k

      call begin_rows(prescribed, 1, points, rows)
      call add_equations(points%equations, .true., rows)
      call add_ties(points%ties, prescribed, rows)
      if (allocated(points%edge_nodes)) then
         allocate (rows%dof_on_tail(size(prescribed)), source=.false.)
         rows%dof_on_tail(points%edge_nodes) = .true.
      end if
      do k = 1, size(points%slave)
         if (all(prescribed(points%nodes_of(k)))) cycle
         call relate(points, k, 1, [1.0_dp], [1.0_dp], slave_leads, rows)
      end do
   end function temperature_rows

   !> Degrees of freedom that elements, springs, trusses, equations or contact points have: those of
   !> a rigid surface have a reference node, and strains along z theirs.
   pure function in_use(used, points, thermal) result(dofs)
      logical, intent(in) :: used(:)
      type(connections_type), intent(in) :: points
      logical, intent(in) :: thermal
      logical, allocatable :: dofs(:)
      logical :: needed(size(used))
      integer :: i

      needed = used
      needed(points%master) = .true.
      if (.not. thermal) needed(points%references(.not. used)) = .true.
      if (thermal) then
         dofs = needed
      else
         dofs = reshape(spread(needed, 1, 2), [2*size(used)])
      end if
      do i = 1, size(points%equations)
         if (points%equations(i)%is_thermal() .eqv. thermal) dofs(points%equations(i)%places()) = &
            .true.
      end do
      if (thermal) return
      do i = 1, size(points%elongations)
         dofs(points%elongations(i)%places()) = .true.
      end do
      if (allocated(points%along_z)) dofs(points%along_z) = .true.
   end function in_use

   !> Adds the rows of the equations of a field. Their first terms are to be written by the others.
   pure subroutine add_equations(equations, thermal, rows)
      type(equation_type), intent(in) :: equations(:)
      logical, intent(in) :: thermal
      type(constraint_rows_type), intent(inout) :: rows
      integer :: i

      do i = 1, size(equations)
         if (equations(i)%is_thermal() .neqv. thermal) cycle
         associate (dofs => equations(i)%places())
            call rows%add(dofs, equations(i)%coefficient)
            rows%origin(rows%count) = row_origin_type(of_equation, i)
            rows%choice(rows%count) = dofs(1)
         end associate
      end do
   end subroutine add_equations

   !> The rows of the supports, u - g = 0, and of the hanging nodes.
   pure subroutine begin_rows(prescribed, components, points, rows)
      logical, intent(in) :: prescribed(:)
      integer, intent(in) :: components
      type(connections_type), intent(in) :: points
      type(constraint_rows_type), intent(out) :: rows
      integer :: c, dof, i, introduced, most

      rows%components = components
      rows%dofs = size(prescribed)
      introduced = components*size(points%slave)
      most = count(prescribed) + components*points%hanging%count + size(points%equations) + &
         2*components*points%ties%difference%count + introduced
      allocate (rows%on_tail(introduced), source=.true.)
      allocate (rows%origin(most), rows%choice(most))
      call rows%reserve(most, 2*count(prescribed) + components*(introduced + &
         size(points%difference%value)*merge(2, 1, points%turns())))
      do dof = 1, size(prescribed)
         if (.not. prescribed(dof)) cycle
         call rows%add([dof, size(prescribed) + introduced + dof], [1.0_dp, -1.0_dp])
         rows%origin(rows%count) = row_origin_type(of_support, dof)
         rows%choice(rows%count) = dof
      end do
      ! Where a hanging node is prescribed, so are those of its side: they are in one set.
      do i = 1, points%hanging%count
         do c = 1, components
            associate (dofs => components*(points%hanging%values_of(i) - 1) + c)
               if (prescribed(dofs(1))) cycle
               call rows%add(dofs, points%hanging%coefficients_of(i))
               rows%origin(rows%count) = row_origin_type(of_hanging, dofs(1))
               rows%choice(rows%count) = dofs(1)
            end associate
         end do
      end do
   end subroutine begin_rows

   !> Adds a row of a contact point, introduced values less direction.(slave - master) = 0. A
   !> component of the slave's own node is to be written by the others, or of the master's; on faces
   !> that do not match always of the slave's.
   pure subroutine relate(points, k, component, direction, introduced, slave_leads, rows)
      type(connections_type), intent(in) :: points
      integer, intent(in) :: k, component
      real(dp), intent(in) :: direction(:)          ! (components)
      real(dp), intent(in) :: introduced(:)         ! factors of its introduced values
      logical, intent(in) :: slave_leads(:)
      type(constraint_rows_type), intent(inout) :: rows
      integer, allocatable :: nodes(:), dofs(:)
      real(dp), allocatable :: along(:), across(:), share(:)
      integer :: i

      if (rows%components == 2) then
         call points%means_of(k, nodes, along, across)
      else
         nodes = points%nodes_of(k)
         along = points%difference%coefficients_of(k)
      end if
      if (slave_leads(k) .and. size(nodes) == 2) then
         nodes = nodes([2, 1])
         along = along([2, 1])
      end if
      dofs = rows%components*(nodes - 1) + component
      share = direction(component)*along
      if (rows%components == 2) then
         associate (other => 3 - component)
            share = [share + (3 - 2*other)*direction(other)*across, direction(other)*along + &
               (3 - 2*component)*direction(component)*across]
            dofs = [dofs, 2*(nodes - 1) + other]
         end associate
      end if
      call rows%add([dofs, (rows%dofs + rows%components*(k - 1) + i, i=1, size(introduced))], &
         [-share, introduced])
      rows%origin(rows%count) = row_origin_type(of_contact, k)
      rows%choice(rows%count) = rows%components*(nodes(1) - 1) + component
   end subroutine relate

   !> Contact points of which supports, ties and equations prescribe how they move: links relate
   !> nothing but their own values. Those of which they prescribe the whole, or the normal motion.
   pure subroutine find_prescribed(constraints, prescribed, along_normal)
      type(linear_constraints_type), intent(in) :: constraints !! of the displacements
      logical, intent(out) :: prescribed(:)         !! (m) whether any motion is
      logical, intent(out) :: along_normal(:)       !! (m) whether the normal one is
      integer :: i, k, links(size(prescribed))

      links = 0
      along_normal = .false.
      do i = 1, constraints%link_unknowns%count
         associate (linked => constraints%link_unknowns%values_of(i), &
            share => constraints%link_unknowns%coefficients_of(i))
            if (size(linked) == 0) cycle
            k = (findloc(constraints%introduced, linked(1), dim=1) + 1)/2
            if (k == 0) cycle
            associate (own => constraints%introduced(2*k - 1:2*k))
               if (any(linked /= own(1) .and. linked /= own(2))) cycle
               links(k) = links(k) + 1
               along_normal(k) = links(k) == 2 .or. &
                  all(linked == own(1) .or. abs(share) <= least_slant)
            end associate
         end associate
      end do
      prescribed = links > 0
   end subroutine find_prescribed

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

   !> Adds the rows of all ties. Two nodes face to face that are both prescribed have a row of their
   !> own: what prescribes them must agree there.
   pure subroutine add_ties(ties, prescribed, rows)
      type(tie_points_type), intent(in) :: ties
      logical, intent(in) :: prescribed(:)                !! (dofs) prescribed values
      type(constraint_rows_type), intent(inout) :: rows
      logical :: determined(ties%difference%count)
      logical :: shared(size(prescribed)/rows%components) ! whether several ties act on a node
      integer :: owner(ties%difference%count)
      integer :: c, first(size(shared)), k, slave_dof, master_dof

      shared = .false.
      first = 0
      do k = 1, size(determined)
         associate (own => ties%difference%values_of(k))
            shared(own) = shared(own) .or. (first(own) > 0 .and. first(own) /= ties%tie(k))
            first(own) = ties%tie(k)
         end associate
      end do
      do c = 1, rows%components
         associate (of_component => prescribed(c::rows%components))
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
            if (ties%is_opposite(k) .and. prescribed(slave_dof) .and. prescribed(master_dof)) then
               call add_row([slave_dof, master_dof], [1.0_dp, -1.0_dp], k, slave_dof, rows)
            end if
            if (owner(k) == k) call add_point(ties, owner, k, c, rows)
         end do
      end do
   end subroutine add_ties

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

end module field_constraints
