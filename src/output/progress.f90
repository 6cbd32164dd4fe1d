!> The progress line, for a person at a terminal.
module progress
   use, intrinsic :: iso_fortran_env, only: error_unit
   use clock, only: wall_seconds
   use file_calls, only: is_terminal
   use kinds, only: dp
   use listing_text, only: zone_counts
   use records, only: increment_record_type
   use text, only: to_text
   implicit none
   private
   public :: progress_type

   real(dp), parameter :: pause_seconds = 0.05_dp  !! between two updates of the line [s]
   integer, parameter :: line_length = 100         !! longest progress line
   character(*), parameter :: to_end_of_line = achar(27)//'[K'   !! erases what is behind

   !> The progress line.
   type :: progress_type
      private
      logical, public :: is_shown = .false. !! whether there is a terminal that wants it
      real(dp) :: last_update = 0.0_dp      !! when the line was last drawn [s]
      character(:), allocatable :: last     !! what the last increment came to
      integer, public :: round = 0          !! of a requested accuracy; 0: none
      real(dp), public :: since = 0.0_dp    !! when its run began, as wall_seconds [s]
      character(line_length) :: line = ''   !! what is there
   contains
      procedure :: start
      procedure :: begin_increment
      procedure :: take
      procedure :: say
      procedure :: clear
   end type progress_type

contains

   !> Prepares the line: it is shown on a terminal only.
   subroutine start(self, quiet)
      class(progress_type), intent(inout) :: self   !! the line
      logical, intent(in) :: quiet                  !! --quiet

      self%is_shown = .not. quiet
      if (self%is_shown) self%is_shown = is_terminal(2)
      self%last = ''
   end subroutine start

   !> Shows which increment is being solved, and what the last one came to. The line is drawn some
   !> times a second at most.
   subroutine begin_increment(self, number, planned)
      class(progress_type), intent(inout) :: self   !! the line
      integer, intent(in) :: number                 !! the increment
      integer, intent(in) :: planned                !! how many there will be

      if (.not. self%is_shown) return
      if (wall_seconds() - self%last_update < pause_seconds) return
      self%last_update = wall_seconds()
      call self%say('increment '//to_text(number)//' of '//to_text(planned)//self%last)
   end subroutine begin_increment

   !> Takes an increment that was accepted.
   subroutine take(self, record)
      class(progress_type), intent(inout) :: self         !! the line
      type(increment_record_type), intent(in) :: record
      integer :: zones(3)

      if (.not. self%is_shown) return
      zones = zone_counts(record%contacts)
      self%last = '  load '//to_text(record%load)
      if (allocated(record%iterations)) self%last = self%last//'  iterations '// &
         to_text(size(record%iterations))
      if (record%cut_backs > 0) self%last = self%last//'  cut-backs '//to_text(record%cut_backs)
      if (sum(zones) > 0) self%last = self%last//'  open '//to_text(zones(1))//', slip '// &
         to_text(zones(2))//', stick '//to_text(zones(3))
   end subroutine take

   !> Shows a line of words in place of the last one.
   subroutine say(self, words)
      class(progress_type), intent(inout) :: self   !! the line
      character(*), intent(in) :: words             !! what it says
      character(:), allocatable :: line

      if (.not. self%is_shown) return
      line = words
      if (self%round > 0) line = 'round '//to_text(self%round)//', '// &
         to_text(nint(wall_seconds() - self%since))//' s: '//words
      line = line(:min(len(line), line_length))
      if (self%line == line) return
      write (error_unit, '(3a)', advance='no') achar(13), line, to_end_of_line
      flush (error_unit)
      self%line = line
   end subroutine say

   !> Wipes the line away.
   subroutine clear(self)
      class(progress_type), intent(inout) :: self   !! the line

      if (self%line /= '') then
         write (error_unit, '(2a)', advance='no') achar(13), to_end_of_line
         flush (error_unit)
      end if
      self%line = ''
   end subroutine clear

end module progress
