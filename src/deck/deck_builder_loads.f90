!> *BOUNDARY, *CLOAD and *DLOAD -> requests, applied when the mesh is final.
module deck_builder_loads
   use card_parameters, only: choose, has_parameter, parameter_place, parameter_text
   use card_values, only: check_extra, field_place, has_field, need_field, take_field
   use cards, only: cards_type, data_card_type, keyword_card_type
   use deck_builder_courses, only: find_amplitude
   use deck_builder_surfaces, only: read_face
   use deck_context, only: deck_context_type, read_target
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use load_requests, only: request_type
   use model, only: model_type
   use steps, only: dof_temperature
   use text, only: nearest_known, string_type, to_text, to_upper
   implicit none
   private
   public :: build_load_card

contains

   !> Takes one *BOUNDARY, *CLOAD or *DLOAD.
   subroutine build_load_card(cards, card, step, model, context, report)
      type(cards_type), intent(in) :: cards                !! the cards
      type(keyword_card_type), intent(in) :: card          !! the keyword card
      integer, intent(in) :: step                          !! index of the step, 0 before the first
      type(model_type), intent(in) :: model                !! mesh, sets and amplitudes
      type(deck_context_type), intent(inout) :: context    !! receives the requests
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(request_type) :: request
      character(:), allocatable :: operation
      integer :: j, errors

      errors = report%error_count()
      request%step = step
      operation = 'MOD'
      call choose(card, 'OP', 'MOD', 'NEW', report, operation)
      call read_amplitude(card, model, report, request%amplitude)
      do j = card%first_data, card%last_data
         request%place = field_place(cards%data(j), 1)
         select case (card%name)
         case ('BOUNDARY')
            call build_boundary(cards%data(j), request, model, context, report)
         case ('CLOAD')
            call build_force(cards%data(j), request, model, context, report)
         case ('DLOAD')
            call build_pressure(cards, j, request, model, context, report)
         case default
            return
         end select
      end do
      if (card%name == 'BOUNDARY' .and. report%error_count() > errors) then
         context%boundaries_sound = .false.
      end if
   end subroutine build_load_card

   subroutine read_amplitude(card, model, report, amplitude)
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer, intent(inout) :: amplitude
      type(string_type), allocatable :: names(:)
      character(:), allocatable :: name
      integer :: i

      if (.not. has_parameter(card, 'AMPLITUDE')) return
      name = to_upper(parameter_text(card, 'AMPLITUDE'))
      amplitude = find_amplitude(model%amplitudes, name)
      if (amplitude > 0) return
      allocate(names(size(model%amplitudes)))
      do i = 1, size(names)
         names(i)%value = model%amplitudes(i)%name
      end do
      call report%error(parameter_place(card, 'AMPLITUDE'), 'unknown amplitude '//name// &
         nearest_known(name, names))
   end subroutine read_amplitude

   !> Node or set, first and last degree of freedom, value; 0 on the degrees 3 to 6, which a plane
   !> has not, is passed over.
   subroutine build_boundary(data, request, model, context, report)
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request
      type(model_type), intent(in) :: model
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      integer :: first, last, dof
      logical :: valid

      request%card = request_card(context)
      valid = .true.
      request%value = 0.0_dp
      call read_target(data, 1, 'node', context%node_index, model%mesh%node_sets, report, &
         request%item, request%set, valid)
      first = 0
      call need_field(data, 2, 'first degree of freedom', report, first, valid)
      last = first
      call take_field(data, 3, 'last degree of freedom', report, last, valid)
      call take_field(data, 4, 'value', report, request%value, valid)
      call check_extra(data, 4, 'node or set, first and last degree of freedom, value', report)
      if (.not. valid) return
      if (last < first) then
         call report%error(field_place(data, 3), 'the last degree of freedom is below the first')
         return
      end if
      do dof = first, last
         select case (dof)
         case (1, 2, dof_temperature)
            request%component = dof
            call context%boundaries%add(request)
         case (3:6)
            if (abs(request%value) > 0.0_dp) then
               call report%error(field_place(data, 4), 'degree of freedom '//to_text(dof)// &
                  ' can only be 0 in the plane')
               return
            end if
            call context%note('*BOUNDARY: 0 on degrees of freedom 3 to 6 is read and not needed')
         case default
            call report%error(field_place(data, merge(2, 3, dof == first)), &
               'degree of freedom '//to_text(dof)//'; the plane has 1, 2 and 11')
            return
         end select
      end do
   end subroutine build_boundary

   !> Number of the next data card of *BOUNDARY.
   pure integer function request_card(context)
      type(deck_context_type), intent(in) :: context

      request_card = 1
      if (context%boundaries%count > 0) then
         request_card = context%boundaries%items(context%boundaries%count)%card + 1
      end if
   end function request_card

   subroutine build_force(data, request, model, context, report)
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request
      type(model_type), intent(in) :: model
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      logical :: valid

      valid = .true.
      call read_target(data, 1, 'node', context%node_index, model%mesh%node_sets, report, &
         request%item, request%set, valid)
      call need_field(data, 2, 'degree of freedom', report, request%component, valid)
      call need_field(data, 3, 'force', report, request%value, valid)
      call check_extra(data, 3, 'node or set, degree of freedom, force', report)
      if (.not. valid) return
      if (any(request%component == [1, 2])) then
         call context%forces%add(request)
      else
         call report%error(field_place(data, 2), 'a force acts on degree of freedom 1 or 2')
      end if
   end subroutine build_force

   subroutine build_pressure(cards, j, request, model, context, report)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: j
      type(request_type), intent(inout) :: request
      type(model_type), intent(in) :: model
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: label
      logical :: valid

      valid = .true.
      associate (data => cards%data(j))
         call read_target(data, 1, 'element', context%element_index, model%mesh%element_sets, &
            report, request%item, request%set, valid)
         label = ''
         if (has_field(data, 2)) label = to_upper(data%fields(2)%text)
         if (any(label == [character(7) :: 'BX', 'BY', 'GRAV', 'CENTRIF'])) then
            call report%error(field_place(data, 2), 'the load '//label//' is not built yet')
            return
         end if
         call read_face(cards, j, 'P', report, request%component, valid)
         call need_field(data, 3, 'pressure', report, request%value, valid)
         call check_extra(data, 3, 'element or set, face, pressure', report)
         if (valid) call context%pressures%add(request)
      end associate
   end subroutine build_pressure

end module deck_builder_loads
