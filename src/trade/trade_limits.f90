!> What a row would cost, from the rows before it, and whether that is affordable.
module trade_limits
   use kinds, only: dp
   use text, only: append, string_type, to_text
   use trade_plan, only: find_row
   use trade_rows, only: trade_row_type, trade_type
   use trade_table, only: factor_text, mesh_of
   implicit none
   private
   public :: check_affordable, note_left_out

   !> From one level to the next the bodies' factors take 16 times the operations and 8 times the
   !> memory at most; small rows, which mostly start up, take less.
   real(dp), parameter :: growth_of_time(3) = [4.0_dp, 8.0_dp, 16.0_dp]   !! least, unknown, most
   real(dp), parameter :: growth_of_memory(3) = [1.0_dp, 4.0_dp, 8.0_dp]  !! alike
   real(dp), parameter :: part_of_memory = 0.7_dp    !! of what is free that rows may take
   real(dp), parameter :: kilobyte = 1024.0_dp       !! as /proc/meminfo counts [byte]

contains

   !> Says why a row is not affordable.
   subroutine check_affordable(trade, row, limit, jobs, reason)
      type(trade_type), intent(in) :: trade               !! the trade, its coarser rows run
      integer, intent(in) :: row                          !! index of the row
      real(dp), intent(in) :: limit                       !! CPU seconds that it may take [s]
      integer, intent(in) :: jobs                         !! rows that run beside each other
      character(:), allocatable, intent(out) :: reason    !! empty where it is affordable
      real(dp) :: seconds, bytes

      reason = ''
      call predict(trade, trade%rows(row), seconds, bytes)
      if (seconds < 0.0_dp) then
         reason = 'not on the mesh before'
      else if (seconds > limit) then
         reason = 'about '//to_text(nint(10.0_dp*seconds)/10.0_dp)//' s'
      else if (bytes > part_of_memory*free_bytes()/jobs) then
         reason = 'about '//to_text(nint(bytes/1.0e6_dp))//' MB'
      end if
   end subroutine check_affordable

   !> Notes that a row was left out; rows that differ in their increments share a line.
   pure subroutine note_left_out(row, reason, lines)
      type(trade_row_type), intent(in) :: row
      character(*), intent(in) :: reason                             !! why
      type(string_type), allocatable, intent(inout) :: lines(:)      !! receives it
      character(:), allocatable :: mesh, words

      mesh = mesh_of(row)//' with increments '
      words = trim(factor_text(row%variation%increments))//' ('//reason//')'
      if (size(lines) > 0) then
         associate (last => lines(size(lines)))
            if (index(last%value, mesh) == 1) then
               last%value = last%value//', '//words
               return
            end if
         end associate
      end if
      call append(lines, mesh//words)
   end subroutine note_left_out

   !> What a row would cost: what it did on the level before, times what that grew by there; 0 on
   !> the first level, below 0 where the level before has no such row. The levels before a first one
   !> at the contact faces are those of the whole mesh, which grow more.
   pure subroutine predict(trade, row, seconds, bytes)
      type(trade_type), intent(in) :: trade
      type(trade_row_type), intent(in) :: row
      real(dp), intent(out) :: seconds, bytes
      integer :: before(2), k, contact_level, level
      real(dp) :: growth(2)

      seconds = 0.0_dp
      bytes = 0.0_dp
      do k = 1, 2
         contact_level = max(row%contact_level - k, 0)
         level = row%level - (k - (row%contact_level - contact_level))
         before(k) = find_row(trade, row%order, level, contact_level, row%variation%increments)
      end do
      if (before(1) == 0) then
         if (row%level > 0 .or. row%contact_level > 0) seconds = -1.0_dp
         return
      end if
      associate (last => trade%rows(before(1)))
         growth = [growth_of_time(2), growth_of_memory(2)]
         if (before(2) > 0) growth = [last%cpu_seconds, last%peak_bytes]/ &
            max([trade%rows(before(2))%cpu_seconds, trade%rows(before(2))%peak_bytes], &
            [1.0e-3_dp, 1.0_dp])
         seconds = last%cpu_seconds*min(max(growth(1), growth_of_time(1)), growth_of_time(3))
         bytes = last%peak_bytes*min(max(growth(2), growth_of_memory(1)), growth_of_memory(3))
      end associate
   end subroutine predict

   !> Memory that is free, from the system; very much where it does not say.
   real(dp) function free_bytes()
      character(80) :: line
      integer :: unit, io
      real(dp) :: kilobytes

      free_bytes = huge(free_bytes)
      open (newunit=unit, file='/proc/meminfo', action='read', status='old', iostat=io)
      if (io /= 0) return
      do while (io == 0)
         read (unit, '(a)', iostat=io) line
         if (io /= 0 .or. index(line, 'MemAvailable:') /= 1) cycle
         read (line(len('MemAvailable:') + 1:), *, iostat=io) kilobytes
         if (io == 0) free_bytes = kilobyte*kilobytes
         exit
      end do
      close (unit)
   end function free_bytes

end module trade_limits
