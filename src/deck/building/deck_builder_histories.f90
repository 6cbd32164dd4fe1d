!> *AMPLITUDE and *INITIAL CONDITIONS: what loads and temperatures start from and follow. An initial
!> stress is one for an element: Abaqus gives it to elements or sets, CalculiX to the integration
!> points of its solid elements, into which it turns plane ones.
module deck_builder_histories
   use amplitudes, only: amplitude_type
   use card_values, only: choice, chosen, need_parameter, take_parameter, decimal_comma, &
      read_field, read_row, report_decimal_comma
   use cards, only: data_card_type
   use deck_context, only: deck_type
   use deck_structure, only: cards_of
   use element_kinds, only: kind_count, plane_stress
   use kinds, only: dp
   use load_requests, only: request_type, target_type
   use text, only: read_integer, to_text
   implicit none
   private
   public :: build_amplitudes, build_time_points, build_temperatures, build_initial_stresses

   !> TYPE= of *INITIAL CONDITIONS; of these the last three mean nothing.
   character(*), parameter :: initial_kinds = 'TEMPERATURE/STRESS/FIELD/SOLUTION/VELOCITY'

   !> Points of CalculiX's solid element, by the kind of the plane one.
   integer, parameter :: solid_points(kind_count) = [27, 8, 8, 9, 2, 1]

   !> Stresses of points of one element agree within what printed digits leave.
   real(dp), parameter :: printed = 1.0e-6_dp

   integer, parameter :: most_fields = 5   !! of a card that gives no integration point

   character(*), parameter :: layout = 'element, integration point, s11, s22, s33, s12, s13, s23'

