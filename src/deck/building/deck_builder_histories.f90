!> *AMPLITUDE and *INITIAL CONDITIONS: what loads and temperatures start from and follow.
module deck_builder_histories
   use amplitudes, only: amplitude_type
   use card_parameters, only: choose, has_parameter, lacks_parameter, parameter_place, &
      parameter_text, take_parameter, take_positive
   use card_values, only: check_extra, need_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use decimal_commas, only: decimal_comma, report_decimal_comma
   use deck_context, only: deck_context_type, name_last, read_target
   use deck_report, only: deck_report_type
   use deck_structure, only: cards_of
   use kinds, only: dp
   use load_requests, only: request_type
   use model, only: model_type
   use text, only: read_real, to_upper
   implicit none
   private
   public :: build_amplitudes, build_temperatures

contains

   !> Builds all amplitudes.
   subroutine build_amplitudes(cards, model, report)
      type(cards_type), intent(in) :: cards
      type(model_type), intent(inout) :: model             !! receives the amplitudes
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer, allocatable :: places(:)
      integer :: n
      logical :: repeated

      places = cards_of(cards, 'AMPLITUDE')
      allocate(model%amplitudes(size(places)))
      do n = 1, size(places)
         call name_last(cards, places(n), 'amplitude', model%amplitudes(:n), report, repeated)
         if (repeated) call report%lose('amplitude')
         call build_amplitude(cards, cards%keywords(places(n)), report, model%amplitudes(n))
      end do
   end subroutine build_amplitudes

   !> Parameters of the card, then its points.
   subroutine build_amplitude(cards, card, report, amplitude)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_report_type), intent(inout) :: report
      type(amplitude_type), intent(inout) :: amplitude
      character(:), allocatable :: kind

      kind = 'STEP TIME'
      call choose(card, 'TIME', 'STEP TIME/TOTAL TIME', report, kind)
      amplitude%total_time = kind == 'TOTAL TIME'
      kind = 'RELATIVE'
      call choose(card, 'VALUE', 'RELATIVE', report, kind)
      kind = to_upper(parameter_text(card, 'DEFINITION'))
      select case (kind)
      case ('PERIODIC', 'MODULATED', 'DECAY', 'SOLUTION DEPENDENT', 'ACTUATOR', 'SPECTRUM', &
         'USER', 'BUBBLE')
         call report%error(parameter_place(card, 'DEFINITION'), 'DEFINITION='//kind// &
            ' is refused; give times and values')
         kind = ''
      case default
         kind = 'TABULAR'
         call choose(card, 'DEFINITION', 'TABULAR/SMOOTH STEP/EQUALLY SPACED', report, kind)
      end select
      amplitude%smooth = kind == 'SMOOTH STEP'
      if (len(kind) == 0) then
         allocate(amplitude%times(1), amplitude%values(1), source=0.0_dp)
      else if (kind == 'EQUALLY SPACED') then
         call read_values(cards, card, report, amplitude)
      else
         if (has_parameter(card, 'FIXED INTERVAL')) call report%error(parameter_place(card, &
            'FIXED INTERVAL'), 'FIXED INTERVAL= needs DEFINITION=EQUALLY SPACED')
         if (has_parameter(card, 'BEGIN')) call report%error(parameter_place(card, 'BEGIN'), &
            'BEGIN= needs DEFINITION=EQUALLY SPACED')
         call read_points(cards, card, report, amplitude)
      end if
   end subroutine build_amplitude

   !> Values at equal intervals, any number of them a card.
   subroutine read_values(cards, card, report, amplitude)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_report_type), intent(inout) :: report
      type(amplitude_type), intent(inout) :: amplitude
      real(dp) :: begin, interval
      integer :: j, i, n
      logical :: valid

      begin = 0.0_dp
      interval = 1.0_dp
      call take_parameter(card, 'BEGIN', report, begin)
      call take_positive(card, 'FIXED INTERVAL', report, interval)
      if (lacks_parameter(card, 'FIXED INTERVAL')) call report%error(card%place, &
         'DEFINITION=EQUALLY SPACED needs FIXED INTERVAL=')
      n = sum([(size(cards%data(j)%fields), j=card%first_data, card%last_data)])
      allocate(amplitude%times(n), amplitude%values(n), source=0.0_dp)
      n = 0
      do j = card%first_data, card%last_data
         do i = 1, size(cards%data(j)%fields)
            n = n + 1
            amplitude%times(n) = begin + (n - 1)*interval
            valid = .true.
            call need_field(cards%data(j), i, 'value', report, amplitude%values(n), valid)
         end do
      end do
   end subroutine read_values

   !> Pairs of time and value, any number of them a card.
   subroutine read_points(cards, card, report, amplitude)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(deck_report_type), intent(inout) :: report
      type(amplitude_type), intent(inout) :: amplitude
      integer :: j, i, n
      logical :: valid

      n = 0
      do j = card%first_data, card%last_data
         n = n + (size(cards%data(j)%fields) + 1)/2
      end do
      allocate(amplitude%times(n), amplitude%values(n), source=0.0_dp)
      n = 0
      do j = card%first_data, card%last_data
         i = decimal_comma(cards%data(j))
         if (i > 0 .and. .not. is_history(cards%data(j), amplitude%times(:n))) then
            call report_decimal_comma(cards%data(j), i, report)
            return
         end if
         do i = 1, size(cards%data(j)%fields), 2
            n = n + 1
            valid = .true.
            call need_field(cards%data(j), i, 'time', report, amplitude%times(n), valid)
            call need_field(cards%data(j), i + 1, 'value', report, amplitude%values(n), valid)
            if (n < 2 .or. .not. valid) cycle
            if (amplitude%times(n) <= amplitude%times(n - 1)) then
               call report%error(field_place(cards%data(j), i), 'times must ascend')
            end if
         end do
      end do
   end subroutine read_points

   !> Whether a data card has pairs of time and value, and times that ascend behind those before.
   pure logical function is_history(data, before)
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: before(:)
      real(dp) :: last, time
      integer :: i

      last = -huge(last)
      if (size(before) > 0) last = before(size(before))
      is_history = mod(size(data%fields), 2) == 0
      do i = 1, size(data%fields), 2
         if (.not. is_history) return
         call read_real(data%fields(i)%text, time, is_history)
         is_history = is_history .and. time > last
         last = time
      end do
   end function is_history

   !> Reads all initial temperatures.
   subroutine build_temperatures(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives the requests
      type(model_type), intent(in) :: model                !! mesh and its sets
      type(deck_report_type), intent(inout) :: report      !! receives errors
      type(request_type) :: request
      character(:), allocatable :: kind
      integer, allocatable :: places(:)
      integer :: k, j
      logical :: valid

      places = cards_of(cards, 'INITIAL CONDITIONS')
      do k = 1, size(places)
         associate (card => cards%keywords(places(k)))
            kind = ''
            if (lacks_parameter(card, 'TYPE')) then
               call report%error(card%place, '*INITIAL CONDITIONS needs TYPE=TEMPERATURE '// &
                  'or TYPE=STRESS')
            end if
            call choose(card, 'TYPE', 'TEMPERATURE/STRESS', report, kind)
            if (kind /= 'TEMPERATURE') cycle
            do j = card%first_data, card%last_data
               valid = .true.
               request%place = field_place(cards%data(j), 1)
               call read_target(cards%data(j), 1, 'node', context%node_index, &
                  model%mesh%node_sets, report, request%item, request%set, valid)
               call need_field(cards%data(j), 2, 'temperature', report, request%value, valid)
               call check_extra(cards%data(j), 2, 'node or set, temperature', report)
               if (valid) call context%temperatures%add(request)
            end do
         end associate
      end do
   end subroutine build_temperatures

end module deck_builder_histories
