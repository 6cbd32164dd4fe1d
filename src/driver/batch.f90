!> Several decks, some of them at a time. Each has a process of its own, so that what becomes of one
!> leaves the others alone.
module batch
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_ptr, c_size_t, c_sizeof
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use batch_ends, only: take_end
   use batch_table, only: print_batch, write_batch
   use clock, only: wall_seconds
   use command_line, only: command_type
   use deck_outcomes, only: deck_outcome_type
   use deck_run, only: base_name
   use deck_task, only: account_type, deck_task_type
   use errors, only: error_type, status_deck, status_internal, status_interrupted
   use file_calls, only: make_folder
   use interruption, only: catch_signals, caught_number, caught_signal, caught_times
   use messages, only: print_error
   use process_ends, only: process_end_type, signal_kill
   use processes, only: collect_process, pause_briefly, send_signal, start_process
   use progress, only: progress_type
   use shared_memory, only: message_file_type, share_memory
   use text, only: to_text
   use kinds, only: dp
   implicit none
   private
   public :: run_batch

   real(dp), parameter :: table_pause = 1.0_dp   !! between two writings of the CSV file [s]
   real(dp), parameter :: one_signal = 0.5_dp   !! time within which signals are one [s]

   !> A deck that is running.
   type :: slot_type
      integer :: deck = 0                    !! its number, 0 where the slot is free
      integer :: process = 0                 !! its process
      real(dp) :: since = 0.0_dp             !! when it began [s]
      logical :: is_killed = .false.         !! whether the batch was told twice to end
      type(message_file_type) :: messages = message_file_type()   !! what it printed
   end type slot_type

   !> All that a batch knows.
   type :: batch_type
      type(command_type) :: command                      !! decks and options
      type(deck_outcome_type), allocatable :: outcomes(:) !! (decks) how each ended
      type(account_type), pointer :: accounts(:) => null() !! (decks) what each says of itself
      type(slot_type), allocatable :: slots(:)           !! (jobs)
      type(progress_type) :: progress                    !! progress line
      integer :: started = 0                             !! decks that were started
      integer :: ended = 0                               !! decks that have ended
      integer :: failed = 0                              !! of these, with a status that is not 0
      integer :: forwarded = 0                           !! signals that were seen
      real(dp) :: signalled = 0.0_dp                     !! when the first was passed on [s]
      real(dp) :: written = 0.0_dp                       !! when the CSV file was written [s]
      integer :: in_file = 0                             !! decks that have ended in it
   end type batch_type

