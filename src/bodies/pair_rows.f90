!> The pairs of all interfaces in one row, as the solution works on them.
module pair_rows
   use conductance_laws, only: conductance_law_type
   use contact_pairs, only: contact_pairs_type, make_pairs
   use errors, only: error_type
   use kinds, only: dp
   use model, only: model_type
   implicit none
   private
   public :: pair_row_type, pair_surfaces, row_of
   public :: find_held_axes, over_constrained, held_approach, tangential_position

   !> Component of a normal along the only free axis that is rounding: the normal motion of such a
   !> pair is prescribed.
   real(dp), parameter :: least_slant = 1.0e-9_dp

   !> The pairs of all interfaces in one row.
   type :: pair_row_type
      integer, allocatable :: interface_start(:)              !! (interfaces + 1) first pair of each
      integer, allocatable :: slave(:), master(:)             !! (m) node indexes
      real(dp), allocatable :: weight(:)                      !! (m) tributary areas [length^2]
      real(dp), allocatable :: initial_gap(:)                 !! (m) h [length]
      real(dp), allocatable :: friction(:)                    !! (m) mu [-]
      real(dp), allocatable :: normal(:, :), tangent(:, :)    !! (2, m) unit vectors
      type(conductance_law_type), allocatable :: law(:)       !! (m) conductance laws
      !> (m) the axis, 1 or 2, along which supports hold both nodes, while they leave one of them
      !> free along the other axis; else 0
      integer, allocatable :: held_axis(:)
   end type pair_row_type

contains

   !> Pairs the surfaces of one *CONTACT PAIR, with the thickness of the slave's first element.
   !> Error: as make_pairs.
   subroutine pair_surfaces(model, i, pairs, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                            !! index into model%contacts
      type(contact_pairs_type), intent(out) :: pairs
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: thickness

      thickness = 1.0_dp
      associate (faces => model%mesh%surfaces(model%contacts(i)%slave)%faces)
         if (size(faces, 2) > 0) then
            thickness = model%sections(model%mesh%element_section(faces(1, 1)))%thickness
         end if
      end associate
      call make_pairs(model%mesh, model%contacts(i), thickness, pairs, error)
   end subroutine pair_surfaces

   !> Puts the pairs of all interfaces in one row.
   pure function row_of(interfaces, model) result(row)
      type(contact_pairs_type), intent(in) :: interfaces(:) !! in the order of the deck
      type(model_type), intent(in) :: model
      type(pair_row_type) :: row                            !! all their pairs
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
   end function row_of

   !> Finds the pairs that supports hold along one axis on both nodes. Their contact condition
   !> stays, along their own normal; the only relative motion that is free is the one along the
   !> other axis.
   pure subroutine find_held_axes(pairs, held)
      type(pair_row_type), intent(inout) :: pairs           !! all pairs
      logical, intent(in) :: held(:)                        !! (2 nodes) prescribed displacements
      logical :: both(2)
      integer :: k

      do k = 1, size(pairs%slave)
         both = on_both_nodes(pairs, held, k)
         pairs%held_axis(k) = merge(merge(1, 2, both(1)), 0, both(1) .neqv. both(2))
      end do
   end subroutine find_held_axes

   !> Pairs whose normal motion is prescribed: both nodes are held along both axes, or along the one
   !> that is their normal.
   pure function over_constrained(pairs, held) result(too_much)
      type(pair_row_type), intent(in) :: pairs
      logical, intent(in) :: held(:)               !! (2 nodes) prescribed displacements
      logical :: too_much(size(pairs%slave))       !! (m)
      logical :: both(2)
      integer :: k

      do k = 1, size(pairs%slave)
         both = on_both_nodes(pairs, held, k)
         too_much(k) = any(both) .and. (all(both) .or. &
            abs(pairs%normal(merge(2, 1, both(1)), k)) <= least_slant)
      end do
   end function over_constrained

   !> Axes along which both nodes of a pair are held.
   pure function on_both_nodes(pairs, held, k) result(both)
      type(pair_row_type), intent(in) :: pairs
      logical, intent(in) :: held(:)
      integer, intent(in) :: k
      logical :: both(2)

      both = held(2*pairs%slave(k) - 1:2*pairs%slave(k)) .and. &
         held(2*pairs%master(k) - 1:2*pairs%master(k))
   end function on_both_nodes

   !> Part of the relative normal displacement that supports prescribe.
   pure function held_approach(pairs, given) result(approach)
      type(pair_row_type), intent(in) :: pairs     !! all pairs
      real(dp), intent(in) :: given(:)             !! (2 nodes) prescribed displacements [length]
      real(dp) :: approach(size(pairs%slave))      !! (m) [length]
      integer :: axis, k

      approach = 0.0_dp
      do k = 1, size(approach)
         axis = pairs%held_axis(k)
         if (axis > 0) approach(k) = pairs%normal(axis, k)* &
            (given(2*pairs%slave(k) - 2 + axis) - given(2*pairs%master(k) - 2 + axis))
      end do
   end function held_approach

   !> Position of a slave node along the tangent, relative to its master. A pair held along an axis
   !> slides only as its supports do: while it is open, the position counts that it would have if
   !> it closed with the supports where they are.
   pure function tangential_position(pairs, k, displacement) result(position)
      type(pair_row_type), intent(in) :: pairs     !! all pairs
      integer, intent(in) :: k                     !! one of them
      real(dp), intent(in) :: displacement(:)      !! (2 nodes) [length]
      real(dp) :: position                         !! [length]
      real(dp) :: relative(2)
      integer :: axis

      relative = displacement(2*pairs%slave(k) - 1:2*pairs%slave(k)) - &
         displacement(2*pairs%master(k) - 1:2*pairs%master(k))
      axis = pairs%held_axis(k)
      if (axis > 0) relative(3 - axis) = (pairs%initial_gap(k) - pairs%normal(axis, k)* &
         relative(axis))/pairs%normal(3 - axis, k)
      position = dot_product(relative, pairs%tangent(:, k))
   end function tangential_position

end module pair_rows
