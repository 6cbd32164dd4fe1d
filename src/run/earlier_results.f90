!> The result file of an earlier run, as far as another run goes on from it: its deck, and the
!> states that it keeps.
module earlier_results
   use card_fields, only: is_comment
   use deck_reader, only: keyword_of
   use deck_source, only: earlier_deck_type
   use errors, only: error_type, set_error, status_deck
   use hdf5_reader, only: hdf5_reader_type
   use hdf5_writer, only: start_hdf5
   use kinds, only: dp
   use restart_results, only: at_count, at_increment, at_increment_in_step, at_step, at_time, &
      names_set, place_columns, place_set, restart_group, value_set
   use run_summaries, only: stages
   use state_tables, only: state_table_type
   use text, only: string_type, to_text
   implicit none
   private
   public :: earlier_result_type, origin_type

   real(dp), parameter :: printed = 5.0e-6_dp   !! what six digits leave out of a time, relative

   !> Where a run goes on from.
   type :: origin_type
      character(:), allocatable :: path      !! of the result
      type(state_table_type) :: table        !! state of its run
      integer :: counts(2) = 0               !! restarts of the result up to it, and their values
      integer :: increment = 0               !! at whose end it is
      integer :: iterations = 0              !! of the increments up to it
      real(dp) :: seconds(size(stages)) = 0.0_dp   !! of the runs that were cut short [s]
      real(dp) :: time = 0.0_dp              !! total time there [time]
   contains
      procedure :: words => words_of_origin
   end type origin_type

   !> A result.
   type :: earlier_result_type
      character(:), allocatable :: path
      character(:), allocatable :: version    !! of the program that wrote it
      character(:), allocatable :: settings   !! options that its run was given
      type(string_type), allocatable :: images(:)   !! its deck
      logical :: is_finished = .false.        !! whether its run came to its end
      integer, allocatable :: iterations(:)   !! (increments) of those that it holds
      integer :: passed_checks = 0            !! *VERIFY checks
      integer :: failed_checks = 0            !! *VERIFY checks
      real(dp) :: seconds(size(stages)) = 0.0_dp   !! of its run [s]
      real(dp), allocatable, private :: places(:, :)   !! (columns, restarts) as place_set
   contains
      procedure :: read => read_result
      procedure :: check
      procedure :: find_difference
      procedure :: find_time
      procedure :: find_step
      procedure :: deck_until
      procedure :: own_earlier_deck
      procedure :: load
   end type earlier_result_type