contains

   !> Solves the decks of a command. What goes wrong is printed on stderr.
   subroutine run_batch(command, status)
      type(command_type), intent(in) :: command   !! decks and options
      integer, intent(out) :: status              !! the largest of all
      type(batch_type) :: self
      type(error_type), allocatable :: error
      real(dp) :: since

      since = wall_seconds()
      call check_names(command, status)
      if (status /= 0) return
      call catch_signals()
      call prepare(self, command, error)
      if (allocated(error)) then
         call print_error('thercon', error%message)
         status = error%status
         return
      end if
      ! The table of an earlier batch must not be taken for that of this one.
      call write_table(self, error)
      if (allocated(error)) then
         call print_error('thercon', error%message)
         status = error%status
         return
      end if
      do while (any(self%slots%deck > 0) .or. &
         self%started < size(self%outcomes) .and. caught_signal() == '')
         call fill_slots(self)
         call collect(self)
         call pass_on_signals(self)
         call show_progress(self)
         if (wall_seconds() - self%written > table_pause .and. self%ended > self%in_file) then
            call write_table(self, error)
         end if
      end do
      call self%progress%clear()
      call leave_out_the_rest(self)
      status = maxval(self%outcomes%status)
      call write_table(self, error)
      if (allocated(error)) then
         call print_error('thercon', error%message)
         status = max(status, error%status)
      end if
      if (.not. command%quiet) call print_batch(output_unit, self%outcomes, wall_seconds() - since)
   end subroutine run_batch

   !> Two decks with the same results are an error before anything runs.
   subroutine check_names(command, status)
      type(command_type), intent(in) :: command
      integer, intent(out) :: status
      integer :: deck, other

      status = 0
      do deck = 2, size(command%decks)
         do other = 1, deck - 1
            if (base_name(command%decks(deck)%value) /= base_name(command%decks(other)%value)) then
               cycle
            end if
            call print_error('thercon', command%decks(other)%value//' and '// &
               command%decks(deck)%value//' would have the same results')
            status = status_deck
         end do
      end do
   end subroutine check_names

   !> Error: status_internal, where there is no memory to share.
   subroutine prepare(self, command, error)
      type(batch_type), intent(inout) :: self
      type(command_type), intent(in) :: command
      type(error_type), allocatable, intent(out) :: error
      type(account_type) :: account
      type(c_ptr) :: address
      integer :: i, decks

      decks = size(command%decks)
      call share_memory(decks*c_sizeof(account), address, error)
      if (allocated(error)) return
      call c_f_pointer(address, self%accounts, [decks])
      self%command = command
      allocate (self%outcomes(decks), self%slots(min(command%jobs, decks)))
      do i = 1, decks
         self%outcomes(i)%path = command%decks(i)%value
         self%outcomes(i)%ending = 'not run'
         self%outcomes(i)%reason = ''
      end do
      call self%progress%start(command%quiet)
      call make_folder(command%folder)
   end subroutine prepare

   !> Starts decks where slots are free.
   subroutine fill_slots(self)
      type(batch_type), intent(inout) :: self
      type(error_type), allocatable :: error
      integer :: s

      do s = 1, size(self%slots)
         if (self%slots(s)%deck > 0) cycle
         if (self%started == size(self%outcomes) .or. caught_signal() /= '') return
         call start_deck(self, self%started + 1, self%slots(s), error)
         if (.not. allocated(error)) then
            self%started = self%started + 1
         else if (any(self%slots%deck > 0)) then
            return   ! until one of those has ended
         else
            self%started = self%started + 1
            call refuse(self, self%started, error)
         end if
      end do
   end subroutine fill_slots

   subroutine start_deck(self, deck, slot, error)
      type(batch_type), intent(inout) :: self
      integer, intent(in) :: deck
      type(slot_type), intent(inout) :: slot
      type(error_type), allocatable, intent(out) :: error
      type(deck_task_type) :: task
      character(:), allocatable :: nothing

      slot = slot_type()
      call slot%messages%open(error)
      if (allocated(error)) return
      task%path = self%outcomes(deck)%path
      task%command = self%command
      task%account => self%accounts(deck)
      slot%since = wall_seconds()
      call start_process(task, slot%messages%descriptor, slot%process, error)
      if (allocated(error)) then
         call slot%messages%take(nothing)
         return
      end if
      slot%deck = deck
      self%outcomes(deck)%ending = 'running'
   end subroutine start_deck

   !> A deck for which the system has no process.
   subroutine refuse(self, deck, error)
      type(batch_type), intent(inout) :: self
      integer, intent(in) :: deck
      type(error_type), intent(in) :: error

      associate (outcome => self%outcomes(deck))
         outcome%status = status_internal
         outcome%ending = 'not run'
         outcome%reason = error%message
         call self%progress%clear()
         call print_error(outcome%path, error%message)
      end associate
      self%ended = self%ended + 1
      self%failed = self%failed + 1
   end subroutine refuse

   !> Takes what has ended; waits a moment where nothing has.
   subroutine collect(self)
      type(batch_type), intent(inout) :: self
      type(process_end_type) :: ended
      character(:), allocatable :: printed
      logical :: has_ended
      integer :: s

      call collect_process(has_ended, ended)
      if (.not. has_ended) then
         call pause_briefly()
         return
      end if
      s = findloc(self%slots%process == ended%process .and. self%slots%deck > 0, .true., dim=1)
      if (s == 0) return
      associate (slot => self%slots(s), outcome => self%outcomes(self%slots(s)%deck))
         call slot%messages%take(printed)
         outcome%seconds = wall_seconds() - slot%since
         call take_end(ended, self%accounts(slot%deck), printed, slot%is_killed, outcome)
         self%ended = self%ended + 1
         if (outcome%status /= 0) self%failed = self%failed + 1
         call self%progress%clear()
         if (len(printed) > 0) write (error_unit, '(a)') printed
         if (.not. self%command%quiet .and. outcome%status /= status_deck) then
            call outcome%print(self%command%folder//'/'//base_name(outcome%path))
         end if
         flush (output_unit)
         slot%deck = 0
      end associate
   end subroutine collect

   !> The first signal goes on to the decks, which end after their increments; a later one ends
   !> them. What comes at once, as from timeout, which signals a process and its group, is one.
   subroutine pass_on_signals(self)
      type(batch_type), intent(inout) :: self
      integer :: s
      logical :: is_first

      if (caught_times() == self%forwarded) return
      is_first = self%forwarded == 0
      self%forwarded = caught_times()
      if (is_first) self%signalled = wall_seconds()
      if (.not. is_first .and. wall_seconds() - self%signalled < one_signal) return
      do s = 1, size(self%slots)
         if (self%slots(s)%deck == 0) cycle
         if (is_first) then
            call send_signal(self%slots(s)%process, caught_number())
         else
            self%slots(s)%is_killed = .true.
            call send_signal(self%slots(s)%process, signal_kill)
         end if
      end do
   end subroutine pass_on_signals

   subroutine show_progress(self)
      type(batch_type), intent(inout) :: self
      character(:), allocatable :: line

      line = to_text(self%ended)//' of '//to_text(size(self%outcomes))//' decks ended, '// &
         to_text(count(self%slots%deck > 0))//' running, '//to_text(self%failed)//' failed'
      if (caught_signal() /= '') line = line//'; ending after their increments, again to kill'
      call self%progress%say(line)
   end subroutine show_progress

   !> Says which decks were not started because of a signal.
   subroutine leave_out_the_rest(self)
      type(batch_type), intent(inout) :: self
      integer :: i

      do i = self%started + 1, size(self%outcomes)
         associate (outcome => self%outcomes(i))
            outcome%status = status_interrupted
            outcome%reason = 'not started because of '//caught_signal()
            call print_error(outcome%path, outcome%reason)
         end associate
      end do
   end subroutine leave_out_the_rest

   subroutine write_table(self, error)
      type(batch_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call write_batch(self%command%folder, self%outcomes, error)
      self%written = wall_seconds()
      self%in_file = self%ended
   end subroutine write_table

end module batch
