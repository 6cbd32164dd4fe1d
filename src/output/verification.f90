!> Judges the *VERIFY cards of a deck on the increments as they come.
module verification
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, estimated, geometry_values
   use due_output, only: is_judged
   use equations, only: section_nodes
   use field_quantities, only: maxima, point_values
   use increment_quantities, only: history_value
   use kinds, only: dp
   use mesh, only: mesh_type
   use model, only: model_type, verify_type
   use no_estimates, only: first_reason, mark_of, no_reason, reason_count, reason_inside_step, &
      reason_of_run
   use quantity_types, only: find_quantity, of_history, of_nodes, of_sections, quantity_type
   use records, only: contact_record_type, increment_record_type, interface_errors_type
   use reported_quantities, only: verifiable
   use state_tables, only: reals, state_table_type, words
   use text, only: few_digits, percent, read_integer, read_real, to_text, to_upper
   implicit none
   private
   public :: verifier_type, outcome_type, failure_words, bound_words, is_on_interface

   !> Outcome of one check.
   type :: outcome_type
      logical :: judged = .false.               !! whether its time was reached
      logical :: passed = .false.               !! the verdict
      real(dp) :: time = 0.0_dp                 !! total time at which it was judged [time]
      real(dp) :: found = 0.0_dp                !! value found, the worst of a set
      real(dp) :: deviation = 0.0_dp            !! magnitude of its deviation, relative for REL
      real(dp), allocatable :: bound            !! of the error of the value; unallocated for none
      integer :: no_estimate = no_reason        !! why a value of this kind has none
      character(:), allocatable :: reason       !! why there is no value; else empty
   end type outcome_type

   !> All checks of a deck, in its order.
   type :: verifier_type
      type(outcome_type), allocatable :: outcomes(:)   !! one for each of model%verifications
   contains
      procedure :: start
      procedure :: judge
      procedure :: exchange
      procedure :: counts
   end type verifier_type

