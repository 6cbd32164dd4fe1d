!> Tables of the listing: *CONTACT PRINT, *NODE PRINT, *EL PRINT, the iteration history, the *VERIFY
!> verdicts.
module listing_tables
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, geometry_values
   use due_output, only: table_is_due
   use increment_quantities, only: pass_value
   use equations, only: equation_nodes, section_nodes
   use kinds, only: dp
   use listing_text, only: column, in_columns, table_cell, table_head
   use model, only: model_type, verify_type
   use print_requests, only: print_displacement, print_force, print_heat, print_heat_flux, &
      print_position, print_request_type, print_stress, print_temperature
   use quantity_types, only: needs_heat, of_contact_points, of_passes, quantity_type
   use records, only: contact_record_type, element_points_record_type, field_record_type, &
      increment_record_type
   use reported_quantities, only: quantities
   use run_summaries, only: or_blank
   use solution_report, only: iteration_record_type
   use text, only: to_text
   use transforms, only: axes_at
   use verification, only: bound_words, outcome_type
   implicit none
   private
   public :: print_contact_table, print_iterations, print_requested, print_verdicts

   ! Keys of the quantities of *NODE PRINT and *EL PRINT, by the print_* constants, and the heads of
   ! their columns.
   integer, parameter :: head_length = 4
   character(*), parameter :: print_keys(print_displacement:print_heat_flux) = [character(3) :: &
      'U', 'NT', 'RF', 'RFL', 'S', 'HFL']
   character(*), parameter :: print_heads(4, print_displacement:print_heat_flux) = reshape([ &
      character(head_length) :: 'U1', 'U2', '', '', 'NT', '', '', '', 'RF1', 'RF2', '', '', &
      'RFL', '', '', '', 'S11', 'S22', 'S33', 'S12', 'HFL1', 'HFL2', '', ''], [4, 6])

