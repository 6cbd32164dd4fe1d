!> Cards of a step beside its loads: *FIXED POINT, *THERMAL SCHEME and *START; *NODE PRINT and
!> *EL PRINT, tables of the listing.
module deck_builder_controls
   use card_values, only: choice, needed_choice, take_parameter, read_row
   use cards, only: data_card_type, keyword_card_type
   use controls, only: continuation_type, crank_nicolson_scheme, explicit_scheme, &
      fixed_point_type, galerkin_scheme, implicit_scheme, l_stable_scheme, method_names, &
      start_both, start_closed, start_given, start_open, start_previous, start_type, &
      thermal_scheme_type
   use deck_context, only: deck_type
   use equations, only: tabled_nodes
   use kinds, only: dp
   use materials, only: melts
   use steps, only: step_controls_type
   use print_requests, only: print_request_type, time_points_type
   use spelling, only: known_choices
   use text, only: split_words, string_type, to_text, to_upper
   implicit none
   private
   public :: build_continuation, build_fixed_point, build_restart, build_thermal_scheme, &
      build_start, build_print, read_frequency

   real(dp), parameter :: consistent = 1.0e-9_dp   !! sums of coefficients count as equal, relative

   ! Keys of a card: those that are computed, and those that only CalculiX has.
   character(*), parameter :: node_keys = 'U/NT/TS/RF/RFL/SOLID', &
      element_keys = 'S/HFL/COORD/PEEQ/PE/CEEQ/CE'
   character(*), parameter :: foreign_node_keys = &
      '/PN/PS/PT/PSF/PTF/TSF/TTF/TT/V/VF/MF/MACH/CP/DEPF/TURB/'
   character(*), parameter :: foreign_element_keys = &
      '/SVF/E/ME/ENER/SDV/HFLF/ELSE/ELKE/EVOL/EMAS/EBHE/CENT/'

