!> What *NODE PRINT and *EL PRINT ask for, as numbers: the listing prints them, the result file
!> keeps them as histories.
module requested_tables
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use due_output, only: table_is_due
   use equations, only: tabled_nodes
   use field_quantities, only: field_table, point_values
   use kinds, only: dp
   use model, only: model_type
   use print_requests, only: print_request_type
   use quadrature, only: point_count
   use quantity_types, only: find_quantity
   use records, only: field_record_type, increment_record_type
   use transforms, only: axes_at
   implicit none
   private
   public :: requested_table_type, table_column_type, due_tables, tables_of_step

   integer, parameter :: key_length = 5
   ! Quantities by their keys on the cards: names in words, and numbers of components.
   character(*), parameter :: print_keys(11) = [character(key_length) :: &
      'U', 'NT', 'RF', 'RFL', 'S', 'HFL', 'PEEQ', 'PE', 'CEEQ', 'CE', 'SOLID']
   character(*), parameter :: names(11) = [character(25) :: 'displacement', &
      'temperature', 'external_force', 'external_heat', 'stress', 'heat_flux', &
      'equivalent_plastic_strain', 'plastic_strain', 'equivalent_creep_strain', 'creep_strain', &
      'solid_fraction']
   integer, parameter :: components(11) = [2, 1, 2, 1, 4, 2, 1, 4, 1, 4, 1]

   !> A column of a table: one component of a quantity.
   type :: table_column_type
      character(key_length) :: key = ''        !! of the quantity
      integer :: component = 0
      character(key_length) :: head = ''       !! in the listing, the name that *VERIFY has
      character(:), allocatable :: name        !! in words, such as displacement_x
      character(32) :: unit = '-'              !! as of quantity_type
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
            associate (points => record%element_points(i), rows => size(tables(n)%member))
               tables(n)%position = points%position
               call take_values(points%fields, rows, tables(n)%columns)
               tables(n)%absent = absent_of(step%element_prints(i)%keys, points%fields, rows)
            end associate
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
      do i = 1, size(request%keys)
         if (index(request%keys(i), 'RF') == 1) then
            if (request%totals) call add_columns(table%totals, 'total_', request%keys(i), .false.)
            if (.not. request%each_node) cycle
         end if
         call add_columns(table%columns, '', request%keys(i), is_turned)
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
      do i = 1, size(request%keys)
         call add_columns(table%columns, '', request%keys(i), any(table%axes > 0))
      end do
   end function table_of_points

   !> Adds the columns of the components of a quantity; none of positions, which every table has.
   pure subroutine add_columns(columns, before, key, is_turned)
      type(table_column_type), allocatable, intent(inout) :: columns(:)
      character(*), intent(in) :: before           ! its name
      character(*), intent(in) :: key
      logical, intent(in) :: is_turned             ! whether components are along axes of their own
      type(table_column_type) :: column
      character(2) :: axes
      integer :: i, k, q

      q = findloc(print_keys, key, dim=1)
      if (q == 0) return
      do k = 1, components(q)
         axes = axes_of(components(q), k)
         column%key = key
         column%component = k
         column%head = trim(key)//axes
         column%unit = field_table(find_quantity(field_table, column%head))%unit
         column%name = before//trim(names(q))
         do i = 1, merge(0, len_trim(axes), is_turned)
            axes(i:i) = achar(iachar(axes(i:i)) - iachar('1') + iachar('x'))
         end do
         if (axes /= '') column%name = column%name//'_'//trim(axes)
         columns = [columns, column]
      end do
   end subroutine add_columns

   !> The axes of a component of a vector or a tensor by their numbers; blank of a scalar.
   pure character(2) function axes_of(count, k)
      integer, intent(in) :: count                 ! of components
      integer, intent(in) :: k                     ! which
      character(2), parameter :: of_tensor(4) = ['11', '22', '33', '12']

      axes_of = ''
      if (count == 2) axes_of = of_tensor(k)(:1)
      if (count == 4) axes_of = of_tensor(k)
   end function axes_of

   !> Takes nodal values and their sums, or the uncertainties of both.
   subroutine take_fields(request, model, fields, table, of_totals)
      type(print_request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      type(field_record_type), intent(in) :: fields
      type(requested_table_type), intent(inout) :: table
      real(dp), intent(in), optional :: of_totals(3)   ! uncertainties of RF1, RF2, RFL; NaN of none
      type(field_record_type) :: there
      integer :: k

      table%has_uncertainties = present(of_totals)
      table%position = model%mesh%coordinates(:, table%member)
      there = at_nodes(fields, table%member)
      call take_values(there, size(table%member), table%totals)
      do k = 1, size(table%totals)
         associate (total => table%totals(k))
            if (present(of_totals)) then
               total%values = of_totals([merge(3, total%component, total%key == 'RFL')])
               if (any(ieee_is_nan(total%values))) deallocate (total%values)
            else if (allocated(total%values)) then
               total%values = [sum(total%values)]
            end if
         end associate
      end do
      if (request%local_axes) then
         call turn(model, table%member, present(of_totals), there%displacement)
         call turn(model, table%member, present(of_totals), there%reaction)
      end if
      call take_values(there, size(table%member), table%columns)
      table%absent = absent_of(request%keys, there, size(table%member))
   end subroutine take_fields

   !> Fields of some nodes; forces and heat are the external ones.
   pure function at_nodes(fields, nodes) result(there)
      type(field_record_type), intent(in) :: fields
      integer, intent(in) :: nodes(:)
      type(field_record_type) :: there

      if (allocated(fields%displacement)) there%displacement = fields%displacement(:, nodes)
      if (allocated(fields%temperature)) there%temperature = fields%temperature(nodes)
      if (allocated(fields%solid_fraction)) there%solid_fraction = fields%solid_fraction(nodes)
      if (allocated(fields%external_force)) there%reaction = fields%external_force(:, nodes)
      if (allocated(fields%external_heat)) there%reaction_heat = fields%external_heat(nodes)
   end function at_nodes

   !> Takes the values of columns from fields of the rows, where these have them.
   pure subroutine take_values(fields, rows, columns)
      type(field_record_type), intent(in) :: fields
      integer, intent(in) :: rows                      ! their number
      type(table_column_type), intent(inout) :: columns(:)
      real(dp), allocatable :: values(:)
      integer :: i, k

      do k = 1, size(columns)
         values = point_values(trim(columns(k)%head), fields, [(i, i=1, rows)])
         if (size(values) == rows) columns(k)%values = values
      end do
   end subroutine take_values

   !> Which quantities fields of some rows do not have.
   pure function absent_of(keys, fields, rows) result(absent)
      character(*), intent(in) :: keys(:)
      type(field_record_type), intent(in) :: fields
      integer, intent(in) :: rows                      ! their number
      character(key_length), allocatable :: absent(:)
      integer :: i, k, q

      allocate (absent(0))
      do k = 1, size(keys)
         q = findloc(print_keys, keys(k), dim=1)
         if (q == 0) cycle
         if (size(point_values(trim(keys(k))//trim(axes_of(components(q), 1)), fields, &
            [(i, i=1, rows)])) /= rows) absent = [character(key_length) :: absent, print_keys(q)]
      end do
   end function absent_of

   !> Replaces the components of vectors by those along the axes of their nodes, and uncertainties
   !> of components by those of these, as of independent ones.
   pure subroutine turn(model, nodes, are_uncertainties, vectors)
      type(model_type), intent(in) :: model
      integer, intent(in) :: nodes(:)
      logical, intent(in) :: are_uncertainties
      real(dp), allocatable, intent(inout) :: vectors(:, :)    ! (2, nodes) or none
      real(dp) :: axes(2, 2)
      integer :: i, k

      if (.not. (allocated(model%transforms) .and. allocated(vectors))) return
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

end module requested_tables
