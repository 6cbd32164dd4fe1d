!> What *NODE PRINT and *EL PRINT ask for, as numbers: the listing prints them, the result file
!> keeps them as histories.
module requested_tables
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use due_output, only: table_is_due
   use equations, only: tabled_nodes
   use kinds, only: dp
   use model, only: model_type
   use print_requests, only: print_ceeq, print_creep, print_displacement, print_force, &
      print_heat, print_heat_flux, print_peeq, print_plastic, print_position, &
      print_request_type, print_solid, print_stress, print_temperature
   use quadrature, only: point_count
   use records, only: element_points_record_type, field_record_type, increment_record_type
   use transforms, only: axes_at
   implicit none
   private
   public :: requested_table_type, table_column_type, due_tables, tables_of_step

   integer, parameter :: last_quantity = print_solid, most_components = 4
   integer, parameter :: head_length = 5
   !> Keys of the quantities on the cards, by the print_* constants.
   character(*), parameter :: print_keys(last_quantity) = [character(5) :: &
      'U', 'NT', 'RF', 'RFL', 'S', 'HFL', 'PEEQ', 'PE', 'CEEQ', 'CE', 'SOLID']
   character(*), parameter :: heads(most_components, last_quantity) = reshape([ &
      character(head_length) :: 'U1', 'U2', '', '', 'NT', '', '', '', 'RF1', 'RF2', '', '', &
      'RFL', '', '', '', 'S11', 'S22', 'S33', 'S12', 'HFL1', 'HFL2', '', '', 'PEEQ', '', '', '', &
      'PE11', 'PE22', 'PE33', 'PE12', 'CEEQ', '', '', '', 'CE11', 'CE22', 'CE33', 'CE12', &
      'SOLID', '', '', ''], [most_components, last_quantity])
   ! Their names in words, the axes of their components, and their units.
   character(*), parameter :: names(last_quantity) = [character(25) :: 'displacement', &
      'temperature', 'external_force', 'external_heat', 'stress', 'heat_flux', &
      'equivalent_plastic_strain', 'plastic_strain', 'equivalent_creep_strain', 'creep_strain', &
      'solid_fraction']
   character(*), parameter :: axes_of_vector(most_components) = [character(2) :: 'x', 'y', '', '']
   character(*), parameter :: axes_of_tensor(most_components) = ['xx', 'yy', 'zz', 'xy']
   character(*), parameter :: units(last_quantity) = [character(15) :: 'length', 'temperature', &
      'stress length^2', 'power', 'stress', 'power/length^2', '-', '-', '-', '-', '-']
   logical, parameter :: is_summed(last_quantity) = [.false., .false., .true., .true., .false., &
      .false., .false., .false., .false., .false., .false.]

   !> A column of a table: one component of a quantity.
   type :: table_column_type
      integer :: quantity = 0                  !! a print_* constant
      integer :: component = 0
      character(head_length) :: head = ''      !! in the listing
      character(:), allocatable :: name        !! in words, such as displacement_x
      character(15) :: unit = '-'              !! as of quantity_type
      !> (rows), one of a total; unallocated where the increment does not have the quantity
      real(dp), allocatable :: values(:)
   end type table_column_type

   !> The table of a card, at an increment or without values.
   type :: requested_table_type
      logical :: is_of_nodes = .true.          !! else of integration points
      logical :: has_uncertainties = .false.   !! whether its numbers are those of others
      character(:), allocatable :: set         !! name of the set
      integer, allocatable :: member(:)        !! (rows) index of the node or the element
      integer, allocatable :: point(:)         !! (rows) number of the point in its element
      real(dp), allocatable :: position(:, :)  !! (2, rows) x, y; unallocated without values
      type(table_column_type), allocatable :: columns(:), totals(:)
      !> Keys of quantities that the increment has not, or that have no uncertainty
      character(5), allocatable :: absent(:)
      integer, allocatable :: axes(:)          !! (rows) orientation of points along its axes, or 0
   end type requested_table_type