contains

   !> Prints the contact points of an interface in fixed columns (*CONTACT PRINT); without heat the
   !> last four are left out.
   subroutine print_contact_table(unit, points, contact, node_number)
      integer, intent(in) :: unit                         !! unit of the listing
      type(contact_points_type), intent(in) :: points     !! contact points of the interface
      type(contact_record_type), intent(in) :: contact    !! their state
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
      type(quantity_type), allocatable :: columns(:)
      real(dp), allocatable :: values(:, :)
      integer :: i, k, n

      columns = pack(quantities, quantities%kind == of_contact_points .and. &
         quantities%width > 0 .and. (quantities%needs /= needs_heat .or. &
         allocated(contact%conductance)))
      n = size(columns)
      allocate (values(size(points%slave), n))
      do i = 1, n
         if (columns(i)%is_geometry) then
            values(:, i) = geometry_values(columns(i)%name, points, node_number)
         else
            values(:, i) = contact_values(columns(i)%name, points, contact)
         end if
      end do
      write (unit, '(/, 2a)') '   CONTACT POINTS OF ', points%name
      write (unit, '(*(a))') ' no.', (table_head(columns(i)), i=1, n)
      do k = 1, size(values, 1)
         write (unit, '(i4, *(a))') k, (table_cell(columns(i), values(k, i)), i=1, n)
      end do
   end subroutine print_contact_table

   !> Prints the passes of an increment.
   subroutine print_iterations(unit, iterations)
      integer, intent(in) :: unit                               !! unit of the listing
      type(iteration_record_type), intent(in) :: iterations(:)  !! passes, in their order
      type(quantity_type), allocatable :: columns(:)
      integer :: i, k

      columns = pack(quantities, quantities%kind == of_passes)
      write (unit, '(/, a)') '   ITERATION HISTORY'
      write (unit, '(*(a))') (table_head(columns(i)), i=1, size(columns))
      do k = 1, size(iterations)
         write (unit, '(*(a))') (table_cell(columns(i), pass_value(columns(i)%name, &
            iterations(k))), i=1, size(columns))
      end do
   end subroutine print_iterations

   !> Prints what came of the *VERIFY cards.
   subroutine print_verdicts(unit, checks, outcomes)
      integer, intent(in) :: unit                    !! unit of the listing
      type(verify_type), intent(in) :: checks(:)
      type(outcome_type), intent(in) :: outcomes(:)  !! what came of each
      integer :: i

      write (unit, '(/, a)') 'VERIFICATION'
      write (unit, '(a6, 2x, a10, 1x, a24, 1x, a16, a11, 2a15, 2a10, a9)') 'card', &
         'kind      ', 'quantity                ', 'where           ', 'time', 'expected', &
         'found', 'deviation', 'allowed', 'verdict'
      do i = 1, size(checks)
         call print_verdict(unit, checks(i), outcomes(i))
      end do
      write (unit, '(/, 3x, i0, a, i0, a)') count(outcomes%passed), ' passed, ', &
         count(.not. outcomes%passed), ' failed'
   end subroutine print_verdicts

   subroutine print_verdict(unit, check, outcome)
      integer, intent(in) :: unit
      type(verify_type), intent(in) :: check
      type(outcome_type), intent(in) :: outcome
      character(10) :: kind
      character(24) :: quantity
      character(16) :: where
      character(11) :: time
      character(15) :: found
      character(10) :: deviation

      kind = or_blank(check%kind)
      quantity = check%quantity
      where = or_blank(check%where)
      time = 'LAST'
      if (.not. check%at_last) time = to_text(check%when)
      found = '-'
      deviation = '-'
      if (outcome%reason == '') then
         found = column(outcome%found, 15, 7)
         deviation = column(outcome%deviation, 10, 2)
      end if
      write (unit, '(i6, 2x, a, 1x, a, 1x, 6a, a4, a5)') check%line, kind, quantity, where, &
         adjustr(time), column(check%value, 15, 7), adjustr(found), adjustr(deviation), &
         column(check%tolerance, 10, 2), merge(' REL', ' ABS', check%relative), &
         merge(' PASS', ' FAIL', outcome%passed)
      if (or_blank(check%source) /= '') write (unit, '(8x, 2a)') 'source: ', check%source
      if (outcome%reason /= '') write (unit, '(8x, 2a)') 'failed: ', outcome%reason
      if (bound_words(outcome) /= '') write (unit, '(8x, 3a)') 'found:  ', &
         to_text(outcome%found), bound_words(outcome)
   end subroutine print_verdict

   !> Prints the tables that are due at an increment.
   subroutine print_requested(unit, record, model)
      integer, intent(in) :: unit                         !! unit of the listing
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      integer :: i

      associate (step => model%steps(record%step))
         if (allocated(step%node_prints)) then
            do i = 1, size(step%node_prints)
               if (table_is_due(step%node_prints(i)%frequency, &
                  step%node_prints(i)%points, record, model)) call print_nodes(unit, &
                  step%node_prints(i), model, record%fields)
            end do
         end if
         if (allocated(step%element_prints)) then
            do i = 1, size(step%element_prints)
               if (table_is_due(step%element_prints(i)%frequency, &
                  step%element_prints(i)%points, record, model)) call print_points( &
                  unit, step%element_prints(i), model, record%element_points(i))
            end do
         end if
      end associate
   end subroutine print_requested

   !> Table of the nodes of a set that elements, springs or trusses have, and sums over them.
   subroutine print_nodes(unit, request, model, fields)
      integer, intent(in) :: unit
      type(print_request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      type(field_record_type), intent(in) :: fields
      real(dp), allocatable :: columns(:, :), sums(:, :), values(:, :)
      character(head_length), allocatable :: heads(:), sum_heads(:)
      character(:), allocatable :: set_name
      integer, allocatable :: nodes(:)
      integer :: i, k
      logical :: is_held(size(model%mesh%node_body)), is_summed

      set_name = request%name_of_set(model%mesh%node_sets)
      nodes = request%members(model%mesh%node_sets, size(model%mesh%node_body))
      is_held = model%mesh%node_body > 0 .or. equation_nodes(model%bars%elongation, size(is_held))
      is_held(section_nodes(model%couplings)) = .true.
      nodes = pack(nodes, is_held(nodes))
      allocate (columns(0, size(nodes)), sums(0, size(nodes)), heads(0), sum_heads(0))
      do i = 1, size(request%quantities)
         associate (quantity => request%quantities(i))
            values = nodal_values(quantity, fields, nodes)
            if (size(values, 1) == 0) then
               call print_absence(unit, '   NODES OF '//set_name, quantity)
               cycle
            end if
            is_summed = quantity == print_force .or. quantity == print_heat
            if (is_summed .and. request%totals) call add(quantity, values, sums, sum_heads)
            if (is_summed .and. .not. request%each_node) cycle
            if (request%local_axes .and. size(values, 1) == 2) call turn(model, nodes, values)
            call add(quantity, values, columns, heads)
         end associate
      end do
      if (size(heads) > 0) then
         write (unit, '(/, 2a)') '   NODES OF ', set_name
         call print_head(unit, '    node', heads)
         do k = 1, size(nodes)
            write (unit, '(i8)', advance='no') model%mesh%node_number(nodes(k))
            write (unit, '(2a)') in_columns(model%mesh%coordinates(:, nodes(k)), 12, 4), &
               in_columns(columns(:, k), 14, 6)
         end do
      end if
      if (size(sum_heads) > 0) then
         write (unit, '(/, 2a)') '   TOTALS OF ', set_name
         write (unit, '(*(a14))') (trim(sum_heads(i)), i=1, size(sum_heads))
         write (unit, '(a)') in_columns(sum(sums, dim=2), 14, 6)
      end if
   end subroutine print_nodes

   !> Replaces the components of vectors by those along the axes of their nodes.
   pure subroutine turn(model, nodes, vectors)
      type(model_type), intent(in) :: model
      integer, intent(in) :: nodes(:)
      real(dp), intent(inout) :: vectors(:, :)    ! (2, nodes)
      integer :: i, k

      if (.not. allocated(model%transforms)) return
      do i = 1, size(model%transforms)
         associate (transform => model%transforms(i))
            do k = 1, size(nodes)
               if (all(model%mesh%node_sets(transform%set)%members /= nodes(k))) cycle
               vectors(:, k) = matmul(vectors(:, k), axes_at(transform, &
                  model%mesh%coordinates(:, nodes(k))))
            end do
         end associate
      end do
   end subroutine turn

   !> A nodal quantity: (components, nodes), no component where the step does not have it.
   pure function nodal_values(quantity, fields, nodes) result(values)
      integer, intent(in) :: quantity
      type(field_record_type), intent(in) :: fields
      integer, intent(in) :: nodes(:)
      real(dp), allocatable :: values(:, :)

      allocate (values(0, size(nodes)))
      select case (quantity)
      case (print_displacement)
         if (allocated(fields%displacement)) values = fields%displacement(:, nodes)
      case (print_force)
         if (allocated(fields%external_force)) values = fields%external_force(:, nodes)
      case (print_temperature)
         if (allocated(fields%temperature)) values = reshape(fields%temperature(nodes), &
            [1, size(nodes)])
      case (print_heat)
         if (allocated(fields%external_heat)) values = reshape(fields%external_heat(nodes), &
            [1, size(nodes)])
      case default   ! of integration points
      end select
   end function nodal_values

   !> Appends a quantity to the columns of a table.
   pure subroutine add(quantity, values, columns, heads)
      integer, intent(in) :: quantity
      real(dp), intent(in) :: values(:, :)                    ! (components, rows)
      real(dp), allocatable, intent(inout) :: columns(:, :)   ! (columns, rows)
      character(head_length), allocatable, intent(inout) :: heads(:)
      real(dp), allocatable :: more(:, :)

      allocate (more(size(columns, 1) + size(values, 1), size(values, 2)))
      more(:size(columns, 1), :) = columns
      more(size(columns, 1) + 1:, :) = values
      call move_alloc(more, columns)
      heads = [character(head_length) :: heads, &
         print_heads(:count(print_heads(:, quantity) /= ''), quantity)]
   end subroutine add

   !> Table of the integration points of the elements of a set.
   subroutine print_points(unit, request, model, points)
      integer, intent(in) :: unit
      type(print_request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      type(element_points_record_type), intent(in) :: points
      real(dp), allocatable :: columns(:, :)
      character(head_length), allocatable :: heads(:)
      character(:), allocatable :: title
      integer :: i, k

      title = '   INTEGRATION POINTS OF '//request%name_of_set(model%mesh%element_sets)
      allocate (columns(0, size(points%element)), heads(0))
      do i = 1, size(request%quantities)
         associate (quantity => request%quantities(i))
            if (quantity == print_stress .and. allocated(points%stress)) then
               call add(quantity, points%stress, columns, heads)
            else if (quantity == print_heat_flux .and. allocated(points%heat_flux)) then
               call add(quantity, points%heat_flux, columns, heads)
            else if (quantity /= print_position) then   ! positions are in every table
               call print_absence(unit, title, quantity)
            end if
         end associate
      end do
      if (size(heads) == 0 .and. any(request%quantities /= print_position)) return
      write (unit, '(/, a)') title
      call print_head(unit, ' element point', heads)
      do k = 1, size(points%element)
         write (unit, '(i8, i6)', advance='no') model%mesh%element_number(points%element(k)), &
            points%point(k)
         write (unit, '(2a)', advance='no') in_columns(points%position(:, k), 12, 4), &
            in_columns(columns(:, k), 14, 6)
         associate (axes => model%sections(model%mesh%element_section(points%element(k)))% &
            orientation)
            if (request%local_axes .and. axes > 0) write (unit, '(1x, a)', advance='no') &
               model%orientations(axes)%name
         end associate
         write (unit, '()')
      end do
   end subroutine print_points

   subroutine print_absence(unit, title, quantity)
      integer, intent(in) :: unit, quantity
      character(*), intent(in) :: title

      write (unit, '(/, 4a)') title, ': there is no ', trim(print_keys(quantity)), &
         ' at this increment'
   end subroutine print_absence

   subroutine print_head(unit, items, heads)
      integer, intent(in) :: unit
      character(*), intent(in) :: items, heads(:)
      integer :: i

      write (unit, '(a, 2a12, *(a14))') items, 'x', 'y', (trim(heads(i)), i=1, size(heads))
   end subroutine print_head

end module listing_tables
