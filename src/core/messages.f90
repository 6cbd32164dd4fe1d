!> Lines for a person at a terminal. All that the program prints goes through here: text of decks,
!> file names and options may hold control characters, which a terminal would obey.
module messages
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use file_calls, only: print_text
   use utf8, only: printable
   implicit none
   private
   public :: print_line, print_error, pass_on

contains

   !> Prints one line with its control characters made visible. What goes to stderr is there at
   !> once, in its place among the lines of stdout where both go to one file.
   subroutine print_line(unit, line)
      integer, intent(in) :: unit           !! open for formatted output, or output_unit
      character(*), intent(in) :: line      !! the line, without its end
      integer :: status

      if (unit == output_unit) then
         call print_text(printable(line)//new_line('a'))
      else if (unit == error_unit) then
         call pass_on(printable(line))
      else
         write (unit, '(a)', iostat=status) printable(line)
         if (status /= 0) return   ! there is nobody left to tell
      end if
   end subroutine print_line

   !> Prints lines on stderr, such as those of another process of the program.
   subroutine pass_on(lines)
      character(*), intent(in) :: lines     !! with line ends between them
      integer :: status

      write (error_unit, '(a)', iostat=status) lines
      if (status == 0) flush (error_unit, iostat=status)
      if (status /= 0) return   ! there is nobody left to tell
   end subroutine pass_on

   !> Prints an error on stderr as `subject: error: message`.
   subroutine print_error(subject, message)
      character(*), intent(in) :: subject   !! the deck as given, or the program
      character(*), intent(in) :: message   !! what went wrong

      call print_line(error_unit, subject//': error: '//message)
   end subroutine print_error

end module messages
