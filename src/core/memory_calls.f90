!> How much memory the system lets the process have.
module memory_calls
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_null_char
   use errors, only: error_type, set_error, status_internal
   use kinds, only: dp, long
   use text, only: to_text
   implicit none
   private
   public :: allow_stack, check_memory

   integer, parameter :: source_length = 100
   real(dp), parameter :: megabyte = 1.0e6_dp   !! [byte]

   !> Stack of a run, what Linux gives by default: small decks need about 0.5 MB, long faces more.
   real(dp), parameter :: stack = 8*1024.0_dp**2   !! [byte]

   interface
      !> Least of the limits on resident memory [byte]: of the process (address space, less what of
      !> it is not resident), of its control groups, of the machine.
      real(c_double) function c_limit(source, length) bind(c, name='memory_limit')
         import :: c_char, c_double, c_int
         integer(c_int), value :: length
         character(kind=c_char), intent(out) :: source(length)
      end function c_limit

      !> Lets the stack grow to so many bytes [byte]; returns what it may have.
      real(c_double) function c_allow_stack(wanted) bind(c, name='memory_allow_stack')
         import :: c_double
         real(c_double), value :: wanted
      end function c_allow_stack
   end interface

contains

   !> Raises the soft limit of the stack, which this process and its children have, to what a run
   !> needs.
   !> Error: status_internal, when the hard limit is below it.
   subroutine allow_stack(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: allowed

      allowed = c_allow_stack(stack)
      if (allowed < stack) call set_error(error, status_internal, 'the stack may have '// &
         to_text(int(allowed/1024))//' kB and needs '//to_text(int(stack/1024))// &
         ' kB; raise its hard limit (ulimit -Hs)')
   end subroutine allow_stack

   !> Compares the memory that a run needs with what it may have.
   !> Error: status_internal, when it needs more.
   subroutine check_memory(needed, error)
      real(dp), intent(in) :: needed                       !! resident, at its largest [byte]
      type(error_type), allocatable, intent(out) :: error
      character(source_length, kind=c_char) :: source
      real(dp) :: limit

      source = c_null_char
      limit = c_limit(source, int(source_length, c_int))
      if (needed <= limit) return
      call set_error(error, status_internal, 'not enough memory: the run needs about '// &
         to_text(nint(needed/megabyte, long))//' MB and may use '// &
         to_text(nint(limit/megabyte, long))//' MB ('//source(:index(source, c_null_char) - 1)//')')
      error%lacks_memory = .true.
   end subroutine check_memory

end module memory_calls
