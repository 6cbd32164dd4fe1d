!> What a failed assertion says.
module funit_messages
   use, intrinsic :: iso_fortran_env, only: int64, real64
   implicit none
   private
   public :: difference, shape_difference, subscripts, to_text

   !> A number as text, reals with all their digits.
   interface to_text
      module procedure integer_to_text, long_to_text, real_to_text
   end interface to_text

contains

   !> Expected and found.
   pure function difference(expected, actual, place) result(message)
      character(*), intent(in) :: expected             !! as text
      character(*), intent(in) :: actual               !! as text
      character(*), intent(in), optional :: place      !! such as (2,1); empty for a scalar
      character(:), allocatable :: message             !! one line each

      message = '    expected: '//expected//new_line('a')//'       found: '//actual
      if (.not. present(place)) return
      if (place /= '') message = message//new_line('a')//'    at index: '//place
   end function difference

   !> Two shapes that are not the same.
   pure function shape_difference(expected, actual) result(message)
      integer, intent(in) :: expected(:)         !! shape expected
      integer, intent(in) :: actual(:)           !! shape found
      character(:), allocatable :: message       !! one line each

      message = '    arrays of different shapes'//new_line('a')// &
         difference(list_text(expected), list_text(actual))
   end function shape_difference

   !> Subscripts of an element.
   pure function subscripts(element, array_shape) result(string)
      integer, intent(in) :: element             !! its place in storage order, from 1
      integer, intent(in) :: array_shape(:)      !! shape; empty for a scalar
      character(:), allocatable :: string        !! such as (2,1); empty for a scalar
      integer :: i, rest, list(size(array_shape))

      string = ''
      if (size(array_shape) == 0) return
      rest = element - 1
      do i = 1, size(array_shape)
         list(i) = mod(rest, array_shape(i)) + 1
         rest = rest/array_shape(i)
      end do
      string = list_text(list)
   end function subscripts

   pure function list_text(list) result(string)
      integer, intent(in) :: list(:)
      character(:), allocatable :: string
      integer :: i

      string = '('
      do i = 1, size(list)
         if (i > 1) string = string//','
         string = string//to_text(list(i))
      end do
      string = string//')'
   end function list_text

   pure function integer_to_text(number) result(string)
      integer, intent(in) :: number
      character(:), allocatable :: string

      string = long_to_text(int(number, int64))
   end function integer_to_text

   pure function long_to_text(number) result(string)
      integer(int64), intent(in) :: number
      character(:), allocatable :: string
      character(20) :: buffer

      write (buffer, '(i0)') number
      string = trim(buffer)
   end function long_to_text

   pure function real_to_text(number) result(string)
      real(real64), intent(in) :: number
      character(:), allocatable :: string
      character(32) :: buffer

      write (buffer, '(g0.17)') number
      string = trim(adjustl(buffer))
   end function real_to_text

end module funit_messages
