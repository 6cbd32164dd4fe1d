!> A deck while its model is built: what is wrong with it, numbers and names -> indexes, places for
!> messages, loads to be applied when the mesh is final; and how a card names nodes and elements.
module deck_context
   use card_values, only: need_parameter, read_field
   use cards, only: add_note, cards_type, data_card_type, keyword_card_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use keywords, only: known_keywords
   use kinds, only: dp
   use load_requests, only: request_list_type, target_type
   use mesh, only: mesh_type, set_type
   use model, only: model_type
   use name_index, only: is_pattern, name_index_type
   use number_lists, only: number_list_type
   use quantity_types, only: quantity_type
   use sorting, only: number_index_type
   use spelling, only: known_choices, nearest_known
   use text, only: read_integer, string_type, to_upper
   use print_requests, only: time_points_type
   implicit none
   private
   public :: deck_type, item_index_type, place_list_type, plane_by_element

   integer, parameter :: plane_by_element = 0   !! PLANE= was not given: element names decide

   integer, parameter :: known_count = size(known_keywords)

   !> Places in a row.
   type :: place_list_type
      type(place_type), allocatable :: items(:)   !! the places
   end type place_list_type

   !> What has a name. One of the first two may be taken for the other.
   character(*), parameter :: nouns(9) = [character(19) :: 'node set', 'element set', 'surface', &
      'material', 'orientation', 'amplitude', 'surface interaction', 'contact pair', 'time points']

   !> Index of the numbers of nodes or of elements.
   type, extends(number_index_type) :: item_index_type
      character(:), allocatable :: noun           !! node or element
   end type item_index_type

   !> A deck and what is wrong with it.
   type, extends(deck_report_type) :: deck_type
      type(cards_type), pointer :: cards => null()        !! its cards, which nobody changes
      type(keyword_card_type), pointer :: card => null()  !! the one that is read
      integer, private :: card_index = 0                  !! its position among the keyword cards
      type(model_type), pointer :: model => null()        !! what its cards make
      type(mesh_type), pointer :: mesh => null()          !! its mesh
      type(quantity_type), allocatable :: verifiable(:)   !! what *VERIFY may name
      type(item_index_type) :: node_index                 !! numbers of nodes -> indexes
      type(item_index_type) :: element_index              !! numbers of elements -> indexes
      !> numbers of elements and, behind them, of lines -> indexes
      type(item_index_type) :: member_index
      integer, allocatable :: line_number(:)              !! (lines) numbers of the lines
      integer, allocatable :: line_nodes(:, :)            !! (3, lines) indexes, 0 behind the last
      type(place_type), allocatable :: line_place(:)      !! (lines) where the line is
      integer, allocatable :: line_kind(:)                !! (lines) drawn_line, ...
      type(set_type), allocatable :: line_sets(:)         !! (element sets) their lines
      type(place_type), allocatable :: element_place(:)   !! (elements) where the element is
      logical, allocatable :: element_valid(:)            !! (elements) whether its nodes are known
      type(place_type), allocatable :: node_place(:)      !! (nodes) where the node is
      logical, allocatable :: node_valid(:)               !! (nodes) whether its place is known
      real(dp), allocatable :: node_height(:)             !! (nodes of cards) third coordinates
      type(place_list_type), allocatable :: face_places(:)   !! (surfaces) where each face is named
      type(place_type), allocatable :: material_place(:)  !! (materials) where the material is
      type(place_type), allocatable :: step_place(:)      !! (steps) where the step is
      type(time_points_type), allocatable :: time_points(:)   !! *TIME POINTS
      type(name_index_type), private :: names(size(nouns))   !! of each noun, -> indexes
      type(number_list_type), private :: used(size(nouns))   !! indexes that cards refer to
      type(place_type), allocatable :: analysis_place(:)  !! (steps) where its analysis is
      !> PLANE=, a plane of element_kinds
      integer :: plane = plane_by_element
      integer :: order = 2                                !! ORDER= of the elements, 1 or 2
      logical, allocatable :: dropped(:)                  !! (nodes) whether ORDER=1 drops them
      integer :: levels = 0                               !! *REFINE, LEVELS=
      type(place_type) :: levels_place                    !! where it is
      character(:), allocatable :: load_set   !! LOAD=: node set; unallocated when not given
      type(place_type) :: load_place                      !! where it is
      type(request_list_type) :: boundaries               !! *BOUNDARY
      type(request_list_type) :: loads                    !! all other loads
      integer :: load_cards = 0                           !! data cards of these loads
      integer :: load_step(known_count) = -1              !! last step with a card of each keyword
      type(request_list_type) :: temperatures             !! *INITIAL CONDITIONS
      logical :: sections_sound = .true.     !! whether all elements of *SOLID SECTION are known
      logical :: analyses_sound = .true.     !! whether it is known what all steps solve, and when
      type(string_type), allocatable :: notes(:)          !! lines for the listing
   contains
      procedure :: open_card
      procedure :: note
      procedure :: index_of
      procedure :: add_name
      procedure :: take_name
      procedure :: need_named
      procedure :: take_named
      procedure :: need_item
      procedure :: need_items
      procedure :: find_matches
      procedure :: need_element_set
      procedure :: need_target
      procedure :: look_up
      procedure :: unused
   end type deck_type

