!> The table of a trade-off study, as text and as a CSV file.
module trade_table
   use, intrinsic :: iso_fortran_env, only: output_unit
   use balances, only: sound_imbalance
   use errors, only: error_type
   use kinds, only: dp
   use messages, only: print_line
   use open_files, only: replace_file
   use reported_quantities, only: traded
   use text, only: few_digits, percent, quoted, to_text, with_decimals
   use trade_study, only: is_there, quantity_count, same_time, target_count, targets, &
      trade_row_type, trade_type
   implicit none
   private
   public :: imbalanced_rows, print_trade, write_trade

   real(dp), parameter :: megabyte = 1.0e6_dp               !! [byte]
   character(*), parameter :: columns_of_row = 'row,default,elements,level,contact_level,'// &
      'increment_factor,varied,status,reason,increments,passes,runs,cpu_seconds,peak_megabytes'
   integer, parameter :: longest_line = 10000               !! reasons are shorter than half of it

contains

   !> Names the rows that leave heat out of balance; empty for none.
   pure function imbalanced_rows(trade) result(names)
      type(trade_type), intent(in) :: trade
      character(:), allocatable :: names
      integer :: i

      names = ''
      do i = 1, size(trade%rows)
         associate (row => trade%rows(i))
            if (row%status /= 0 .or. row%imbalance <= sound_imbalance) cycle
            names = names//', row '//to_text(i)//' ('//percent(row%imbalance)
            if (row%varied /= '') names = names//', '//row%varied
            names = names//')'
         end associate
      end do
      names = names(3:)
   end function imbalanced_rows

   !> Prints the table, the rows that were left out, and the recommendations on stdout.
   subroutine print_trade(name, table, trade)
      character(*), intent(in) :: name          !! the deck
      character(*), intent(in) :: table         !! the CSV file
      type(trade_type), intent(in) :: trade
      character(71 + 9*(quantity_count + 1)) :: head
      character(13) :: mesh
      character(16) :: varied
      character(71) :: line
      character(:), allocatable :: times
      integer :: i

      call say(name//': speed against accuracy; errors in %, those of the reference included')
      call say('')
      write (head, '(a, *(a9))') ' row  mesh           incr.  number  varied             CPU s'// &
         '      MB', (trim(traded(i)%head), i=1, quantity_count), 'worst'
      call say(trim(head))
      do i = 1, size(trade%rows)
         associate (row => trade%rows(i))
            mesh = mesh_of(row)
            varied = row%varied
            write (line, '(i4, 2a, 2x, a, 2x, a6, i7, 2x, a, f9.3, f8.1)') i, &
               merge('*', ' ', row%is_optimal), merge('=', ' ', row%is_default), mesh, &
               factor_of(row), row%increments, varied, row%cpu_seconds, row%peak_bytes/megabyte
            if (row%status == 0) call say(line//columns([row%errors, row%worst]))
            if (row%status /= 0) call say(line//'  failed ('//to_text(row%status)//'): '// &
               row%reason)
         end associate
      end do
      call say('      reference uncertain by'//repeat(' ', 40)//columns(trade%uncertainty))
      call say('')
      call say('* no row that takes at most '//to_text(nint(1000.0_dp*same_time))// &
         ' ms more is better (worst error); = the deck as written')
      if (any(trade%rows%variation%contact_levels > 0)) call say('x 1:4: sides are those of '// &
         'the deck''s mesh, at both contact faces divided by 4 (*REFINE, LEVELS=2, SURFACE=)')
      times = ''
      do i = 1, size(trade%instants)
         times = times//' '//to_text(trade%instants(i))
      end do
      call say('compared at the times'//times)
      do i = 1, size(trade%left_out)
         call say('left out by --limit: '//described(trade%left_out(i))//': '// &
            trade%left_out(i)%reason)
      end do
      if (allocated(trade%ended_early)) call say(trade%ended_early)
      call say('')
      do i = 1, target_count
         call print_target(trade, i)
      end do
      call say('table: '//table)
   end subroutine print_trade

   subroutine say(line)
      character(*), intent(in) :: line

      call print_line(output_unit, line)
   end subroutine say

   subroutine print_target(trade, k)
      type(trade_type), intent(in) :: trade
      integer, intent(in) :: k
      integer :: i

      associate (words => 'for '//percent(targets(k)), remark => trade%remarks(k)%value)
         i = findloc(trade%rows%is_recommended(k), .true., dim=1)
         if (i == 0) then
            call say(words//': no row; '//remark)
            return
         end if
         call say(words//': row '//to_text(i)//' ('//described(trade%rows(i))//'), '// &
            with_decimals(trade%rows(i)%cpu_seconds, 3)//' s of CPU')
         if (remark /= '') call say('       but not for '//remark)
      end associate
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

      associate (mesh => row%variation)
         name = row%elements//' x '//to_text(2**mesh%levels)
         if (mesh%contact_levels > 0) name = name//':'//to_text(2**(mesh%levels + &
            mesh%contact_levels))
      end associate
   end function mesh_of

   !> Factor on the increments, such as x 1/4.
   pure character(6) function factor_of(row)
      type(trade_row_type), intent(in) :: row

      associate (factor => row%variation%increments)
         factor_of = 'x '//to_text(nint(factor))
         if (factor < 1.0_dp) factor_of = 'x 1/'//to_text(nint(1.0_dp/factor))
      end associate
   end function factor_of

   !> Errors in percent.
   pure function columns(errors) result(text)
      real(dp), intent(in) :: errors(:)
      character(:), allocatable :: text
      character(9) :: column
      integer :: i

      text = ''
      do i = 1, size(errors)
         column = few_digits(100.0_dp*errors(i))
         if (100.0_dp*errors(i) >= 1000.0_dp) column = '> 1000'
         if (.not. is_there(errors(i))) column = '-'
         text = text//adjustr(column)
      end do
   end function columns

   !> Writes the CSV file. Its last row, `reference`, holds the uncertainty of the reference; errors
   !> are relative, and absent values are empty.
   !> Error: status_internal, when the file cannot be written.
   subroutine write_trade(path, trade, error)
      character(*), intent(in) :: path                     !! the file
      type(trade_type), intent(in) :: trade
      type(error_type), allocatable, intent(out) :: error
      character(longest_line) :: line
      character(:), allocatable :: text
      integer :: i, k

      write (line, '(*(a))') columns_of_row, (',error_'//trim(traded(i)%name), i=1, &
         quantity_count), ',error_worst,pareto,recommended_10,recommended_1,recommended_0.1'
      text = trim(line)//new_line('a')
      do i = 1, size(trade%rows)
         associate (row => trade%rows(i), mesh => trade%rows(i)%variation)
            write (line, '(*(g0, ","))') i, merge(1, 0, row%is_default), row%elements, &
               mesh%levels, mesh%contact_levels, to_text(mesh%increments), row%varied, &
               row%status, quoted(row%reason), row%increments, row%passes, size(row%cpu)
            text = text//trim(line)//fields([row%cpu_seconds, row%peak_bytes/megabyte, &
               row%errors, row%worst])//merge(',1', ',0', row%is_optimal)
            do k = 1, target_count
               text = text//','
               if (.not. row%is_recommended(k)) cycle
               if (trade%remarks(k)%value == '') text = text//'all'
               if (trade%remarks(k)%value /= '') text = text// &
                  quoted('but not for '//trade%remarks(k)%value)
            end do
         end associate
         text = text//new_line('a')
      end do
      text = text//'reference'//repeat(',', 14)//fields([trade%uncertainty, &
         maxval(trade%uncertainty)])//repeat(',', target_count + 1)//new_line('a')
      call replace_file(path, text, error)
   end subroutine write_trade

   !> Numbers between commas; absent ones are empty.
   pure function fields(numbers) result(text)
      real(dp), intent(in) :: numbers(:)
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(numbers)
         if (i > 1) text = text//','
         if (is_there(numbers(i))) text = text//to_text(numbers(i))
      end do
   end function fields

end module trade_table
