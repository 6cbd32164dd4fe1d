!> The result file in the making: it grows beside the one in place, and is renamed over it once
!> closed. So the file in place is always a closed and complete one, whatever ends the program.
module working_files
   use clock, only: wall_seconds
   use errors, only: error_type
   use hdf5, only: hid_t
   use hdf5_helpers, only: close_file, create_file, open_file
   use kinds, only: dp
   use system_calls, only: copy_file, remove_file, rename_file
   implicit none
   private
   public :: working_file_type

   real(dp), parameter :: patience = 11.0_dp   !! pause between publishings, in costs of one
   real(dp), parameter :: usual_cost = 0.01_dp   !! what the first one is taken to cost [s]

   !> A file in place and the working copy beside it.
   type :: working_file_type
      private
      character(:), allocatable :: path          !! path of the file in place
      character(:), allocatable :: working_path  !! path of the working copy
      integer(hid_t), public :: id = -1          !! HDF5's handle while the working copy is open
      logical :: is_open = .false.               !! whether the working copy is open
      logical, public :: in_place = .false.      !! whether this run's file is in place
      real(dp) :: cost = 0.0_dp                  !! what the present publishing has cost so far [s]
      real(dp) :: last_cost = usual_cost         !! what the last one cost [s]
      real(dp) :: last_end = 0.0_dp              !! when it ended, at first when the run began [s]
   contains
      procedure :: start
      procedure :: open => open_working
      procedure :: close => close_working
      procedure :: put_in_place
      procedure :: is_due
      procedure :: charge
      procedure :: discard
   end type working_file_type

contains

   !> Names the files; nothing is touched yet.
   subroutine start(self, path)
      class(working_file_type), intent(inout) :: self  !! the file
      character(*), intent(in) :: path                 !! path of the file in place

      self%path = path
      self%working_path = path//'.tmp'
      self%last_end = wall_seconds()
   end subroutine start

   !> Opens the working copy: a new one at first (a killed run's leftover is replaced), later a copy
   !> of the file in place.
   !> Error: status_internal, when it cannot be written.
   subroutine open_working(self, is_new, error)
      class(working_file_type), intent(inout) :: self     !! the file
      logical, intent(out) :: is_new                      !! whether it is empty
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      is_new = .false.
      if (self%is_open) return
      if (self%in_place) then
         call copy_file(self%path, self%working_path, error)
         if (allocated(error)) return
         call open_file(self%working_path, self%id, error)
      else
         is_new = .true.
         call create_file(self%working_path, self%id, error)
      end if
      self%is_open = .not. allocated(error)
   end subroutine open_working

   !> Closes the working copy.
   !> Error: status_internal, when the rest cannot be written.
   subroutine close_working(self, error)
      class(working_file_type), intent(inout) :: self     !! the file
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      self%is_open = .false.
      call close_file(self%id, error)
   end subroutine close_working

   !> Renames the closed working copy over the file in place.
   !> Error: status_internal, when the system refuses.
   subroutine put_in_place(self, error)
      class(working_file_type), intent(inout) :: self     !! the file
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call rename_file(self%working_path, self%path, error)
      if (.not. allocated(error)) self%in_place = .true.
   end subroutine put_in_place

   !> Whether publishing now keeps the cost of it below a tenth of the run time.
   function is_due(self) result(due)
      class(working_file_type), intent(in) :: self  !! the file
      logical :: due                                !! whether it does

      due = wall_seconds() - self%last_end > patience*(self%last_cost + self%cost)
   end function is_due

   !> Books time that was spent on publishing.
   subroutine charge(self, since, ended)
      class(working_file_type), intent(inout) :: self  !! the file
      real(dp), intent(in) :: since                    !! when the work began [s]
      logical, intent(in) :: ended                     !! whether the file is in place now

      self%cost = self%cost + (wall_seconds() - since)
      if (.not. ended) return
      self%last_cost = self%cost
      self%cost = 0.0_dp
      self%last_end = wall_seconds()
   end subroutine charge

   !> Drops the working copy.
   subroutine discard(self)
      class(working_file_type), intent(inout) :: self  !! the file
      type(error_type), allocatable :: ignored

      if (self%is_open) call self%close(ignored)
      call remove_file(self%working_path)
   end subroutine discard

end module working_files
