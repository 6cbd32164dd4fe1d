!> The table of `--table`: a CSV file whose columns are parameters of a deck, each row the values of
!> a run.
module value_tables
   use batch_table, only: is_batch_column
   use card_fields, only: split_fields, without_quotes
   use cards, only: field_type
   use command_line, only: command_type
   use deck_reader, only: parameters_of_deck
   use deck_report, only: deck_report_type
   use deck_source, only: place_type, read_lines
   use file_calls, only: is_stream
   use kinds, only: dp
   use name_index, only: name_index_type
   use spelling, only: nearest_known
   use text, only: append, counted, read_real, string_type, to_text, to_upper
   implicit none
   private
   public :: value_table_type, read_values

   !> Parameters and their values.
   type :: value_table_type
      type(string_type), allocatable :: names(:)       !! (columns) as given
      type(string_type), allocatable :: values(:, :)   !! (columns, rows) numbers as given
   contains
      procedure :: settings
   end type value_table_type

contains

   !> Reads the table of a command and compares it with the deck. Mistakes are reported with their
   !> lines and columns.
   subroutine read_values(command, table, report)
      type(command_type), intent(in) :: command          !! with --table
      type(value_table_type), intent(out) :: table
      type(deck_report_type), intent(out) :: report      !! receives errors
      type(string_type), allocatable :: lines(:)
      type(field_type), allocatable :: fields(:)
      character(:), allocatable :: fault
      integer :: heading, i, rows

      report%path = command%table
      allocate (report%source%paths(0), table%names(0))
      call append(report%source%paths, command%table)
      call read_lines(command%table, lines, fault)
      if (len(fault) > 0) then
         call report%error(place_type(), 'the table cannot be read: '//fault)
         return
      end if
      do i = 1, size(lines)
         call report%source%add_image(1, i, lines(i)%value)
      end do
      heading = findloc([(is_filled(lines(i)%value), i=1, size(lines))], .true., dim=1)
      if (heading == 0) then
         if (size(lines) == 0) call report%source%add_image(1, 1, '')
         call report%error(place_type(1, 1), 'the table is empty; its first line has the names '// &
            'of parameters, each further line the values of a run')
         return
      end if
      call split_fields(lines(heading)%value, heading, report, fields)
      call read_names(command, heading, fields, table, report)
      if (report%has_errors()) return
      rows = count([(is_filled(lines(i)%value), i=heading + 1, size(lines))])
      if (rows == 0) call report%error(place_type(heading, 1), 'no row of values follows')
      allocate (table%values(size(table%names), rows))
      rows = 0
      do i = heading + 1, size(lines)
         if (.not. is_filled(lines(i)%value)) cycle
         rows = rows + 1
         call split_fields(lines(i)%value, i, report, fields)
         call read_row(fields, table%names, table%values(:, rows), report)
      end do
   end subroutine read_values

   pure logical function is_filled(line)
      character(*), intent(in) :: line

      is_filled = verify(line, ' '//achar(9)) > 0
   end function is_filled

   !> The heading: each column is a parameter of the deck, once.
   subroutine read_names(command, line, fields, table, report)
      type(command_type), intent(in) :: command
      integer, intent(in) :: line                        ! of the heading
      type(field_type), intent(in) :: fields(:)
      type(value_table_type), intent(inout) :: table
      type(deck_report_type), intent(inout) :: report
      type(string_type), allocatable :: parameters(:)
      type(name_index_type) :: given, known
      character(:), allocatable :: deck, fault, name
      integer :: i

      deck = command%decks(1)%value
      fault = 'a pipe can be read only once, and the deck once for each row'
      if (.not. is_stream(deck)) call parameters_of_deck(deck, command%settings, parameters, fault)
      if (len(fault) > 0) then
         call report%error(place_type(line, 1), 'the deck '//deck//' cannot be read: '//fault)
         return
      end if
      do i = 1, size(parameters)
         call known%add(parameters(i)%value)
      end do
      do i = 1, size(command%settings)
         name = command%settings(i)%value
         call given%add(trim(adjustl(name(:index(name, '=') - 1))))
      end do
      do i = 1, size(fields)
         name = without_quotes(fields(i)%text)
         if (name == '') then
            call report%error(fields(i)%place, 'column '//to_text(i)//' has no name')
         else if (given%find(name) > size(command%settings)) then
            call report%error(fields(i)%place, 'column '//name//' is there twice; leave '// &
               'one out (names are case-insensitive)')
         else if (given%find(name) > 0) then
            call report%error(fields(i)%place, '--set gives '//name//', too; leave one out')
         else if (known%find(name) == 0 .and. scan(name, ';'//achar(9)) > 0) then
            call report%error(fields(i)%place, 'commas separate the fields of a table, not '// &
               trim(merge('semicolons', 'tabs      ', index(name, ';') > 0)))
         else if (known%find(name) == 0) then
            call report%error(fields(i)%place, 'no *PARAMETER of '//deck//' has the name '// &
               name//nearest_known(to_upper(name), parameters))
         else if (is_batch_column(name)) then
            call report%error(fields(i)%place, 'the table of results has a column '//name// &
               ' of its own; give the parameter another name')
         end if
         call given%add(name)
         call append(table%names, name)
      end do
   end subroutine read_names

   !> The values of a row: a number for each column.
   subroutine read_row(fields, names, values, report)
      type(field_type), intent(in) :: fields(:)
      type(string_type), intent(in) :: names(:)
      type(string_type), intent(inout) :: values(:)      ! (columns)
      type(deck_report_type), intent(inout) :: report
      real(dp) :: number
      integer :: i
      logical :: valid

      do i = 1, min(size(fields), size(names))
         values(i)%value = without_quotes(fields(i)%text)
         call read_real(values(i)%value, number, valid)
         if (values(i)%value == '') then
            call report%error(fields(i)%place, 'there is no value of '//names(i)%value)
         else if (.not. valid) then
            call report%error(fields(i)%place, names(i)%value//' needs a number, not '// &
               values(i)%value)
         end if
      end do
      if (size(fields) < size(names)) then
         call report%error(fields(size(fields))%place, 'there is no value of '// &
            names(size(fields) + 1)%value//' in this row')
      else if (size(fields) > size(names)) then
         call report%error(fields(size(names) + 1)%place, 'this row has '// &
            counted(size(fields), 'value')//', and the table '//counted(size(names), 'column'))
      end if
   end subroutine read_row

   !> What a row sets, each NAME=VALUE.
   function settings(self, row)
      class(value_table_type), intent(in) :: self
      integer, intent(in) :: row
      type(string_type), allocatable :: settings(:)
      integer :: i

      allocate (settings(0))
      do i = 1, size(self%names)
         call append(settings, self%names(i)%value//'='//self%values(i, row)%value)
      end do
   end function settings

end module value_tables
