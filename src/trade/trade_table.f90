!> The table of a trade-off study, as text and as a CSV file.
module trade_table
   use, intrinsic :: iso_fortran_env, only: output_unit
   use csv_fields, only: quoted
   use errors, only: error_type
   use kinds, only: dp
   use messages, only: print_line
   use open_files, only: write_file
   use recommendation, only: same_time
   use reported_quantities, only: traded
   use text, only: few_digits, percent, to_text, with_decimals
   use trade_study, only: is_there, quantity_count, target_count, targets, trade_row_type, &
      trade_type
   implicit none
   private
   public :: print_trade, write_trade

   real(dp), parameter :: megabyte = 1.0e6_dp    !! [byte]

contains

   !> Prints the table, the rows that were left out, and the recommendations on stdout.
   subroutine print_trade(name, trade)
      character(*), intent(in) :: name          !! the deck
      type(trade_type), intent(in) :: trade
      character(:), allocatable :: line
      integer :: i

      call say(name//': speed against accuracy; errors in %, those of the reference included')
      call say('')
      line = ' row  mesh          incr.  number  varied           CPU s      MB'
      do i = 1, quantity_count
         line = line//right(trim(traded(i)%head))
      end do
      call say(line//right('worst'))
      do i = 1, size(trade%rows)
         call say(row_line(i, trade%rows(i)))
      end do
      call say('      reference uncertain by'//repeat(' ', 37)//cells(trade%uncertainty))
      call say('')
      call say('* no row that takes at most '//to_text(nint(1000.0_dp*same_time))// &
         ' ms more is better (worst error); = the deck as written')
      if (any(trade%rows%variation%contact_levels > 0)) call say('x 1:4: sides are those of '// &
         'the deck''s mesh, at both contact faces divided by 4 (*REFINE, LEVELS=2, SURFACE=)')
      line = 'compared at the times'
      do i = 1, size(trade%instants)
         line = line//' '//to_text(trade%instants(i))
      end do
      call say(line)
      do i = 1, size(trade%left_out)
         call say('left out by --limit: '//described(trade%left_out(i))//': '// &
            trade%left_out(i)%reason)
      end do
      if (allocated(trade%ended_early)) call say(trade%ended_early)
      call say('')
      do i = 1, target_count
         call print_target(trade, i)
      end do
   end subroutine print_trade

   subroutine say(line)
      character(*), intent(in) :: line

      call print_line(output_unit, line)
   end subroutine say

   pure function row_line(number, row) result(line)
      integer, intent(in) :: number
      type(trade_row_type), intent(in) :: row
      character(:), allocatable :: line
      character(12) :: mesh
      character(14) :: varied
      character(68) :: first

      mesh = mesh_of(row)
      varied = row%varied
      line = to_text(row%increments)
      if (row%status /= 0) line = '-'
      write (first, '(i4, 2a, 2x, a, 2x, a6, a7, 2x, a, f9.3, f8.1)') number, &
         merge('*', ' ', row%is_optimal), merge('=', ' ', row%is_default), mesh, factor_of(row), &
         line, varied, row%cpu_seconds, row%peak_bytes/megabyte
      line = first//cells([row%errors, row%worst])
      if (row%status /= 0) line = first//'  failed ('//to_text(row%status)//'): '//row%reason
   end function row_line

   subroutine print_target(trade, k)
      type(trade_type), intent(in) :: trade
      integer, intent(in) :: k
      character(:), allocatable :: words
      integer :: i

      words = 'for '//percent(targets(k))
      i = findloc(trade%rows%is_recommended(k), .true., dim=1)
      if (i == 0) then
         call say(words//': no row; '//trade%remarks(k)%value)
         return
      end if
      if (trade%remarks(k)%value /= '') words = words//', not of all quantities'
      call say(words//': row '//to_text(i)//' ('//described(trade%rows(i))//'), '// &
         with_decimals(trade%rows(i)%cpu_seconds, 3)//' s of CPU')
      if (trade%remarks(k)%value /= '') call say('       but not for '//trade%remarks(k)%value)
   end subroutine print_target

   !> Mesh, increments and what else is varied.
   pure function described(row) result(words)
      type(trade_row_type), intent(in) :: row
      character(:), allocatable :: words

      words = mesh_of(row)//', increments '//trim(factor_of(row))
      if (row%varied /= '') words = words//', '//row%varied
   end function described

   !> Elements and mesh, such as Q8 x 2, or Q8 x 2:8 with contact levels.
   pure function mesh_of(row) result(name)
      type(trade_row_type), intent(in) :: row
      character(:), allocatable :: name

      associate (variation => row%variation)
         name = elements_of(row)//' x '//to_text(2**variation%levels)
         if (variation%contact_levels > 0) name = name//':'// &
            to_text(2**(variation%levels + variation%contact_levels))
      end associate
   end function mesh_of

   pure character(2) function elements_of(row)
      type(trade_row_type), intent(in) :: row

      elements_of = merge('Q8', 'Q4', row%variation%order == 2)
   end function elements_of

   !> Factor on the increments, such as x 1/4.
   pure function factor_of(row) result(text)
      type(trade_row_type), intent(in) :: row
      character(6) :: text

      associate (factor => row%variation%increments)
         text = 'x '//to_text(nint(factor))
         if (factor < 1.0_dp) text = 'x 1/'//to_text(nint(1.0_dp/factor))
      end associate
   end function factor_of

   !> Errors in percent.
   pure function cells(errors) result(text)
      real(dp), intent(in) :: errors(:)
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(errors)
         if (.not. is_there(errors(i))) then
            text = text//right('-')
         else if (100.0_dp*errors(i) >= 1000.0_dp) then
            text = text//right('> 1000')
         else
            text = text//right(few_digits(100.0_dp*errors(i)))
         end if
      end do
   end function cells

   pure character(9) function right(words)
      character(*), intent(in) :: words

      right = words
      right = adjustr(right)
   end function right

   !> Writes the CSV file. Its last row, `reference`, holds the uncertainty of the reference; errors
   !> are relative, and absent values are empty.
   !> Error: status_internal, when the file cannot be written.
   subroutine write_trade(path, trade, error)
      character(*), intent(in) :: path                     !! the file
      type(trade_type), intent(in) :: trade
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: text
      integer :: i

      text = 'row,default,elements,level,contact_level,increment_factor,varied,status,reason,'// &
         'increments,passes,runs,cpu_seconds,peak_megabytes'
      do i = 1, quantity_count
         text = text//',error_'//trim(traded(i)%name)
      end do
      text = text//',error_worst,pareto,recommended_10,recommended_1,recommended_0.1'//new_line('a')
      do i = 1, size(trade%rows)
         text = text//csv_line(i, trade%rows(i), trade)//new_line('a')
      end do
      call write_file(path, text//'reference'//repeat(',', 13)//fields([trade%uncertainty, &
         maxval(trade%uncertainty)])//repeat(',', target_count + 1)//new_line('a'), error)
   end subroutine write_trade

   pure function csv_line(number, row, trade) result(line)
      integer, intent(in) :: number
      type(trade_row_type), intent(in) :: row
      type(trade_type), intent(in) :: trade
      character(:), allocatable :: line
      integer :: k

      associate (variation => row%variation)
         line = to_text(number)//','//merge('1', '0', row%is_default)//','//elements_of(row)// &
            ','//to_text(variation%levels)//','//to_text(variation%contact_levels)//','// &
            to_text(variation%increments)//','//row%varied//','//to_text(row%status)//','// &
            quoted(row%reason)//','//to_text(row%increments)//','//to_text(row%passes)//','// &
            to_text(size(row%cpu))//fields([row%cpu_seconds, row%peak_bytes/megabyte, &
            row%errors, row%worst])//','//merge('1', '0', row%is_optimal)
      end associate
      do k = 1, target_count
         line = line//','
         if (.not. row%is_recommended(k)) cycle
         if (trade%remarks(k)%value == '') then
            line = line//'all'
         else
            line = line//quoted('but not for '//trade%remarks(k)%value)
         end if
      end do
   end function csv_line

   !> Numbers after commas; absent ones are empty.
   pure function fields(numbers) result(text)
      real(dp), intent(in) :: numbers(:)
      character(:), allocatable :: text
      character(12) :: buffer
      integer :: i

      text = ''
      do i = 1, size(numbers)
         write (buffer, '(es12.5)') numbers(i)
         if (.not. is_there(numbers(i))) buffer = ''
         text = text//','//trim(adjustl(buffer))
      end do
   end function fields

end module trade_table
