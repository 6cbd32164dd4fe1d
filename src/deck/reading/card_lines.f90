!> One line after another -> cards: comments, continuations, parameters.
module card_lines
   use card_fields, only: drop_empty_end, first_text, is_comment, is_keyword, last_text, &
      split_fields, without_quotes, fixed_columns_type, split_columns, take_format
   use card_values, only: take_parameter
   use keyword_cards, only: check_commas, lacks_star, is_parameter, make_keyword_card
   use cards, only: add_data, add_keyword, add_note, cards_type, field_type, keyword_card_type
   use deck_parameters, only: deck_parameters_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use element_types, only: element_type_fields
   use keywords, only: is_output
   use spelling, only: find_look_alike
   use text, only: to_upper
   implicit none
   private
   public :: card_lines_type, default_width

   integer, parameter :: default_width = 256   !! columns of a card
   integer, parameter :: most_fields = 9   !! of an *ELEMENT data card, that of eight nodes

   !> State of the reader between two lines.
   type :: card_lines_type
      type(cards_type), pointer :: cards => null()          !! receives the cards
      type(deck_report_type), pointer :: report => null()   !! receives errors
      type(deck_parameters_type) :: parameters              !! *PARAMETER so far
      integer :: width = default_width                      !! columns of a card
      character(:), allocatable :: include                  !! path that the card just read includes
      type(place_type) :: include_place                     !! where it is
      type(field_type), allocatable, private :: pending(:)  !! of a keyword card that continues
      type(field_type), allocatable, private :: comma       !! behind which an element continues
      character(:), allocatable, private :: keyword         !! keyword to which data cards belong
      logical, private :: skips_data = .false.              !! its data cards are of no use
      character(:), allocatable, private :: refusal_of_data !! error at its first data card
      integer, private :: element_fields = 0                !! of a complete *ELEMENT data card
      type(fixed_columns_type), private :: columns          !! of data cards in fixed columns
   contains
      procedure :: take_line
      procedure :: finish
   end type card_lines_type

