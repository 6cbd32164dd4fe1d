!> Where the run of a deck goes on from: the result that `--restart` names, its own one with
!> `--resume`, at the increment that *RESTART, READ or the command line says, or the last one kept.
module deck_origins
   use, intrinsic :: iso_fortran_env, only: error_unit
   use card_values, only: take_parameter
   use cards, only: cards_type
   use command_line, only: command_type, settings_in_words
   use deck_files, only: results_of, row_file_of
   use deck_reader, only: read_deck
   use deck_report, only: deck_report_type
   use deck_source, only: earlier_deck_type, place_type
   use earlier_results, only: earlier_result_type, origin_type
   use errors, only: error_type, set_error, status_deck
   use messages, only: print_line
   use version, only: program_version
   implicit none
   private
   public :: find_origin, reads_restart

   !> Cards that a deck with *RESTART, READ may have before its first step.
   character(*), parameter :: before_steps(*) = [character(12) :: 'HEADING', 'RESTART', &
      'AMPLITUDE', 'NSET', 'ELSET', 'SURFACE', 'TIME POINTS', 'VERIFY', 'STEP']

contains

   !> Finds where a run goes on from; a deck with *RESTART, READ is read again, behind the deck that
   !> it goes on from. Errors are reported.
   subroutine find_origin(path, command, cards, report, origin, finished)
      character(*), intent(in) :: path                    !! the deck as given
      type(command_type), intent(in) :: command           !! options of the command line
      type(cards_type), intent(inout) :: cards            !! of the deck
      type(deck_report_type), intent(inout) :: report
      type(origin_type), allocatable, intent(out) :: origin
      !> With --resume: the result that is finished, so that there is nothing to be done
      type(earlier_result_type), allocatable, intent(out) :: finished
      type(earlier_result_type) :: result
      type(earlier_deck_type) :: earlier
      type(error_type), allocatable :: error
      character(:), allocatable :: source
      type(place_type) :: place
      integer :: errors, restart
      logical :: has_row, is_there, reads

      has_row = .true.
      reads = reads_restart(cards)
      if (reads) place = cards%keywords(first_card(cards))%place
      errors = report%error_count()
      call check_read_cards(cards, reads, report)
      source = command%restart
      if (command%resumes) then
         source = results_of(path, command)//'.vtkhdf'
         inquire (file=source, exist=is_there)
         if (.not. is_there) source = ''
         if (command%row > 0) inquire (file=row_file_of(path, command), exist=has_row)
      end if
      if (reads .and. source == '') call report%error(place, &
         '*RESTART, READ goes on from a result: name it by --restart RESULT')
      if (source == '' .or. report%error_count() > merge(errors, 0, reads)) return
      call result%read(source, error)
      if (.not. allocated(error)) call result%check(program_version, settings_in_words(command), &
         error)
      if (.not. allocated(error)) call choose(command, cards, reads, result, earlier, restart, &
         error)
      if (allocated(error)) then
         if (error%card > 0) place = place_type(error%card)
      else if (restart == 0) then
         ! A row of a table is finished with its own file alone; else it is solved once more.
         if (.not. has_row) return
         finished = result
      end if
      if (.not. (allocated(error) .or. allocated(finished))) then
         allocate (origin)
         call result%load(restart, origin, error)
      end if
      if (allocated(error)) then
         if (allocated(origin)) deallocate (origin)
         if (command%resumes .and. .not. reads) then
            call print_line(error_unit, path//': note: begins again: '//error%message)
         else
            call report%error(place, error%message)
         end if
      else if (reads .and. .not. allocated(finished)) then
         call read_deck(path, command%width, command%settings, cards, report, earlier)
      end if
   end subroutine find_origin

   !> Whether a deck goes on from a result: its first card does, but for a title.
   pure logical function reads_restart(cards)
      type(cards_type), intent(in) :: cards

      reads_restart = first_card(cards) > 0
      if (reads_restart) reads_restart = cards%keywords(first_card(cards))%name == 'RESTART' .and. &
         cards%keywords(first_card(cards))%has('READ')
   end function reads_restart

   !> The first card that is no *HEADING; 0 for none.
   pure integer function first_card(cards)
      type(cards_type), intent(in) :: cards
      integer :: k

      first_card = 0
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name == 'HEADING') cycle
         first_card = k
         return
      end do
   end function first_card

   !> Reports READ elsewhere, and cards of a model where that is the one of the result.
   subroutine check_read_cards(cards, reads, report)
      type(cards_type), intent(in) :: cards
      logical, intent(in) :: reads                        ! whether the first card does
      type(deck_report_type), intent(inout) :: report
      integer :: k

      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (card%name == 'RESTART' .and. k > first_card(cards) .and. &
               card%has('READ')) call report%error(card%place_of('READ'), 'READ belongs on the '// &
               'first card of a deck behind *HEADING; the deck then has steps alone')
         end associate
      end do
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (.not. reads .or. card%name == 'STEP') exit
            if (all(card%name /= before_steps)) call report%error(card%place, '*'//card%name// &
               ' cannot follow *RESTART, READ: the model is that of the result')
         end associate
      end do
   end subroutine check_read_cards

   !> The restart to go on from; 0 where nothing is to be done.
   !> Error: status_deck, why there is none, with the card where the decks differ.
   subroutine choose(command, cards, reads, result, earlier, restart, error)
      type(command_type), intent(in) :: command
      type(cards_type), intent(in) :: cards
      logical, intent(in) :: reads                        ! whether the deck has *RESTART, READ
      type(earlier_result_type), intent(in) :: result
      type(earlier_deck_type), intent(out) :: earlier     ! the deck before that deck
      integer, intent(out) :: restart
      type(error_type), allocatable, intent(out) :: error
      type(deck_report_type) :: ignored
      character(:), allocatable :: words
      integer :: card, increment, step
      logical :: is_own

      restart = 0
      card = 0
      if (reads) then
         call result%own_earlier_deck(cards%images, earlier, is_own)
         words = ''
         if (command%resumes .and. .not. is_own) words = '"'//result%path// &
            '" is of another deck; name the result to go on from by --restart'
      else
         is_own = .true.
         call result%find_difference(cards%images, words, card)
      end if
      if (words /= '') then
         call set_error(error, status_deck, words)
         error%card = card
      else if (command%resumes .and. result%is_finished) then
         return
      else if (is_own) then
         call result%find_time(command%restart_time, restart, error)
      else
         ! What *RESTART, READ names by STEP= and INC=, or the command line by its time.
         step = 0
         increment = 0
         associate (read_card => cards%keywords(first_card(cards)))
            call take_parameter(read_card, 'STEP', ignored, step, '>=1')
            call take_parameter(read_card, 'INC', ignored, increment, '>=1')
         end associate
         if (step > 0 .and. allocated(command%restart_time)) then
            call set_error(error, status_deck, 'STEP= and --restart RESULT@TIME both say where '// &
               'to go on from: leave one out')
         else if (step > 0) then
            call result%find_step(step, increment, restart, error)
         else
            call result%find_time(command%restart_time, restart, error)
         end if
         if (.not. allocated(error)) earlier = result%deck_until(restart)
      end if
   end subroutine choose

end module deck_origins