contains

   !> Begins to read a keyword card.
   subroutine open_card(self, k)
      class(deck_type), intent(inout) :: self
      integer, intent(in) :: k                          !! index of the card

      self%card_index = k
      self%card => self%cards%keywords(k)
   end subroutine open_card

   !> Notes a default that was used or a card that is not needed.
   subroutine note(self, line)
      class(deck_type), intent(inout) :: self
      character(*), intent(in) :: line                  !! the note; each is kept once

      call add_note(self%notes, line)
   end subroutine note

   !> Index of the item that has a name; 0 where none has.
   pure integer function index_of(self, noun, name)
      class(deck_type), intent(in) :: self
      character(*), intent(in) :: noun                  !! such as material
      character(*), intent(in) :: name                  !! in any case

      index_of = self%names(findloc(nouns == noun, .true., dim=1))%find(name)
   end function index_of

   !> Adds the name of the next item.
   pure subroutine add_name(self, noun, name)
      class(deck_type), intent(inout) :: self
      character(*), intent(in) :: noun                  !! such as material
      character(*), intent(in) :: name                  !! in any case

      call self%names(findloc(nouns == noun, .true., dim=1))%add(name)
   end subroutine add_name

   !> Takes the name of an item, NAME= of the card. That it has none, or that of an earlier one, is
   !> an error; another name may have been meant.
   subroutine take_name(self, noun, name)
      class(deck_type), intent(inout) :: self           !! receives the name, and errors
      character(*), intent(in) :: noun                  !! such as material
      character(:), allocatable, intent(out) :: name
      integer :: first

      call need_parameter(self%card, 'NAME', self, name)
      first = self%card_index
      if (len(name) > 0 .and. self%index_of(noun, name) > 0) then
         do first = 1, self%card_index - 1
            associate (other => self%cards%keywords(first))
               if (other%name == self%card%name .and. to_upper(other%text('NAME')) == name) exit
            end associate
         end do
         call self%error(self%card%place_of('NAME'), noun//' '//name//' is defined twice, '// &
            'first on '//self%source%words_of(self%cards%keywords(first)%place))
      end if
      if (first < self%card_index .or. len(name) == 0) call self%lose(noun)
      call self%add_name(noun, name)
   end subroutine take_name

   !> Index of the item that a parameter names, which the card must have; 0 after an error.
   subroutine need_named(self, parameter, noun, index)
      class(deck_type), intent(inout) :: self           !! receives errors
      character(*), intent(in) :: parameter             !! the parameter
      character(*), intent(in) :: noun                  !! what it names, such as material
      integer, intent(out) :: index
      character(:), allocatable :: name

      index = 0
      call need_parameter(self%card, parameter, self, name)
      if (len(name) > 0) call self%look_up(noun, name, self%card%place_of(parameter), index)
   end subroutine need_named

   !> Index of the item that a parameter names, where the card has it; else it stays as it is.
   subroutine take_named(self, parameter, noun, index)
      class(deck_type), intent(inout) :: self           !! receives errors
      character(*), intent(in) :: parameter             !! the parameter
      character(*), intent(in) :: noun                  !! what it names, such as material
      integer, intent(inout) :: index                   !! 0 after an error

      if (self%card%has(parameter)) call self%need_named(parameter, noun, index)
   end subroutine take_named

   !> Index of the item that a field of a data card names; 0 after an error.
   subroutine need_item(self, data, position, noun, what, index)
      class(deck_type), intent(inout) :: self           !! receives errors
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position                   !! the field
      character(*), intent(in) :: noun                  !! what it names, such as surface
      character(*), intent(in) :: what                  !! what the field holds
      integer, intent(out) :: index
      character(:), allocatable :: name
      logical :: valid

      index = 0
      valid = .true.
      call read_field(data, position, what, self, name, valid)
      if (valid) call self%look_up(noun, to_upper(name), data%place(position), index)
   end subroutine need_item

   !> Indexes of the items that a field means by a name or by a pattern; none after an error.
   subroutine need_items(self, data, position, noun, what, indexes)
      class(deck_type), intent(inout) :: self           !! receives errors
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position                   !! the field
      character(*), intent(in) :: noun                  !! what it names, such as surface
      character(*), intent(in) :: what                  !! what the field holds
      integer, allocatable, intent(out) :: indexes(:)
      integer :: index

      if (is_pattern(data%text(position))) then
         call self%find_matches(data, position, noun, indexes)
      else
         call self%need_item(data, position, noun, what, index)
         indexes = pack([index], index > 0)
      end if
   end subroutine need_items

   !> Indexes of the items, among the first ones, that a field means by a pattern; none is an error.
   subroutine find_matches(self, data, position, noun, indexes, known)
      class(deck_type), intent(inout) :: self           !! receives the error
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position                   !! the field
      character(*), intent(in) :: noun                  !! such as surface
      integer, allocatable, intent(out) :: indexes(:)
      integer, intent(in), optional :: known            !! items so far
      type(string_type), allocatable :: names(:)
      character(:), allocatable :: pattern
      integer :: k, most

      most = huge(most)
      if (present(known)) most = known
      k = findloc(nouns == noun, .true., dim=1)
      indexes = self%names(k)%matching(data%text(position))
      indexes = pack(indexes, indexes <= most)
      call self%used(k)%add(indexes)
      if (size(indexes) > 0) return
      names = self%names(k)%known()
      pattern = to_upper(data%text(position))
      call self%missing(data%place(position), 'no '//noun//' matches '//pattern// &
         nearest_known(pattern, names(:min(size(names), most))), noun, pattern)
   end subroutine find_matches

   !> Index of the item that has a name; 0 after an error.
   subroutine look_up(self, noun, name, place, index)
      class(deck_type), intent(inout) :: self           !! receives errors
      character(*), intent(in) :: noun                  !! such as material
      character(*), intent(in) :: name
      type(place_type), intent(in) :: place             !! where it is
      integer, intent(out) :: index

      index = self%index_of(noun, name)
      if (index == 0) call report_unknown(self, noun, name, place, huge(index))
      if (index > 0) call self%used(findloc(nouns == noun, .true., dim=1))%add([index])
   end subroutine look_up

   !> The first items of a noun that no card refers to.
   pure function unused(self, noun, count) result(indexes)
      class(deck_type), intent(in) :: self
      character(*), intent(in) :: noun                  !! such as material
      integer, intent(in) :: count                      !! how many are asked for
      integer, allocatable :: indexes(:)
      logical :: is_used(count)
      integer :: i

      is_used = .false.
      is_used(self%used(findloc(nouns == noun, .true., dim=1))%numbers()) = .true.
      indexes = pack([(i, i=1, count)], .not. is_used)
   end function unused

   subroutine report_unknown(self, noun, name, place, most)
      class(deck_type), intent(inout) :: self           !! receives the error
      character(*), intent(in) :: noun, name
      type(place_type), intent(in) :: place
      integer, intent(in) :: most                       !! names that may be meant, the first ones
      type(string_type), allocatable :: known(:)
      character(:), allocatable :: message

      if (noun == 'node set' .and. self%index_of('element set', name) > 0) then
         message = name//' is an element set, and a node set is due here; *NSET, NSET='//name// &
            ', ELSET='//name//' makes one of its nodes'
      else if (noun == 'element set' .and. self%index_of('node set', name) > 0) then
         message = name//' is a node set, and an element set is due here; give its elements a '// &
            'name by *ELSET'
      else if (is_pattern(name)) then
         message = name//' is a pattern, and one name is due here; patterns are data of *NSET, '// &
            '*ELSET, *SURFACE, *CONTACT PAIR and what changes it: make a set or surface of all'
      else
         known = self%names(findloc(nouns == noun, .true., dim=1))%known()
         known = known(:min(size(known), most))
         message = 'unknown '//noun//' '//name
         ! Sets and surfaces may be many, and the mesh's.
         if (any(nouns(:3) == noun)) then
            message = message//nearest_known(name, known)
         else
            message = message//known_choices(name, known)
         end if
      end if
      call self%missing(place, message, noun, name)
   end subroutine report_unknown

   !> Index of the element set that ELSET= of the card names; 0 after an error.
   subroutine need_element_set(self, set)
      class(deck_type), intent(inout) :: self           !! receives errors
      integer, intent(out) :: set

      call self%need_named('ELSET', 'element set', set)
      if (set == 0) return
      if (.not. self%mesh%element_sets(set)%of_lines) return
      call report_lines(self%mesh%element_sets(set)%name, self%card%place_of('ELSET'), self)
      set = 0
   end subroutine need_element_set

   !> Reads the field of a card that names a node or an element by its number, or a set of them by
   !> its name. While sets are built those so far are known, and elements are lines, too.
   subroutine need_target(self, noun, data, position, target, valid, known)
      class(deck_type), intent(inout) :: self           !! receives errors
      character(*), intent(in) :: noun                  !! node or element
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position                   !! position of the field
      type(target_type), intent(out) :: target
      logical, intent(inout) :: valid                   !! becomes false after an error
      integer, intent(in), optional :: known            !! sets so far
      character(:), allocatable :: name
      integer :: most, number
      logical :: is_number

      call read_field(data, position, noun//' or set', self, name, valid)
      if (len(name) == 0) return
      most = huge(most)
      if (present(known)) most = known
      call read_integer(name, number, is_number)
      if (.not. is_number) then
         target%set = self%index_of(noun//' set', name)
         if (target%set > most) target%set = 0
      else if (noun == 'node') then
         target%item = self%node_index%find(number)
      else if (present(known)) then
         target%item = self%member_index%find(number)
      else
         target%item = self%element_index%find(number)
      end if
      if (target%set > 0 .and. noun == 'element' .and. .not. present(known)) then
         if (self%mesh%element_sets(target%set)%of_lines) then
            call report_lines(self%mesh%element_sets(target%set)%name, data%place(position), self)
            valid = .false.
         end if
      end if
      if (target%item > 0 .or. target%set > 0) return
      valid = .false.
      if (is_number .or. verify(name, '0123456789') == 0) then
         call self%missing(data%place(position), 'there is no '//noun//' '//name, noun, name)
      else
         call report_unknown(self, noun//' set', to_upper(name), data%place(position), most)
      end if
   end subroutine need_target

   !> Reports an element set that has lines only where elements or their faces are due.
   subroutine report_lines(name, place, report)
      character(*), intent(in) :: name                  !! the set
      type(place_type), intent(in) :: place             !! where it is
      class(deck_report_type), intent(inout) :: report  !! receives the error

      call report%error(place, 'element set '//name// &
         ' contains only lines, springs or trusses; make a *SURFACE or an *NSET of lines')
   end subroutine report_lines

end module deck_context