contains

   !> Takes one line.
   subroutine take_line(self, line, image)
      class(card_lines_type), intent(inout) :: self        !! what is open
      character(*), intent(in) :: line                     !! card image
      integer, intent(in) :: image                         !! its running number
      type(field_type), allocatable :: fields(:)
      character(:), allocatable :: words
      integer :: position
      logical :: is_text, is_variable, title

      if (last_text(line) == 0) return
      if (is_comment(line)) return
      title = .false.
      is_text = .false.
      is_variable = .false.
      if (allocated(self%keyword)) then
         ! FILM, a keyword, is also a quantity.
         is_variable = is_output(self%keyword) .and. &
            scan(line(first_text(line):last_text(line)), ' ,=') == 0
         title = self%keyword == 'HEADING'
         is_text = title .or. self%keyword == 'STEP'
      end if
      if (.not. is_text .and. line(first_text(line):first_text(line)) == '#') then
         call self%report%error(place_type(image, first_text(line)), 'a comment begins with **', &
            'comments of other programs')
         return
      end if
      if (is_keyword(line) .or. .not. (is_text .or. self%skips_data)) then
         call find_look_alike(line, position, words)
         if (position > 0) then
            if (index(to_upper(line(:position)), 'SOURCE=') == 0) call self%report%possible_cause( &
               place_type(image, position), 'this character is '//words)
         end if
      end if
      if (is_keyword(line) .or. (.not. is_variable .and. lacks_star(line, title, self%cards))) then
         call self%finish()
         call split_fields(line, image, self%report, fields)
         if (.not. is_keyword(line)) then
            call self%report%error(fields(1)%place, 'a keyword without its asterisk; write *'// &
               to_upper(fields(1)%text))
            fields(1)%text = '*'//fields(1)%text
         end if
         call take_fields(self, fields)
         return
      end if
      if (allocated(self%pending)) then
         call split_fields(line, image, self%report, fields)
         if (is_parameter(self%pending(1)%text, fields(1)%text)) then
            ! The comma at the end of the card left an empty field.
            fields = [self%pending(:size(self%pending) - 1), fields]
            deallocate (self%pending)
            call take_fields(self, fields)
            return
         end if
         call self%finish()
      end if
      call take_data_line(self, line, image)
   end subroutine take_line

   !> Ends a card that waits for its continuation, which a keyword card need not have.
   subroutine finish(self)
      class(card_lines_type), intent(inout) :: self        !! what is open
      type(field_type), allocatable :: fields(:)

      if (allocated(self%pending)) then
         call move_alloc(self%pending, fields)
         call drop_empty_end(fields)
         call take_keyword(self, fields)
      else if (allocated(self%comma)) then
         call take_last(self, fields)
         call self%report%error(place_type(self%comma%place%image, self%comma%place%column - 1), &
            'the card ends in a comma, but nothing continues it')
         self%comma%undefined = .true.
         fields = [fields, self%comma]
         call add_data(self%cards, fields, self%comma%place)
         deallocate (self%comma)
      end if
   end subroutine finish

   !> Takes the last data card away again, which goes on.
   subroutine take_last(self, fields)
      type(card_lines_type), intent(inout) :: self
      type(field_type), allocatable, intent(out) :: fields(:)

      associate (card => self%cards%keywords(self%cards%keyword_count))
         call move_alloc(card%data(card%data_count)%fields, fields)
         card%data_count = card%data_count - 1
      end associate
   end subroutine take_last

   !> Takes the fields of a keyword card that may continue.
   subroutine take_fields(self, fields)
      type(card_lines_type), intent(inout) :: self
      type(field_type), allocatable, intent(inout) :: fields(:)

      if (size(fields) > 1 .and. len(fields(size(fields))%text) == 0) then
         call move_alloc(fields, self%pending)
      else
         call take_keyword(self, fields)
      end if
   end subroutine take_fields

   !> A complete keyword card. *INCLUDE leaves none: what it includes is in its place.
   subroutine take_keyword(self, fields)
      type(card_lines_type), intent(inout) :: self
      type(field_type), allocatable, intent(inout) :: fields(:)
      type(keyword_card_type) :: card
      integer :: i, width
      logical :: valid

      do i = 2, size(fields)
         call self%parameters%substitute(fields(i), self%report)
      end do
      call make_keyword_card(fields, self%report, self%cards, card)
      if (card%known > 0 .and. card%name == 'INCLUDE') then
         if (size(card%parameters) > 0) then
            self%include = card%parameters(1)%text
            self%include_place = card%parameters(1)%value_place
         else
            if (.not. card%flawed) call self%report%error(card%place, '*INCLUDE needs INPUT=')
            call self%report%lose()
         end if
         return
      end if
      if (card%name == 'OPTIONS') then
         width = self%width
         call take_parameter(card, 'WIDTH', self%report, width, '>=80')
         self%width = max(self%width, width)
      end if
      if (card%name == 'ELEMENT') self%element_fields = element_type_fields(card%text('TYPE'))
      self%keyword = card%name
      if (allocated(self%refusal_of_data)) deallocate(self%refusal_of_data)
      if (allocated(card%refusal_of_data)) self%refusal_of_data = card%refusal_of_data
      call take_format(card, self%report, self%columns, valid)
      self%skips_data = card%known == 0 .or. .not. valid
      card%data_lost = .not. valid
      call add_keyword(self%cards, card)
   end subroutine take_keyword

   subroutine take_data_line(self, line, image)
      type(card_lines_type), intent(inout) :: self
      character(*), intent(in) :: line
      integer, intent(in) :: image
      type(field_type), allocatable :: fields(:)
      logical :: valid

      if (.not. allocated(self%keyword)) then
         call self%report%error(place_type(image, first_text(line)), 'a data card before the '// &
            'first keyword')
         self%keyword = ''
         self%skips_data = .true.
      end if
      if (allocated(self%refusal_of_data)) then
         call self%report%error(place_type(image, first_text(line)), self%refusal_of_data)
         deallocate(self%refusal_of_data)
      end if
      if (self%skips_data) return
      if (self%keyword == 'STEP' .and. verify(line, '0123456789+-.eEdD, ') > 0) then
         call add_note(self%cards%notes, '*STEP: its title is ignored')
         return
      end if
      if (self%keyword == 'HEADING') then
         allocate(fields(1))
         fields(1)%text = line(first_text(line):last_text(line))
         fields(1)%place = place_type(image, first_text(line))
         call add_data(self%cards, fields, place_type(image, last_text(line) + 1))
         return
      end if
      if (allocated(self%columns%last)) then
         call split_columns(self%columns, line, image, self%report, fields, valid)
         call drop_empty_end(fields)
         if (.not. valid) self%cards%keywords(self%cards%keyword_count)%data_lost = .true.
      else
         call split_fields(line, image, self%report, fields)
         if (self%keyword /= 'PARAMETER') then
            call check_commas(self%cards, fields, self%report, valid)
            if (.not. valid) then
               self%cards%keywords(self%cards%keyword_count)%data_lost = .true.
               self%cards%keywords(self%cards%keyword_count)%flawed = .true.
               self%skips_data = .true.
               return
            end if
         end if
      end if
      if (self%keyword == 'ELEMENT') then
         call take_element(self, fields, image)
      else
         call take_data(self, fields, image)
      end if
   end subroutine take_data_line

   !> A line of elements, which may go on on the next line, or with the element before it: where
   !> that ends in a comma, a slip where the line is a whole element, or where the line has just the
   !> nodes that it lacks, as in CalculiX.
   subroutine take_element(self, fields, image)
      type(card_lines_type), intent(inout) :: self
      type(field_type), allocatable, intent(inout) :: fields(:)
      integer, intent(in) :: image
      type(field_type), allocatable :: before(:)
      type(field_type) :: last
      logical :: continues
      integer :: filled, i, so_far

      so_far = 0
      if (.not. allocated(self%comma)) then
         associate (card => self%cards%keywords(self%cards%keyword_count))
            if (card%data_count > 0) so_far = size(card%data(card%data_count)%fields)
         end associate
      end if
      continues = allocated(self%comma) .or. (so_far > 0 .and. so_far < self%element_fields)
      if (continues .and. self%element_fields > 0) then
         filled = count([(len(fields(i)%text) > 0, i=1, size(fields))])
         continues = allocated(self%comma) .neqv. so_far + filled == self%element_fields
      end if
      if (continues) then
         call take_last(self, before)
         fields = [before, pack(fields, [(len(fields(i)%text) > 0 .or. i == size(fields), &
            i=1, size(fields))])]
         if (allocated(self%comma)) deallocate (self%comma)
      else
         call self%finish()
      end if
      last = fields(size(fields))
      if (size(fields) > 1 .and. len(last%text) == 0 .and. size(fields) <= merge( &
         self%element_fields, most_fields, self%element_fields > 0)) self%comma = last
      call take_data(self, fields, image)
   end subroutine take_element

   subroutine take_data(self, fields, image)
      type(card_lines_type), intent(inout) :: self
      type(field_type), allocatable, intent(inout) :: fields(:)
      integer, intent(in) :: image
      integer :: i

      call drop_empty_end(fields)
      do i = 1, size(fields)
         if (self%keyword == 'PARAMETER') then
            call self%parameters%define(fields(i), self%cards%notes, self%report)
            cycle
         end if
         call self%parameters%substitute(fields(i), self%report)
         if (index(fields(i)%text, '"') > 0) fields(i)%text = without_quotes(fields(i)%text)
      end do
      if (self%keyword == 'PARAMETER') return
      call add_data(self%cards, fields, place_type(image, last_text( &
         self%report%source%images(image)%value) + 1))
   end subroutine take_data

end module card_lines
