!> Lines for a person at a terminal. All that the program prints goes through here: text of decks,
!> file names and options may hold control characters, which a terminal would obey.
module messages
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use file_calls, only: print_text
   use text, only: to_text
   use utf8, only: printable
   implicit none
   private
   public :: print_line, print_error, pass_on, message_type, append_message

   !> What is said of a deck.
   type :: message_type
      character(:), allocatable :: severity   !! error, warning or note
      character(:), allocatable :: file       !! as given
      integer :: line = 0                     !! 0 for the deck as a whole
      integer :: column = 0                   !! character in the line, likewise
      character(:), allocatable :: words      !! one sentence
   contains
      procedure :: as_line
   end type message_type

contains

   !> `file:line:column: severity: words`, or `file: severity: words` for the deck as a whole.
   pure function as_line(self) result(line)
      class(message_type), intent(in) :: self
      character(:), allocatable :: line

      line = self%file
      if (self%line > 0) line = line//':'//to_text(self%line)//':'//to_text(self%column)
      line = line//': '//self%severity//': '//self%words
   end function as_line

   !> Adds a message on a deck as a whole to a list.
   pure subroutine append_message(messages, severity, file, words)
      type(message_type), allocatable, intent(inout) :: messages(:)   !! unallocated for none
      character(*), intent(in) :: severity, file, words               !! as in message_type
      type(message_type) :: message

      ! gfortran never frees the components of a constructor within another one.
      message%severity = severity
      message%file = file
      message%words = words
      if (.not. allocated(messages)) allocate (messages(0))
      messages = [messages, message]
   end subroutine append_message

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
