!> Errors and warnings of a deck with their places, printed in one go.
module deck_report
   use deck_source, only: column_of, print_card, deck_source_type, place_type
   use sorting, only: sort_order
   use messages, only: message_type, print_line
   use name_index, only: name_index_type
   use text, only: append, string_type, to_text, to_upper
   implicit none
   private
   public :: deck_report_type, frictionless, heatless

   !> Groups of warnings that may be a root cause: of bodies which friction should hold, and of a
   !> deck without quantities of heat.
   character(*), parameter :: frictionless = 'friction', heatless = 'heatless'

   integer, parameter :: severity_error = 1     !! the deck cannot be solved
   integer, parameter :: severity_warning = 2   !! the deck can be solved, perhaps not as meant
   integer, parameter :: most_errors = 50       !! errors that are printed
   integer, parameter :: most_alike = 3         !! places with one mistake that are all told

   !> One error or warning.
   type :: diagnostic_type
      integer :: severity = severity_error   !! severity_error or severity_warning
      type(place_type) :: place              !! where
      character(:), allocatable :: message   !! what, in plain words
      character(:), allocatable :: group     !! what it has in common with others; empty for none
      integer :: places = 1                  !! places like it, of which the first is told
      logical :: is_root_cause = .false.     !! of what else is wrong on its card
   end type diagnostic_type

   !> Something whose definition a reported error may hide.
   type :: lost_type
      character(:), allocatable :: noun   !! its kind in upper case, such as NODE SET; empty for any
      character(:), allocatable :: name   !! in upper case; empty for any
   end type lost_type

   !> The errors and warnings of one deck, and the card images to which they point.
   type :: deck_report_type
      character(:), allocatable :: path                             !! the deck as given
      type(deck_source_type) :: source                              !! its card images
      integer, private :: count = 0                                 !! number of diagnostics
      integer, private :: errors = 0                                !! number of errors among them
      type(diagnostic_type), allocatable, private :: diagnostics(:) !! (capacity)
      type(lost_type), allocatable, private :: lost(:)   !! what reported errors may hide
   contains
      procedure :: error
      procedure :: root_cause
      procedure :: possible_cause
      procedure :: confirm_cause
      procedure :: missing
      procedure :: warning
      procedure :: lose
      procedure :: has_lost
      procedure :: has_errors
      procedure :: error_count
      procedure :: warnings
      procedure :: messages => message_list
      procedure :: first_error
      procedure :: print => print_report
   end type deck_report_type

