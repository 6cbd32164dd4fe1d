!> The table of a trade as a CSV file.
module trade_file
   use csv_fields, only: quoted
   use errors, only: error_type
   use kinds, only: dp
   use open_files, only: write_file
   use reported_quantities, only: traded
   use text, only: to_text
   use trade_quantities, only: is_there, quantity_count
   use trade_rows, only: trade_row_type, trade_type, target_count
   use trade_table, only: elements_of
   implicit none
   private
   public :: write_trade

   character(*), parameter :: first_columns = 'row,default,elements,level,contact_level,'// &
      'increment_factor,varied,status,reason,increments,passes,runs,cpu_seconds,peak_megabytes'
   character(3), parameter :: target_names(target_count) = ['10 ', '1  ', '0.1']

contains

   !> Writes the table. The last row, named `reference`, has what the reference is uncertain by;
   !> errors are relative, and fields of what there is not are empty.
   !> Error: status_internal, when the file cannot be written.
   subroutine write_trade(path, trade, error)
      character(*), intent(in) :: path                     !! the file
      type(trade_type), intent(in) :: trade
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: text
      integer :: i

      text = heading()//new_line('a')
      do i = 1, trade%count
         text = text//row_text(i, trade%rows(i), trade)//new_line('a')
      end do
      call write_file(path, text//reference_text(trade)//new_line('a'), error)
   end subroutine write_trade

   pure function heading() result(line)
      character(:), allocatable :: line
      integer :: i

      line = first_columns
      do i = 1, quantity_count
         line = line//',error_'//trim(traded(i)%name)
      end do
      line = line//',error_worst,pareto'
      do i = 1, target_count
         line = line//',recommended_'//trim(target_names(i))
      end do
   end function heading

   pure function row_text(number, row, trade) result(line)
      integer, intent(in) :: number
      type(trade_row_type), intent(in) :: row
      type(trade_type), intent(in) :: trade
      character(:), allocatable :: line
      integer :: i

      line = to_text(number)//','//flag(row%is_default)//','//elements_of(row)//','// &
         to_text(row%level)//','//to_text(row%contact_level)//','// &
         to_text(row%variation%increments)//','//row%varied//','// &
         to_text(row%status)//','//quoted(row%reason)//','//to_text(row%values%increments)//','// &
         to_text(row%values%passes)//','//to_text(size(row%cpu))//','// &
         scientific(row%cpu_seconds)//','//scientific(row%peak_bytes/1.0e6_dp)// &
         errors_text(row%errors)//','// &
         number_or_empty(row%worst)//','//flag(row%is_optimal)
      do i = 1, target_count
         line = line//','
         if (.not. row%is_recommended(i)) cycle
         if (len(trade%remarks(i)%value) == 0) then
            line = line//'all'
         else
            line = line//quoted('but not for '//trade%remarks(i)%value)
         end if
      end do
   end function row_text

   pure function reference_text(trade) result(line)
      type(trade_type), intent(in) :: trade
      character(:), allocatable :: line

      line = 'reference'//repeat(',', 13)//errors_text(trade%uncertainty)//','// &
         number_or_empty(maxval(trade%uncertainty))//repeat(',', target_count + 1)
   end function reference_text

   pure function errors_text(errors) result(text)
      real(dp), intent(in) :: errors(:)
      character(:), allocatable :: text
      integer :: q

      text = ''
      do q = 1, size(errors)
         text = text//','//number_or_empty(errors(q))
      end do
   end function errors_text

   pure function number_or_empty(number) result(text)
      real(dp), intent(in) :: number
      character(:), allocatable :: text

      text = ''
      if (is_there(number)) text = scientific(number)
   end function number_or_empty

   pure function scientific(number) result(text)
      real(dp), intent(in) :: number
      character(:), allocatable :: text
      character(16) :: buffer

      write (buffer, '(es12.5)') number
      text = trim(adjustl(buffer))
   end function scientific

   pure character(1) function flag(holds)
      logical, intent(in) :: holds

      flag = merge('1', '0', holds)
   end function flag

end module trade_file
