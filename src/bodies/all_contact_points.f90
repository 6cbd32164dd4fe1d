!> The contact points of all interfaces in one row, as the solution works on them, and beside them
!> the points of all ties.
module all_contact_points
   use conductance_laws, only: conductance_law_type
   use interface_points, only: make_contact_points
   use contact_points, only: contact_points_type
   use errors, only: error_type
   use kinds, only: dp
   use model, only: model_type
   use sum_lists, only: sum_list_type
   use tie_points, only: joined_ties, make_tie_points, tie_points_type
   implicit none
   private
   public :: all_contact_points_type, match_surfaces, match_tie, joined_points
   public :: find_held_axes, over_constrained, held_approach, tangential_positions

   !> Component of a normal along the only free axis that is rounding: the normal motion of such a
   !> contact point is prescribed.
   real(dp), parameter :: least_slant = 1.0e-9_dp

   !> The contact points of all interfaces in one row.
   type :: all_contact_points_type
      integer, allocatable :: interface_start(:)     !! (interfaces + 1) first contact point of each
      integer, allocatable :: slave(:), master(:)             !! (m) node indexes
      !> (m, nodes) slave's value less master's, as the mean that the contact point takes of each
      type(sum_list_type) :: difference
      !> (m, nodes) the same of displacements, as in contact_points_type; no sums where no normal of
      !> any contact point turns
      type(sum_list_type) :: along, across
      real(dp), allocatable :: weight(:)                      !! (m) tributary areas [length^2]
      real(dp), allocatable :: initial_gap(:)                 !! (m) h [length]
      real(dp), allocatable :: friction(:)                    !! (m) mu [-]
      real(dp), allocatable :: normal(:, :), tangent(:, :)    !! (2, m) unit vectors
      type(conductance_law_type), allocatable :: law(:)       !! (m) conductance laws
      !> (m) the axis, 1 or 2, along which supports hold both nodes, while they leave one of them
      !> free along the other axis; else 0
      integer, allocatable :: held_axis(:)
      type(tie_points_type) :: ties                           !! points of the ties, no part of m
   contains
      procedure :: jumps
      procedure :: relative
      procedure :: add_heat
      procedure :: add_forces
      procedure :: nodes_of
      procedure :: turns
   end type all_contact_points_type

