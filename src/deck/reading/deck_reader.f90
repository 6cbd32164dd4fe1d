!> Files -> cards: the deck, the files that it includes, and the width of a card.
module deck_reader
   use assembly_cards, only: flatten_cards
   use card_fields, only: is_comment, is_keyword, last_text
   use card_lines, only: card_lines_type, default_width
   use cards, only: cards_type, trim_cards
   use deck_report, only: deck_report_type
   use deck_source, only: earlier_deck_type, place_type, read_lines
   use deck_structure, only: check_data_counts, repeat_steps
   use file_calls, only: identity_of
   use generated_cards, only: generate_cards
   use keywords, only: keyword_lines
   use text, only: append, string_type, to_text, to_upper, without_blanks
   use utf8, only: first_byte
   implicit none
   private
   public :: read_deck, files_of_deck, parameters_of_deck, keyword_of, keyword_lines

   integer, parameter :: deepest_include = 16   !! files that may include each other
   integer, parameter :: most_files = 1000      !! of a deck, each counted as often as it is read
   integer, parameter :: longest_card = 100000  !! bytes of a line that is no comment

contains

   !> Reads a deck and the files that it includes; behind the deck of a result that it goes on from,
   !> its cards before the first *STEP where the model's are.
   subroutine read_deck(path, width, settings, cards, report, earlier)
      character(*), intent(in) :: path                  !! the deck as given
      integer, intent(in) :: width                      !! --width, 0 for none
      type(string_type), intent(in) :: settings(:)      !! --set, each NAME=VALUE
      type(cards_type), intent(out), target :: cards
      type(deck_report_type), intent(out), target :: report     !! what is wrong with it
      type(earlier_deck_type), intent(in), optional :: earlier   !! the deck of a result
      type(card_lines_type) :: open_lines
      character(:), allocatable :: fault
      integer :: i
      logical :: exists

      open_lines%width = max(default_width, width)
      if (present(earlier)) report%source%earlier = earlier
      call read_all_lines(path, settings, open_lines, cards, report, fault)
      call trim_cards(cards)
      if (.not. report%has_lost()) call check_data_counts(cards, report)
      call flatten_cards(cards, report)
      call generate_cards(cards, report)
      call repeat_steps(cards, report)
      if (len(fault) > 0) then
         inquire (file=path, exist=exists)
         if (.not. exists .and. index(path, '.inp', back=.true.) /= len(path) - 3) fault = fault// &
            ', and no '//path//'.inp'
         call report%error(place_type(), 'the deck cannot be read: '//fault)
      else if (size(cards%keywords) == 0 .and. .not. report%has_errors()) then
         call report%error(place_type(), 'the deck is empty')
      else
         call open_lines%parameters%check_settings(report)
      end if
      call check_width(open_lines%width, report)
      do i = 1, report%source%count
         if (report%source%file(i) == 1) cards%last%image = i
      end do
      allocate(cards%images(report%source%count))
      do i = 1, report%source%count
         cards%images(i)%value = report%source%images(i)%value
      end do
   end subroutine read_deck

   !> The files of which a deck consists, as seen from the current folder: it and those that it
   !> includes, as far as they can be read. What is wrong with it is not told.
   function files_of_deck(path, settings) result(files)
      character(*), intent(in) :: path                  !! the deck as given, no pipe
      type(string_type), intent(in) :: settings(:)      !! --set, each NAME=VALUE
      type(string_type), allocatable :: files(:)        !! their paths
      type(card_lines_type) :: open_lines
      type(cards_type), target :: cards
      type(deck_report_type), target :: report
      character(:), allocatable :: fault

      call read_all_lines(path, settings, open_lines, cards, report, fault)
      call move_alloc(cards%files, files)
   end function files_of_deck

   !> The names that the *PARAMETER cards of a deck define. What else is wrong with it is not told.
   subroutine parameters_of_deck(path, settings, names, fault)
      character(*), intent(in) :: path                  !! the deck as given, no pipe
      type(string_type), intent(in) :: settings(:)      !! --set, each NAME=VALUE
      type(string_type), allocatable, intent(out) :: names(:)   !! in upper case
      character(:), allocatable, intent(out) :: fault   !! why the deck is not read; else empty
      type(card_lines_type) :: open_lines
      type(cards_type), target :: cards
      type(deck_report_type), target :: report

      call read_all_lines(path, settings, open_lines, cards, report, fault)
      names = open_lines%parameters%names%known()
   end subroutine parameters_of_deck

   subroutine read_all_lines(path, settings, open_lines, cards, report, fault)
      character(*), intent(in) :: path
      type(string_type), intent(in) :: settings(:)
      type(card_lines_type), intent(inout) :: open_lines
      type(cards_type), intent(inout), target :: cards
      type(deck_report_type), intent(inout), target :: report
      character(:), allocatable, intent(out) :: fault        ! why it is not read; else empty
      type(string_type), allocatable :: none(:)

      open_lines%cards => cards
      open_lines%report => report
      cards%path = path
      report%path = path
      allocate (report%source%paths(0), cards%files(0), none(0))
      call open_lines%parameters%take_settings(settings, report)
      if (allocated(report%source%earlier)) then
         call append(report%source%paths, path)
         call append(report%source%paths, report%source%earlier%path)
         call take_earlier(1, report%source%earlier%steps, open_lines)
      end if
      call read_file(path, path, none, open_lines, fault)
      call take_earlier_steps(open_lines)
      call open_lines%finish()
   end subroutine read_all_lines

   !> Reads one file, and the files that it includes where it includes them.
   recursive subroutine read_file(path, found, above, open_lines, fault)
      character(*), intent(in) :: path                       !! file as given, for messages
      character(*), intent(in) :: found                      !! file as seen from the current folder
      type(string_type), intent(in) :: above(:)              !! identities of those that include it
      type(card_lines_type), intent(inout) :: open_lines     !! what is open
      character(:), allocatable, intent(out) :: fault        !! why it is not read; else empty
      type(string_type), allocatable :: lines(:), open_files(:)
      character(:), allocatable :: identity, included, include_fault
      type(place_type) :: place
      integer :: i, k, file

      call read_lines(found, lines, fault)
      if (len(fault) == 0) fault = length_fault(lines)
      if (len(fault) > 0) return
      ! The paths of a deck that goes on from a result are there before its lines.
      file = 1
      if (size(above) > 0 .or. size(open_lines%report%source%paths) == 0) then
         call append(open_lines%report%source%paths, path)
         file = size(open_lines%report%source%paths)
      end if
      call append(open_lines%cards%files, found)
      open_files = above
      call append(open_files, identity_of(found))
      do i = 1, size(lines)
         if (allocated(open_lines%report%source%earlier)) then
            if (keyword_of(lines(i)%value) == 'STEP') call take_earlier_steps(open_lines)
         end if
         call open_lines%report%source%add_image(file, i, lines(i)%value)
         call open_lines%take_line(lines(i)%value, open_lines%report%source%count)
         if (.not. allocated(open_lines%include)) cycle
         call move_alloc(open_lines%include, included)
         place = open_lines%include_place
         identity = identity_of(beside(found, included))
         if (any([(len(identity) > 0 .and. open_files(k)%value == identity, k=1, &
            size(open_files))])) then
            call open_lines%report%error(place, included//' is already open: it would include '// &
               'itself')
            cycle
         else if (size(open_files) == deepest_include .or. &
            size(open_lines%report%source%paths) == most_files) then
            include_fault = 'the deck has more than '//to_text(most_files)//' files, or more '// &
               'than '//to_text(deepest_include)//' within each other'
         else
            call read_file(included, beside(found, included), open_files, open_lines, &
               include_fault)
            if (len(include_fault) == 0) cycle
            include_fault = included//' cannot be read: '//include_fault
         end if
         call open_lines%report%error(place, include_fault, include_fault)
         call open_lines%report%lose()
      end do
   end subroutine read_file

   !> Reads the steps of the earlier deck, where there is one and they are not read yet.
   subroutine take_earlier_steps(open_lines)
      type(card_lines_type), intent(inout) :: open_lines

      if (.not. allocated(open_lines%report%source%earlier)) return
      associate (earlier => open_lines%report%source%earlier)
         call take_earlier(earlier%steps + 1, size(earlier%images), open_lines)
      end associate
      deallocate (open_lines%report%source%earlier)
   end subroutine take_earlier_steps

   !> Reads lines of the earlier deck, those of included files among them, without its *VERIFY.
   subroutine take_earlier(first, last, open_lines)
      integer, intent(in) :: first, last                     ! images
      type(card_lines_type), intent(inout) :: open_lines
      integer :: i
      logical :: is_check
      character(:), allocatable :: keyword

      is_check = .false.
      do i = first, last
         associate (line => open_lines%report%source%earlier%images(i)%value)
            keyword = keyword_of(line)
            if (keyword /= '') is_check = keyword == 'VERIFY'
            if (is_check) cycle
            call open_lines%report%source%add_image(2, i, line)
            call open_lines%take_line(line, open_lines%report%source%count)
            if (allocated(open_lines%include)) deallocate (open_lines%include)
         end associate
      end do
   end subroutine take_earlier

   !> The keyword of a line, in upper case without blanks; empty for other lines.
   pure function keyword_of(line) result(name)
      character(*), intent(in) :: line
      character(:), allocatable :: name

      name = ''
      if (index(adjustl(line), '*') /= 1) return
      name = to_upper(without_blanks(line(:index(line//',', ',') - 1)))
      name = name(2:)
      if (index(name, '*') == 1) name = ''
   end function keyword_of

   !> Why the lines of a file are not taken: one of them is too long; else empty.
   pure function length_fault(lines) result(fault)
      type(string_type), intent(in) :: lines(:)
      character(:), allocatable :: fault
      integer :: i

      fault = ''
      do i = 1, size(lines)
         if (len(lines(i)%value) <= longest_card) cycle
         if (is_comment(lines(i)%value)) cycle
         fault = 'line '//to_text(i)//' has more than '//to_text(longest_card)//' characters'
         return
      end do
   end function length_fault

   !> An included file is looked for beside the file that includes it, then in the current folder.
   function beside(path, included) result(found)
      character(*), intent(in) :: path       !! file that includes
      character(*), intent(in) :: included   !! file as given
      character(:), allocatable :: found     !! where it is
      logical :: there

      found = included
      if (index(included, '/') == 1) return
      inquire (file=path(:index(path, '/', back=.true.))//included, exist=there)
      if (there) found = path(:index(path, '/', back=.true.))//included
   end function beside

   !> Reports cards that are wider than they may be; comments and titles have any width.
   subroutine check_width(width, report)
      integer, intent(in) :: width
      type(deck_report_type), intent(inout) :: report
      integer :: image, column
      logical :: is_title

      is_title = .false.
      do image = 1, report%source%count
         associate (line => report%source%images(image)%value)
            if (is_comment(line)) cycle
            if (is_keyword(line)) then
               is_title = any(keyword_of(line) == ['HEADING', 'STEP   '])
            else if (is_title) then
               cycle
            end if
            if (last_text(line) <= width) cycle
            column = first_byte(line, width + 1)
            if (column > last_text(line)) cycle
            call report%error(place_type(image, column), 'text past column '//to_text(width)// &
               '; *OPTIONS, WIDTH=n or --width n widens the card')
         end associate
      end do
   end subroutine check_width

end module deck_reader