contains

   !> Reads one *FIXED POINT; what it does not say stays as it was.
   subroutine build_fixed_point(deck, fixed_point)
      type(deck_type), intent(inout) :: deck
      type(fixed_point_type), intent(inout) :: fixed_point    !! receives the controls
      character(:), allocatable :: method

      method = choice(deck%card, 'METHOD', 'PICARD/ZAITSEV/ANDERSON/NEWTON', deck, '')
      if (method /= '') fixed_point%method = findloc(method_names == method, .true., dim=1)
      call take_parameter(deck%card, 'TOL', deck, fixed_point%tolerance, '>0')
      call take_parameter(deck%card, 'MAXITER', deck, fixed_point%max_iterations, '>=1')
      call take_parameter(deck%card, 'G', deck, fixed_point%g, '>0 <=1')
      call take_parameter(deck%card, 'CONSTANT', deck, fixed_point%constant, '>=0')
   end subroutine build_fixed_point

   !> Reads what one *RESTART says of writing; where to go on from is read before the steps are.
   subroutine build_restart(deck, controls)
      type(deck_type), intent(inout) :: deck
      type(step_controls_type), intent(inout) :: controls     !! receives when they are written
      integer :: place

      place = 1
      if (deck%card%has('READ')) then
         call take_parameter(deck%card, 'STEP', deck, place, '>=1')
         call take_parameter(deck%card, 'INC', deck, place, '>=1')
         if (deck%card%has('INC') .and. .not. deck%card%has('STEP')) call deck%error( &
            deck%card%place_of('INC'), 'INC= needs STEP=')
      else
         call report_alone('STEP', 'READ')
         call report_alone('INC', 'READ')
      end if
      if (.not. deck%card%has('WRITE')) then
         call report_alone('FREQUENCY', 'WRITE')
         call report_alone('OVERLAY', 'WRITE')
         if (size(deck%card%parameters) == 0 .and. .not. deck%card%flawed) call deck%error( &
            deck%card%place, '*RESTART needs WRITE, to keep states of the run, or READ, to go '// &
            'on from one')
         return
      end if
      controls%restart_frequency = 1
      call take_parameter(deck%card, 'FREQUENCY', deck, controls%restart_frequency, '>=0')
      controls%overlays_restarts = deck%card%has('OVERLAY')
   contains
      subroutine report_alone(parameter, other)
         character(*), intent(in) :: parameter, other

         if (deck%card%has(parameter)) call deck%error(deck%card%place_of(parameter), parameter// &
            ' needs '//other)
      end subroutine report_alone
   end subroutine build_restart

   !> Reads one *THERMAL SCHEME; after an error the scheme stays as it was.
   subroutine build_thermal_scheme(deck, scheme)
      type(deck_type), intent(inout) :: deck
      type(thermal_scheme_type), intent(inout) :: scheme      !! receives the coefficients
      type(thermal_scheme_type), parameter :: schemes(*) = [implicit_scheme, galerkin_scheme, &
         crank_nicolson_scheme, explicit_scheme, l_stable_scheme]
      character(:), allocatable :: kind
      real(dp) :: given(8), sums(3)
      integer :: i
      logical :: valid

      kind = needed_choice(deck%card, 'TYPE', &
         'IMPLICIT/GALERKIN/CRANK-NICOLSON/EXPLICIT/L-STABLE/FREE', deck)
      i = findloc(schemes%name == kind, .true., dim=1)
      if (i > 0) scheme = schemes(i)
      if (i > 0 .and. size(deck%card%data) > 0) call deck%error(deck%card%data(1)%place(1), &
         'extra data card; *THERMAL SCHEME has one with TYPE=FREE only')
      if (kind /= 'FREE') return
      if (size(deck%card%data) == 0) then
         call deck%error(deck%card%place, '*THERMAL SCHEME, TYPE=FREE needs a data card')
         return
      end if
      ! Coefficients of eq. (3.4) as the card gives them; multiples of them are the same scheme.
      associate (data => deck%card%data(1))
         call read_row(data, 'a1 >0/a2 >=0/a3 >=0/b1/b2/b3/c1/c2', deck, given, valid)
         if (.not. valid) return
         sums = [given(1) + given(4), sum(given(7:8)), sum(given([2, 3, 5, 6]))]
         if (given(2) + given(3) <= 0.0_dp) then
            call deck%error(data%place(2), 'a2 + a3 must be positive')
         else if (sums(1) <= 0.0_dp) then
            call deck%error(data%place(4), 'a1 + b1 must be positive')
         else if (any(abs(sums - sums(1)) > consistent*sums(1))) then
            call deck%error(data%place(1), 'a steady state would not stay: a1 + b1 = '// &
               to_text(sums(1))//', c1 + c2 = '//to_text(sums(2))//', a2 + a3 + b2 + b3 = '// &
               to_text(sums(3))//' must be equal')
         else
            scheme = thermal_scheme_type(given(1:3)/sums(1), given(4:6)/sums(1), given(7:8)/sums(1))
         end if
      end associate
   end subroutine build_thermal_scheme

   !> Reads one *CONTINUATION.
   subroutine build_continuation(deck, continuation)
      type(deck_type), intent(inout) :: deck
      type(continuation_type), intent(out) :: continuation

      continuation%is_on = .true.
      call take_parameter(deck%card, 'POINTS', deck, continuation%most_points, '>=2')
      call take_parameter(deck%card, 'LOWEST', deck, continuation%range(1))
      call take_parameter(deck%card, 'HIGHEST', deck, continuation%range(2))
      call take_parameter(deck%card, 'ARC', deck, continuation%longest_step, '>0')
      continuation%rises = choice(deck%card, 'DIRECTION', 'UP/DOWN', deck, 'UP') == 'UP'
      if (continuation%range(1) < continuation%range(2)) return
      call deck%error(deck%card%place_of('HIGHEST'), 'LOWEST='//to_text(continuation%range(1))// &
         ' must be below HIGHEST='//to_text(continuation%range(2))//': the range of load factors')
   end subroutine build_continuation

   !> Reads one *START; after an error the start stays as it was.
   subroutine build_start(deck, start)
      type(deck_type), intent(inout) :: deck
      type(start_type), intent(inout) :: start           !! receives the start
      real(dp) :: given(size(deck%model%contacts)), value(2)
      character(:), allocatable :: from
      integer :: i, k
      logical :: sound, valid

      from = needed_choice(deck%card, 'FROM', 'PREVIOUS/OPEN/CLOSED/BOTH/GIVEN', deck)
      if (from /= 'GIVEN' .and. size(deck%card%data) > 0 .and. from /= '') call deck%error( &
         deck%card%data(1)%place(1), 'extra data card; *START has them with FROM=GIVEN only')
      if (from == 'PREVIOUS') start%kind = start_previous
      if (from == 'OPEN') start%kind = start_open
      if (from == 'CLOSED') start%kind = start_closed
      if (from == 'BOTH') start%kind = start_both
      if (from /= 'GIVEN') return
      given = 0.0_dp
      sound = .true.
      do k = 1, size(deck%card%data)
         call read_row(deck%card%data(k), '@contact pair/conductance >0', deck, value, valid)
         call deck%need_item(deck%card%data(k), 1, 'contact pair', 'contact pair', i)
         if (valid .and. i > 0) given(i) = value(2)
         sound = sound .and. valid .and. i > 0
      end do
      if (.not. sound) return
      i = findloc(given > 0.0_dp, .false., dim=1)
      if (i == 0) then
         start = start_type(kind=start_given, conductance=given)
      else
         call deck%error(deck%card%place, '*START, FROM=GIVEN gives no conductance to '// &
            deck%model%contacts(i)%name)
      end if
   end subroutine build_start

   !> Reads *NODE PRINT or *EL PRINT. The first one in a step ends the tables of former steps.
   subroutine build_print(is_later, deck, requests)
      logical, intent(inout) :: is_later   !! whether its step has one before; becomes true
      type(deck_type), intent(inout) :: deck
      type(print_request_type), allocatable, intent(inout) :: requests(:) !! receives the table
      type(print_request_type) :: request
      character(:), allocatable :: totals
      integer :: i, j
      logical :: is_known     ! whether the set is

      if (allocated(requests) .and. .not. is_later) deallocate(requests)
      is_later = .true.
      if (deck%card%name == 'NODE PRINT') then
         call take_set('NSET', 'node set', deck, request%set, is_known)
         if (request%set > 0) then
            associate (set => deck%mesh%node_sets(request%set))
               if (size(set%members) > 0 .and. all(deck%dropped(set%members))) then
                  call deck%warning(deck%card%place_of('NSET'), 'ORDER=1 leaves no node of '// &
                     set%name//', because none is a corner: nothing is printed')
                  is_known = .false.
               else if (lacks_rows(deck, set%members)) then
                  call deck%warning(deck%card%place_of('NSET'), 'nothing is printed for '// &
                     set%name//': its nodes have no element and are no reference nodes of '// &
                     'rigid bodies, couplings or pre-tension sections; *VERIFY tells values '// &
                     'of other nodes of equations and of generalized plane strain')
                  is_known = .false.
               end if
            end associate
         end if
         totals = choice(deck%card, 'TOTALS', 'YES/NO/ONLY', deck, 'NO')
         request%each_node = totals /= 'ONLY'
         request%totals = totals /= 'NO'
      else
         call take_set('ELSET', 'element set', deck, request%set, is_known)
         if (request%set > 0) then
            if (deck%mesh%element_sets(request%set)%of_lines) then
               call deck%warning(deck%card%place_of('ELSET'), 'element set '// &
                  deck%mesh%element_sets(request%set)%name//' has only lines, springs or '// &
                  'trusses: nothing is printed')
               is_known = .false.
            end if
         end if
      end if
      request%local_axes = choice(deck%card, 'GLOBAL', 'YES/NO', deck, 'NO') == 'NO'
      call read_frequency(deck, request%frequency, request%points)
      allocate(request%keys(0))
      do j = 1, size(deck%card%data)
         do i = 1, size(deck%card%data(j)%fields)
            if (deck%card%data(j)%has(i)) call take_quantity(deck%card, deck%card%data(j), i, &
               deck, request%keys)
         end do
      end do
      if (size(deck%card%data) == 0) call deck%note('*'//deck%card%name//' without data prints '// &
         'nothing')
      if (.not. is_known .or. size(request%keys) == 0) return
      if (.not. allocated(requests)) allocate (requests(0))
      requests = [requests, request]
   end subroutine build_print

   !> Whether there are nodes, and none that a table has a row for.
   pure logical function lacks_rows(deck, nodes)
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: nodes(:)
      logical :: tabled(size(deck%mesh%node_number))

      lacks_rows = .false.
      ! Where a card is wrong, no node is known to be without an element or a coupling.
      if (size(nodes) == 0 .or. deck%has_errors()) return
      tabled = tabled_nodes(deck%mesh, deck%model%bars%elongation, deck%model%couplings)
      lacks_rows = .not. any(tabled(nodes))
   end function lacks_rows

   !> Takes the set of a table. One that is not known is no error where the cards of sets have some.
   subroutine take_set(parameter, noun, deck, set, is_known)
      character(*), intent(in) :: parameter, noun
      type(deck_type), intent(inout) :: deck
      integer, intent(inout) :: set
      logical, intent(out) :: is_known

      if (.not. deck%has_lost('set') .or. deck%index_of(noun, deck%card%text(parameter)) > &
         0) call deck%take_named(parameter, noun, set)
      is_known = set > 0 .or. deck%card%lacks(parameter)
   end subroutine take_set

   !> One key: what is not computed, or what nobody knows, is ignored with a warning.
   subroutine take_quantity(card, data, position, deck, keys)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position
      type(deck_type), intent(inout) :: deck
      character(5), allocatable, intent(inout) :: keys(:)
      type(string_type), allocatable :: known(:)
      character(:), allocatable :: foreign, key
      integer :: i

      if (card%name == 'NODE PRINT') then
         known = split_words(node_keys)
         foreign = foreign_node_keys
      else
         known = split_words(element_keys)
         foreign = foreign_element_keys
      end if
      key = to_upper(data%text(position))
      if (any([(known(i)%value == key, i=1, size(known))])) then
         if (needed(key) /= '') then
            ! Its card may be one with an error.
            if (.not. deck%has_errors()) call deck%warning(data%place(position), key//' of *'// &
               card%name//' is not there without *'//needed(key)//': it is not printed')
         else
            if (key == 'TS') key = 'NT'
            if (all(keys /= key)) keys = [character(5) :: keys, key]
         end if
      else if (index(foreign, '/'//key//'/') > 0) then
         call deck%warning(data%place(position), key//' of *'//card%name//' is not '// &
            'computed: it is not printed')
      else
         call deck%warning(data%place(position), 'unknown quantity '//key//' of *'//card%name// &
            ' is not printed'//known_choices(key, known))
      end if
   contains
      !> The card without which no material has a quantity; empty where one has it.
      pure function needed(key)
         character(*), intent(in) :: key
         character(:), allocatable :: needed

         needed = ''
         associate (law => deck%model%materials%law)
            select case (key)
            case ('PEEQ', 'PE')
               if (.not. any(law%strains(1) > 0)) needed = 'PLASTIC'
            case ('CEEQ', 'CE')
               if (.not. any(law%strains(2) > 0)) needed = 'CREEP'
            case ('SOLID')
               if (.not. any(melts(deck%model%materials))) needed = 'LATENT HEAT'
            case default   ! of all materials
            end select
         end associate
      end function needed
   end subroutine take_quantity

   !> FREQUENCY=n, default 1.
   subroutine read_frequency(deck, frequency, points)
      type(deck_type), intent(inout) :: deck
      integer, intent(out) :: frequency                 !! n, at least 0
      type(time_points_type), intent(out) :: points     !! those that the card names
      integer :: i

      frequency = 1
      i = 0
      call deck%take_named('TIME POINTS', 'time points', i)
      if (i > 0) then
         points = deck%time_points(i)
         frequency = huge(frequency)   ! the last increment is written besides
      end if
      call take_parameter(deck%card, 'FREQUENCY', deck, frequency, '>=0')
   end subroutine read_frequency

end module deck_builder_controls