contains

   !> Matches the surfaces of one *CONTACT PAIR, with the thickness of the slave's first element.
   !> Error: as make_contact_points.
   subroutine match_surfaces(model, i, points, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                            !! index into model%contacts
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error

      call make_contact_points(model%mesh, model%contacts(i), &
         thickness_at(model, model%contacts(i)%slave), points, error)
   end subroutine match_surfaces

   !> Matches the surfaces of one *TIE.
   !> Error: as make_tie_points.
   subroutine match_tie(model, i, points, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                            !! index into model%ties
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error

      call make_tie_points(model%mesh, model%ties(i), &
         thickness_at(model, model%ties(i)%faces%slave), points, error)
   end subroutine match_tie

   !> Thickness of a surface's first element.
   pure real(dp) function thickness_at(model, surface)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface

      thickness_at = 1.0_dp
      associate (faces => model%mesh%surfaces(surface)%faces)
         if (size(faces, 2) > 0) then
            thickness_at = model%sections(model%mesh%element_section(faces(1, 1)))%thickness
         end if
      end associate
   end function thickness_at

   !> Puts the contact points of all interfaces in one row, and those of all ties.
   pure function joined_points(interfaces, of_ties, model) result(row)
      type(contact_points_type), intent(in) :: interfaces(:) !! in the order of the deck
      type(contact_points_type), intent(in) :: of_ties(:)    !! (ties) in the order of the deck
      type(model_type), intent(in) :: model
      type(all_contact_points_type) :: row                  !! all their contact points
      integer :: i, first, k, last, m

      allocate (row%interface_start(size(interfaces) + 1))
      row%interface_start(1) = 1
      do i = 1, size(interfaces)
         row%interface_start(i + 1) = row%interface_start(i) + size(interfaces(i)%slave_node)
      end do
      m = row%interface_start(size(interfaces) + 1) - 1
      allocate (row%slave(m), row%master(m), row%weight(m), row%initial_gap(m), row%friction(m), &
         row%normal(2, m), row%tangent(2, m), row%law(m))
      allocate (row%held_axis(m), source=0)
      call row%difference%reserve(m, 2*m)
      if (any([(interfaces(i)%across%count > 0, i=1, size(interfaces))])) then
         call row%along%reserve(m, 2*m)
         call row%across%reserve(m, 2*m)
      end if
      do i = 1, size(interfaces)
         first = row%interface_start(i)
         last = row%interface_start(i + 1) - 1
         row%slave(first:last) = interfaces(i)%slave_node
         row%master(first:last) = interfaces(i)%master_node
         row%weight(first:last) = interfaces(i)%weight
         row%initial_gap(first:last) = interfaces(i)%initial_gap
         row%normal(:, first:last) = interfaces(i)%normal
         row%tangent(:, first:last) = interfaces(i)%tangent
         row%friction(first:last) = model%interactions(model%contacts(i)%interaction)%friction
         row%law(first:last) = model%interactions(model%contacts(i)%interaction)%law
         call append(interfaces(i)%difference, row%difference)
         if (.not. row%turns()) cycle
         if (interfaces(i)%across%count > 0) then
            call append(interfaces(i)%along, row%along)
            call append(interfaces(i)%across, row%across)
         else
            call append(interfaces(i)%difference, row%along)
            do k = first, last
               call row%across%add([integer ::], [real(dp) ::])
            end do
         end if
      end do
      row%ties = joined_ties(model%mesh, model%ties, of_ties)
   end function joined_points

   !> Adds the sums of a list to another one.
   pure subroutine append(sums, list)
      type(sum_list_type), intent(in) :: sums
      type(sum_list_type), intent(inout) :: list
      integer :: k

      do k = 1, sums%count
         call list%add(sums%values_of(k), sums%coefficients_of(k))
      end do
   end subroutine append

   !> Whether the normal turns along the face of some contact point.
   pure logical function turns(self)
      class(all_contact_points_type), intent(in) :: self

      turns = allocated(self%across%start)
   end function turns

   !> Slave's value less master's of a field, at every contact point.
   pure function jumps(self, field)
      class(all_contact_points_type), intent(in) :: self
      real(dp), intent(in) :: field(:)             !! (nodes)
      real(dp) :: jumps(size(self%slave))          !! (m)

      jumps = 0.0_dp
      call self%difference%add_totals(field, jumps)
   end function jumps

   !> Slave's displacement less master's, at every contact point, in the directions of its normal:
   !> the mean of displacements that are turned with the face.
   pure function relative(self, displacement)
      class(all_contact_points_type), intent(in) :: self
      real(dp), intent(in) :: displacement(:)      !! (2 nodes) [length]
      real(dp) :: relative(2, size(self%slave))    !! (2, m) [length]

      real(dp) :: across(2, size(self%slave))

      relative(1, :) = self%jumps(displacement(1::2))
      relative(2, :) = self%jumps(displacement(2::2))
      if (.not. self%turns()) return
      relative = 0.0_dp
      across = 0.0_dp
      call self%along%add_totals(displacement(1::2), relative(1, :))
      call self%along%add_totals(displacement(2::2), relative(2, :))
      call self%across%add_totals(displacement(1::2), across(1, :))
      call self%across%add_totals(displacement(2::2), across(2, :))
      relative = relative + reshape([across(2, :), -across(1, :)], shape(across), order=[2, 1])
   end function relative

   !> Adds what leaves the slave's nodes through the contact points, and enters the master's.
   pure subroutine add_heat(self, heat, rates)
      class(all_contact_points_type), intent(in) :: self
      real(dp), intent(in) :: heat(:)              !! (m) heat from slave to master [power]
      real(dp), intent(inout) :: rates(:)          !! (nodes) [power]

      call self%difference%add_shares(heat, rates)
   end subroutine add_heat

   !> Adds the nodal forces of forces on the slave at the contact points, and of their opposites on
   !> the master.
   pure subroutine add_forces(self, on_slave, forces)
      class(all_contact_points_type), intent(in) :: self
      real(dp), intent(in) :: on_slave(:, :)       !! (2, m) [force]
      real(dp), intent(inout) :: forces(:)         !! (2 nodes) [force]

      if (.not. self%turns()) then
         call self%difference%add_shares(on_slave(1, :), forces(1::2))
         call self%difference%add_shares(on_slave(2, :), forces(2::2))
         return
      end if
      call self%along%add_shares(on_slave(1, :), forces(1::2))
      call self%along%add_shares(on_slave(2, :), forces(2::2))
      call self%across%add_shares(on_slave(1, :), forces(2::2))
      call self%across%add_shares(-on_slave(2, :), forces(1::2))
   end subroutine add_forces

   !> The nodes whose values a contact point takes.
   pure function nodes_of(self, k) result(nodes)
      class(all_contact_points_type), intent(in) :: self
      integer, intent(in) :: k                     !! a contact point
      integer, allocatable :: nodes(:)

      nodes = self%difference%values_of(k)
   end function nodes_of

   !> Finds the contact points that supports hold along one axis on all nodes, or on the two
   !> opposite ones if the axis is their tangent, as on a line of symmetry: no shear acts there.
   !> Their contact condition stays, along their own normal; the only relative motion that is free
   !> is the one along the other axis.
   pure subroutine find_held_axes(points, held)
      type(all_contact_points_type), intent(inout) :: points !! all contact points
      logical, intent(in) :: held(:)                        !! (2 nodes) prescribed displacements
      logical :: both(2)
      integer :: k

      do k = 1, size(points%slave)
         both = on_all_nodes(points, held, k) .or. (on_both_nodes(points, held, k) .and. &
            abs(points%normal(:, k)) <= least_slant)
         points%held_axis(k) = merge(merge(1, 2, both(1)), 0, both(1) .neqv. both(2))
      end do
   end subroutine find_held_axes

   !> Contact points whose normal motion is prescribed: both nodes are held along both axes, or
   !> along the one that is their normal.
   pure function over_constrained(points, held) result(too_much)
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: held(:)               !! (2 nodes) prescribed displacements
      logical :: too_much(size(points%slave))      !! (m)
      logical :: both(2)
      integer :: k

      do k = 1, size(points%slave)
         both = on_all_nodes(points, held, k)
         too_much(k) = any(both) .and. (all(both) .or. &
            abs(points%normal(merge(2, 1, both(1)), k)) <= least_slant)
      end do
   end function over_constrained

   !> Axes along which all nodes whose values a contact point takes are held.
   pure function on_all_nodes(points, held, k) result(all_held)
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: held(:)
      integer, intent(in) :: k
      logical :: all_held(2)

      associate (nodes => points%nodes_of(k))
         all_held = [all(held(2*nodes - 1)), all(held(2*nodes))]
      end associate
      if (.not. points%turns()) return
      if (size(points%across%values_of(k)) > 0) all_held = all(all_held)
   end function on_all_nodes

   !> Axes along which both nodes of a contact point are held.
   pure function on_both_nodes(points, held, k) result(both)
      type(all_contact_points_type), intent(in) :: points
      logical, intent(in) :: held(:)
      integer, intent(in) :: k
      logical :: both(2)

      both = held(2*points%slave(k) - 1:2*points%slave(k)) .and. &
         held(2*points%master(k) - 1:2*points%master(k))
   end function on_both_nodes

   !> Part of the relative normal displacement that supports prescribe.
   pure function held_approach(points, given) result(approach)
      type(all_contact_points_type), intent(in) :: points !! all contact points
      real(dp), intent(in) :: given(:)             !! (2 nodes) prescribed displacements [length]
      real(dp) :: approach(size(points%slave))     !! (m) [length]
      real(dp) :: relative(2, size(approach))
      integer :: axis, k

      approach = 0.0_dp
      relative = points%relative(given)
      do k = 1, size(approach)
         axis = points%held_axis(k)
         if (axis > 0) approach(k) = points%normal(axis, k)*relative(axis, k)
      end do
   end function held_approach

   !> Positions of the slave along the tangents, relative to the master. A contact point held along
   !> an axis slides only as its supports do: while it is open, the position counts that it would
   !> have if it closed with the supports where they are.
   pure function tangential_positions(points, displacement) result(position)
      type(all_contact_points_type), intent(in) :: points !! all contact points
      real(dp), intent(in) :: displacement(:)      !! (2 nodes) [length]
      real(dp) :: position(size(points%slave))     !! (m) [length]
      real(dp) :: relative(2, size(position))
      integer :: axis, k

      relative = points%relative(displacement)
      do k = 1, size(position)
         axis = points%held_axis(k)
         if (axis > 0) relative(3 - axis, k) = (points%initial_gap(k) - points%normal(axis, k)* &
            relative(axis, k))/points%normal(3 - axis, k)
         position(k) = dot_product(relative(:, k), points%tangent(:, k))
      end do
   end function tangential_positions

end module all_contact_points
