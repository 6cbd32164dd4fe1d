!> The files `.sta`, one line an accepted increment, and `.cvg`, one line an iteration. Lines wait
!> here until the result file that holds their increments is in place.
module status_files
   use errors, only: error_type
   use file_calls, only: check_in_place, read_file
   use increment_quantities, only: history_value, pass_value
   use listing_text, only: column, page_type, table_heads, table_row, to_right
   use open_files, only: close_descriptor, open_new_file, write_to_file
   use quantity_types, only: of_passes, quantity_type
   use records, only: increment_record_type
   use reported_quantities, only: quantities
   use solution_report, only: iteration_record_type
   use text, only: to_text
   implicit none
   private
   public :: status_file_type

   integer, parameter :: most_bytes = 1000000000   !! of an earlier file

   !> A file that grows by whole lines.
   type :: status_file_type
      private
      character(:), allocatable :: path               !! path of the file
      character(:), allocatable :: heading            !! first line; begins with no digit
      type(quantity_type), allocatable :: columns(:)  !! of `.cvg`
      integer :: descriptor = -1                      !! of the file while it is open
      type(page_type) :: page                         !! lines not yet written
   contains
      procedure :: start_increments
      procedure :: start_iterations
      procedure :: add_increment
      procedure :: add_iterations
      procedure :: go_on
      procedure :: empty
      procedure :: write_waiting
      procedure :: close => close_file
   end type status_file_type

contains

   !> Makes this the `.sta` file; nothing is touched yet.
   subroutine start_increments(self, path)
      class(status_file_type), intent(inout) :: self
      character(*), intent(in) :: path                !! its path

      self%path = path
      self%heading = 'increment  step            time            load  iterations  cut-backs'// &
         '    residual  heat imb.  force imb.'
   end subroutine start_increments

   !> Makes this the `.cvg` file; nothing is touched yet.
   subroutine start_iterations(self, path)
      class(status_file_type), intent(inout) :: self
      character(*), intent(in) :: path                !! its path

      self%path = path
      self%columns = pack(quantities, quantities%kind == of_passes)
      ! The first number of a line is its first character.
      self%columns(1)%width = len_trim(self%columns(1)%head)
      where (.not. self%columns%is_integer) self%columns%width = max(self%columns%width, 12)
      self%columns%is_plain = .false.
      self%heading = table_heads(self%columns)
   end subroutine start_iterations

   !> Adds the line of an accepted increment.
   subroutine add_increment(self, record)
      class(status_file_type), intent(inout) :: self      !! the `.sta` file
      type(increment_record_type), intent(in) :: record
      character(10) :: number

      number = to_text(record%increment)
      call self%page%line(number//to_right(to_text(record%step), 5)//column(record%time, 16, 8)// &
         column(record%load, 16, 8)//to_right(to_text(nint(history_value('iterations', record))), &
         12)//to_right(to_text(record%cut_backs), 11)//column(history_value('residual', record), &
         12, 3)//column(record%heat_imbalance, 11, 2)//column(record%force_imbalance, 11, 2))
   end subroutine add_increment

   !> Adds the lines of iterations.
   subroutine add_iterations(self, iterations)
      class(status_file_type), intent(inout) :: self            !! the `.cvg` file
      type(iteration_record_type), intent(in) :: iterations(:)  !! passes, in their order
      integer :: i, k

      do k = 1, size(iterations)
         associate (columns => self%columns)
            call self%page%line(adjustl(table_row(columns(:1), [pass_value(columns(1)%name, &
               iterations(k))]))//table_row(columns(2:), [(pass_value(columns(i)%name, &
               iterations(k)), i=2, size(columns))]))
         end associate
      end do
   end subroutine add_iterations

   !> Goes on behind the lines of an earlier file up to an increment, as far as it has them.
   subroutine go_on(self, path, increment)
      class(status_file_type), intent(inout) :: self
      character(*), intent(in) :: path                !! the earlier file
      integer, intent(in) :: increment                !! the last that is kept
      character(:), allocatable :: contents, fault
      integer :: first, last, number, status

      call read_file(path, most_bytes, contents, fault)
      first = 1
      do while (len(fault) == 0 .and. first <= len(contents))
         last = first + index(contents(first:)//new_line('a'), new_line('a')) - 2
         read (contents(first:min(last, first + 9)), *, iostat=status) number
         if (status == 0) then
            if (number <= increment) call self%page%line(contents(first:last))
         end if
         first = last + 2
      end do
   end subroutine go_on

   !> Empties the file of an earlier run and leaves it with its heading.
   !> Error: status_internal, when it cannot be written.
   subroutine empty(self, error)
      class(status_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call open_new_file(self%path, self%descriptor, error)
      if (.not. allocated(error)) call write_to_file(self%descriptor, self%path, &
         self%heading//new_line('a'), error)
   end subroutine empty

   !> Writes the lines that wait; the file was emptied before.
   !> Error: status_internal, when they cannot be written.
   subroutine write_waiting(self, error)
      class(status_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      character(:), allocatable :: lines

      call self%page%take(lines)
      call write_to_file(self%descriptor, self%path, lines, error)
      if (.not. allocated(error)) call check_in_place(self%path, self%descriptor, error)
   end subroutine write_waiting

   !> Closes the file.
   subroutine close_file(self)
      class(status_file_type), intent(inout) :: self

      if (self%descriptor >= 0) call close_descriptor(self%descriptor)
      self%descriptor = -1
   end subroutine close_file

end module status_files
