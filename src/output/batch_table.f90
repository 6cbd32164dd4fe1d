!> The table of a batch: on the terminal, and as a CSV file, which for the rows of a table of values
!> has these and the results, too.
module batch_table
   use, intrinsic :: iso_fortran_env, only: output_unit
   use deck_outcomes, only: deck_outcome_type
   use errors, only: error_type
   use kinds, only: dp
   use messages, only: print_line
   use name_index, only: name_index_type
   use open_files, only: replace_file
   use processes, only: reason_of, report_type
   use text, only: append, counted, quoted, string_type, to_text, to_upper, with_decimals
   use utf8, only: character_count, printable
   implicit none
   private
   public :: print_batch, write_batch, is_batch_column, table_name

   !> Name of the CSV file. Those of a deck's results end otherwise, and a table of values that
   !> is in the folder is likely to be called batch.csv.
   character(*), parameter :: table_name = 'thercon-batch.csv'
   character(*), parameter :: columns = ',status,outcome,reason,increments,iterations,'// &
      'checks_passed,checks_failed,seconds,cpu_seconds,peak_megabytes'
   real(dp), parameter :: megabyte = 1.0e6_dp   !! [byte]

contains

   !> Prints the table, and how many decks ended in which way.
   subroutine print_batch(outcomes, noun, seconds)
      type(deck_outcome_type), intent(in) :: outcomes(:)  !! one a run, in their order
      character(*), intent(in) :: noun                     !! what each is of: deck or row
      real(dp), intent(in) :: seconds                      !! time that the batch took [s]
      character(120) :: line
      integer :: width, i

      width = len(noun)
      do i = 1, size(outcomes)
         width = max(width, character_count(printable(outcomes(i)%path)))
      end do
      write (line, '(2x, a20, 2a12, 2a8, 2a10, a9)') 'outcome', 'increments', 'iterations', &
         'passed', 'failed', 'seconds', 'CPU s', 'peak MB'
      call print_line(output_unit, '')
      call print_line(output_unit, noun//repeat(' ', width - len(noun))//trim(line))
      do i = 1, size(outcomes)
         associate (deck => outcomes(i), report => outcomes(i)%report)
            write (line, '(2x, a20)') deck%words()
            if (deck%has_run) write (line(23:), '(2i12, 2i8, f10.2)') report%increments, &
               report%iterations, report%verify_passed, report%verify_failed, report%seconds
            if (deck%has_run .and. .not. deck%is_earlier()) write (line(73:), '(f10.2, f9.1)') &
               deck%cpu_seconds, deck%peak_bytes/megabyte
            call print_line(output_unit, deck%path//repeat(' ', width - &
               character_count(printable(deck%path)))//trim(line))
         end associate
      end do
      call print_line(output_unit, counted(size(outcomes), noun)//' in '// &
         with_decimals(seconds, 3)//' s: '//counts_of(outcomes))
   end subroutine print_batch

   !> How many decks ended in which way, in the order of the first of each.
   function counts_of(outcomes) result(string)
      type(deck_outcome_type), intent(in) :: outcomes(:)
      character(:), allocatable :: string
      logical :: is_counted(size(outcomes))
      integer :: i, k, number

      string = ''
      is_counted = .false.
      do i = 1, size(outcomes)
         if (is_counted(i)) cycle
         number = 0
         do k = i, size(outcomes)
            if (outcomes(k)%words() /= outcomes(i)%words()) cycle
            is_counted(k) = .true.
            number = number + 1
         end do
         if (i > 1) string = string//', '
         string = string//outcomes(i)%words()//' '//to_text(number)
      end do
   end function counts_of

   !> Whether a column of the CSV file has a name.
   pure logical function is_batch_column(name)
      character(*), intent(in) :: name                     !! in any case

      is_batch_column = index(to_upper(',run'//columns//','), to_upper(','//name//',')) > 0
   end function is_batch_column

   !> Writes the CSV file; one that is there is replaced in one instant. Fields of a run that was
   !> not begun are empty; those of one that runs say how far it is. Of a result that was finished
   !> before, CPU time and memory are not known. Rows of a table begin with their values and end
   !> with their results.
   !> Error: status_internal, when the file cannot be written.
   subroutine write_batch(path, outcomes, error, names, values)
      character(*), intent(in) :: path
      type(deck_outcome_type), intent(in) :: outcomes(:)  !! one a run, in their order
      type(error_type), allocatable, intent(out) :: error
      type(string_type), intent(in), optional :: names(:)      !! columns of a table of values
      type(string_type), intent(in), optional :: values(:, :)  !! (columns, runs)
      character(:), allocatable :: line, text
      type(string_type), allocatable :: results(:)
      integer :: i, k

      results = result_columns(outcomes)
      text = 'deck'//columns//new_line('a')
      if (present(names)) then
         line = ''
         do k = 1, size(names)
            line = line//quoted(names(k)%value)//','
         end do
         line = line//'run'//columns
         do k = 1, size(results)
            line = line//','//quoted(results(k)%value)
         end do
         text = line//new_line('a')
      end if
      do i = 1, size(outcomes)
         line = ''
         do k = 1, merge(size(names), 0, present(names))
            line = line//values(k, i)%value//','
         end do
         line = line//row_of(outcomes(i), outcomes(i)%report)
         do k = 1, size(results)
            line = line//','//outcomes(i)%row%value_of(results(k)%value)
         end do
         text = text//line//new_line('a')
      end do
      call replace_file(path, text, error)
   end subroutine write_batch

   !> The quantities of all rows, in the order in which they come first.
   function result_columns(outcomes) result(names)
      type(deck_outcome_type), intent(in) :: outcomes(:)
      type(string_type), allocatable :: names(:)
      type(name_index_type) :: known
      integer :: i, k

      allocate (names(0))
      do i = 1, size(outcomes)
         if (.not. allocated(outcomes(i)%row%names)) cycle
         do k = 1, size(outcomes(i)%row%names)
            associate (name => outcomes(i)%row%names(k)%value)
               if (known%find(name) > 0) cycle
               call known%add(name)
               call append(names, name)
            end associate
         end do
      end do
   end function result_columns

   function row_of(deck, report) result(line)
      type(deck_outcome_type), intent(in) :: deck
      type(report_type), intent(in) :: report   ! of the deck
      character(:), allocatable :: line

      line = ''
      if (deck%has_run) line = to_text(report%status)
      line = quoted(deck%path)//','//line//','//deck%words()//','//quoted(reason_of(report))//','
      if (.not. (deck%has_run .or. deck%is_running)) then
         line = line//repeat(',', 6)
         return
      end if
      line = line//to_text(report%increments)//','//to_text(report%iterations)//','
      if (deck%has_run) line = line//to_text(report%verify_passed)
      line = line//','
      if (deck%has_run) line = line//to_text(report%verify_failed)
      line = line//','//with_decimals(report%seconds, 3)//','
      if (deck%has_run .and. .not. deck%is_earlier()) then
         line = line//with_decimals(deck%cpu_seconds, 3)//','// &
            with_decimals(deck%peak_bytes/megabyte, 3)
      else
         line = line//','
      end if
   end function row_of

end module batch_table
