!> One document in JSON (RFC 8259), in ASCII and on one line.
module json
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: dp
   use text, only: all_digits, to_text
   use utf8, only: as_utf8
   implicit none
   private
   public :: json_type

   !> A document, or members of one, while it grows.
   type :: json_type
      character(:), allocatable :: text       !! so far; unallocated before the first
   contains
      procedure :: open
      procedure :: close => close_bracket
      procedure :: put_members
      generic :: put => put_text, put_integer, put_real, put_logical
      procedure, private :: put_text
      procedure, private :: put_integer
      procedure, private :: put_real
      procedure, private :: put_logical
   end type json_type

contains

   !> Opens an object or a list.
   pure subroutine open(self, bracket, name)
      class(json_type), intent(inout) :: self
      character(1), intent(in) :: bracket            !! { or [
      character(*), intent(in), optional :: name     !! of the member of an object; none in a list

      call begin(self, name)
      self%text = self%text//bracket
   end subroutine open

   !> Closes what was opened last.
   pure subroutine close_bracket(self, bracket)
      class(json_type), intent(inout) :: self
      character(1), intent(in) :: bracket            !! } or ]

      self%text = self%text//bracket
   end subroutine close_bracket

   !> Adds a text: an element of a list, or a member of an object, which has a name.
   pure subroutine put_text(self, value, name)
      class(json_type), intent(inout) :: self
      character(*), intent(in) :: value
      character(*), intent(in), optional :: name

      call begin(self, name)
      self%text = self%text//quoted(value)
   end subroutine put_text

   pure subroutine put_integer(self, value, name)
      class(json_type), intent(inout) :: self
      integer, intent(in) :: value
      character(*), intent(in), optional :: name

      call begin(self, name)
      self%text = self%text//to_text(value)
   end subroutine put_integer

   !> Adds a number; null for one that is not finite.
   pure subroutine put_real(self, value, name)
      class(json_type), intent(inout) :: self
      real(dp), intent(in) :: value
      character(*), intent(in), optional :: name

      call begin(self, name)
      if (ieee_is_finite(value)) then
         self%text = self%text//all_digits(value)
      else
         self%text = self%text//'null'
      end if
   end subroutine put_real

   pure subroutine put_logical(self, value, name)
      class(json_type), intent(inout) :: self
      logical, intent(in) :: value
      character(*), intent(in), optional :: name

      call begin(self, name)
      self%text = self%text//trim(merge('true ', 'false', value))
   end subroutine put_logical

   !> Adds members of an object that are written already.
   pure subroutine put_members(self, members)
      class(json_type), intent(inout) :: self
      type(json_type), intent(in) :: members         !! may be none

      if (.not. allocated(members%text)) return
      call begin(self)
      self%text = self%text//members%text
   end subroutine put_members

   !> The comma and the name before a value.
   pure subroutine begin(self, name)
      class(json_type), intent(inout) :: self
      character(*), intent(in), optional :: name

      if (.not. allocated(self%text)) self%text = ''
      if (len(self%text) > 0) then
         if (scan(self%text(len(self%text):), '{[') == 0) self%text = self%text//', '
      end if
      if (present(name)) self%text = self%text//quoted(name)//': '
   end subroutine begin

   !> A text between quotes. Characters that are not printable ASCII become \u and four digits, two
   !> of these beyond U+FFFF.
   pure function quoted(words) result(string)
      character(*), intent(in) :: words
      character(:), allocatable :: string
      character(:), allocatable :: encoded
      integer :: code, i, k, more

      encoded = as_utf8(words)
      string = '"'
      i = 1
      do while (i <= len(encoded))
         code = iachar(encoded(i:i))
         more = count(code >= [192, 224, 240])
         if (more > 0) code = mod(code, 2**(6 - more))
         do k = i + 1, i + more
            code = 64*code + mod(iachar(encoded(k:k)), 64)
         end do
         i = i + 1 + more
         if (code >= 32 .and. code < 127 .and. code /= iachar('"') .and. code /= iachar('\')) then
            string = string//achar(code)
         else if (code < 65536) then
            string = string//escaped(code)
         else
            string = string//escaped(55296 + (code - 65536)/1024)//escaped(56320 + mod(code, 1024))
         end if
      end do
      string = string//'"'
   end function quoted

   pure function escaped(code) result(string)
      integer, intent(in) :: code
      character(6) :: string

      write (string, '(a, z4.4)') '\u', code
   end function escaped

end module json
