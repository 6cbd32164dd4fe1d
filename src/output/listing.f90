!> The print file `NAME.lst`: a summary, what is modelled and why, every increment, the verdicts,
!> the zone diagrams, all warnings, and the deck.
!>
!> The summary is known at the end only: its lines are blank until then, and written over. A draft
!> is kept in memory until it is whole; then it takes the place of what the file holds.
module listing
   use contact_points, only: contact_points_type, never_approached
   use due_output, only: table_is_due
   use errors, only: error_type
   use file_calls, only: check_in_place, copy_file
   use listing_head, only: checks, ending, print_model, summary_block
   use listing_increments, only: print_attempts, print_balances, print_body_errors, &
      print_increment, print_interface, print_interface_errors, print_maxima
   use listing_tables, only: print_contact_table, print_iterations, print_requested, print_verdicts
   use listing_text, only: page_width, print_deck, print_list, print_title, print_wrapped, &
      printed_text_type
   use materials, only: follows_temperature
   use mesh_bodies, only: body_name
   use model, only: follows_temperatures, model_type
   use open_files, only: append_to_file, close_descriptor, empty_file, lock_file, open_in_memory, &
      overwrite_in_file, unlock_file
   use records, only: increment_record_type
   use run_sizes, only: run_size_type
   use run_summaries, only: in_times, or_blank, run_entries, run_entry_type, run_summary_type
   use summary, only: summary_type
   use text, only: append, counted, string_type, to_text
   use verification, only: verifier_type
   use zone_diagram, only: zone_diagram_type
   implicit none
   private
   public :: listing_type

   !> An open listing.
   type :: listing_type
      private
      character(:), allocatable, public :: path                !! path of the file
      integer :: lock = -1                                     !! descriptor of the locked file
      integer :: descriptor = -1                               !! of what is written: it, or a draft
      character(:), allocatable :: draft                       !! path of the draft, if there is one
      type(printed_text_type) :: text                          !! what is not yet in the file
      type(zone_diagram_type), allocatable :: diagrams(:)      !! one an interface
      character(:), allocatable :: failure                     !! why the run ended early
      type(string_type), allocatable :: warnings(:)            !! of the run
      type(summary_type), public :: summary                    !! what the run comes to
      integer :: summary_start = 0                             !! bytes before it
   contains
      procedure :: reserve
      procedure :: open => open_listing
      procedure :: is_begun
      procedure :: add
      procedure :: add_failure
      procedure :: break_off
      procedure :: drop_draft
      procedure :: warn
      procedure :: finish
      procedure :: close => close_listing
   end type listing_type

