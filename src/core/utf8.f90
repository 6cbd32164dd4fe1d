!> Text in UTF-8: whether it is, Latin-1 as UTF-8, and what of it can be shown.
module utf8
   implicit none
   private
   public :: as_utf8, printable, character_count, first_byte

   character(*), parameter :: hexadecimal = '0123456789ABCDEF'

contains

   !> Text in UTF-8 as it is; any other text is read as Latin-1 and encoded in UTF-8.
   pure function as_utf8(string) result(encoded)
      character(*), intent(in) :: string           !! any bytes
      character(:), allocatable :: encoded         !! UTF-8
      integer :: code, i, n

      i = 1
      do while (i <= len(string))
         n = character_length(string, i)
         if (n == 0) exit
         i = i + n
      end do
      if (i > len(string)) then
         encoded = string
         return
      end if
      n = 0
      allocate (character(2*len(string)) :: encoded)
      do i = 1, len(string)
         code = iachar(string(i:i))
         if (code < 128) then
            encoded(n + 1:n + 1) = string(i:i)
            n = n + 1
         else
            encoded(n + 1:n + 2) = char(192 + code/64)//char(128 + modulo(code, 64))
            n = n + 2
         end if
      end do
      encoded = encoded(:n)
   end function as_utf8

   !> Text as a terminal or a text file may have it: each byte of a control character, and each that
   !> is no UTF-8, becomes four characters such as \x1B.
   pure function printable(string) result(shown)
      character(*), intent(in) :: string           !! any bytes
      character(:), allocatable :: shown           !! UTF-8 without control characters
      integer :: i, k, length, n
      logical :: is_shown

      do i = 1, len(string)
         if (iachar(string(i:i)) < 32 .or. iachar(string(i:i)) > 126) exit
      end do
      if (i > len(string)) then   ! as most texts
         shown = string
         return
      end if
      allocate (character(4*len(string)) :: shown)
      n = 0
      i = 1
      do while (i <= len(string))
         length = character_length(string, i)
         is_shown = length > 0 .and. iachar(string(i:i)) >= 32 .and. iachar(string(i:i)) /= 127
         ! Those of Unicode beyond ASCII.
         if (is_shown .and. iachar(string(i:i)) == 194) is_shown = iachar(string(i + 1:i + 1)) >= &
            160
         if (is_shown) then
            shown(n + 1:n + length) = string(i:i + length - 1)
            n = n + length
         else
            length = max(length, 1)
            do k = i, i + length - 1
               shown(n + 1:n + 4) = '\x'//digit(iachar(string(k:k))/16)// &
                  digit(modulo(iachar(string(k:k)), 16))
               n = n + 4
            end do
         end if
         i = i + length
      end do
      shown = shown(:n)
   end function printable

   pure character function digit(number)
      integer, intent(in) :: number

      digit = hexadecimal(number + 1:number + 1)
   end function digit

   !> Number of bytes of the character that begins at a byte, 1 to 4; 0 where these are no UTF-8.
   !>
   !> Source: The Unicode Standard 15.0, table 3-7, well-formed UTF-8 byte sequences.
   pure integer function character_length(string, i)
      character(*), intent(in) :: string   !! any bytes
      integer, intent(in) :: i             !! index of the first byte
      integer :: first, k, least, most, second

      character_length = 0
      first = iachar(string(i:i))
      least = 128
      most = 191
      select case (first)
      case (0:127)
         character_length = 1
         return
      case (194:223)
         k = 2
      case (224:239)
         k = 3
         if (first == 224) least = 160
         if (first == 237) most = 159
      case (240:244)
         k = 4
         if (first == 240) least = 144
         if (first == 244) most = 143
      case default
         return
      end select
      if (i + k - 1 > len(string)) return
      second = iachar(string(i + 1:i + 1))
      if (second < least .or. second > most) return
      do first = i + 2, i + k - 1
         if (iachar(string(first:first)) < 128 .or. iachar(string(first:first)) > 191) return
      end do
      character_length = k
   end function character_length

   !> Number of characters in text of UTF-8.
   pure integer function character_count(string)
      character(*), intent(in) :: string   !! UTF-8
      integer :: i

      character_count = count([(iachar(string(i:i)) < 128 .or. iachar(string(i:i)) >= 192, &
         i=1, len(string))])
   end function character_count

   !> First byte of the n-th character of a line in UTF-8; behind the line where it has fewer.
   pure integer function first_byte(line, n)
      character(*), intent(in) :: line   !! UTF-8
      integer, intent(in) :: n           !! from 1
      integer :: characters

      characters = 0
      do first_byte = 1, len(line)
         if (iachar(line(first_byte:first_byte)) < 128 .or. &
            iachar(line(first_byte:first_byte)) >= 192) characters = characters + 1
         if (characters == n) return
      end do
   end function first_byte

end module utf8
