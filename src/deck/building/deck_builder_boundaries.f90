!> Data cards of *BOUNDARY -> requests.
module deck_builder_boundaries
   use card_values, only: check_extra, need_field, take_field
   use cards, only: data_card_type, field_place, field_text
   use deck_context, only: deck_context_type, read_target
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use load_requests, only: request_type
   use model, only: model_type
   use spelling, only: is_slip
   use steps, only: dof_temperature
   use text, only: read_real, to_text, to_upper
   implicit none
   private
   public :: build_boundary, dof_rotation

   integer, parameter :: dof_rotation = 6   !! about z, of the reference node of a coupling

   character(*), parameter :: out_of_plane = &
      '*BOUNDARY: 0 on degrees of freedom 3 to 6 is ignored'

   !> Supports that are known by a name.
   character(8), parameter :: support_names(5) = &
      [character(8) :: 'ENCASTRE', 'PINNED', 'XSYMM', 'YSYMM', 'ZSYMM']

contains

   !> Takes one data card: node or set, first and last degree of freedom, value; or node or set and
   !> the name of a support. 0 on the degrees 3 to 6, which a plane does not have, is ignored.
   subroutine build_boundary(data, request, model, context, report)
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request         !! step, amplitude, place
      type(model_type), intent(in) :: model                !! mesh and its sets
      type(deck_context_type), intent(inout) :: context    !! receives the requests
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: first, last, dof
      integer, allocatable :: held(:)
      logical :: valid

      request%card = 1
      if (context%boundaries%count > 0) request%card = &
         context%boundaries%items(context%boundaries%count)%card + 1
      valid = .true.
      request%value = 0.0_dp
      call read_target(data, 1, 'node', context%node_index, model%mesh%node_sets, report, &
         request%item, request%set, valid)
      held = held_degrees(to_upper(field_text(data, 2)))
      if (size(held) > 0) then
         call check_extra(data, 2, 'node or set, '//to_upper(field_text(data, 2)), report)
         if (valid) call hold(held, request, model, context)
         return
      end if
      call check_name(data, report, valid)
      if (.not. valid) return
      call read_degrees(data, report, first, last, request%value, valid)
      if (.not. valid) return
      do dof = first, last
         select case (dof)
         case (1, 2, dof_temperature)
            request%component = dof
            call context%boundaries%add(request)
         case (3:6)
            if (dof == dof_rotation .and. turns(request, model)) then
               call add_rotations(request, model, context)
               cycle
            end if
            if (abs(request%value) > 0.0_dp) then
               call report%error(field_place(data, 4), 'degree of freedom '//to_text(dof)// &
                  ' can only be 0 in the plane')
               return
            end if
            call context%note(out_of_plane)
            if (first >= 3 .and. dof == last) call report%warning(field_place(data, 2), &
               'degree of freedom '//to_text(first)//' does not exist in a plane model: '// &
               'this support is ignored')
         case default
            call report%error(field_place(data, merge(2, 3, dof == first)), &
               'degree of freedom '//to_text(dof)//'; the plane has 1, 2 and 11')
            return
         end select
      end do
   end subroutine build_boundary

   !> First and last degree of freedom, and the value.
   subroutine read_degrees(data, report, first, last, value, valid)
      type(data_card_type), intent(in) :: data
      type(deck_report_type), intent(inout) :: report
      integer, intent(out) :: first, last
      real(dp), intent(inout) :: value
      logical, intent(inout) :: valid

      first = 0
      call need_field(data, 2, 'first degree of freedom, such as 1, 2 or, of the temperature, 11', &
         report, first, valid)
      last = first
      if (.not. valid) return
      call take_field(data, 3, 'last degree of freedom'//value_advice(data), report, last, valid)
      call take_field(data, 4, 'value', report, value, valid)
      call check_extra(data, 4, 'node or set, first and last degree of freedom, value', report)
      if (last >= first .or. .not. valid) return
      call report%error(field_place(data, 3), 'the last degree of freedom is below the first')
      valid = .false.
   end subroutine read_degrees

   !> Shows where a value belongs that stands in the place of the last degree of freedom.
   pure function value_advice(data) result(advice)
      type(data_card_type), intent(in) :: data
      character(:), allocatable :: advice
      real(dp) :: value
      logical :: is_number

      advice = ''
      call read_real(field_text(data, 3), value, is_number)
      if (is_number .and. size(data%fields) == 3) advice = '; the value is the fourth field: '// &
         field_text(data, 1)//', '//field_text(data, 2)//', '//field_text(data, 2)//', '// &
         field_text(data, 3)
   end function value_advice

   !> Reports a likely misspelling of the name of a support.
   subroutine check_name(data, report, valid)
      type(data_card_type), intent(in) :: data
      type(deck_report_type), intent(inout) :: report
      logical, intent(inout) :: valid
      character(:), allocatable :: name
      integer :: i

      name = to_upper(field_text(data, 2))
      do i = 1, size(support_names)
         if (.not. is_slip(name, trim(support_names(i)))) cycle
         call report%error(field_place(data, 2), 'unknown support '//name// &
            '; the nearest known is '//trim(support_names(i)))
         valid = .false.
         return
      end do
   end subroutine check_name

   !> Degrees of freedom that a support known by a name holds at 0, rotations about x, y and z as 4
   !> to 6 among them; empty for another word.
   pure function held_degrees(name) result(degrees)
      character(*), intent(in) :: name      ! in upper case
      integer, allocatable :: degrees(:)

      select case (name)
      case ('ENCASTRE')
         degrees = [1, 2, 3, 4, 5, 6]
      case ('PINNED')
         degrees = [1, 2, 3]
      case ('XSYMM')
         degrees = [1, 5, 6]
      case ('YSYMM')
         degrees = [2, 4, 6]
      case ('ZSYMM')
         degrees = [3, 4, 5]
      case default
         allocate (degrees(0))
      end select
   end function held_degrees

   !> Requests those of some degrees of freedom at 0 that the plane has.
   subroutine hold(degrees, request, model, context)
      integer, intent(in) :: degrees(:)
      type(request_type), intent(inout) :: request
      type(model_type), intent(in) :: model
      type(deck_context_type), intent(inout) :: context
      integer :: i

      do i = 1, size(degrees)
         if (degrees(i) == dof_rotation .and. turns(request, model)) then
            call add_rotations(request, model, context)
         else if (degrees(i) > 2) then
            call context%note(out_of_plane)
         else
            request%component = degrees(i)
            call context%boundaries%add(request)
         end if
      end do
   end subroutine hold

   !> Whether the reference node of a coupling is among the nodes of a request.
   pure logical function turns(request, model)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model

      turns = any(is_target(model%couplings%reference, request, model))
   end function turns

   elemental logical function is_target(node, request, model)
      integer, intent(in) :: node
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model

      is_target = node > 0 .and. node == request%item
      if (request%set > 0) is_target = any(model%mesh%node_sets(request%set)%members == node)
   end function is_target

   !> Requests the rotations of reference nodes.
   subroutine add_rotations(request, model, context)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      type(deck_context_type), intent(inout) :: context
      type(request_type) :: rotation
      integer :: i

      rotation = request
      rotation%set = 0
      rotation%component = 1
      do i = 1, size(model%couplings)
         if (.not. is_target(model%couplings(i)%reference, request, model)) cycle
         rotation%item = model%couplings(i)%rotation
         call context%boundaries%add(rotation)
      end do
   end subroutine add_rotations

end module deck_builder_boundaries
