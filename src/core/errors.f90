!> The one error type of the program. A procedure that can fail has
!> `type(error_type), allocatable, intent(out) :: error` as its last argument; its caller checks it
!> on the next line. Numbers that overflowed are an error, too.
module errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: dp
   implicit none
   private
   public :: error_type, place_type, set_error, status_ok, status_deck, status_no_convergence, &
      status_internal, status_verify, status_interrupted, check_finite

   integer, parameter :: status_ok = 0              !! solved
   integer, parameter :: status_deck = 1            !! the deck is wrong
   integer, parameter :: status_no_convergence = 2  !! an increment did not converge
   integer, parameter :: status_internal = 3        !! internal or I/O error
   integer, parameter :: status_verify = 4          !! a *VERIFY check failed
   integer, parameter :: status_interrupted = 5     !! ended by SIGINT or SIGTERM

   !> A place in a deck.
   type :: place_type
      integer :: image = 0    !! running number of the card image; 0 for the deck as a whole
      integer :: column = 1   !! byte in the image
   end type place_type

   !> An error and its exit status.
   type :: error_type
      integer :: status = status_internal      !! one of the status_* constants
      character(:), allocatable :: message     !! one sentence in plain words
      logical :: lacks_memory = .false.        !! whether it is that there is too little memory
      integer :: card = 0                      !! card image of the deck where it lies, if known
      integer :: column = 1                    !! byte in that image
   end type error_type

contains

   !> Raises an error.
   subroutine set_error(error, status, message, card)
      type(error_type), allocatable, intent(out) :: error !! the error that is raised
      integer, intent(in) :: status                       !! one of the status_* constants
      character(*), intent(in) :: message                 !! one sentence in plain words
      integer, intent(in), optional :: card               !! card image of the deck where it lies

      allocate(error)
      error%status = status
      error%message = message
      if (present(card)) error%card = card
   end subroutine set_error

   !> Raises an error where values overflowed.
   !> Error: the status given; some value is infinite or no number.
   subroutine check_finite(values, what, status, error)
      real(dp), intent(in) :: values(:)                   !! any values
      character(*), intent(in) :: what                    !! what they are, in the plural
      integer, intent(in) :: status                       !! one of the status_* constants
      type(error_type), allocatable, intent(out) :: error

      if (all(ieee_is_finite(values))) return
      call set_error(error, status, what//' overflow: values of the deck are too large, or too '// &
         'far apart')
   end subroutine check_finite

end module errors
