!> The print file `NAME.lst`: a summary, what is modelled and why, every increment, the verdicts,
!> the zone diagrams, all warnings, and the deck.
!>
!> The summary is known at the end only: a line says so until then. A draft waits in memory until it
!> is whole; then it takes the place of what the file holds.
module listing
   use contact_points, only: contact_points_type, never_approached
   use due_output, only: table_is_due
   use errors, only: error_type, set_error, status_internal
   use file_calls, only: cannot_write, check_in_place, is_stream, read_file
   use listing_head, only: checks, ending, print_model, summary_block
   use listing_increments, only: print_attempts, print_balances, print_body_errors, &
      print_history_uncertainties, print_increment, print_interface, print_interfaces, &
      print_maxima, print_uncertainties
   use listing_tables, only: print_contact_table, print_iterations, print_requested, &
      print_verdicts, uncertainties_of, zone_diagram_type
   use listing_text, only: page_type, page_width, to_right
   use model, only: follows_temperatures, model_type
   use model_words, only: has_many
   use no_estimates, only: no_reason, reason_of_run
   use open_files, only: empty_file, lock_file, unlock_file, write_to_file
   use records, only: increment_record_type
   use requested_tables, only: requested_table_type
   use run_summaries, only: in_times, run_entries, run_entry_type, run_summary_type
   use summary, only: summary_type
   use text, only: append, counted, or_blank, string_type, to_text, with_decimals
   use verification, only: verifier_type
   implicit none
   private
   public :: listing_type

   !> An open listing.
   type :: listing_type
      private
      character(:), allocatable, public :: path                !! path of the file
      integer :: descriptor = -1                               !! of the locked file
      logical :: is_draft = .false.                            !! whether all waits for the end
      type(page_type) :: page                                  !! what is not yet in the file
      type(zone_diagram_type), allocatable :: diagrams(:)      !! one an interface
      character(:), allocatable :: failure                     !! why the run ended early
      type(summary_type), public :: summary                    !! what the run comes to
      integer :: summary_ends(2) = 0   !! bytes before and up to the end of what stands in its place
   contains
      procedure :: reserve
      procedure :: open => open_listing
      procedure :: is_begun
      procedure :: add
      procedure :: end_early
      procedure :: break_off
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
      self%descriptor = lock
   end subroutine reserve

   !> Begins the reserved listing: heading, place of the summary, defaults, what is modelled.
   !> Error: status_internal, when the file cannot be written.
   subroutine open_listing(self, is_draft, model, interfaces, run, error)
      class(listing_type), intent(inout) :: self
      logical, intent(in) :: is_draft                     !! whether the file stays until the end
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(run_summary_type), intent(in) :: run
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      character(19) :: date
      character(111) :: program
      integer :: now(8)

      self%is_draft = is_draft
      if (.not. is_draft) call empty_file(self%descriptor, self%path, error)
      if (allocated(error)) return
      allocate(self%diagrams(merge(size(interfaces), 0, lists_points(model))))
      call date_and_time(values=now)
      write (date, '(i4.4, 2("-", i2.2), 1x, 2(i2.2, ":"), i2.2)') now(1:3), now(5:7)
      program = 'THERCON '//or_blank(run%version)//'   THERMOMECHANICAL CONTACT IN TWO DIMENSIONS'
      call self%page%line(repeat('=', page_width))
      call self%page%line(program//date)
      call self%page%line(repeat('=', page_width))
      call self%page%line('deck      '//or_blank(run%deck_path))
      if (allocated(run%origin)) call self%page%wrapped('goes on   ', run%origin)
      call self%page%wrapped('heading   ', or_blank(model%heading))
      call self%page%title('SUMMARY')
      self%summary_ends(1) = self%page%length
      call self%page%line('   not finished: the run is still in progress, or was killed')
      self%summary_ends(2) = self%page%length
      call self%page%list('DEFAULTS AND IGNORED CARDS', model%notes)
      call print_model(self%page, model, interfaces, run)
      call self%page%title('INCREMENTS')
      call write_text(self, error)
   end subroutine open_listing

   !> Whether zone diagrams and contact points that never approach are listed: of a few interfaces,
   !> or where the deck asks for contact points.
   pure logical function lists_points(model)
      type(model_type), intent(in) :: model
      integer :: i

      lists_points = .not. has_many(size(model%contacts)) .or. &
         any(model%steps%contact_print_frequency > 0) .or. &
         any([(allocated(model%steps(i)%contact_print_points%times), i=1, size(model%steps))])
   end function lists_points

   !> Whether the file holds anything of this run.
   pure logical function is_begun(self)
      class(listing_type), intent(in) :: self

      is_begun = allocated(self%diagrams)
   end function is_begun

   !> Writes what waits; of a draft all goes on waiting.
   !> Error: status_internal, when the file cannot be written.
   subroutine write_text(self, error)
      class(listing_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: lines

      if (self%is_draft) return
      call self%page%take(lines)
      call write_to_file(self%descriptor, self%path, lines, error)
   end subroutine write_text

   !> Adds the block of an accepted increment, with its PRINT tables where these are due.
   !> Error: status_internal, when the file cannot be written.
   subroutine add(self, record, model, interfaces, tables, error)
      class(listing_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(requested_table_type), intent(in) :: tables(:)    !! of *NODE PRINT, *EL PRINT, now due
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer :: i
      logical :: has_tables

      has_tables = table_is_due(model%steps(record%step)%contact_print_frequency, &
         model%steps(record%step)%contact_print_points, record, model)
      call self%summary%take(model, interfaces, record)
      call print_increment(self%page, record)
      if (has_many(size(interfaces)) .and. .not. (has_tables .or. record%last_of_step)) then
         call print_interfaces(self%page, interfaces, record%contacts)
      else
         do i = 1, size(interfaces)
            call print_interface(self%page, interfaces(i), record%contacts(i))
         end do
      end if
      do i = 1, size(self%diagrams)
         call self%diagrams(i)%add(record, record%contacts(i)%contact_state)
      end do
      call print_balances(self%page, record, model)
      call print_body_errors(self%page, record)
      if (allocated(record%notes)) then
         do i = 1, size(record%notes)
            call self%page%wrapped('   ', 'note: '//record%notes(i)%value)
         end do
      end if
      if (allocated(record%warnings)) then
         do i = 1, size(record%warnings)
            call self%page%wrapped('   ', 'warning: '//record%warnings(i)%words())
         end do
      end if
      if (allocated(record%uncertainties) .and. reason_of_run(model) == no_reason) then
         do i = 1, size(interfaces)
            call print_uncertainties(self%page, interfaces(i), record%uncertainties(:, i))
         end do
         do i = 1, size(record%body_uncertainties)
            call print_maxima(self%page, model%mesh, i, record%body_uncertainties(i))
         end do
         if (allocated(record%history_uncertainties)) call print_history_uncertainties(self%page, &
            record%history_uncertainties)
      end if
      call print_requested(self%page, tables, model)
      self%summary%printed = self%summary%printed + sum([(merge(size(tables(i)%member), 0, &
         size(tables(i)%columns) > 0 .and. .not. tables(i)%has_uncertainties), i=1, size(tables))])
      if (has_tables) then
         do i = 1, size(interfaces)
            call print_contact_table(self%page, interfaces(i), record%contacts(i), &
               model%mesh%node_number, 'CONTACT POINTS OF ')
            if (allocated(record%contact_uncertainties)) call print_contact_table(self%page, &
               interfaces(i), record%contact_uncertainties(i), model%mesh%node_number, &
               uncertainties_of//'CONTACT POINTS OF ')
         end do
      end if
      call write_text(self, error)
   end subroutine add

   !> Says why the run ended early; prints the attempts at an increment that failed, and the passes
   !> of the last one. Of a draft nothing else is left: what the file holds stays before it.
   subroutine end_early(self, reason, record, kept)
      class(listing_type), intent(inout) :: self
      character(*), intent(in) :: reason                     !! what went wrong
      type(increment_record_type), intent(in) :: record      !! that increment; empty for none
      character(*), intent(in) :: kept                       !! what the results hold, a sentence
      character(:), allocatable :: dropped

      if (self%is_draft) call self%page%take(dropped)
      self%is_draft = .false.
      self%failure = reason
      call self%page%title('ENDED EARLY')
      call self%page%wrapped('   ', reason)
      if (kept /= '') call self%page%wrapped('   ', kept)
      if (allocated(record%failed)) call print_attempts(self%page, record%failed)
      if (allocated(record%iterations)) call print_iterations(self%page, &
         pack(record%iterations, record%iterations%cut_backs == record%cut_backs))
   end subroutine end_early

   !> Ends the listing that is reserved with the reason why the run cannot go on; whether there is
   !> room for that is not asked.
   subroutine break_off(self, reason, record, kept)
      class(listing_type), intent(inout) :: self
      character(*), intent(in) :: reason                     !! what went wrong
      type(increment_record_type), intent(in) :: record      !! as for end_early
      character(*), intent(in) :: kept                       !! what the results hold, or nothing
      type(error_type), allocatable :: ignored

      if (self%descriptor < 0) return   ! another run writes the file
      call self%end_early(reason, record, kept)
      call write_text(self, ignored)
   end subroutine break_off

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
      character(:), allocatable :: labels, times
      type(run_entry_type), allocatable :: entries(:)
      integer :: i

      if (size(verifier%outcomes) > 0) call print_verdicts(self%page, model%verifications, &
         verifier%outcomes)
      if (lists_points(model)) then
         do i = 1, size(interfaces)
            call self%diagrams(i)%print(self%page, interfaces(i))
         end do
         call print_unapproached(self%page, model%mesh%node_number, interfaces, self%summary)
      else
         call self%page%title('ZONE DIAGRAMS')
         call self%page%wrapped('   ', '*CONTACT PRINT prints those of '// &
            to_text(size(interfaces))//' interfaces. /contact of the result file has all '// &
            'contact points at all increments; post/plot zones draws them.')
      end if
      call self%page%list('REQUESTED ACCURACY', run%accuracy%targets)
      if (size(run%accuracy%rounds) > 0) call self%page%line('')
      do i = 1, size(run%accuracy%rounds)
         call self%page%line('  '//run%accuracy%rounds(i)%value)
      end do
      if (size(run%accuracy%advice) > 0) call self%page%line('')
      do i = 1, size(run%accuracy%advice)
         call self%page%wrapped('   ', run%accuracy%advice(i)%value)
      end do
      warnings = [model%warnings, run%warnings]
      call self%page%list('WARNINGS', warnings)
      if (size(warnings) == 0) then
         call self%page%line('')
         call self%page%line('No warnings.')
      end if
      entries = run_entries(run, model)
      labels = '   '
      times = '   '
      do i = 1, size(entries)
         if (.not. entries(i)%is_told(in_times)) cycle
         labels = labels//to_right(entries(i)%label, 12)
         times = times//to_right(with_decimals(entries(i)%number, 4), 12)
      end do
      call self%page%title('SECONDS')
      call self%page%line(labels)
      call self%page%line(times)
      if (any(model%steps%is_transient) .or. follows_temperatures(model)) then
         call self%page%line('')
         call self%page%line('   The matrix of heat was factored '// &
            counted(run%sizes%heat_factored, 'time')//' in '// &
            counted(self%summary%last%increment, 'increment')//'.')
      end if
      call self%page%deck(cards)
      call write_text(self, error)
      if (allocated(error)) return
      allocate (lines(0))
      call append(lines, ending(run, allocated(self%failure), self%summary%last%increment))
      call append(lines, checks(verifier, run))
      if (size(warnings) == 0) call append(lines, 'no warnings')
      if (size(warnings) > 0) call append(lines, counted(size(warnings), 'warning')// &
         ', see WARNINGS below')
      call self%summary%add_lines(model, interfaces, lines)
      call check_in_place(self%path, self%descriptor, error)
      if (.not. allocated(error)) call place_summary(self, summary_block(lines), error)
   end subroutine finish

   !> Puts the summary in its place in the text that is written, or waits; behind the text of what
   !> is no file.
   !> Error: status_internal, when the text cannot be read or written.
   subroutine place_summary(self, block, error)
      class(listing_type), intent(inout) :: self
      character(*), intent(in) :: block
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: reason, text

      if (is_stream(self%path)) then
         call write_to_file(self%descriptor, self%path, block, error)
         return
      else if (self%is_draft) then
         call self%page%take(text)
         call empty_file(self%descriptor, self%path, error)
      else
         call read_file(self%path, huge(1), text, reason)
         if (len(reason) > 0) call set_error(error, status_internal, &
            cannot_write(self%path, reason))
      end if
      if (allocated(error)) return
      call write_to_file(self%descriptor, self%path, text(:self%summary_ends(1))//block// &
         text(self%summary_ends(2) + 1:), error, position=0)
   end subroutine place_summary

   !> Frees the file; one in which nothing was written is removed. One that is not reserved stays.
   subroutine close_listing(self, keeps_lock)
      class(listing_type), intent(inout) :: self
      logical, intent(in) :: keeps_lock   !! whether the file stays locked

      if (self%descriptor >= 0 .and. .not. keeps_lock) call unlock_file(self%path, self%descriptor)
      self%descriptor = -1
   end subroutine close_listing

   !> Prints the contact points of each interface that never came nearer than they were.
   subroutine print_unapproached(page, node_number, interfaces, summary)
      type(page_type), intent(inout) :: page
      integer, intent(in) :: node_number(:)
      type(contact_points_type), intent(in) :: interfaces(:)
      type(summary_type), intent(in) :: summary
      integer, parameter :: most = 20
      integer, allocatable :: far(:)
      character(:), allocatable :: line
      integer :: i, k

      if (.not. allocated(summary%last%contacts)) return
      do i = 1, size(interfaces)
         associate (m => size(interfaces(i)%slave))
            far = pack([(k, k=1, m)], never_approached(interfaces(i)%initial_gap, &
               summary%last%contacts(i)%smallest_gap))
            if (size(far) == 0) cycle
            call page%title('CONTACT POINTS THAT NEVER APPROACHED: '// &
               to_text(size(far))//' of '//to_text(m)//' of '//interfaces(i)%name)
         end associate
         line = 'slave and master nodes'
         do k = 1, min(size(far), most)
            line = line//' '//to_text(node_number(interfaces(i)%slave(far(k))))//'-'// &
               to_text(node_number(interfaces(i)%master(far(k))))
         end do
         if (size(far) > most) line = line//' and '//to_text(size(far) - most)//' more'
         call page%wrapped('   ', line)
      end do
   end subroutine print_unapproached

end module listing