contains

   !> Builds all amplitudes.
   subroutine build_amplitudes(deck)
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: kind, none
      integer, allocatable :: places(:)
      real(dp) :: begin, interval
      integer :: errors, i, n

      places = cards_of(deck%cards, 'AMPLITUDE')
      allocate(deck%model%amplitudes(size(places)))
      do n = 1, size(places)
         call deck%open_card(places(n))
         call deck%take_name('amplitude', deck%model%amplitudes(n)%name)
         associate (amplitude => deck%model%amplitudes(n))
            amplitude%total_time = choice(deck%card, 'TIME', 'STEP TIME/TOTAL TIME', deck, &
               'STEP TIME') == 'TOTAL TIME'
            none = choice(deck%card, 'VALUE', 'RELATIVE', deck, 'RELATIVE')
            errors = deck%error_count()
            kind = choice(deck%card, 'DEFINITION', 'TABULAR/SMOOTH STEP/EQUALLY SPACED', deck, &
               'TABULAR')
            amplitude%smooth = kind == 'SMOOTH STEP'
            if (deck%error_count() > errors) then
               allocate(amplitude%times(1), amplitude%values(1), source=0.0_dp)
            else if (kind == 'EQUALLY SPACED') then
               begin = 0.0_dp
               interval = 1.0_dp
               call take_parameter(deck%card, 'BEGIN', deck, begin)
               call need_parameter(deck%card, 'FIXED INTERVAL', deck, none)
               call take_parameter(deck%card, 'FIXED INTERVAL', deck, interval, '>0')
               amplitude%values = values_of('value', deck)
               amplitude%times = [(begin + i*interval, i=0, size(amplitude%values) - 1)]
            else
               if (deck%card%has('FIXED INTERVAL')) call deck%error(deck%card%place_of('FIXED '// &
                  'INTERVAL'), 'FIXED INTERVAL= needs DEFINITION=EQUALLY SPACED')
               if (deck%card%has('BEGIN')) call deck%error(deck%card%place_of('BEGIN'), &
                  'BEGIN= needs DEFINITION=EQUALLY SPACED')
               call read_points(deck, amplitude)
            end if
         end associate
      end do
   end subroutine build_amplitudes

   !> Builds all *TIME POINTS: times, any number of them a card, or start, end and interval.
   subroutine build_time_points(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: places(:)
      integer :: i, j, n
      logical :: valid
      real(dp) :: values(3)

      places = cards_of(deck%cards, 'TIME POINTS')
      allocate (deck%time_points(size(places)))
      do n = 1, size(places)
         call deck%open_card(places(n))
         call deck%take_name('time points', deck%time_points(n)%name)
         associate (points => deck%time_points(n))
            points%total_time = choice(deck%card, 'TIME', 'STEP TIME/TOTAL TIME', deck, 'STEP '// &
               'TIME') == 'TOTAL TIME'
            if (.not. deck%card%has('GENERATE')) then
               points%times = values_of('time', deck)
            else
               allocate (points%times(0))
               do j = 1, size(deck%card%data)
                  call read_row(deck%card%data(j), 'start/end/interval >0 =1', deck, values, valid)
                  if (valid .and. values(2) < values(1)) call deck%error( &
                     deck%card%data(j)%place(2), 'the end is before the start')
                  points%times = [points%times, (values(1) + i*values(3), i=0, floor((values(2) - &
                     values(1))/values(3) + 1.0e-6_dp))]
               end do
            end if
            if (any(points%times(2:) <= points%times(:size(points%times) - 1))) call deck%error( &
               deck%card%place, 'time points must ascend')
         end associate
      end do
   end subroutine build_time_points

   !> All fields of a card as numbers, without those that cannot be read.
   function values_of(what, deck) result(values)
      character(*), intent(in) :: what
      type(deck_type), intent(inout) :: deck
      real(dp), allocatable :: values(:)
      real(dp) :: value
      integer :: i, j
      logical :: valid

      allocate (values(0))
      do j = 1, size(deck%card%data)
         do i = 1, size(deck%card%data(j)%fields)
            valid = .true.
            call read_field(deck%card%data(j), i, what, deck, value, valid)
            if (valid) values = [values, value]
         end do
      end do
   end function values_of

   !> Pairs of time and value, any number of them a card.
   subroutine read_points(deck, amplitude)
      type(deck_type), intent(inout) :: deck
      type(amplitude_type), intent(inout) :: amplitude
      integer :: errors, j, i, n
      logical :: valid

      n = sum([((size(deck%card%data(j)%fields) + 1)/2, j=1, size(deck%card%data))])
      allocate(amplitude%times(n), amplitude%values(n), source=0.0_dp)
      n = 0
      do j = 1, size(deck%card%data)
         errors = deck%error_count()
         do i = 1, size(deck%card%data(j)%fields), 2
            n = n + 1
            valid = .true.
            call read_field(deck%card%data(j), i, 'time', deck, amplitude%times(n), valid)
            call read_field(deck%card%data(j), i + 1, 'value', deck, amplitude%values(n), valid)
            if (n < 2 .or. .not. valid) cycle
            if (amplitude%times(n) <= amplitude%times(n - 1)) call deck%error( &
               deck%card%data(j)%place(i), 'times must ascend')
         end do
         i = decimal_comma(deck%card%data(j))
         if (deck%error_count() == errors .or. i == 0) cycle
         call report_decimal_comma(deck%card%data(j), i, deck)
         return
      end do
   end subroutine read_points

   !> Reads all initial temperatures.
   subroutine build_temperatures(deck)
      type(deck_type), intent(inout) :: deck
      type(request_type) :: request
      character(:), allocatable :: kind
      integer, allocatable :: places(:)
      integer :: k, j
      logical :: valid
      real(dp) :: given(2)

      places = cards_of(deck%cards, 'INITIAL CONDITIONS')
      do k = 1, size(places)
         call deck%open_card(places(k))
         if (deck%card%lacks('TYPE')) call deck%error(deck%card%place, '*INITIAL CONDITIONS '// &
            'needs TYPE=TEMPERATURE or TYPE=STRESS')
         kind = choice(deck%card, 'TYPE', initial_kinds, deck, '')
         if (any(kind == [character(8) :: 'FIELD', 'SOLUTION', 'VELOCITY'])) call deck%note( &
            '*INITIAL CONDITIONS, TYPE='//kind//' is ignored: nothing depends on it')
         if (kind /= 'TEMPERATURE') cycle
         do j = 1, size(deck%card%data)
            request%place = deck%card%data(j)%place(1)
            call read_row(deck%card%data(j), '@node or set/temperature', deck, given, valid)
            call deck%need_target('node', deck%card%data(j), 1, request%target_type, valid)
            request%value = given(2)
            if (valid) call deck%temperatures%add(request)
         end do
      end do
   end subroutine build_temperatures

   !> Reads all initial stresses; later cards replace earlier ones.
   subroutine build_initial_stresses(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: points(:)
      integer :: j, k

      do k = 1, size(deck%cards%keywords)
         call deck%open_card(k)
         if (deck%card%name /= 'INITIAL CONDITIONS') cycle
         if (chosen(deck%card, 'TYPE', initial_kinds) /= 'STRESS' .or. deck%card%flawed) cycle
         if (.not. allocated(deck%mesh%initial_stress)) allocate (deck%mesh%initial_stress(4, &
            size(deck%mesh%element_number)), source=0.0_dp)
         points = spread(0, 1, size(deck%mesh%element_number))
         do j = 1, size(deck%card%data)
            if (size(deck%card%data(j)%fields) > most_fields) then
               call take_point(deck%card%data(j), deck, points)
            else
               call take_elements(deck%card%data(j), deck)
            end if
         end do
         do j = 1, size(points)
            if (points(j) <= 0 .or. points(j) == solid_points(deck%mesh%element_kind(j))) cycle
            call deck%error(deck%card%place, 'element '//to_text(deck%mesh%element_number(j))// &
               ' has a stress at '//to_text(points(j))//' of the '//to_text(solid_points( &
               deck%mesh%element_kind(j)))//' integration points that it has in CalculiX, and '// &
               'none at the others; an element has one stress here')
            exit
         end do
      end do
   end subroutine build_initial_stresses

   !> Element or set, s11, s22, s33, s12; in plane stress Abaqus leaves s33 out.
   subroutine take_elements(data, deck)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      type(target_type) :: target
      integer, allocatable :: members(:)
      real(dp) :: given(5), stress(4)
      integer :: i, number
      logical :: is_flat, valid

      call read_row(data, '@element or set/s11/s22?/s33?/s12?', deck, given, valid)
      call deck%need_target('element', data, 1, target, valid)
      stress = given(2:)
      if (.not. valid) return
      members = target%members(deck%mesh%element_sets)
      if (target%item > 0) then
         call read_integer(data%fields(2)%text, number, valid)
         if (valid .and. number > 0 .and. number <= solid_points(deck%mesh%element_kind( &
            target%item))) then
            call deck%error(data%place(2), 'integration point or stress? Give '//layout//', or '// &
               'a stress with a decimal point')
            return
         end if
      end if
      is_flat = .true.
      do i = 1, size(members)
         is_flat = is_flat .and. deck%mesh%element_plane(members(i)) == plane_stress
      end do
      if (is_flat .and. size(data%fields) == 4) stress = [stress(:2), 0.0_dp, stress(3)]
      if (any(deck%mesh%element_plane(members) == plane_stress) .and. abs(stress(3)) > 0.0_dp) then
         call deck%error(data%place(4), 's33 is 0 in plane stress; the card is element or set, '// &
            's11, s22, s12, or with s33=0 before s12')
         return
      end if
      deck%mesh%initial_stress(:, members) = spread(stress, 2, size(members))
   end subroutine take_elements

   !> One integration point of an element as CalculiX has it; all of its points have one stress.
   subroutine take_point(data, deck, points)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      !> (elements) points that were given, -1 where one of them is wrong
      integer, intent(inout) :: points(:)
      type(target_type) :: target
      real(dp) :: given(8), stress(6)
      integer :: next, point
      logical :: valid

      next = 1
      call read_row(data, '@element/#integration point/s11/s22?/s33?/s12?/s13?/s23?', deck, given, &
         valid)
      call deck%need_target('element', data, 1, target, valid)
      point = nint(given(2))
      stress = given(3:)
      associate (item => target%item)
         if (item > 0) then
            if (points(item) < 0) return
            next = points(item) + 1
            points(item) = -1
         end if
         if (.not. valid) return
         if (target%set > 0) then
            call deck%error(data%place(1), 'an element set has no integration points; the card '// &
               'is set, s11, s22, s33, s12, or '//layout)
         else if (any(abs(stress(5:)) > 0.0_dp)) then
            call deck%error(data%place(7), 's13 and s23 are 0 in a plane')
         else if (deck%mesh%element_plane(item) == plane_stress .and. abs(stress(3)) > 0.0_dp) then
            call deck%error(data%place(5), 's33 is 0 in plane stress')
         else if (point /= next .or. point > solid_points(deck%mesh%element_kind(item))) then
            call deck%error(data%place(2), 'the integration points of an element follow each '// &
               'other from 1 to '//to_text(solid_points(deck%mesh%element_kind(item)))//', as '// &
               'in CalculiX')
         else if (point > 1 .and. maxval(abs(stress(:4) - deck%mesh%initial_stress(:, item))) > &
            printed*maxval(abs(stress))) then
            call deck%error(data%place(2), 'the stress differs from that at point 1 of element '// &
               to_text(deck%mesh%element_number(item))//'; an element has one stress here')
         else
            if (point == 1) deck%mesh%initial_stress(:, item) = stress(:4)
            points(item) = point
         end if
      end associate
   end subroutine take_point

end module deck_builder_histories
