!> Finds in a record what a *VERIFY card asks for.
module verify_values
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_pairs, only: contact_pairs_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use model, only: verify_type
   use record_values, only: contact_values, history_names, history_value, name_length, &
      not_a_number, point_values
   use records, only: contact_record_type, increment_record_type
   use text, only: read_integer, read_real, to_upper
   implicit none
   private
   public :: values_asked_for, is_on_interface

   !> Datasets of `/contact/<name>` that can be checked.
   character(name_length), parameter :: contact_names(22) = [character(name_length) :: &
      'gap', 'pressure', 'shear', 'slip', 'status', 'conductance', 'heat_flux', &
      'slave_temperature', 'master_temperature', 'normal_force', 'shear_force', 'heat_rate', &
      'edge_contact', 'edge_stick', 'edges_contact', 'edges_stick', 'x', 'y', 's', 'weight', &
      'slave_node', 'master_node']

   !> Those of them that are numbers of a pair and have no values between two.
   character(name_length), parameter :: numbers_of_pairs(3) = [character(name_length) :: &
      'status', 'slave_node', 'master_node']

contains

   !> The values that a check is about: one, or those of a set, of which the worst counts.
   subroutine values_asked_for(check, record, mesh, pairs, point_node, values, reason)
      type(verify_type), intent(in) :: check               !! the check
      type(increment_record_type), intent(in) :: record    !! the increment
      type(mesh_type), intent(in) :: mesh                  !! the mesh
      type(contact_pairs_type), intent(in) :: pairs(:)     !! pairs of every interface
      integer, intent(in) :: point_node(:)                 !! (points) node index of each point
      real(dp), allocatable, intent(out) :: values(:)      !! unallocated where there are none
      character(:), allocatable, intent(out) :: reason     !! why there are none; else empty
      character(:), allocatable :: name

      reason = ''
      name = known_name(check%quantity, contact_names)
      if (name /= '') then
         call contact_values_at(name, check%where, record, mesh, pairs, values, reason)
         return
      end if
      name = known_name(check%quantity, history_names)
      if (name /= '') then
         values = [history_value(name, record)]
         return
      end if
      values = point_values(to_upper(check%quantity), record%fields, point_node)
      if (size(values) == 0) then
         deallocate(values)
         reason = 'this step has no '//check%quantity
      else
         call select_points(check%where, mesh, point_node, values, reason)
      end if
   end subroutine values_asked_for

   pure function known_name(quantity, names) result(name)
      character(*), intent(in) :: quantity
      character(*), intent(in) :: names(:)
      character(:), allocatable :: name
      integer :: i

      name = ''
      do i = 1, size(names)
         if (to_upper(names(i)) == to_upper(quantity)) name = trim(names(i))
      end do
   end function known_name

   subroutine contact_values_at(name, where, record, mesh, pairs, values, reason)
      character(*), intent(in) :: name
      character(*), intent(in) :: where
      type(increment_record_type), intent(in) :: record
      type(mesh_type), intent(in) :: mesh
      type(contact_pairs_type), intent(in) :: pairs(:)
      real(dp), allocatable, intent(out) :: values(:)
      character(:), allocatable, intent(inout) :: reason
      integer :: i, at

      if (to_upper(where) == 'MIN' .or. to_upper(where) == 'MAX') then
         allocate(values(0))
         do i = 1, size(pairs)
            values = [values, values_of(name, mesh, pairs(i), record%contacts(i))]
         end do
         values = [extreme(values, to_upper(where))]
         return
      end if
      at = index(where, '@')
      if (at == 0) at = len(where) + 1
      do i = 1, size(pairs)
         if (to_upper(pairs(i)%name) /= to_upper(trim(where(:at - 1)))) cycle
         values = values_of(name, mesh, pairs(i), record%contacts(i))
         if (at < len(where)) call take_place(pairs(i), where(at + 1:), &
            any(name == numbers_of_pairs), values, reason)
         return
      end do
      reason = 'there is no contact pair "'//where(:at - 1)//'"'
   end subroutine contact_values_at

   function values_of(name, mesh, pairs, contact) result(values)
      character(*), intent(in) :: name
      type(mesh_type), intent(in) :: mesh
      type(contact_pairs_type), intent(in) :: pairs
      type(contact_record_type), intent(in) :: contact
      real(dp), allocatable :: values(:)

      select case (name)
      case ('slave_node')
         values = real(mesh%node_number(pairs%slave_node), dp)
      case ('master_node')
         values = real(mesh%node_number(pairs%master_node), dp)
      case ('edges_contact', 'edges_stick')
         values = contact_values(name, pairs, contact)
         values = pack(values, .not. ieee_is_nan(values))
         if (size(values) == 0) values = [not_a_number()]
      case default
         values = contact_values(name, pairs, contact)
      end select
   end function values_of

   !> Whether an arc length lies on an interface.
   pure logical function is_on_interface(s, pairs)
      real(dp), intent(in) :: s                        !! arc length [length]
      type(contact_pairs_type), intent(in) :: pairs    !! pairs of the interface
      ! The deck's digits and the sum of the sides may differ in the last places.
      real(dp), parameter :: rounding = 1.0e-9_dp

      is_on_interface = s >= 0.0_dp .and. &
         s <= pairs%arc_length(size(pairs%arc_length))*(1.0_dp + rounding)
   end function is_on_interface

   !> The value at an arc length: between two pairs, or that of the nearest pair (of two as near the
   !> first).
   subroutine take_place(pairs, place, nearest, values, reason)
      type(contact_pairs_type), intent(in) :: pairs
      character(*), intent(in) :: place
      logical, intent(in) :: nearest
      real(dp), allocatable, intent(inout) :: values(:)
      character(:), allocatable, intent(inout) :: reason
      real(dp) :: s, share
      integer :: k, last
      logical :: valid

      last = size(pairs%arc_length)
      call read_real(trim(adjustl(place)), s, valid)
      if (valid) valid = is_on_interface(s, pairs) .and. size(values) == last
      if (.not. valid) then
         deallocate(values)
         reason = 'no such arc length, "'//place//'"'
         return
      end if
      if (nearest) then
         values = [values(minloc(abs(pairs%arc_length - s), dim=1))]
         return
      end if
      k = max(1, min(last - 1, count(pairs%arc_length <= s)))
      share = (s - pairs%arc_length(k))/(pairs%arc_length(k + 1) - pairs%arc_length(k))
      values = [(1.0_dp - share)*values(k) + share*values(k + 1)]
   end subroutine take_place

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
         value = not_a_number()
      else if (which == 'MIN') then
         value = minval(numbers)
      else
         value = maxval(numbers)
      end if
   end function extreme

end module verify_values
