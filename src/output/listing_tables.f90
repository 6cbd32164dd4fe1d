!> Tables of the listing: *CONTACT PRINT, *NODE PRINT, *EL PRINT, the iteration history, the *VERIFY
!> verdicts.
module listing_tables
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, geometry_values, has_quantity
   use due_output, only: table_is_due
   use increment_quantities, only: pass_value
   use equations, only: equation_nodes, section_nodes
   use kinds, only: dp
   use listing_text, only: column, in_columns, page_type, table_heads, table_row, to_right
   use model, only: model_type, verify_type
   use print_requests, only: print_ceeq, print_creep, print_displacement, print_force, &
      print_heat, print_heat_flux, print_peeq, print_plastic, print_position, &
      print_request_type, print_solid, print_stress, print_temperature
   use quantity_types, only: of_contact_points, of_passes, quantity_type
   use records, only: contact_record_type, element_points_record_type, field_record_type, &
      increment_record_type
   use reported_quantities, only: quantities
   use solution_report, only: iteration_record_type
   use text, only: or_blank, string_type, to_text
   use transforms, only: axes_at
   use verification, only: uncertainty_words, outcome_type
   implicit none
   private
   public :: print_contact_table, print_iterations, print_requested, print_verdicts, &
      uncertainties_of

   character(*), parameter :: uncertainties_of = 'UNCERTAINTIES (95 %) OF '

   ! Keys of the quantities of *NODE PRINT and *EL PRINT, by the print_* constants, and the heads of
   ! their columns.
   integer, parameter :: head_length = 5
   character(*), parameter :: node_head = '    node           x           y'
   character(*), parameter :: point_head = ' element point           x           y'
   character(*), parameter :: print_keys(print_displacement:print_solid) = [character(5) :: &
      'U', 'NT', 'RF', 'RFL', 'S', 'HFL', 'PEEQ', 'PE', 'CEEQ', 'CE', 'SOLID']
   character(*), parameter :: print_heads(4, print_displacement:print_solid) = reshape([ &
      character(head_length) :: 'U1', 'U2', '', '', 'NT', '', '', '', 'RF1', 'RF2', '', '', &
      'RFL', '', '', '', 'S11', 'S22', 'S33', 'S12', 'HFL1', 'HFL2', '', '', 'PEEQ', '', '', '', &
      'PE11', 'PE22', 'PE33', 'PE12', 'CEEQ', '', '', '', 'CE11', 'CE22', 'CE33', 'CE12', &
      'SOLID', '', '', ''], [4, 11])

