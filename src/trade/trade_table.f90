!> The table of a trade as a person reads it.
module trade_table
   use heat_balance, only: sound_imbalance
   use kinds, only: dp
   use messages, only: print_line
   use recommendation, only: same_time
   use reported_quantities, only: traded
   use text, only: few_digits, percent, to_text, with_decimals
   use trade_quantities, only: is_there, quantity_count
   use trade_rows, only: trade_row_type, trade_type, target_count, targets
   implicit none
   private
   public :: print_trade, print_imbalances, elements_of, mesh_of, factor_text

   real(dp), parameter :: megabyte = 1.0e6_dp    !! [byte]

contains

   !> Prints the table, what was left out, and the rows that are recommended.
   subroutine print_trade(unit, name, trade)
      integer, intent(in) :: unit               !! where to
      character(*), intent(in) :: name          !! the deck
      type(trade_type), intent(in) :: trade
      integer :: i, q

      write (unit, '(3a)') name, ': speed against accuracy; errors in %, those of the reference', &
         ' included'
      write (unit, '(/, a)', advance='no') &
         ' row  mesh          incr.  number  varied           CPU s      MB'
      do q = 1, quantity_count
         write (unit, '(a9)', advance='no') trim(traded(q)%head)
      end do
      write (unit, '(a)') '    worst'
      do i = 1, trade%count
         call print_row(unit, i, trade%rows(i))
      end do
      write (unit, '(a, t66)', advance='no') '      reference uncertain by'
      do q = 1, quantity_count
         write (unit, '(a9)', advance='no') cell(trade%uncertainty(q))
      end do
      write (unit, '(/, /, 3a)') '* no row that takes at most ', &
         to_text(nint(1000.0_dp*same_time)), ' ms more is better (worst error); '// &
         '= the deck as written'
      if (any(trade%rows(:trade%count)%contact_level > 0)) write (unit, '(a)') &
         'x 1:4: sides are those of the deck''s mesh, at both contact faces divided by 4 '// &
         '(*REFINE, LEVELS=2, SURFACE=)'
      call print_instants(unit, trade)
      do i = 1, size(trade%left_out)
         write (unit, '(2a)') 'left out by --limit or memory: ', trade%left_out(i)%value
      end do
      if (allocated(trade%ended_early)) write (unit, '(a)') trade%ended_early
      write (unit, '(a)') ''
      do i = 1, target_count
         call print_target(unit, trade, i)
      end do
   end subroutine print_trade

   !> Prints a warning that names the rows that leave heat out of balance.
   subroutine print_imbalances(unit, name, trade)
      integer, intent(in) :: unit               !! where to
      character(*), intent(in) :: name          !! the deck
      type(trade_type), intent(in) :: trade
      character(:), allocatable :: rows
      integer :: i

      rows = ''
      do i = 1, trade%count
         associate (row => trade%rows(i))
            if (row%status /= 0 .or. row%values%imbalance <= sound_imbalance) cycle
            rows = rows//', row '//to_text(i)//' ('//percent(row%values%imbalance)// &
               comma(row%varied)//')'
         end associate
      end do
      if (len(rows) > 0) call print_line(unit, name//': warning: at the end of an increment '// &
         'heat is out of balance by more than 1 % of the largest rate '// &
         '(heat_imbalance_pointwise), left by the thermal scheme: '//rows(3:))
   end subroutine print_imbalances

   subroutine print_row(unit, number, row)
      integer, intent(in) :: unit, number
      type(trade_row_type), intent(in) :: row
      integer :: q

      write (unit, '(i4, 2a, 2x, a12, 2x, a6)', advance='no') number, &
         merge('*', ' ', row%is_optimal), merge('=', ' ', row%is_default), &
         padded(mesh_of(row)), factor_text(row%variation%increments)
      if (row%status == 0) then
         write (unit, '(i7)', advance='no') row%values%increments
      else
         write (unit, '(a7)', advance='no') '-'
      end if
      write (unit, '(2x, a14, f9.3, f8.1)', advance='no') shown(row%varied), row%cpu_seconds, &
         row%peak_bytes/megabyte
      if (row%status /= 0) then
         write (unit, '(4a)') '  failed (', to_text(row%status), '): ', row%reason
         return
      end if
      do q = 1, quantity_count
         write (unit, '(a9)', advance='no') cell(row%errors(q))
      end do
      write (unit, '(a9)') cell(row%worst)
   end subroutine print_row

   pure function padded(words) result(field)
      character(*), intent(in) :: words
      character(12) :: field

      field = words
   end function padded

   pure function shown(words) result(field)
      character(*), intent(in) :: words
      character(14) :: field

      field = words
   end function shown

   subroutine print_instants(unit, trade)
      integer, intent(in) :: unit
      type(trade_type), intent(in) :: trade
      character(:), allocatable :: times
      integer :: i

      times = ''
      do i = 1, size(trade%instants)
         times = times//' '//to_text(trade%instants(i))
      end do
      write (unit, '(2a)') 'compared at the times', times
   end subroutine print_instants

   subroutine print_target(unit, trade, target_index)
      integer, intent(in) :: unit, target_index
      type(trade_type), intent(in) :: trade
      integer :: i

      associate (rows => trade%rows(:trade%count), remark => trade%remarks(target_index)%value)
         i = findloc(rows%is_recommended(target_index), .true., dim=1)
         write (unit, '(2a)', advance='no') 'for ', percent(targets(target_index))
         if (i == 0) then
            write (unit, '(2a)') ': no row; ', remark
            return
         end if
         if (len(remark) > 0) write (unit, '(a)', advance='no') ', not of all quantities'
         write (unit, '(a, i0, 8a)') ': row ', i, ' (', mesh_of(rows(i)), ', increments ', &
            trim(factor_text(rows(i)%variation%increments))//comma(rows(i)%varied)//'), ', &
            with_decimals(rows(i)%cpu_seconds, 3), ' s of CPU'
         if (len(remark) > 0) write (unit, '(7x, 2a)') 'but not for ', remark
      end associate
   end subroutine print_target

   pure function comma(words) result(text)
      character(*), intent(in) :: words
      character(:), allocatable :: text

      text = ''
      if (len(words) > 0) text = ', '//words
   end function comma

   !> Elements of a row by their order.
   pure function elements_of(row) result(name)
      type(trade_row_type), intent(in) :: row
      character(2) :: name                      !! Q8 or Q4

      name = merge('Q8', 'Q4', row%order == 2)
   end function elements_of

   !> Elements and mesh of a row.
   pure function mesh_of(row) result(name)
      type(trade_row_type), intent(in) :: row
      character(:), allocatable :: name         !! such as Q8 x 2, or Q8 x 2:8 with contact levels

      name = elements_of(row)//' x '//to_text(2**row%level)
      if (row%contact_level > 0) name = name//':'//to_text(2**(row%level + row%contact_level))
   end function mesh_of

   !> A factor on the increments as one writes it.
   pure function factor_text(factor) result(text)
      real(dp), intent(in) :: factor    !! a power of two
      character(6) :: text              !! such as x 1/4

      if (factor < 1.0_dp) then
         text = 'x 1/'//to_text(nint(1.0_dp/factor))
      else
         text = 'x '//to_text(nint(factor))
      end if
   end function factor_text

   !> An error in percent, or - for none.
   pure function cell(error) result(text)
      real(dp), intent(in) :: error
      character(:), allocatable :: text

      text = '-'
      if (is_there(error)) text = few_digits(100.0_dp*error)
      if (100.0_dp*error >= 1000.0_dp) text = '> 1000'
   end function cell

end module trade_table
