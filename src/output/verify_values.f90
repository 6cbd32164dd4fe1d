!> Finds in a record what a *VERIFY card asks for.
module verify_values
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, geometry_values
   use field_quantities, only: point_values
   use increment_quantities, only: history_value
   use kinds, only: dp
   use mesh, only: mesh_type
   use model, only: verify_type
   use quantity_types, only: find_quantity, of_history, of_nodes, quantity_type
   use records, only: contact_record_type, increment_record_type
   use reported_quantities, only: verifiable
   use text, only: read_integer, read_real, to_upper
   implicit none
   private
   public :: values_asked_for, is_on_interface

contains

   !> The values that a check is about: one, or those of a set, of which the worst counts.
   subroutine values_asked_for(check, record, mesh, interfaces, point_node, values, reason)
      type(verify_type), intent(in) :: check
      type(increment_record_type), intent(in) :: record
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: point_node(:)                 !! (points) node index of each point
      real(dp), allocatable, intent(out) :: values(:)      !! unallocated where there are none
      character(:), allocatable, intent(out) :: reason     !! why there are none; else empty
      type(quantity_type) :: quantity

      reason = ''
      quantity = verifiable(find_quantity(verifiable, check%quantity))
      select case (quantity%kind)
      case (of_history)
         values = [history_value(quantity%name, record)]
      case (of_nodes)
         values = point_values(quantity%name, record%fields, point_node)
         if (size(values) == 0) then
            deallocate (values)
            reason = 'this step has no '//check%quantity
         else
            call select_points(check%where, mesh, point_node, values, reason)
         end if
      case default
         call contact_values_at(quantity, check%where, record, mesh, interfaces, values, reason)
      end select
   end subroutine values_asked_for

   subroutine contact_values_at(quantity, where, record, mesh, interfaces, values, reason)
      type(quantity_type), intent(in) :: quantity
      character(*), intent(in) :: where
      type(increment_record_type), intent(in) :: record
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: interfaces(:)
      real(dp), allocatable, intent(out) :: values(:)
      character(:), allocatable, intent(inout) :: reason
      integer :: i, at

      if (to_upper(where) == 'MIN' .or. to_upper(where) == 'MAX') then
         allocate(values(0))
         do i = 1, size(interfaces)
            values = [values, values_of(quantity, mesh, interfaces(i), record%contacts(i))]
         end do
         values = [extreme(values, to_upper(where))]
         return
      end if
      at = index(where, '@')
      if (at == 0) at = len(where) + 1
      do i = 1, size(interfaces)
         if (to_upper(interfaces(i)%name) /= to_upper(trim(where(:at - 1)))) cycle
         values = values_of(quantity, mesh, interfaces(i), record%contacts(i))
         if (at < len(where)) call take_position(interfaces(i), where(at + 1:), &
            quantity%is_integer, values, reason)
         return
      end do
      reason = 'there is no contact pair "'//where(:at - 1)//'"'
   end subroutine contact_values_at

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
         values = contact_values(quantity%name, points, contact)
      end if
      if (quantity%values == 1) return
      values = pack(values, .not. ieee_is_nan(values))
      if (size(values) == 0) values = [ieee_value(1.0_dp, ieee_quiet_nan)]
   end function values_of

   !> Whether an arc length lies on an interface.
   pure logical function is_on_interface(s, points)
      real(dp), intent(in) :: s                        !! arc length [length]
      type(contact_points_type), intent(in) :: points  !! contact points of the interface
      ! The deck's digits and the sum of the sides may differ in the last places.
      real(dp), parameter :: rounding = 1.0e-9_dp

      is_on_interface = s >= 0.0_dp .and. &
         s <= points%arc_length(size(points%arc_length))*(1.0_dp + rounding)
   end function is_on_interface

   !> The value at an arc length: between two contact points, or that of the nearest contact point
   !> (of two as near the first).
   subroutine take_position(points, position, nearest, values, reason)
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
         deallocate(values)
         reason = 'no such arc length, "'//position//'"'
         return
      end if
      if (nearest) then
         values = [values(minloc(abs(points%arc_length - s), dim=1))]
         return
      end if
      k = max(1, min(last - 1, count(points%arc_length <= s)))
      share = (s - points%arc_length(k))/(points%arc_length(k + 1) - points%arc_length(k))
      values = [(1.0_dp - share)*values(k) + share*values(k + 1)]
   end subroutine take_position

   subroutine select_points(where, mesh, point_node, values, reason)
      character(*), intent(in) :: where
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: point_node(:)
      real(dp), allocatable, intent(inout) :: values(:)
      character(:), allocatable, intent(inout) :: reason
      logical, allocatable :: wanted(:)
      integer :: number, i
      logical :: is_number

      if (to_upper(where) == 'MIN' .or. to_upper(where) == 'MAX') then
         ! Nodes that no element has, such as mesh generators leave, have nothing but zeros.
         if (allocated(mesh%node_body)) values = pack(values, mesh%node_body(point_node) > 0)
         values = [extreme(values, to_upper(where))]
         return
      end if
      allocate(wanted(size(mesh%node_number)), source=.false.)
      call read_integer(where, number, is_number)
      if (is_number) then
         wanted = mesh%node_number == number
      else
         do i = 1, size(mesh%node_sets)
            if (to_upper(mesh%node_sets(i)%name) /= to_upper(where)) cycle
            wanted(mesh%node_sets(i)%members) = .true.
         end do
      end if
      values = pack(values, wanted(point_node))
      if (size(values) > 0) return
      deallocate(values)
      reason = 'there is no node or node set "'//where//'"'
   end subroutine select_points

   function extreme(values, which) result(value)
      real(dp), intent(in) :: values(:)
      character(*), intent(in) :: which
      real(dp) :: value
      real(dp), allocatable :: numbers(:)

      numbers = pack(values, .not. ieee_is_nan(values))
      if (size(numbers) == 0) then
         value = ieee_value(value, ieee_quiet_nan)
      else if (which == 'MIN') then
         value = minval(numbers)
      else
         value = maxval(numbers)
      end if
   end function extreme

end module verify_values