contains

   !> Such as `old.vtkhdf, increment 12 (time 0.4)`.
   pure function words_of_origin(self) result(words)
      class(origin_type), intent(in) :: self
      character(:), allocatable :: words

      words = self%path//', increment '//to_text(self%increment)//' (time '//to_text(self%time)//')'
   end function words_of_origin

   !> Reads all but the states.
   !> Error: status_deck, when it is no result.
   subroutine read_result(self, path, error)
      class(earlier_result_type), intent(out) :: self
      character(*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error
      type(hdf5_reader_type) :: file
      real(dp), allocatable :: values(:)
      logical :: is_there
      integer :: i

      inquire (file=path, exist=is_there)
      if (.not. is_there) call set_error(error, status_deck, 'there is no result "'//path//'"')
      if (.not. allocated(error)) call start_hdf5(error)
      if (allocated(error)) return
      self%path = path
      call file%open(path)
      self%version = file%text('/run', 'version')
      self%settings = file%text('/run', 'settings')
      self%is_finished = file%number('/run', 'finished') > 0.0_dp
      self%passed_checks = nint(file%number('/run', 'verify_passed'))
      self%failed_checks = nint(file%number('/run', 'verify_failed'))
      do i = 1, size(stages)
         self%seconds(i) = file%number('/run', 'seconds_'//trim(stages(i)))
      end do
      call file%strings('/deck', self%images)
      call file%reals('/history/iterations', values)
      self%iterations = nint(values)
      deallocate (values)
      allocate (values(0))
      if (file%has(restart_group)) call file%reals(place_set, values)
      self%places = reshape(values, [place_columns, size(values)/place_columns])
      call file%close(error)
   end subroutine read_result

   !> Whether this program, with some options, can go on from it.
   !> Error: status_deck, with what is other.
   subroutine check(self, version, settings, error)
      class(earlier_result_type), intent(in) :: self
      character(*), intent(in) :: version, settings       !! of this run
      type(error_type), allocatable, intent(out) :: error

      if (self%version /= version) then
         call set_error(error, status_deck, '"'//self%path//'" is of thercon '//self%version// &
            ', not of '//version//': solve its deck anew')
      else if (self%settings /= settings) then
         call set_error(error, status_deck, '"'//self%path//'" was solved with '// &
            or_none(self%settings)//', this run has '//or_none(settings)//': give the same')
      end if
   end subroutine check

   pure function or_none(settings) result(words)
      character(*), intent(in) :: settings
      character(:), allocatable :: words

      words = settings
      if (settings == '') words = 'no --set, --accuracy or --errors'
   end function or_none

   !> The first card in which its deck differs from another one, comments aside.
   pure subroutine find_difference(self, images, words, image)
      class(earlier_result_type), intent(in) :: self
      type(string_type), intent(in) :: images(:)          !! of the other deck
      character(:), allocatable, intent(out) :: words     !! empty where there is none
      integer, intent(out) :: image                       !! of the other deck
      integer :: i, k
      character(:), allocatable :: was, is

      words = ''
      image = 0
      i = 0
      k = 0
      do
         call next_card(self%images, i, was)
         call next_card(images, k, is)
         if (was /= is) exit
         if (i > size(self%images)) return
      end do
      words = '"'//self%path//'" is of another deck, which has '//quoted(was)//' in place of '// &
         quoted(is)
      image = min(k, size(images))
   end subroutine find_difference

   pure function quoted(card) result(words)
      character(*), intent(in) :: card
      character(:), allocatable :: words

      words = '"'//card//'"'
      if (card == '') words = 'its end'
   end function quoted

   !> The next line that is no comment, without blanks at its end; empty behind the last one.
   pure subroutine next_card(images, i, card)
      type(string_type), intent(in) :: images(:)
      integer, intent(inout) :: i                         ! its image
      character(:), allocatable, intent(out) :: card

      card = ''
      do while (i <= size(images))
         i = i + 1
         if (i > size(images)) exit
         if (is_comment(images(i)%value)) cycle
         card = trim(images(i)%value)
         if (card /= '') return
      end do
      card = ''
   end subroutine next_card

   !> The restart nearest to a time, within the digits of the listing, or the last one of all.
   !> Error: status_deck, when there is none.
   subroutine find_time(self, time, restart, error)
      class(earlier_result_type), intent(in) :: self
      real(dp), allocatable, intent(in) :: time           !! unallocated: the last one
      integer, intent(out) :: restart
      type(error_type), allocatable, intent(out) :: error

      restart = size(self%places, 2)
      if (restart == 0) then
         call set_error(error, status_deck, '"'//self%path//'" keeps no state to go on from: '// &
            'give *RESTART, WRITE in its deck')
      else if (allocated(time)) then
         restart = minloc(abs(self%places(at_time, :) - time), dim=1)
         if (abs(self%places(at_time, restart) - time) > printed*abs(time)) call set_error(error, &
            status_deck, '"'//self%path//'" keeps no state at time '//to_text(time)//'; the '// &
            'nearest one is at time '//to_text(self%places(at_time, restart)))
      end if
   end subroutine find_time

   !> The restart at an increment of a step, or the last one of the step.
   !> Error: status_deck, when there is none.
   subroutine find_step(self, step, increment, restart, error)
      class(earlier_result_type), intent(in) :: self
      integer, intent(in) :: step
      integer, intent(in) :: increment                    !! in the step; 0: the last one
      integer, intent(out) :: restart
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: there(:)
      integer :: i

      there = pack([(i, i=1, size(self%places, 2))], nint(self%places(at_step, :)) == step)
      restart = 0
      if (size(there) == 0) then
         call set_error(error, status_deck, '"'//self%path//'" keeps no state of step '// &
            to_text(step))
         return
      end if
      restart = there(size(there))
      if (increment == 0) return
      restart = there(minloc(abs(self%places(at_increment_in_step, there) - increment), dim=1))
      i = nint(self%places(at_increment_in_step, restart))
      if (i /= increment) call set_error(error, status_deck, '"'//self%path//'" keeps no state '// &
         'at increment '//to_text(increment)//' of step '//to_text(step)//'; the nearest one '// &
         'is at increment '//to_text(i))
   end subroutine find_step

   !> Its deck up to the end of the step of a restart.
   pure function deck_until(self, restart) result(earlier)
      class(earlier_result_type), intent(in) :: self
      integer, intent(in) :: restart
      type(earlier_deck_type) :: earlier
      integer :: i, steps

      earlier%path = self%path
      steps = 0
      do i = 1, size(self%images)
         select case (keyword_of(self%images(i)%value))
         case ('STEP')
            if (steps == 0) earlier%steps = i - 1
            steps = steps + 1
         case ('ENDSTEP')
            if (steps == nint(self%places(at_step, restart))) exit
         case default
            cycle
         end select
      end do
      earlier%images = self%images(:min(i, size(self%images)))
   end function deck_until

   !> Of a deck that goes on from a result, and whose own result this is: the deck of the other one.
   pure subroutine own_earlier_deck(self, images, earlier, is_own)
      class(earlier_result_type), intent(in) :: self
      type(string_type), intent(in) :: images(:)          !! of the deck alone
      type(earlier_deck_type), intent(out) :: earlier
      logical, intent(out) :: is_own
      integer :: before, first, head, i, tail

      head = 0
      do while (head < size(images))
         if (keyword_of(images(head + 1)%value) == 'STEP') exit
         head = head + 1
      end do
      tail = size(images) - head
      is_own = .false.
      first = size(self%images) - tail
      if (first < head) return
      if (any([(self%images(first + i)%value /= images(head + i)%value, i=1, tail)])) return
      do before = 0, first - head
         is_own = all([(self%images(before + i)%value == images(i)%value, i=1, head)])
         if (is_own) exit
      end do
      if (.not. is_own) return
      earlier%path = self%path
      earlier%steps = before
      earlier%images = [self%images(:before), self%images(before + head + 1:first)]
   end subroutine own_earlier_deck

   !> Reads the state of a restart.
   !> Error: status_deck, when the file is damaged.
   subroutine load(self, restart, origin, error)
      class(earlier_result_type), intent(in) :: self
      integer, intent(in) :: restart
      type(origin_type), intent(out) :: origin
      type(error_type), allocatable, intent(out) :: error
      type(hdf5_reader_type) :: file
      type(string_type), allocatable :: names(:)
      real(dp), allocatable :: values(:)
      integer :: before, i, n

      origin%path = self%path
      origin%increment = nint(self%places(at_increment, restart))
      origin%time = self%places(at_time, restart)
      origin%iterations = sum(self%iterations(:origin%increment))
      ! A run that came to its end spent time on increments that this one does not have.
      if (.not. self%is_finished) origin%seconds = self%seconds
      associate (count => nint(self%places(at_count, :)))
         before = sum(count(:restart - 1))
         origin%counts = [restart, before + count(restart)]
      end associate
      call file%open(self%path)
      call file%strings(names_set, names)
      call file%reals(value_set, values, before + 1, origin%counts(2) - before)
      call file%close(error)
      if (allocated(error)) return
      n = size(names)
      associate (table => origin%table)
         allocate (table%names(n))
         table%arrays = n
         table%count = size(values) - n
         do i = 1, n
            table%names(i) = names(i)%value
         end do
         table%sizes = nint(values(:n))
         table%values = values(n + 1:)
      end associate
   end subroutine load

end module earlier_results
