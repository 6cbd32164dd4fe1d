!> The contact points of all interfaces in one row, as the solution works on them.
module all_contact_points
   use conductance_laws, only: conductance_law_type
   use contact_pairs, only: contact_points_type, make_contact_points
   use errors, only: error_type
   use kinds, only: dp
   use model, only: model_type
   implicit none
   private
   public :: all_contact_points_type, match_surfaces, joined_points
   public :: find_held_axes, over_constrained, held_approach, tangential_position

   !> Component of a normal along the only free axis that is rounding: the normal motion of such a
   !> contact point is prescribed.
   real(dp), parameter :: least_slant = 1.0e-9_dp

   !> The contact points of all interfaces in one row.
   type :: all_contact_points_type
      integer, allocatable :: interface_start(:)     !! (interfaces + 1) first contact point of each
      integer, allocatable :: slave(:), master(:)             !! (m) node indexes
      real(dp), allocatable :: weight(:)                      !! (m) tributary areas [length^2]
      real(dp), allocatable :: initial_gap(:)                 !! (m) h [length]
      real(dp), allocatable :: friction(:)                    !! (m) mu [-]
      real(dp), allocatable :: normal(:, :), tangent(:, :)    !! (2, m) unit vectors
      type(conductance_law_type), allocatable :: law(:)       !! (m) conductance laws
      !> (m) the axis, 1 or 2, along which supports hold both nodes, while they leave one of them
      !> free along the other axis; else 0
      integer, allocatable :: held_axis(:)
   end type all_contact_points_type

contains

   !> Matches the surfaces of one *CONTACT PAIR, with the thickness of the slave's first element.
   !> Error: as make_contact_points.
   subroutine match_surfaces(model, i, points, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                            !! index into model%contacts
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: thickness

      thickness = 1.0_dp
      associate (faces => model%mesh%surfaces(model%contacts(i)%slave)%faces)
         if (size(faces, 2) > 0) then
            thickness = model%sections(model%mesh%element_section(faces(1, 1)))%thickness
         end if
      end associate
      call make_contact_points(model%mesh, model%contacts(i), thickness, points, error)
   end subroutine match_surfaces

   !> Puts the contact points of all interfaces in one row.
   pure function joined_points(interfaces, model) result(row)
      type(contact_points_type), intent(in) :: interfaces(:) !! in the order of the deck
      type(model_type), intent(in) :: model
      type(all_contact_points_type) :: row                  !! all their contact points
      integer :: i, first, last, m

      allocate (row%interface_start(size(interfaces) + 1))
      row%interface_start(1) = 1
      do i = 1, size(interfaces)
         row%interface_start(i + 1) = row%interface_start(i) + size(interfaces(i)%slave_node)
      end do
      m = row%interface_start(size(interfaces) + 1) - 1
      allocate (row%slave(m), row%master(m), row%weight(m), row%initial_gap(m), row%friction(m), &
         row%normal(2, m), row%tangent(2, m), row%law(m))
      allocate (row%held_axis(m), source=0)
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
      end do
   end function joined_points

   !> Finds the contact points that supports hold along one axis on both nodes. Their contact
   !> condition stays, along their own normal; the only relative motion that is free is the one
   !> along the other axis.
   pure subroutine find_held_axes(points, held)
      type(all_contact_points_type), intent(inout) :: points !! all contact points
      logical, intent(in) :: held(:)                        !! (2 nodes) prescribed displacements
      logical :: both(2)
      integer :: k

      do k = 1, size(points%slave)
         both = on_both_nodes(points, held, k)
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
         both = on_both_nodes(points, held, k)
         too_much(k) = any(both) .and. (all(both) .or. &
            abs(points%normal(merge(2, 1, both(1)), k)) <= least_slant)
      end do
   end function over_constrained

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
      integer :: axis, k

      approach = 0.0_dp
      do k = 1, size(approach)
         axis = points%held_axis(k)
         if (axis > 0) approach(k) = points%normal(axis, k)* &
            (given(2*points%slave(k) - 2 + axis) - given(2*points%master(k) - 2 + axis))
      end do
   end function held_approach

   !> Position of a slave node along the tangent, relative to its master. A contact point held along
   !> an axis slides only as its supports do: while it is open, the position counts that it would
   !> have if it closed with the supports where they are.
   pure function tangential_position(points, k, displacement) result(position)
      type(all_contact_points_type), intent(in) :: points !! all contact points
      integer, intent(in) :: k                     !! one of them
      real(dp), intent(in) :: displacement(:)      !! (2 nodes) [length]
      real(dp) :: position                         !! [length]
      real(dp) :: relative(2)
      integer :: axis

      relative = displacement(2*points%slave(k) - 1:2*points%slave(k)) - &
         displacement(2*points%master(k) - 1:2*points%master(k))
      axis = points%held_axis(k)
      if (axis > 0) relative(3 - axis) = (points%initial_gap(k) - points%normal(axis, k)* &
         relative(axis))/points%normal(3 - axis, k)
      position = dot_product(relative, points%tangent(:, k))
   end function tangential_position

end module all_contact_points