contains

   !> Locks the file, so that no other run of the same name writes it, or goes on with a lock; its
   !> contents stay.
   !> Error: status_internal, when it cannot be written or another run has it.
   subroutine reserve(self, path, lock, has_lock, error)
      class(listing_type), intent(inout) :: self
      character(*), intent(in) :: path                    !! path of the file
      integer, intent(inout) :: lock                      !! its descriptor once locked; -1 before
      logical, intent(out) :: has_lock                    !! false where there are no locks
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      self%path = path
      has_lock = .true.
      if (lock < 0) call lock_file(path, lock, has_lock, error)
      self%lock = lock
      self%descriptor = lock
      if (.not. allocated(error)) call self%text%open(error)
   end subroutine reserve

   !> Begins the reserved listing: heading, room for the summary, defaults, what is modelled.
   !> Error: status_internal, when the file cannot be written.
   subroutine open_listing(self, is_draft, model, interfaces, run, error)
      class(listing_type), intent(inout) :: self
      logical, intent(in) :: is_draft                     !! whether the file stays until the end
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(run_summary_type), intent(in) :: run
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      character(:), allocatable :: lines
      type(string_type), allocatable :: running(:)

      if (is_draft) then
         call open_in_memory(self%descriptor, self%draft, error)
      else
         call empty_file(self%descriptor, self%path, error)
      end if
      if (allocated(error)) return
      allocate(self%diagrams(size(interfaces)), self%warnings(0))
      call print_heading(self%text%unit, model, run)
      call print_title(self%text%unit, 'SUMMARY')
      call self%text%take(lines)
      self%summary_start = len(lines)
      allocate (running(0))
      call append(running, 'not finished: the run is still in progress, or was killed')
      lines = lines//summary_block(running, size(interfaces), size(model%steps), &
         merge(model%mesh%body_count, 0, model%estimates_errors))
      call append_to_file(self%descriptor, self%path, lines, error)
      if (allocated(error)) return
      call print_list(self%text%unit, 'DEFAULTS AND IGNORED CARDS', model%notes)
      call print_model(self%text%unit, model, interfaces, run)
      call print_title(self%text%unit, 'INCREMENTS')
      call write_text(self, error)
   end subroutine open_listing

   !> Whether the file holds anything of this run.
   pure logical function is_begun(self)
      class(listing_type), intent(in) :: self

      is_begun = allocated(self%warnings)
   end function is_begun

   !> Writes what was printed.
   !> Error: status_internal, when the file cannot be written.
   subroutine write_text(self, error)
      class(listing_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: lines

      call self%text%take(lines)
      call append_to_file(self%descriptor, self%path, lines, error)
   end subroutine write_text

   !> Adds the block of an accepted increment, with its PRINT tables where these are due.
   !> Error: status_internal, when the file cannot be written.
   subroutine add(self, record, model, interfaces, error)
      class(listing_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer :: i

      call self%summary%take(model, interfaces, record)
      call print_increment(self%text%unit, record)
      do i = 1, size(interfaces)
         call print_interface(self%text%unit, interfaces(i), record%contacts(i))
         call self%diagrams(i)%add(record, record%contacts(i)%contact_state)
      end do
      call print_balances(self%text%unit, record, model%steps(record%step)%analysis)
      call print_body_errors(self%text%unit, record)
      call print_warnings(self, record)
      if (allocated(record%errors) .and. model%estimates_errors) then
         do i = 1, size(interfaces)
            call print_interface_errors(self%text%unit, interfaces(i), record%errors(i))
         end do
         do i = 1, size(record%body_errors)
            call print_maxima(self%text%unit, model%mesh, i, record%body_errors(i))
         end do
      end if
      call print_requested(self%text%unit, record, model)
      if (table_is_due(model%steps(record%step)%contact_print_frequency, &
         model%steps(record%step)%contact_print_points, record, model)) then
         do i = 1, size(interfaces)
            call print_contact_table(self%text%unit, interfaces(i), record%contacts(i), &
               model%mesh%node_number)
         end do
      end if
      call write_text(self, error)
   end subroutine add

   !> Says why the run ended early; prints the attempts at an increment that failed, and the passes
   !> of the last one.
   subroutine add_failure(self, reason, record, kept)
      class(listing_type), intent(inout) :: self
      character(*), intent(in) :: reason                     !! what went wrong
      type(increment_record_type), intent(in) :: record      !! that increment; empty for none
      character(*), intent(in) :: kept                       !! what the results hold, a sentence

      self%failure = reason
      call print_title(self%text%unit, 'ENDED EARLY')
      call print_wrapped(self%text%unit, '   ', reason)
      call print_wrapped(self%text%unit, '   ', kept)
      if (allocated(record%failed)) call print_attempts(self%text%unit, record%failed)
      if (allocated(record%iterations)) call print_iterations(self%text%unit, &
         pack(record%iterations, record%iterations%cut_backs == record%cut_backs))
   end subroutine add_failure

   !> Ends the listing, where it is open, with the reason why the run cannot go on; whether there is
   !> room for that is not asked.
   subroutine break_off(self, reason)
      class(listing_type), intent(inout) :: self
      character(*), intent(in) :: reason                     !! what went wrong
      type(error_type), allocatable :: ignored

      if (.not. allocated(self%warnings)) return
      call print_title(self%text%unit, 'ENDED EARLY')
      call print_wrapped(self%text%unit, '   ', reason)
      call write_text(self, ignored)
   end subroutine break_off

   !> Drops a draft; what the file holds stays, and the reason why there is no more follows it.
   subroutine drop_draft(self, reason, record, kept)
      class(listing_type), intent(inout) :: self
      character(*), intent(in) :: reason                     !! what went wrong
      type(increment_record_type), intent(in) :: record      !! as for add_failure
      character(*), intent(in) :: kept                       !! what the results hold, a sentence
      character(:), allocatable :: dropped
      type(error_type), allocatable :: ignored

      call close_draft(self)
      if (self%text%unit == 0) return   ! not reserved: another run writes the file
      call self%text%take(dropped)
      call self%add_failure(reason, record, kept)
      call write_text(self, ignored)
   end subroutine drop_draft

   !> From now on the file itself is written.
   subroutine close_draft(self)
      class(listing_type), intent(inout) :: self

      if (allocated(self%draft)) then
         call close_descriptor(self%descriptor)
         deallocate (self%draft)
      end if
      self%descriptor = self%lock
   end subroutine close_draft

   !> Takes the warnings of the run as a whole.
   subroutine warn(self, warnings)
      class(listing_type), intent(inout) :: self
      type(string_type), intent(in) :: warnings(:)
      integer :: i

      do i = 1, size(warnings)
         call append(self%warnings, warnings(i)%value)
      end do
   end subroutine warn

   !> Ends the listing that is open: verdicts, zone diagrams, all warnings again, times, the deck;
   !> then the summary in the room that was left for it.
   !> Error: status_internal, when its end cannot be written.
   subroutine finish(self, model, interfaces, cards, verifier, run, error)
      class(listing_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(string_type), intent(in) :: cards(:)           !! card images as read
      type(verifier_type), intent(in) :: verifier         !! what came of the *VERIFY cards
      type(run_summary_type), intent(in) :: run           !! the whole run
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      type(string_type), allocatable :: lines(:), warnings(:)
      character(:), allocatable :: block
      type(run_entry_type), allocatable :: entries(:)
      logical, allocatable :: is_time(:)
      integer :: i

      if (size(verifier%outcomes) > 0) call print_verdicts(self%text%unit, model%verifications, &
         verifier%outcomes)
      do i = 1, size(interfaces)
         call self%diagrams(i)%print(self%text%unit, interfaces(i))
      end do
      call print_list(self%text%unit, 'REQUESTED ACCURACY', run%accuracy%targets)
      if (size(run%accuracy%rounds) > 0) write (self%text%unit, '()')
      do i = 1, size(run%accuracy%rounds)
         write (self%text%unit, '(2x, a)') run%accuracy%rounds(i)%value
      end do
      call print_unapproached(self%text%unit, model%mesh%node_number, interfaces, self%summary)
      warnings = model%warnings
      do i = 1, size(self%warnings)
         call append(warnings, self%warnings(i)%value)
      end do
      call print_list(self%text%unit, 'WARNINGS', warnings)
      if (size(warnings) == 0) write (self%text%unit, '(/, a)') 'No warnings.'
      entries = run_entries(run, model)
      is_time = [(entries(i)%is_told(in_times), i=1, size(entries))]
      call print_title(self%text%unit, 'SECONDS')
      write (self%text%unit, '(3x, *(a12))') (entries(i)%label, i=findloc(is_time, .true., dim=1), &
         findloc(is_time, .true., dim=1, back=.true.))
      write (self%text%unit, '(3x, *(f12.4))') pack(entries%number, is_time)
      if (any(model%steps%is_transient) .or. follows_temperatures(model)) write (self%text%unit, &
         '(/, 3x, a)') 'The matrix of heat was factored '//counted(run%sizes%heat_factored, &
         'time')//' in '//counted(self%summary%increment, 'increment')//'.'
      if (follows_temperatures(model)) call print_bodies(self%text%unit, model, run%sizes)
      call print_deck(self%text%unit, cards)
      call write_text(self, error)
      if (allocated(error)) return
      allocate (lines(0))
      call append(lines, ending(allocated(self%failure), self%summary%increment, &
         run%verify_failed, run%accuracy%missed /= '', run%accuracy%later_round))
      call append(lines, checks(verifier, run))
      if (size(warnings) == 0) call append(lines, 'no warnings')
      if (size(warnings) > 0) call append(lines, counted(size(warnings), 'warning')// &
         ', see WARNINGS below')
      call self%summary%add_lines(model, interfaces, lines)
      block = summary_block(lines, size(interfaces), size(model%steps), &
         merge(model%mesh%body_count, 0, model%estimates_errors))
      call overwrite_in_file(self%descriptor, self%path, self%summary_start, block, error)
      if (allocated(error)) return
      if (allocated(self%draft)) call copy_file(self%draft, self%path, error)
      if (.not. allocated(error)) call check_in_place(self%path, self%lock, error)
   end subroutine finish

   !> Frees the file; one in which nothing was written is removed. One that is not reserved stays.
   subroutine close_listing(self, keeps_lock)
      class(listing_type), intent(inout) :: self
      logical, intent(in) :: keeps_lock   !! whether the file stays locked

      call self%text%close()
      call close_draft(self)
      if (self%lock >= 0 .and. .not. keeps_lock) call unlock_file(self%path, self%lock)
      self%lock = -1
   end subroutine close_listing

   subroutine print_heading(unit, model, run)
      integer, intent(in) :: unit
      type(model_type), intent(in) :: model
      type(run_summary_type), intent(in) :: run
      integer :: now(8)

      call date_and_time(values=now)
      write (unit, '(a)') repeat('=', page_width)
      write (unit, '(3a, t112, i4.4, 2("-", i2.2), 1x, 2(i2.2, ":"), i2.2)') 'THERCON ', &
         or_blank(run%version), '   THERMOMECHANICAL CONTACT OF ELASTIC BODIES', now(1:3), now(5:7)
      write (unit, '(a)') repeat('=', page_width)
      write (unit, '(2a)') 'deck      ', or_blank(run%deck_path)
      if (allocated(run%origin)) call print_wrapped(unit, 'goes on   ', run%origin)
      call print_wrapped(unit, 'heading   ', or_blank(model%heading))
   end subroutine print_heading

   !> Prints the warnings of an increment and keeps them for the end.
   subroutine print_warnings(self, record)
      class(listing_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      integer :: i

      if (allocated(record%notes)) then
         do i = 1, size(record%notes)
            call print_wrapped(self%text%unit, '   ', 'note: '//record%notes(i)%value)
         end do
      end if
      if (.not. allocated(record%warnings)) return
      do i = 1, size(record%warnings)
         call print_wrapped(self%text%unit, '   ', 'warning: '//record%warnings(i)%words())
      end do
   end subroutine print_warnings

   !> Prints the contact points of each interface that never came nearer than they were.
   subroutine print_unapproached(unit, node_number, interfaces, summary)
      integer, intent(in) :: unit
      integer, intent(in) :: node_number(:)
      type(contact_points_type), intent(in) :: interfaces(:)
      type(summary_type), intent(in) :: summary
      integer, parameter :: most = 20
      integer, allocatable :: far(:)
      character(:), allocatable :: line
      integer :: i, k

      if (.not. allocated(summary%contacts)) return
      do i = 1, size(interfaces)
         associate (m => size(interfaces(i)%slave))
            far = pack([(k, k=1, m)], never_approached(interfaces(i)%initial_gap, &
               summary%contacts(i)%smallest_gap))
            if (size(far) == 0) cycle
            call print_title(unit, 'CONTACT POINTS THAT NEVER APPROACHED: '// &
               to_text(size(far))//' of '//to_text(m)//' of '//interfaces(i)%name)
         end associate
         line = 'slave and master nodes'
         do k = 1, min(size(far), most)
            line = line//' '//to_text(node_number(interfaces(i)%slave(far(k))))//'-'// &
               to_text(node_number(interfaces(i)%master(far(k))))
         end do
         if (size(far) > most) line = line//' and '//to_text(size(far) - most)//' more'
         call print_wrapped(unit, '   ', line)
      end do
   end subroutine print_unapproached

   !> How bodies whose properties may follow temperatures were solved.
   subroutine print_bodies(unit, model, sizes)
      integer, intent(in) :: unit
      type(model_type), intent(in) :: model
      type(run_size_type), intent(in) :: sizes
      integer :: b

      write (unit, '(3x, a)') 'The stiffness was factored '// &
         counted(sizes%stiffness_factored, 'time')//'; '//counted(sizes%corrections, &
         'correction')//' in all, at most '//to_text(sizes%most_corrections)//' in an increment.'
      do b = 1, model%mesh%body_count
         write (unit, '(3x, a)') body_name(model, b)//trim(merge( &
            ': properties over temperature, corrected by true heat and stress', &
            ': constant properties, no corrections of its own                ', &
            any(follows_temperature(model%materials(model%sections(pack( &
            model%mesh%element_section, model%mesh%element_body == b))%material)))))
      end do
   end subroutine print_bodies

end module listing
