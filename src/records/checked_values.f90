!> The values that *VERIFY cards are about, found in the record of an increment.
module checked_values
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, geometry_values
   use equations, only: section_nodes
   use field_quantities, only: point_values
   use increment_quantities, only: history_value, part_values
   use kinds, only: dp
   use materials, only: reference_nodes
   use mesh, only: mesh_type
   use model, only: model_type, verify_type
   use quantity_types, only: find_quantity, needs_stability, of_history, of_nodes, of_references, &
      of_sections, quantity_type
   use records, only: contact_record_type, increment_record_type
   use reported_quantities, only: verifiable
   use text, only: read_integer, read_real, to_upper
   implicit none
   private
   public :: is_estimable, is_of_motions, is_on_interface, is_recovered, values_asked_for, &
      worst_node, worst_of

   !> Quantities of nodes that are there without a recovery of stress and heat flux.
   character(*), parameter :: own_of_nodes(7) = [character(5) :: 'U1', 'U2', 'NT', 'SOLID', &
      'RF1', 'RF2', 'RFL']

contains

   !> Whether the quantity of a check has an error that a finer mesh shows.
   pure logical function is_estimable(check)
      type(verify_type), intent(in) :: check
      type(quantity_type) :: quantity

      quantity = verifiable(find_quantity(verifiable, check%quantity))
      is_estimable = .not. (quantity%is_integer .or. quantity%is_geometry .or. &
         any(quantity%unit == [character(4) :: '-', 'time', 'load']) .and. &
         all(quantity%kind /= [of_nodes, of_references]) .and. .not. quantity%is_estimated)
   end function is_estimable

   !> Whether the value of a check is of small motions, which a finer mesh does not have.
   pure logical function is_of_motions(check)
      type(verify_type), intent(in) :: check
      type(quantity_type) :: quantity

      quantity = verifiable(find_quantity(verifiable, check%quantity))
      is_of_motions = quantity%needs == needs_stability
   end function is_of_motions

   !> Whether the value of a check is recovered from those of elements.
   pure logical function is_recovered(check)
      type(verify_type), intent(in) :: check
      type(quantity_type) :: quantity

      quantity = verifiable(find_quantity(verifiable, check%quantity))
      is_recovered = quantity%kind == of_nodes .and. all(own_of_nodes /= quantity%name)
   end function is_recovered

   !> The value that is farthest from what a check expects; NaN where one is.
   pure real(dp) function worst_of(check, values) result(worst)
      type(verify_type), intent(in) :: check
      real(dp), intent(in) :: values(:)                    !! at least one

      worst = ieee_value(worst, ieee_quiet_nan)
      if (.not. any(ieee_is_nan(values))) worst = values(maxloc(abs(values - check%value), dim=1))
   end function worst_of

   !> Number in the deck of the node whose value is worst_of; 0 where a check is about no set of
   !> nodes.
   pure integer function worst_node(check, mesh, point_node, values)
      type(verify_type), intent(in) :: check
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: point_node(:)                 !! (points) node index of each point
      real(dp), intent(in) :: values(:)                    !! at least one, those asked for
      type(quantity_type) :: quantity
      integer, allocatable :: nodes(:)

      worst_node = 0
      if (size(values) < 2) return
      quantity = verifiable(find_quantity(verifiable, check%quantity))
      if (quantity%kind /= of_nodes) return
      nodes = pack(point_node, is_wanted(check%where, mesh, point_node))
      worst_node = mesh%node_number(nodes(maxloc(abs(values - check%value), dim=1)))
   end function worst_node

   !> The values that a check is about: one, or those of a set, of which the worst counts.
   !> [those of the quantity]
   subroutine values_asked_for(check, record, model, interfaces, point_node, values, reason)
      type(verify_type), intent(in) :: check
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: point_node(:)                 !! (points) node index of each point
      real(dp), allocatable, intent(out) :: values(:)
      character(:), allocatable, intent(out) :: reason     !! why there are none; else empty
      type(quantity_type) :: quantity
      character(:), allocatable :: name
      integer, allocatable :: nodes(:)
      integer :: at, i
      logical :: is_extreme

      reason = ''
      quantity = verifiable(find_quantity(verifiable, check%quantity))
      is_extreme = any(to_upper(check%where) == ['MIN', 'MAX'])
      select case (quantity%kind)
      case (of_history)
         values = [history_value(quantity%name, record)]
         return
      case (of_nodes)
         values = point_values(quantity%name, record%fields, point_node)
         if (size(values) == 0) then
            reason = 'this step has no '//check%quantity
         else if (.not. is_extreme) then
            call select_points(check%where, model%mesh, point_node, values, reason)
         else if (allocated(model%mesh%node_body)) then
            ! Nodes without elements, such as mesh generators leave, have nothing but zeros.
            values = pack(values, model%mesh%node_body(point_node) > 0)
         end if
      case (of_sections, of_references)
         values = part_values(quantity, record)
         if (size(values) == 0) reason = 'this step has no '//check%quantity
         if (size(values) > 0 .and. .not. is_extreme) then
            if (quantity%kind == of_sections) nodes = section_nodes(model%couplings)
            if (quantity%kind == of_references) nodes = reference_nodes(model%sections)
            call select_points(check%where, model%mesh, nodes, values, reason)
         end if
      case default
         allocate (values(0))
         at = index(check%where//'@', '@')
         name = check%where(:at - 1)
         do i = 1, size(interfaces)
            if (.not. is_extreme .and. to_upper(interfaces(i)%name) /= to_upper(name)) cycle
            values = [values, values_of(quantity, model%mesh, interfaces(i), record%contacts(i))]
            if (is_extreme) cycle
            if (at < len(check%where)) call select_position(interfaces(i), check%where(at + 1:), &
               quantity%is_integer, values, reason)
            return
         end do
         if (.not. is_extreme) reason = 'there is no contact pair "'//name//'"'
      end select
      if (.not. is_extreme .or. reason /= '') return
      values = pack(values, .not. ieee_is_nan(values))
      if (size(values) == 0) then
         values = [ieee_value(1.0_dp, ieee_quiet_nan)]
      else
         values = [merge(minval(values), maxval(values), to_upper(check%where) == 'MIN')]
      end if
   end subroutine values_asked_for

   !> Values of an interface; of positions in a list that is padded with NaN those that there are.
   function values_of(quantity, mesh, points, contact) result(values)
      type(quantity_type), intent(in) :: quantity
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points
      type(contact_record_type), intent(in) :: contact
      real(dp), allocatable :: values(:)

      if (quantity%is_geometry) then
         values = geometry_values(quantity%name, points, mesh%node_number)
      else
         values = contact_values(quantity%name, contact)
      end if
      if (quantity%values == 1) return
      values = pack(values, .not. ieee_is_nan(values))
      if (size(values) == 0) values = [ieee_value(1.0_dp, ieee_quiet_nan)]
   end function values_of

   !> Whether an arc length lies on a piece of an interface.
   pure logical function is_on_interface(s, points)
      real(dp), intent(in) :: s                        !! arc length [length]
      type(contact_points_type), intent(in) :: points  !! contact points of the interface
      ! The deck's digits and the sum of the sides may differ in the last places.
      real(dp), parameter :: rounding = 1.0e-9_dp
      real(dp), allocatable :: ends(:)

      ends = points%arc_length(points%ends())
      is_on_interface = any(s >= ends(1::2)*(1.0_dp - rounding) .and. &
         s <= ends(2::2)*(1.0_dp + rounding))
   end function is_on_interface

   !> The value at an arc length: between two contact points, or that of the nearest contact point
   !> (of two as near the first).
   subroutine select_position(points, position, nearest, values, reason)
      type(contact_points_type), intent(in) :: points
      character(*), intent(in) :: position
      logical, intent(in) :: nearest
      real(dp), allocatable, intent(inout) :: values(:)
      character(:), allocatable, intent(inout) :: reason
      real(dp) :: s, share
      integer :: k, last
      logical :: valid

      last = size(points%arc_length)
      call read_real(trim(adjustl(position)), s, valid)
      if (valid) valid = is_on_interface(s, points) .and. size(values) == last
      if (.not. valid) then
         reason = 'no such arc length, "'//position//'"'
         return
      end if
      if (nearest) then
         values = [values(minloc(abs(points%arc_length - s), dim=1))]
         return
      end if
      k = max(1, min(last - 1, count(points%arc_length <= s)))
      if (.not. points%on_one_piece(k, k + 1)) then
         ! At an end of a piece but for rounding.
         values = values(minloc(abs(points%arc_length - s)))
         return
      end if
      share = (s - points%arc_length(k))/(points%arc_length(k + 1) - points%arc_length(k))
      values = [(1.0_dp - share)*values(k) + share*values(k + 1)]
   end subroutine select_position

   subroutine select_points(where, mesh, point_node, values, reason)
      character(*), intent(in) :: where
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: point_node(:)
      real(dp), allocatable, intent(inout) :: values(:)
      character(:), allocatable, intent(inout) :: reason

      values = pack(values, is_wanted(where, mesh, point_node))
      if (size(values) == 0) reason = 'there is no node or node set "'//where//'"'
   end subroutine select_points

   !> Which points are the node or the nodes of the set that a check names.
   pure function is_wanted(where, mesh, point_node) result(wanted)
      character(*), intent(in) :: where
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: point_node(:)
      logical :: wanted(size(point_node)), of_node(size(mesh%node_number))
      integer :: number, i
      logical :: is_number

      of_node = .false.
      call read_integer(where, number, is_number)
      if (is_number) then
         of_node = mesh%node_number == number
      else
         do i = 1, size(mesh%node_sets)
            if (to_upper(mesh%node_sets(i)%name) /= to_upper(where)) cycle
            of_node(mesh%node_sets(i)%members) = .true.
         end do
      end if
      wanted = of_node(point_node)
   end function is_wanted

end module checked_values