contains

   !> The tables that are due at an increment, those of nodes first, in the order of their cards;
   !> behind one of nodes that of its uncertainties where there are some.
   subroutine due_tables(record, model, tables)
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      type(requested_table_type), allocatable, intent(out) :: tables(:)
      logical, allocatable :: nodes_due(:), elements_due(:)
      real(dp), allocatable :: values(:, :)
      integer :: i, k, n

      associate (step => model%steps(record%step))
         nodes_due = due_of(step%node_prints, record, model)
         elements_due = due_of(step%element_prints, record, model)
         n = merge(2, 1, allocated(record%field_uncertainties))
         allocate (tables(n*count(nodes_due) + count(elements_due)))
         n = 0
         do i = 1, size(nodes_due)
            if (.not. nodes_due(i)) cycle
            n = n + 1
            tables(n) = table_of_nodes(step%node_prints(i), model)
            call take_fields(step%node_prints(i), model, record%fields, tables(n))
            if (.not. allocated(record%field_uncertainties)) cycle
            n = n + 1
            tables(n) = table_of_nodes(step%node_prints(i), model)
            call take_fields(step%node_prints(i), model, record%field_uncertainties, tables(n), &
               record%total_uncertainties(:, i))
            associate (without => tables(n)%absent, none => tables(n - 1)%absent)
               without = pack(without, [(all(without(k) /= none), k=1, size(without))])
            end associate
         end do
         do i = 1, size(elements_due)
            if (.not. elements_due(i)) cycle
            n = n + 1
            tables(n) = table_of_points(step%element_prints(i), model)
            tables(n)%position = record%element_points(i)%position
            allocate (tables(n)%absent(0))
            do k = 1, size(tables(n)%columns)
               associate (column => tables(n)%columns(k))
                  values = values_at(record%element_points(i), column%quantity)
                  if (size(values, 1) > 0) then
                     column%values = values(column%component, :)
                  else if (column%component == 1) then
                     tables(n)%absent = [character(5) :: tables(n)%absent, print_keys( &
                        column%quantity)]
                  end if
               end associate
            end do
         end do
      end associate
   end subroutine due_tables

   !> Whether the table of each request is due at an increment.
   pure function due_of(requests, record, model) result(due)
      type(print_request_type), allocatable, intent(in) :: requests(:)   ! unallocated for none
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      logical, allocatable :: due(:)
      integer :: i, n

      n = 0
      if (allocated(requests)) n = size(requests)
      allocate (due(n))
      do i = 1, n
         due(i) = table_is_due(requests(i)%frequency, requests(i)%points, record, model)
      end do
   end function due_of

   !> The tables that a step asks for, in the order of due_tables, without values.
   subroutine tables_of_step(step, model, tables)
      integer, intent(in) :: step              !! its number
      type(model_type), intent(in) :: model
      type(requested_table_type), allocatable, intent(out) :: tables(:)
      integer :: elements, i, nodes

      nodes = 0
      elements = 0
      if (allocated(model%steps(step)%node_prints)) nodes = size(model%steps(step)%node_prints)
      if (allocated(model%steps(step)%element_prints)) elements = &
         size(model%steps(step)%element_prints)
      allocate (tables(nodes + elements))
      do i = 1, nodes
         tables(i) = table_of_nodes(model%steps(step)%node_prints(i), model)
      end do
      do i = 1, elements
         tables(nodes + i) = table_of_points(model%steps(step)%element_prints(i), model)
      end do
   end subroutine tables_of_step

   !> The table of the nodes of a set that tables have rows for, and of sums over them.
   function table_of_nodes(request, model) result(table)
      type(print_request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      type(requested_table_type) :: table
      logical :: is_held(size(model%mesh%node_number)), is_turned
      integer :: i

      is_held = tabled_nodes(model%mesh, model%bars%elongation, model%couplings)
      table%set = request%name_of_set(model%mesh%node_sets)
      table%member = request%members(model%mesh%node_sets, size(is_held))
      table%member = pack(table%member, is_held(table%member))
      is_turned = .false.
      if (request%local_axes .and. allocated(model%transforms)) then
         do i = 1, size(model%transforms)
            is_held = .false.
            is_held(model%mesh%node_sets(model%transforms(i)%set)%members) = .true.
            is_turned = is_turned .or. any(is_held(table%member))
         end do
      end if
      allocate (table%columns(0), table%totals(0))
      do i = 1, size(request%quantities)
         associate (q => request%quantities(i))
            if (is_summed(q) .and. request%totals) call add_columns(table%totals, 'total_', q, &
               .false.)
            if (is_summed(q) .and. .not. request%each_node) cycle
            call add_columns(table%columns, '', q, is_turned)
         end associate
      end do
   end function table_of_nodes

   !> The table of the integration points of the elements of a set.
   function table_of_points(request, model) result(table)
      type(print_request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      type(requested_table_type) :: table
      integer, allocatable :: members(:)
      integer :: g, i

      table%is_of_nodes = .false.
      table%set = request%name_of_set(model%mesh%element_sets)
      associate (mesh => model%mesh)
         members = request%members(mesh%element_sets, size(mesh%element_kind))
         table%member = [(spread(members(i), 1, point_count(mesh%element_kind(members(i)))), &
            i=1, size(members))]
         table%point = [([(g, g=1, point_count(mesh%element_kind(members(i))))], &
            i=1, size(members))]
         allocate (table%axes(size(table%member)), source=0)
         if (request%local_axes) table%axes = &
            model%sections(mesh%element_section(table%member))%orientation
      end associate
      allocate (table%columns(0), table%totals(0))
      do i = 1, size(request%quantities)
         associate (q => request%quantities(i))
            ! Positions are in every table.
            if (q /= print_position) call add_columns(table%columns, '', q, any(table%axes > 0))
         end associate
      end do
   end function table_of_points

   !> Adds the columns of the components of a quantity.
   pure subroutine add_columns(columns, before, quantity, is_turned)
      type(table_column_type), allocatable, intent(inout) :: columns(:)
      character(*), intent(in) :: before           ! its name
      integer, intent(in) :: quantity              ! a print_* constant
      logical, intent(in) :: is_turned             ! whether components are along axes of their own
      type(table_column_type) :: column
      character(2) :: axes
      integer :: i, k

      do k = 1, count(heads(:, quantity) /= '')
         column%quantity = quantity
         column%component = k
         column%head = heads(k, quantity)
         column%unit = units(quantity)
         column%name = before//trim(names(quantity))
         axes = ''
         if (any(heads(2:, quantity) /= '')) axes = axes_of_vector(k)
         if (heads(3, quantity) /= '') axes = axes_of_tensor(k)
         do i = 1, merge(len_trim(axes), 0, is_turned)
            axes(i:i) = achar(iachar(axes(i:i)) - iachar('x') + iachar('1'))
         end do
         if (axes /= '') column%name = column%name//'_'//trim(axes)
         columns = [columns, column]
      end do
   end subroutine add_columns

   !> Takes nodal values and their sums, or the uncertainties of both.
   subroutine take_fields(request, model, fields, table, of_totals)
      type(print_request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      type(field_record_type), intent(in) :: fields
      type(requested_table_type), intent(inout) :: table
      real(dp), intent(in), optional :: of_totals(3)   ! uncertainties of RF1, RF2, RFL; NaN of none
      real(dp), allocatable :: values(:, :)
      integer :: i, k

      table%has_uncertainties = present(of_totals)
      table%position = model%mesh%coordinates(:, table%member)
      allocate (table%absent(0))
      do i = 1, size(request%quantities)
         associate (q => request%quantities(i))
            values = nodal_values(q, fields, table%member)
            if (size(values, 1) == 0) table%absent = [character(5) :: table%absent, print_keys(q)]
            do k = 1, size(table%totals)
               associate (total => table%totals(k))
                  if (total%quantity /= q) cycle
                  if (present(of_totals)) then
                     total%values = of_totals([merge(3, total%component, q == print_heat)])
                     if (any(ieee_is_nan(total%values))) deallocate (total%values)
                  else if (size(values, 1) > 0) then
                     total%values = [sum(values(total%component, :))]
                  end if
               end associate
            end do
            if (request%local_axes .and. size(values, 1) == 2) call turn(model, table%member, &
               present(of_totals), values)
            do k = 1, size(table%columns)
               associate (column => table%columns(k))
                  if (column%quantity == q .and. size(values, 1) > 0) column%values = &
                     values(column%component, :)
               end associate
            end do
         end associate
      end do
   end subroutine take_fields

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

end module requested_tables
