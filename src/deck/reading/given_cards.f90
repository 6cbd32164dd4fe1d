!> The nodes and elements of the cards so far, by which others are generated.
module given_cards
   use cards, only: data_card_type, field_text
   use kinds, only: dp
   use text, only: read_integer, read_real
   implicit none
   private
   public :: given_type, position_of

   integer, parameter :: most_nodes = 8              !! of an element

   !> Nodes and elements of the cards so far.
   type :: given_type
      integer :: nodes = 0                        !! number of nodes
      integer, allocatable :: node(:)             !! (capacity) their numbers
      real(dp), allocatable :: place(:, :)        !! (2, capacity) [length]
      integer :: elements = 0                     !! number of elements
      integer, allocatable :: element(:)          !! (capacity) their numbers
      integer, allocatable :: corners(:, :)       !! (most_nodes, capacity) their nodes, 0 behind
      integer, allocatable :: keyword(:)          !! (capacity) keyword card that gives the type
   contains
      procedure :: begin
      procedure :: note
      procedure :: keep_node
   end type given_type

contains

   !> Begins without any.
   subroutine begin(self)
      class(given_type), intent(out) :: self

      allocate(self%node(0), self%place(2, 0), self%element(0), self%corners(most_nodes, 0), &
         self%keyword(0))
   end subroutine begin

   !> Remembers a node or an element; fields that are no numbers are reported elsewhere.
   subroutine note(self, keyword, data, position)
      class(given_type), intent(inout) :: self
      character(*), intent(in) :: keyword          !! NODE, ELEMENT or another one
      type(data_card_type), intent(in) :: data     !! its data card
      integer, intent(in) :: position              !! of the keyword card
      real(dp) :: place(2)
      integer :: number, corners(most_nodes), i
      logical :: valid

      call read_integer(field_text(data, 1), number, valid)
      if (.not. valid) return
      if (keyword == 'NODE') then
         do i = 1, 2
            call read_real(field_text(data, i + 1), place(i), valid)
            if (.not. valid) place(i) = 0.0_dp
         end do
         call self%keep_node(number, place)
      else if (keyword == 'ELEMENT') then
         corners = 0
         do i = 1, min(most_nodes, size(data%fields) - 1)
            call read_integer(field_text(data, i + 1), corners(i), valid)
            if (.not. valid) corners(i) = 0
         end do
         call keep_element(self, number, corners, position)
      end if
   end subroutine note

   !> Remembers a node.
   subroutine keep_node(self, number, place)
      class(given_type), intent(inout) :: self
      integer, intent(in) :: number            !! its number
      real(dp), intent(in) :: place(2)         !! [length]
      integer :: n

      n = self%nodes
      if (n == size(self%node)) then
         self%node = [self%node, spread(0, 1, n + 64)]
         self%place = reshape(self%place, [2, 2*n + 64], pad=[0.0_dp])
      end if
      self%node(n + 1) = number
      self%place(:, n + 1) = place
      self%nodes = n + 1
   end subroutine keep_node

   subroutine keep_element(self, number, corners, position)
      class(given_type), intent(inout) :: self
      integer, intent(in) :: number, corners(most_nodes), position
      integer :: n

      n = self%elements
      if (n == size(self%element)) then
         self%element = [self%element, spread(0, 1, n + 64)]
         self%keyword = [self%keyword, spread(0, 1, n + 64)]
         self%corners = reshape(self%corners, [most_nodes, 2*n + 64], pad=[0])
      end if
      self%element(n + 1) = number
      self%corners(:, n + 1) = corners
      self%keyword(n + 1) = position
      self%elements = n + 1
   end subroutine keep_element

   !> Position of a number in a list; 0 where it is not.
   pure integer function position_of(number, list)
      integer, intent(in) :: number    !! what is looked for
      integer, intent(in) :: list(:)   !! the last one counts

      do position_of = size(list), 1, -1
         if (list(position_of) == number) return
      end do
   end function position_of

end module given_cards