contains

   !> Prepares the outcomes: a check that is never reached fails.
   subroutine start(self, model)
      class(verifier_type), intent(inout) :: self   !! the checks
      type(model_type), intent(in) :: model
      integer :: i

      allocate(self%outcomes(size(model%verifications)))
      do i = 1, size(self%outcomes)
         self%outcomes(i)%reason = 'the run ended before this time'
      end do
   end subroutine start

   !> Judges the checks that name the time of an increment.
   subroutine judge(self, record, model, interfaces, point_node)
      class(verifier_type), intent(inout) :: self         !! the checks
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: point_node(:)                !! (points) node index of each point
      real(dp), allocatable :: values(:)
      character(:), allocatable :: reason
      integer :: i

      do i = 1, size(self%outcomes)
         if (.not. is_judged(model%verifications(i), record, model)) cycle
         call values_asked_for(model%verifications(i), record, model, interfaces, point_node, &
            values, reason)
         self%outcomes(i) = outcome_of(model%verifications(i), values, reason)
         self%outcomes(i)%time = record%time
         if (len(self%outcomes(i)%reason) > 0) cycle
         call take_bound(model, i, record, interfaces, self%outcomes(i))
      end do
   end subroutine judge

   !> The outcomes so far, in either direction; none where the table is of another deck's checks.
   subroutine exchange(self, table)
      class(verifier_type), intent(inout) :: self   !! started
      type(state_table_type), intent(inout) :: table
      character(:), allocatable :: reasons
      real(dp), allocatable :: values(:)
      real(dp) :: rows(7, size(self%outcomes))
      integer :: first, i

      reasons = ''
      do i = 1, size(self%outcomes)
         associate (outcome => self%outcomes(i))
            rows(:, i) = [outcome%time, outcome%found, outcome%deviation, merge(1.0_dp, 0.0_dp, &
               [outcome%judged, outcome%passed, allocated(outcome%bound)]), &
               real(outcome%no_estimate, dp)]
            if (allocated(outcome%bound)) rows(7, i) = outcome%bound
            if (outcome%judged) reasons = reasons//outcome%reason//new_line('a')
         end associate
      end do
      values = [rows]
      call reals(table, 'checks', values)
      call words(table, 'check_reasons', reasons)
      if (size(values) /= size(rows) .or. .not. table%is_restoring()) return
      rows = reshape(values, shape(rows))
      first = 1
      do i = 1, size(self%outcomes)
         associate (outcome => self%outcomes(i))
            outcome%judged = rows(4, i) > 0.0_dp
            if (.not. outcome%judged) cycle
            outcome%time = rows(1, i)
            outcome%found = rows(2, i)
            outcome%deviation = rows(3, i)
            outcome%passed = rows(5, i) > 0.0_dp
            if (rows(6, i) > 0.0_dp) outcome%bound = rows(7, i)
            if (rows(6, i) <= 0.0_dp) outcome%no_estimate = nint(rows(7, i))
            outcome%reason = reasons(first:first - 2 + index(reasons(first:), new_line('a')))
            first = first + len(outcome%reason) + 1
         end associate
      end do
   end subroutine exchange

   !> Takes the bound of what a check is about, or why it has none: of a quantity of an interface,
   !> of the largest pressure of the only one, of stress or temperature at a node, or of the largest
   !> von Mises stress or temperature, where that is the maximum of a body.
   subroutine take_bound(model, c, record, interfaces, outcome)
      type(model_type), intent(in) :: model
      integer, intent(in) :: c                              ! the check
      type(increment_record_type), intent(in) :: record
      type(contact_points_type), intent(in) :: interfaces(:)
      type(outcome_type), intent(inout) :: outcome
      character(:), allocatable :: quantity, where
      integer :: bodies, i, number, q, why
      logical :: holds(reason_count), is_node

      quantity = to_upper(model%verifications(c)%quantity)
      where = to_upper(model%verifications(c)%where)
      call read_integer(where, number, is_node)
      why = reason_of_run(model)
      if (.not. allocated(record%errors)) why = reason_inside_step(model)
      q = 0
      if (quantity == 'NT') q = find_quantity(maxima, 'temperature')
      if (quantity == 'MISES' .or. is_node .and. any(quantity == ['S11', 'S22', 'S33', 'S12'])) then
         q = find_quantity(maxima, 'von_mises')
      end if
      if (q > 0 .and. (is_node .or. where == 'MAX')) then
         outcome%no_estimate = why
         holds = .false.
         bodies = 0
         if (why == no_reason .and. allocated(record%body_errors)) bodies = size(record%body_errors)
         do i = 1, bodies
            associate (errors => record%body_errors(i))
               if (is_node) then
                  if (errors%no_estimate(q) /= no_reason) holds(errors%no_estimate(q)) = .true.
               else if (.not. ieee_is_nan(errors%value(q))) then
                  if (errors%value(q) >= outcome%found) call take(errors, q)
               end if
            end associate
         end do
         if (any(holds)) outcome%no_estimate = first_reason(holds)
         if (is_node .and. allocated(record%check_bounds)) then
            if (.not. ieee_is_nan(record%check_bounds(c))) outcome%bound = record%check_bounds(c)
         end if
      end if
      q = find_quantity(estimated, quantity)
      if (quantity == 'PRESSURE' .and. where == 'MAX' .and. size(interfaces) == 1) q = &
         find_quantity(estimated, 'peak_pressure')
      do i = 1, merge(size(interfaces), 0, q > 0)
         if (to_upper(interfaces(i)%name) /= where .and. size(interfaces) > 1) cycle
         outcome%no_estimate = why
         if (why == no_reason) call take(record%errors(i), q)
      end do
   contains
      subroutine take(errors, q)
         class(interface_errors_type), intent(in) :: errors
         integer, intent(in) :: q

         outcome%no_estimate = errors%no_estimate(q)
         if (outcome%no_estimate == no_reason) outcome%bound = errors%bound(q)
      end subroutine take
   end subroutine take_bound

   !> Numbers of the checks that passed, that failed, and that could not be judged, because the run
   !> ended before their times.
   pure function counts(self)
      class(verifier_type), intent(in) :: self
      integer :: counts(3)

      associate (outcomes => self%outcomes)
         counts = [count(outcomes%passed), count(outcomes%judged .and. .not. outcomes%passed), &
            count(.not. outcomes%judged)]
      end associate
   end function counts

   !> The message on a check that failed, such as `deck.inp:36: check failed: heat_rate JOINT at
   !> time 1: 3.6, expected 3.7 (off by 2.7027 %, allowed 1 %)`.
   pure function failure_words(check, outcome) result(words)
      type(verify_type), intent(in) :: check
      type(outcome_type), intent(in) :: outcome
      character(:), allocatable :: words

      words = check%address//': check failed: '//trim(check%quantity//' '//check%where)// &
         ' at time '//to_text(outcome%time)//': '
      if (len(outcome%reason) > 0) then
         words = words//'expected '//to_text(check%value)//', but '//outcome%reason
      else if (check%relative .and. abs(check%value) > 0.0_dp) then
         words = words//to_text(outcome%found)//bound_words(outcome)//', expected '// &
            to_text(check%value)//' (off by '//percent(outcome%deviation, digits=6)// &
            ', allowed '//percent(check%tolerance, digits=6)//')'
      else
         words = words//to_text(outcome%found)//bound_words(outcome)//', expected '// &
            to_text(check%value)//' (off by '//to_text(outcome%deviation)//', allowed '// &
            to_text(merge(0.0_dp, check%tolerance, check%relative))//')'
      end if
   end function failure_words

   !> How far the value may be from the exact one, or why that is not known; nothing for values
   !> that are never bounded.
   pure function bound_words(outcome) result(words)
      type(outcome_type), intent(in) :: outcome
      character(:), allocatable :: words            !! with a blank before them

      words = ''
      if (outcome%no_estimate /= no_reason) words = mark_of(outcome%no_estimate)
      if (allocated(outcome%bound)) words = ' +- '//few_digits(outcome%bound)
   end function bound_words

   pure function outcome_of(check, values, reason) result(outcome)
      type(verify_type), intent(in) :: check
      real(dp), intent(in) :: values(:)
      character(*), intent(in) :: reason
      type(outcome_type) :: outcome

      outcome%judged = .true.
      outcome%reason = reason
      if (reason /= '') return
      if (any(ieee_is_nan(values))) then
         outcome%reason = 'there is no value (NaN)'
         return
      end if
      outcome%found = values(maxloc(abs(values - check%value), dim=1))
      outcome%deviation = abs(outcome%found - check%value)
      outcome%passed = outcome%deviation <= check%tolerance
      if (.not. check%relative) return
      outcome%passed = outcome%deviation <= check%tolerance*abs(check%value)
      if (abs(check%value) > 0.0_dp) outcome%deviation = outcome%deviation/abs(check%value)
   end function outcome_of

   !> The values that a check is about: one, or those of a set, of which the worst counts.
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
      case (of_sections)
         allocate (values(0))
         if (allocated(record%pre_tension)) values = record%pre_tension
         if (size(values) == 0) reason = 'this step has no '//check%quantity
         if (size(values) > 0 .and. .not. is_extreme) call select_points(check%where, model%mesh, &
            section_nodes(model%couplings), values, reason)
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
      logical, allocatable :: wanted(:)
      integer :: number, i
      logical :: is_number

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
      if (size(values) == 0) reason = 'there is no node or node set "'//where//'"'
   end subroutine select_points

end module verification
