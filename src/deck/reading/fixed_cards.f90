!> Data cards of *NODE and *ELEMENT in the fixed columns of FORMAT=: lines -> fields.
module fixed_cards
   use card_formats, only: card_format_type, edit_real, edit_whole, parse_format, unquoted_format
   use card_parameters, only: has_parameter, parameter_place, parameter_text
   use cards, only: field_type, keyword_card_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use fixed_columns, only: cut_line
   implicit none
   private
   public :: fixed_cards_type

   integer, parameter :: least_of_node = 3, most_of_node = 4   !! number, x, y, z

   !> The format of the keyword card that is open, and the card that is not complete yet.
   type :: fixed_cards_type
      private
      logical :: open = .false.                     !! whether the keyword card has a format
      type(card_format_type) :: format              !! the format
      integer :: due = 0                            !! fields of a complete card
      integer :: edit = 1                           !! where the format goes on
      logical :: sound = .true.                     !! whether the card can be used
      type(field_type), allocatable :: fields(:)    !! its fields so far
   contains
      procedure :: begin
      procedure :: is_open
      procedure :: take
      procedure :: release
   end type fixed_cards_type

contains

   !> Begins a keyword card, which may have a format.
   subroutine begin(self, card, element_fields, report, valid)
      class(fixed_cards_type), intent(inout) :: self      !! receives the format
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: element_fields               !! of an *ELEMENT; 0 for an unknown type
      type(deck_report_type), intent(inout) :: report     !! receives an error
      logical, intent(out) :: valid                       !! false after it: data cannot be read
      character(:), allocatable :: fault
      type(place_type) :: place
      integer :: position, n
      logical :: quoted

      valid = .true.
      self%open = has_parameter(card, 'FORMAT')
      if (.not. self%open) return
      self%edit = 1
      self%sound = .true.
      if (allocated(self%fields)) deallocate(self%fields)
      call parse_format(parameter_text(card, 'FORMAT'), self%format, position, fault)
      place = parameter_place(card, 'FORMAT')
      quoted = report%source%images(place%image)%value(place%column:place%column) == '"'
      if (len(fault) == 0) then
         associate (kinds => self%format%edits%kind)
            n = count(kinds == edit_whole .or. kinds == edit_real)
            if (card%name == 'NODE') then
               self%due = n
               if (.not. reads_node(pack(kinds, kinds == edit_whole .or. kinds == edit_real))) then
                  fault = 'FORMAT= of *NODE reads a whole number, I, and x, y and perhaps z, F'
               end if
            else
               self%due = element_fields
               if (self%due == 0) self%due = n
               if (any(kinds == edit_real)) fault = 'FORMAT= of *ELEMENT reads whole numbers, I'
            end if
         end associate
      else if (quoted) then
         place%column = place%column + position
      else
         fault = unquoted_format
      end if
      valid = len(fault) == 0
      if (.not. valid) call report%error(place, fault)
   end subroutine begin

   pure logical function reads_node(kinds)
      integer, intent(in) :: kinds(:)   !! of the fields

      reads_node = size(kinds) >= least_of_node .and. size(kinds) <= most_of_node
      if (reads_node) reads_node = kinds(1) == edit_whole .and. all(kinds(2:) == edit_real)
   end function reads_node

   !> Whether data cards are in fixed columns.
   pure logical function is_open(self)
      class(fixed_cards_type), intent(in) :: self   !! the format

      is_open = self%open
   end function is_open

   !> Takes one line.
   subroutine take(self, line, image, report, complete)
      class(fixed_cards_type), intent(inout) :: self      !! the format
      character(*), intent(in) :: line                    !! card image
      integer, intent(in) :: image                        !! its running number
      type(deck_report_type), intent(inout) :: report     !! receives an error
      logical, intent(out) :: complete                    !! whether all fields that are due are
      type(field_type), allocatable :: more(:), all(:)
      integer :: i, n
      logical :: sound

      n = 0
      if (allocated(self%fields)) n = size(self%fields)
      call cut_line(line, image, self%format, self%due - n, self%edit, more, sound, report)
      self%sound = self%sound .and. sound
      allocate(all(n + size(more)))
      do i = 1, n
         all(i) = self%fields(i)
      end do
      do i = 1, size(more)
         all(n + i) = more(i)
      end do
      call move_alloc(all, self%fields)
      complete = size(self%fields) == self%due
   end subroutine take

   !> Hands over the fields of a card, complete or not; none where there is no card, or none that
   !> can be used.
   subroutine release(self, fields)
      class(fixed_cards_type), intent(inout) :: self               !! the format
      type(field_type), allocatable, intent(out) :: fields(:)  !! the fields; unallocated for none

      if (self%sound) call move_alloc(self%fields, fields)
      if (allocated(self%fields)) deallocate(self%fields)
      self%sound = .true.
      self%edit = 1
   end subroutine release

end module fixed_cards