contains

   !> Reports an error. Errors of one group are told once, with their number.
   subroutine error(self, place, message, group)
      class(deck_report_type), intent(inout) :: self
      type(place_type), intent(in) :: place           !! where
      character(*), intent(in) :: message             !! what, in plain words
      character(*), intent(in), optional :: group     !! the group, such as node 6
      integer :: i

      i = root_cause_of(self, place)
      if (i > 0) then
         call make_error(self, i)
      else
         call add(self, severity_error, place, message, group)
      end if
   end subroutine error

   !> Reports an error from which all others of its card image follow: it takes the place of those
   !> that are reported already, and those to come are dropped.
   subroutine root_cause(self, place, message)
      class(deck_report_type), intent(inout) :: self
      type(place_type), intent(in) :: place           !! where
      character(*), intent(in) :: message             !! what, in plain words

      call self%possible_cause(place, message)
      call self%error(place, message)
   end subroutine root_cause

   !> Warns of what is hardly meant. Errors on its card image follow from it: it replaces them.
   subroutine possible_cause(self, place, message)
      class(deck_report_type), intent(inout) :: self
      type(place_type), intent(in) :: place           !! where
      character(*), intent(in) :: message             !! what, in plain words
      logical :: follows(self%count)
      integer :: i

      if (root_cause_of(self, place) > 0) return
      follows = [(self%diagnostics(i)%place%image == place%image .and. &
         self%diagnostics(i)%severity == severity_error, i=1, self%count)]
      if (any(follows)) self%diagnostics = pack(self%diagnostics(:self%count), .not. follows)
      self%count = self%count - count(follows)
      self%errors = self%errors - count(follows)
      call add(self, merge(severity_error, severity_warning, any(follows)), place, message)
      self%diagnostics(self%count)%is_root_cause = .true.
   end subroutine possible_cause

   !> Makes the warnings of a group errors, in place of the one that follows from them.
   subroutine confirm_cause(self, group, found)
      class(deck_report_type), intent(inout) :: self
      character(*), intent(in) :: group               !! the group, such as friction
      logical, intent(out) :: found                   !! whether there are any
      integer :: i

      found = .false.
      do i = 1, self%count
         if (self%diagnostics(i)%group /= group) cycle
         found = .true.
         call make_error(self, i)
      end do
   end subroutine confirm_cause

   subroutine make_error(self, i)
      class(deck_report_type), intent(inout) :: self
      integer, intent(in) :: i

      if (self%diagnostics(i)%severity == severity_error) return
      self%diagnostics(i)%severity = severity_error
      self%errors = self%errors + 1
   end subroutine make_error

   !> Index of the message that explains what is wrong at a place; 0 where there is none.
   pure integer function root_cause_of(self, place)
      class(deck_report_type), intent(in) :: self
      type(place_type), intent(in) :: place

      do root_cause_of = self%count, 1, -1
         if (self%diagnostics(root_cause_of)%is_root_cause .and. &
            self%diagnostics(root_cause_of)%place%image == place%image) return
      end do
   end function root_cause_of

   !> Reports once that something is not there, unless a reported error may hide its definition.
   subroutine missing(self, place, message, noun, name)
      class(deck_report_type), intent(inout) :: self
      type(place_type), intent(in) :: place           !! where
      character(*), intent(in) :: message             !! what, in plain words
      character(*), intent(in), optional :: noun      !! kind of what is not there, such as node set
      character(*), intent(in), optional :: name      !! its name
      character(:), allocatable :: group

      if (self%has_lost(noun, name)) return
      if (present(noun) .and. present(name)) group = noun//' '//to_upper(name)
      call self%error(place, message, group)
   end subroutine missing

   !> Remembers what an error that is reported may hide the definition of; without kind and name:
   !> of anything, as a file that cannot be read.
   subroutine lose(self, noun, name)
      class(deck_report_type), intent(inout) :: self
      character(*), intent(in), optional :: noun      !! the kind, such as node set
      character(*), intent(in), optional :: name      !! the name, in any case
      type(lost_type) :: lost
      integer :: i

      lost = lost_type('', '')
      if (present(noun)) lost%noun = to_upper(noun)
      if (present(name)) lost%name = to_upper(name)
      if (.not. allocated(self%lost)) allocate (self%lost(0))
      if (all([(self%lost(i)%noun /= lost%noun .or. self%lost(i)%name /= lost%name, i=1, &
         size(self%lost))])) self%lost = [self%lost, lost]
   end subroutine lose

   !> Whether a reported error may hide the definition of a name; without a name: of something of
   !> the kind; without both: of anything at all. Without an error nothing is hidden, so that
   !> whatever is dropped leaves one behind.
   pure logical function has_lost(self, noun, name)
      class(deck_report_type), intent(in) :: self
      character(*), intent(in), optional :: noun      !! the kind, such as node set
      character(*), intent(in), optional :: name      !! the name, in any case
      character(:), allocatable :: kind
      integer :: i

      kind = ''
      if (present(noun)) kind = to_upper(noun)
      has_lost = .false.
      if (self%errors == 0 .or. .not. allocated(self%lost)) return
      do i = 1, size(self%lost)
         associate (lost => self%lost(i))
            has_lost = lost%noun == '' .or. lost%noun == kind
            if (present(name)) then
               has_lost = has_lost .and. (lost%name == '' .or. lost%name == to_upper(name))
            else
               has_lost = has_lost .and. (lost%name == '' .or. lost%noun /= '')
            end if
         end associate
         if (has_lost) return
      end do
   end function has_lost

   !> Reports a warning. Warnings of one group are told once, with their number.
   subroutine warning(self, place, message, group)
      class(deck_report_type), intent(inout) :: self
      type(place_type), intent(in) :: place           !! where
      character(*), intent(in) :: message             !! what, in plain words
      character(*), intent(in), optional :: group     !! the group

      call add(self, severity_warning, place, message, group)
   end subroutine warning

   !> Whether the deck has an error.
   pure logical function has_errors(self)
      class(deck_report_type), intent(in) :: self

      has_errors = self%errors > 0
   end function has_errors

   !> Number of errors so far.
   pure integer function error_count(self)
      class(deck_report_type), intent(in) :: self

      error_count = self%errors
   end function error_count

   !> The warnings as printed, without images, in the order of the deck.
   function warnings(self) result(lines)
      class(deck_report_type), intent(in) :: self
      type(string_type), allocatable :: lines(:)      !! one a warning
      type(message_type), allocatable :: list(:)
      integer :: i

      list = self%messages()
      allocate (lines(0))
      do i = 1, size(list)
         if (list(i)%severity == 'warning') call append(lines, list(i)%as_line())
      end do
   end function warnings

   !> The first error in the order of the deck, without its place.
   function first_error(self) result(message)
      class(deck_report_type), intent(in) :: self
      character(:), allocatable :: message            !! one sentence; empty for none
      type(message_type), allocatable :: list(:)
      integer :: i

      message = ''
      list = self%messages()
      do i = size(list), 1, -1
         if (list(i)%severity == 'error') message = list(i)%words
      end do
   end function first_error

   !> Prints warnings and at most 50 errors in the order of the deck, with their cards and carets.
   subroutine print_report(self, unit)
      class(deck_report_type), intent(in) :: self
      integer, intent(in) :: unit                     !! open for formatted output
      type(diagnostic_type), allocatable :: told(:)
      type(message_type) :: message
      integer :: i, errors

      told = told_by(self)
      errors = 0
      do i = 1, size(told)
         if (told(i)%severity == severity_error) errors = errors + 1
         if (told(i)%severity == severity_error .and. errors > most_errors) cycle
         message = message_of(self, told(i))
         call print_line(unit, message%as_line())
         associate (place => told(i)%place)
            if (place%image == 0) cycle
            associate (image => self%source%images(place%image)%value)
               call print_card(unit, image, min(place%column, len(image) + 1))
            end associate
         end associate
      end do
      if (errors > most_errors) call print_line(unit, self%path//': error: '// &
         'errors that are not shown: '//to_text(errors - most_errors))
   end subroutine print_report

   !> The errors and warnings in the order of the deck.
   function message_list(self) result(list)
      class(deck_report_type), intent(in) :: self
      type(message_type), allocatable :: list(:)
      type(diagnostic_type), allocatable :: told(:)
      integer :: i

      told = told_by(self)
      allocate (list(size(told)))
      do i = 1, size(told)
         list(i) = message_of(self, told(i))
      end do
   end function message_list

   function message_of(self, diagnostic) result(message)
      class(deck_report_type), intent(in) :: self
      type(diagnostic_type), intent(in) :: diagnostic
      type(message_type) :: message

      message%severity = 'error'
      if (diagnostic%severity == severity_warning) message%severity = 'warning'
      message%file = self%path
      message%words = diagnostic%message
      associate (place => diagnostic%place, source => self%source)
         if (place%image > 0) then
            message%file = source%paths(source%file(place%image))%value
            message%line = source%line(place%image)
            message%column = column_of(source%images(place%image)%value, place%column)
         end if
      end associate
      if (diagnostic%places > 1) message%words = message%words//' ('// &
         to_text(diagnostic%places)//' such places)'
   end function message_of

   !> The messages in the order of the deck, each once where *CYCLE repeats its card; one mistake in
   !> more than a few places of a card is told at the first.
   function told_by(self) result(told)
      class(deck_report_type), intent(in) :: self
      type(diagnostic_type), allocatable :: told(:)
      type(name_index_type) :: kinds, known
      character(:), allocatable :: key, kind, line
      integer :: alike(self%count), cards(0:self%source%count), first(self%count), &
         first_of(self%count), i, order(self%count)
      logical :: is_told(self%count)

      order = order_of(self)
      allocate (told(self%count))
      cards = 0
      ! Fewer messages are all told.
      do i = 1, merge(self%source%count, 0, self%count > most_alike)
         line = adjustl(self%source%images(i)%value)
         cards(i) = merge(i, cards(i - 1), index(line, '*') == 1 .and. index(line, '**') /= 1)
      end do
      first = 0
      alike = 0
      do i = 1, size(told)
         told(i) = self%diagnostics(order(i))
         associate (place => told(i)%place)
            key = to_text(place%image)//':'//to_text(place%column)//' '//told(i)%message
            is_told(i) = known%find(key) == 0
            if (.not. is_told(i)) cycle
            call known%add(key)
            if (told(i)%places > 1 .or. cards(place%image) == 0) cycle
            kind = to_text(told(i)%severity)//' '//to_text(cards(place%image))//' '// &
               without_digits(told(i)%message)
         end associate
         if (kinds%find(kind) == 0) then
            call kinds%add(kind)
            first_of(kinds%find(kind)) = i
         end if
         first(i) = first_of(kinds%find(kind))
         alike(first(i)) = alike(first(i)) + 1
      end do
      do i = 1, size(told)
         if (first(i) == 0) cycle
         if (alike(first(i)) <= most_alike) cycle
         is_told(i) = first(i) == i
         told(i)%places = alike(i)
      end do
      told = pack(told, is_told)
   end function told_by

   pure function without_digits(message) result(kind)
      character(*), intent(in) :: message
      character(:), allocatable :: kind
      integer :: i

      kind = ''
      do i = 1, len(message)
         if (scan(message(i:i), '0123456789') == 0) kind = kind//message(i:i)
      end do
   end function without_digits

   !> The order of the diagnostics by image, then column, then as reported.
   function order_of(self) result(order)
      class(deck_report_type), intent(in) :: self
      integer, allocatable :: order(:)
      integer :: keys(self%count), i

      allocate(order(self%count))
      keys = [(self%diagnostics(i)%place%column, i=1, self%count)]
      order = sort_order(keys)
      keys = [(self%diagnostics(order(i))%place%image, i=1, self%count)]
      order = order(sort_order(keys))
   end function order_of

   !> Adds a message, or counts a place more where there is one of its group.
   subroutine add(self, severity, place, message, group)
      class(deck_report_type), intent(inout) :: self
      integer, intent(in) :: severity
      type(place_type), intent(in) :: place
      character(*), intent(in) :: message
      character(*), intent(in), optional :: group
      type(diagnostic_type), allocatable :: more(:)
      integer :: i

      if (present(group)) then
         do i = 1, min(self%count, most_errors)
            if (self%diagnostics(i)%group /= group) cycle
            if (self%diagnostics(i)%severity /= severity) cycle
            self%diagnostics(i)%places = self%diagnostics(i)%places + 1
            return
         end do
      end if
      if (.not. allocated(self%diagnostics)) allocate(self%diagnostics(0))
      if (self%count == size(self%diagnostics)) then
         allocate(more(2*self%count + most_errors))
         more(:self%count) = self%diagnostics
         call move_alloc(more, self%diagnostics)
      end if
      self%count = self%count + 1
      self%diagnostics(self%count)%severity = severity
      self%diagnostics(self%count)%place = place
      self%diagnostics(self%count)%message = message
      self%diagnostics(self%count)%group = ''
      if (present(group)) self%diagnostics(self%count)%group = group
      if (severity == severity_error) self%errors = self%errors + 1
   end subroutine add

end module deck_report