contains

   !> Prints the contact points of an interface in fixed columns (*CONTACT PRINT), or the
   !> uncertainties of their numbers; without heat the last four are left out.
   subroutine print_contact_table(page, points, contact, node_number, title)
      type(page_type), intent(inout) :: page              !! of the listing
      type(contact_points_type), intent(in) :: points     !! contact points of the interface
      type(contact_record_type), intent(in) :: contact    !! their state
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
      character(*), intent(in) :: title                   !! before the name of the interface
      type(quantity_type), allocatable :: columns(:)
      real(dp), allocatable :: values(:, :)
      type(string_type), allocatable :: rows(:)
      integer :: i

      columns = pack(quantities, quantities%kind == of_contact_points .and. &
         quantities%width > 0 .and. has_quantity(contact, quantities%needs))
      allocate (values(size(points%slave), size(columns)), rows(0:size(points%slave)))
      do i = 1, size(columns)
         if (columns(i)%is_geometry) then
            values(:, i) = geometry_values(columns(i)%name, points, node_number)
         else
            values(:, i) = contact_values(columns(i)%name, contact)
         end if
      end do
      rows(0)%value = ' no.'//table_heads(columns)
      do i = 1, size(points%slave)
         rows(i)%value = to_right(to_text(i), 4)//table_row(columns, values(i, :))
      end do
      call page%table('   '//title//points%name, rows)
   end subroutine print_contact_table

   !> Prints the passes of an increment.
   subroutine print_iterations(page, iterations)
      type(page_type), intent(inout) :: page                    !! of the listing
      type(iteration_record_type), intent(in) :: iterations(:)  !! passes, in their order
      type(quantity_type), allocatable :: columns(:)
      type(string_type) :: rows(0:size(iterations))
      integer :: i, k

      columns = pack(quantities, quantities%kind == of_passes)
      rows(0)%value = table_heads(columns)
      do k = 1, size(iterations)
         rows(k)%value = table_row(columns, [(pass_value(columns(i)%name, iterations(k)), &
            i=1, size(columns))])
      end do
      call page%table('   ITERATION HISTORY', rows)
   end subroutine print_iterations

   !> Prints what came of the *VERIFY cards.
   subroutine print_verdicts(page, checks, outcomes)
      type(page_type), intent(inout) :: page         !! of the listing
      type(verify_type), intent(in) :: checks(:)
      type(outcome_type), intent(in) :: outcomes(:)  !! what came of each
      integer :: i

      call page%line('')
      call page%line('VERIFICATION')
      call page%line('  card  kind       quantity                 where                  time'// &
         '       expected          found deviation   allowed  verdict')
      do i = 1, size(checks)
         call print_verdict(page, checks(i), outcomes(i))
      end do
      call page%line('')
      call page%line('   '//to_text(count(outcomes%passed))//' passed, '// &
         to_text(count(.not. outcomes%passed))//' failed')
   end subroutine print_verdicts

   subroutine print_verdict(page, check, outcome)
      type(page_type), intent(inout) :: page
      type(verify_type), intent(in) :: check
      type(outcome_type), intent(in) :: outcome
      character(10) :: kind
      character(24) :: quantity
      character(16) :: where
      character(:), allocatable :: time, found

      kind = or_blank(check%kind)
      quantity = check%quantity
      where = or_blank(check%where)
      time = 'LAST'
      if (.not. check%at_last) time = to_text(check%when)
      found = to_right('-', 15)//to_right('-', 10)
      if (outcome%reason == '') found = column(outcome%found, 15, 7)// &
         column(outcome%deviation, 10, 2)
      call page%line(to_right(to_text(check%line), 6)//'  '//kind//' '//quantity//' '//where// &
         to_right(time, 11)//column(check%value, 15, 7)//found//column(check%tolerance, 10, 2)// &
         merge(' REL', ' ABS', check%relative)//merge(' PASS', ' FAIL', outcome%passed))
      if (or_blank(check%source) /= '') call page%line('        source: '//check%source)
      if (outcome%reason /= '') call page%line('        failed: '//outcome%reason)
      if (uncertainty_words(outcome) /= '') call page%line('        found:  '// &
         to_text(outcome%found)//uncertainty_words(outcome))
   end subroutine print_verdict

   !> Prints the tables that are due at an increment.
   subroutine print_requested(page, record, model)
      type(page_type), intent(inout) :: page              !! of the listing
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      integer :: i

      associate (step => model%steps(record%step))
         if (allocated(step%node_prints)) then
            do i = 1, size(step%node_prints)
               if (table_is_due(step%node_prints(i)%frequency, &
                  step%node_prints(i)%points, record, model)) then
                  call print_nodes(page, step%node_prints(i), model, record%fields)
                  if (allocated(record%field_uncertainties)) then
                     call print_nodes(page, step%node_prints(i), model, &
                        record%field_uncertainties, record%total_uncertainties(:, i))
                  end if
               end if
            end do
         end if
         if (allocated(step%element_prints)) then
            do i = 1, size(step%element_prints)
               if (table_is_due(step%element_prints(i)%frequency, &
                  step%element_prints(i)%points, record, model)) call print_points( &
                  page, step%element_prints(i), model, record%element_points(i))
            end do
         end if
      end associate
   end subroutine print_requested

   !> Table of the nodes of a set that elements, springs or trusses have, and sums over them; or of
   !> the uncertainties of both.
   subroutine print_nodes(page, request, model, fields, of_totals)
      type(page_type), intent(inout) :: page
      type(print_request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      type(field_record_type), intent(in) :: fields
      real(dp), intent(in), optional :: of_totals(3)   ! uncertainties of RF1, RF2, RFL; NaN of none
      real(dp), allocatable :: sums(:), values(:, :)
      type(string_type), allocatable :: rows(:)
      type(string_type) :: totals(0:1)
      character(:), allocatable :: set_name, title
      integer, allocatable :: nodes(:)
      integer :: i
      logical :: is_held(size(model%mesh%node_body)), is_summed

      title = '   '
      if (present(of_totals)) title = title//uncertainties_of
      set_name = request%name_of_set(model%mesh%node_sets)
      nodes = request%members(model%mesh%node_sets, size(model%mesh%node_body))
      is_held = model%mesh%node_body > 0 .or. equation_nodes(model%bars%elongation, size(is_held))
      is_held(section_nodes(model%couplings)) = .true.
      nodes = pack(nodes, is_held(nodes))
      allocate (rows(0:size(nodes)))
      rows(0)%value = node_head
      do i = 1, size(nodes)
         rows(i)%value = to_right(to_text(model%mesh%node_number(nodes(i))), 8)// &
            in_columns(model%mesh%coordinates(:, nodes(i)), 12, 4)
      end do
      totals(0)%value = ''
      totals(1)%value = ''
      do i = 1, size(request%quantities)
         associate (quantity => request%quantities(i))
            values = nodal_values(quantity, fields, nodes)
            sums = sum(values, dim=2)
            if (present(of_totals)) then
               sums = pack(of_totals, [quantity == print_force, quantity == print_force, &
                  quantity == print_heat] .and. .not. ieee_is_nan(of_totals))
            else if (size(values, 1) == 0) then
               call print_absence(page, '   NODES OF '//set_name, quantity)
            end if
            is_summed = quantity == print_force .or. quantity == print_heat
            if (is_summed .and. request%totals) call add(totals, quantity, reshape(sums, &
               [size(sums), 1]))
            if (is_summed .and. .not. request%each_node) cycle
            if (request%local_axes .and. size(values, 1) == 2) call turn(model, nodes, &
               present(of_totals), values)
            call add(rows, quantity, values)
         end associate
      end do
      if (len(rows(0)%value) > len(node_head)) call page%table(title//'NODES OF '//set_name, rows)
      if (totals(0)%value /= '') call page%table(title//'TOTALS OF '//set_name, totals)
   end subroutine print_nodes

   !> Replaces the components of vectors by those along the axes of their nodes, and uncertainties
   !> of components by those of these, as of independent ones.
   pure subroutine turn(model, nodes, are_uncertainties, vectors)
      type(model_type), intent(in) :: model
      integer, intent(in) :: nodes(:)
      logical, intent(in) :: are_uncertainties
      real(dp), intent(inout) :: vectors(:, :)    ! (2, nodes)
      real(dp) :: axes(2, 2)
      integer :: i, k

      if (.not. allocated(model%transforms)) return
      do i = 1, size(model%transforms)
         associate (transform => model%transforms(i))
            do k = 1, size(nodes)
               if (all(model%mesh%node_sets(transform%set)%members /= nodes(k))) cycle
               axes = axes_at(transform, model%mesh%coordinates(:, nodes(k)))
               if (are_uncertainties) then
                  vectors(:, k) = sqrt(matmul(vectors(:, k)**2, axes**2))
               else
                  vectors(:, k) = matmul(vectors(:, k), axes)
               end if
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
      case (print_solid)
         if (allocated(fields%solid_fraction)) values = reshape(fields%solid_fraction(nodes), &
            [1, size(nodes)])
      case default   ! of integration points
      end select
   end function nodal_values

   !> Adds the columns of a quantity to the rows of a table, the first of which is its head.
   pure subroutine add(rows, quantity, values)
      type(string_type), intent(inout) :: rows(0:)
      integer, intent(in) :: quantity
      real(dp), intent(in) :: values(:, :)                    ! (components, rows)
      integer :: k

      do k = 1, size(values, 1)
         rows(0)%value = rows(0)%value//to_right(trim(print_heads(k, quantity)), 14)
      end do
      do k = 1, size(values, 2)
         rows(k)%value = rows(k)%value//in_columns(values(:, k), 14, 6)
      end do
   end subroutine add

   !> Table of the integration points of the elements of a set.
   subroutine print_points(page, request, model, points)
      type(page_type), intent(inout) :: page
      type(print_request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      type(element_points_record_type), intent(in) :: points
      real(dp), allocatable :: values(:, :)
      type(string_type), allocatable :: rows(:)
      character(:), allocatable :: title
      integer :: i, axes

      title = '   INTEGRATION POINTS OF '//request%name_of_set(model%mesh%element_sets)
      allocate (rows(0:size(points%element)))
      rows(0)%value = point_head
      do i = 1, size(points%element)
         rows(i)%value = to_right(to_text(model%mesh%element_number(points%element(i))), 8)// &
            to_right(to_text(points%point(i)), 6)//in_columns(points%position(:, i), 12, 4)
      end do
      do i = 1, size(request%quantities)
         associate (quantity => request%quantities(i))
            if (quantity == print_position) cycle   ! positions are in every table
            values = values_at(points, quantity)
            if (size(values, 1) > 0) then
               call add(rows, quantity, values)
            else
               call print_absence(page, title, quantity)
            end if
         end associate
      end do
      if (rows(0)%value == point_head .and. any(request%quantities /= print_position)) return
      do i = 1, merge(size(points%element), 0, request%local_axes)
         axes = model%sections(model%mesh%element_section(points%element(i)))%orientation
         if (axes > 0) rows(i)%value = rows(i)%value//' '//model%orientations(axes)%name
      end do
      call page%table(title, rows)
   end subroutine print_points

   !> A quantity of integration points: (components, points), no component where the step does not
   !> have it.
   pure function values_at(points, quantity) result(values)
      type(element_points_record_type), intent(in) :: points
      integer, intent(in) :: quantity
      real(dp), allocatable :: values(:, :)

      allocate (values(0, size(points%element)))
      if (quantity == print_stress .and. allocated(points%stress)) values = points%stress
      if (quantity == print_heat_flux .and. allocated(points%heat_flux)) values = points%heat_flux
      if (.not. allocated(points%inelastic_strain)) return
      associate (strain => points%inelastic_strain)
         select case (quantity)
         case (print_plastic)
            values = strain(:4, :)
         case (print_peeq)
            values = strain(5:5, :)
         case (print_creep)
            values = strain(6:9, :)
         case (print_ceeq)
            values = strain(10:, :)
         case default   ! above
         end select
      end associate
   end function values_at

   subroutine print_absence(page, title, quantity)
      type(page_type), intent(inout) :: page
      character(*), intent(in) :: title
      integer, intent(in) :: quantity

      call page%line('')
      call page%line(title//': there is no '//trim(print_keys(quantity))//' at this increment')
   end subroutine print_absence

end module listing_tables
