!> The result file in the making: it grows beside the one in place, and is renamed over it once
!> closed. So the file in place is always a closed and complete one, whatever ends the program.
module working_files
   use clock, only: wall_seconds
   use errors, only: error_type, set_error, status_internal
   use file_calls, only: cannot_write, check_seal, copy_file, create_working_file, remove_file, &
      remove_working_files, rename_file, seal_file, sync_file, try_file, try_growth
   use hdf5_writer, only: hdf5_writer_type
   use kinds, only: dp
   implicit none
   private
   public :: working_file_type

   real(dp), parameter :: patience = 11.0_dp   !! pause between publishings, in costs of one
   !> An increment that takes longer is published at once: a signal may end the next one. [s]
   real(dp), parameter :: long_increment = 2.0_dp
   real(dp), parameter :: usual_cost = 0.01_dp   !! assumed cost of the first one [s]
   integer, parameter :: tried_bytes = 16384   !! room for these must be had before the run [byte]
   integer, parameter :: unlike_full = 65536   !! a disk that takes these is not full [byte]
   character(*), parameter :: extension = '.tmp'   !! of a working copy, as in file_calls.c

   !> A file in place and the working copy beside it.
   type :: working_file_type
      private
      character(:), allocatable, public :: path  !! path of the file in place
      character(:), allocatable :: working_path  !! path of the working copy, if there is one
      character(:), allocatable, public :: source   !! file of which the first copy is made, if any
      logical, public :: is_synced = .false.     !! whether it is on the disk before it is in place
      type(hdf5_writer_type), public :: content  !! writes the working copy while it is open
      logical, public :: in_place = .false.      !! whether this run's file is in place
      real(dp) :: last_cost = usual_cost         !! what the last one cost [s]
      real(dp) :: last_increment = 0.0_dp        !! when the last increment was accepted [s]
      real(dp) :: last_end = 0.0_dp              !! when it ended, at first when the run began [s]
   contains
      procedure :: start
      procedure :: reserve
      procedure :: open => open_working
      procedure :: close => close_working
      procedure :: put_in_place
      procedure :: is_due
      procedure :: note_publishing
      procedure :: check
      procedure :: discard
   end type working_file_type

contains

   !> Names the files; nothing is touched yet.
   subroutine start(self, path)
      class(working_file_type), intent(inout) :: self
      character(*), intent(in) :: path                 !! path of the file in place

      self%path = path
      self%last_end = wall_seconds()
      self%last_increment = self%last_end
   end subroutine start

   !> Tries whether both files can be written, and leaves none behind.
   !> Error: status_internal, when they cannot.
   subroutine reserve(self, has_lock, error)
      class(working_file_type), intent(inout) :: self     !! the file, named
      logical, intent(in) :: has_lock                     !! whether no other run writes it
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      character(:), allocatable :: reason

      if (has_lock) call remove_working_files(self%path)
      call try_file(self%path, error)
      if (allocated(error)) return
      call create_working_file(self%path, self%working_path, error)
      if (allocated(error)) return
      call try_growth(self%working_path, tried_bytes, reason)
      if (len(reason) > 0) call set_error(error, status_internal, cannot_write(self%path, reason))
      call self%discard()
   end subroutine reserve

   !> Opens the working copy: a new one at first, or a copy of the source; later one of the file in
   !> place.
   !> Error kept by `content`: status_internal, when it cannot be written.
   subroutine open_working(self, is_new)
      class(working_file_type), intent(inout) :: self
      logical, intent(out) :: is_new                      !! whether it is empty
      type(error_type), allocatable :: error

      is_new = .false.
      if (self%content%id >= 0) return
      call create_working_file(self%path, self%working_path, error)
      is_new = .not. (self%in_place .or. allocated(self%source))
      if (self%in_place .and. .not. allocated(error)) then
         call copy_file(self%path, self%working_path, error)
      else if (allocated(self%source) .and. .not. allocated(error)) then
         call check_seal(self%source, error)
         if (.not. allocated(error)) call copy_file(self%source, self%working_path, error)
      end if
      if (allocated(error)) then
         call move_alloc(error, self%content%error)
      else if (is_new) then
         call self%content%create(self%working_path)
      else
         call self%content%open(self%working_path)
      end if
   end subroutine open_working

   !> Error: the first one since the working copy was opened.
   subroutine check(self, error)
      class(working_file_type), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      if (allocated(self%content%error)) error = self%content%error
      call explain(self, error)
   end subroutine check

   !> Closes and seals the working copy.
   !> Error: the first one since it was opened; status_internal, when the rest cannot be written.
   subroutine close_working(self, error)
      class(working_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call self%content%close(error)
      if (.not. allocated(error)) call seal_file(self%working_path, error)
      call explain(self, error)
   end subroutine close_working

   !> Renames the closed working copy over the file in place.
   !> Error: status_internal, when the system refuses. The copy then stays, under a name that no
   !> later run takes for a leftover, and the message says where.
   subroutine put_in_place(self, error)
      class(working_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      type(error_type), allocatable :: still_there
      character(:), allocatable :: kept

      if (self%is_synced) call sync_file(self%working_path)
      call rename_file(self%working_path, self%path, error)
      if (allocated(error)) then
         kept = self%working_path(:len(self%working_path) - len(extension))
         call rename_file(self%working_path, kept, still_there)
         if (allocated(still_there)) kept = self%working_path
         error%message = error%message//'; the results are in "'//kept//'"'
      else
         self%in_place = .true.
      end if
      deallocate (self%working_path)
   end subroutine put_in_place

   !> Whether an increment that has just been accepted is to be published: where that keeps the cost
   !> of it below a tenth of the run time, or where increments are long.
   function is_due(self) result(due)
      class(working_file_type), intent(inout) :: self
      logical :: due                                   !! whether it does
      real(dp) :: now

      now = wall_seconds()
      due = now - self%last_end > patience*self%last_cost .or. &
         now - self%last_increment > long_increment
      self%last_increment = now
   end function is_due

   !> Notes that the file is in place now.
   subroutine note_publishing(self, since)
      class(working_file_type), intent(inout) :: self
      real(dp), intent(in) :: since                    !! when the work for that began [s]

      self%last_end = wall_seconds()
      self%last_cost = self%last_end - since
   end subroutine note_publishing

   !> Gives the system's reason to an error of HDF5, which tells none.
   subroutine explain(self, error)
      class(working_file_type), intent(in) :: self
      type(error_type), allocatable, intent(inout) :: error           !! the error, if there is one
      character(:), allocatable :: reason

      if (.not. (allocated(error) .and. allocated(self%working_path))) return
      call try_growth(self%working_path, unlike_full, reason)
      if (len(reason) == 0) reason = error%message
      error%message = cannot_write(self%path, reason)
   end subroutine explain

   !> Drops the working copy, where there is one.
   subroutine discard(self)
      class(working_file_type), intent(inout) :: self
      type(error_type), allocatable :: ignored

      call self%content%close(ignored)
      if (.not. allocated(self%working_path)) return
      call remove_file(self%working_path)
      deallocate (self%working_path)
   end subroutine discard

end module working_files
