!> *PART, *INSTANCE and *ASSEMBLY of Abaqus -> the flat deck that they stand for.
!>
!> An instance repeats the cards of its part, and may have cards of its own. Its sets and surfaces
!> become INSTANCE.NAME. Nodes and elements of the first instance keep their numbers; those of the
!> next ones, and last those of the assembly itself, are raised by multiples of a power of ten.
module assembly_cards
   use card_values, only: chosen, need_parameter, surface_kinds, take_parameter
   use cards, only: add_data, add_keyword, add_note, cards_type, data_card_type, field_type, &
      keyword_card_type, replace_cards
   use deck_report, only: deck_report_type
   use given_cards, only: exact_text, motion_type, read_motion
   use kinds, only: dp, long
   use name_index, only: name_index_type
   use spelling, only: nearest_known
   use text, only: read_integer, read_real, to_text, to_upper
   implicit none
   private
   public :: flatten_cards

   ! Levels at which a card may stand, the keywords that open those from 1 on, and the level at
   ! which each of these must stand.
   integer, parameter :: at_model = 0, at_part = 1, at_assembly = 2, at_instance = 3
   character(*), parameter :: structures(3) = [character(8) :: 'PART', 'ASSEMBLY', 'INSTANCE']
   integer, parameter :: outside(3) = [at_model, at_model, at_assembly]

   !> Where the cards of a part come to be.
   type, extends(motion_type) :: instance_type
      character(:), allocatable :: name       !! in upper case; empty for the assembly itself
      integer :: offset = 0                   !! what is added to numbers of nodes and elements
      logical :: moves = .false.              !! whether coordinates change
   end type instance_type

   !> State of the conversion between two cards.
   type :: reading_type
      integer :: level = at_model
      integer :: opened = 0                              !! keyword card that opened it
      type(name_index_type) :: parts                     !! those so far
      integer, allocatable :: first(:), last(:)          !! (parts) keyword cards within each
      type(name_index_type) :: names                     !! of the instances so far
      type(instance_type), allocatable :: instances(:)   !! the same
      integer :: begun = 1                               !! first one of the last *INSTANCE
      type(instance_type) :: assembly                    !! cards of the assembly itself
      character(:), allocatable :: prefix                !! the name of the assembly and a dot
      integer :: step = 0                                !! power of ten between instances
   end type reading_type

contains

   !> Replaces parts and instances by the cards that they stand for, at the place of the instance.
   !> Cards keep the places where the user wrote them.
   subroutine flatten_cards(cards, report)
      type(cards_type), intent(inout) :: cards
      type(deck_report_type), intent(inout) :: report   !! receives errors
      type(cards_type) :: all
      type(reading_type) :: open
      integer :: k, n, times
      logical :: is_number

      if (.not. any([(level_of(cards%keywords(k)%name) /= at_model .or. &
         cards%keywords(k)%has('INSTANCE'), k=1, size(cards%keywords))])) return
      allocate (open%first(0), open%last(0), open%instances(0))
      open%assembly%name = ''
      open%prefix = '.'
      n = 0
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name /= 'INSTANCE') cycle
         call read_integer(cards%keywords(k)%text('MULTIPLE'), times, is_number)
         n = n + merge(max(times, 1), 1, is_number)
      end do
      call find_step(cards, n, report, open%step)
      open%assembly%offset = n*open%step
      call move_alloc(cards%notes, all%notes)
      do k = 1, size(cards%keywords)
         call take_card(cards, k, open, all, report)
      end do
      if (open%level /= at_model) call report%error(cards%keywords(open%opened)%place, '*'// &
         cards%keywords(open%opened)%name//' has no *END '//cards%keywords(open%opened)%name)
      call move_alloc(all%notes, cards%notes)
      call replace_cards(cards, all)
   end subroutine flatten_cards

   !> Level that a keyword opens or ends; at_model where it belongs to no part and no assembly.
   pure integer function level_of(keyword)
      character(*), intent(in) :: keyword

      do level_of = size(structures), 1, -1
         if (keyword == structures(level_of) .or. keyword == 'END '//structures(level_of)) return
      end do
   end function level_of

   !> The smallest power of ten above all numbers of nodes and elements.
   subroutine find_step(cards, instances, report, step)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: instances
      type(deck_report_type), intent(inout) :: report
      integer, intent(out) :: step
      integer(long) :: largest, values(7)
      integer :: i, j, k, number
      logical :: valid

      largest = 1
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (all(card%name /= [character(7) :: 'NODE', 'ELEMENT', 'NGEN', 'ELGEN'])) cycle
            do j = 1, size(card%data)
               values = [0, 1, 1, 1, 1, 1, 1]
               do i = 1, 7
                  call read_integer(card%data(j)%text(i), number, valid)
                  if (valid) values(i) = abs(number)
               end do
               if (card%name == 'NGEN') values(1) = maxval(values(:2))
               if (card%name == 'ELGEN') values(1) = values(1) + (values(2) - 1)*values(4) + &
                  (values(5) - 1)*values(7)
               largest = max(largest, values(1))
            end do
         end associate
      end do
      step = 10
      do while (step <= largest .and. step < 10**9)
         step = 10*step
      end do
      if (instances == 0 .or. (step > largest .and. (instances + 1_long)*step <= huge(step))) return
      call report%error(cards%last, 'the numbers of nodes and elements of '//to_text(instances)// &
         ' instances would exceed '//to_text(huge(1)))
      step = 0
   end subroutine find_step

   !> Takes one card where it is.
   subroutine take_card(cards, k, open, all, report)
      type(cards_type), intent(in) :: cards
      integer, intent(in) :: k
      type(reading_type), intent(inout) :: open
      type(cards_type), intent(inout) :: all
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: name
      integer :: i, level

      associate (card => cards%keywords(k))
         level = level_of(card%name)
         if (level == at_model) then
            select case (open%level)
            case (at_part)
               open%last(size(open%last)) = k
            case (at_instance)
               do i = open%begun, size(open%instances)
                  call copy_card(card, open%instances(i), all)
               end do
            case default
               call take_flat(card, open, all, report)
            end select
         else if (index(card%name, 'END ') == 1) then
            if (open%level == level) then
               open%level = outside(level)
            else
               call report%error(card%place, '*'//card%name//' without *'//card%name(5:))
            end if
         else if (open%level /= outside(level)) then
            call report%error(card%place, '*'//card%name//' must be '//trim(merge( &
               'directly in an *ASSEMBLY      ', 'outside of *PART and *ASSEMBLY', &
               level == at_instance)))
         else
            open%level = level
            open%opened = k
            if (level == at_part) then
               call need_parameter(card, 'NAME', report, name)
               call open%parts%add(name)
               open%first = [open%first, k + 1]
               open%last = [open%last, k]
            else if (level == at_instance) then
               call open_instances(cards, card, open, all, report)
            else
               open%prefix = to_upper(card%text('NAME'))//'.'
            end if
         end if
      end associate
   end subroutine take_card

   !> Begins the instances of a card, of which each is moved once more than the one before.
   subroutine open_instances(cards, card, open, all, report)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(reading_type), intent(inout) :: open
      type(cards_type), intent(inout) :: all
      type(deck_report_type), intent(inout) :: report
      type(instance_type) :: instance
      type(motion_type) :: once
      character(:), allocatable :: name
      integer :: i, times

      call need_parameter(card, 'NAME', report, name)
      call read_motion(card%data, 1, report, once)
      instance%name = name
      instance%motion_type = once
      instance%moves = size(card%data) > 0
      open%begun = size(open%instances) + 1
      if (.not. card%has('MULTIPLE')) then
         call open_instance(cards, card, instance, open, all, report)
         return
      end if
      times = 1
      call take_parameter(card, 'MULTIPLE', report, times, '>=1')
      instance%motion_type = motion_type()
      do i = 1, times
         instance%name = name//'-'//to_text(i)
         call open_instance(cards, card, instance, open, all, report)
         instance%shift = once%moved(instance%shift)
         instance%turn = matmul(once%turn, instance%turn)
      end do
   end subroutine open_instances

   subroutine open_instance(cards, card, instance, open, all, report)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(instance_type), intent(inout) :: instance
      type(reading_type), intent(inout) :: open
      type(cards_type), intent(inout) :: all
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: part
      integer :: i, k

      instance%offset = size(open%instances)*open%step
      if (open%names%find(instance%name) > 0) call report%error(card%place_of('NAME'), &
         'instance '//instance%name//' is defined twice')
      call open%names%add(instance%name)
      open%instances = [open%instances, instance]
      if (instance%offset > 0) call add_note(all%notes, '*INSTANCE '//instance%name//': '// &
         'numbers of its nodes and elements are those of the part plus '//to_text(instance%offset))
      call need_parameter(card, 'PART', report, part)
      if (len(part) == 0) return
      i = open%parts%find(part)
      if (i == 0) then
         call report%missing(card%place_of('PART'), 'unknown part '//part// &
            nearest_known(part, open%parts%known()), 'part', part)
         return
      end if
      do k = open%first(i), open%last(i)
         call copy_card(cards%keywords(k), instance, all)
      end do
   end subroutine open_instance

   !> Takes a card of the assembly or of the model as it is, but for INSTANCE= of its members,
   !> INSTANCE.number, and the numbers of the assembly's own nodes and elements.
   subroutine take_flat(card, open, all, report)
      type(keyword_card_type), intent(in) :: card
      type(reading_type), intent(in) :: open
      type(cards_type), intent(inout) :: all
      type(deck_report_type), intent(inout) :: report
      type(instance_type) :: owner
      integer :: first, i, k

      first = all%keyword_count + 1
      owner%name = ''
      if (open%level == at_assembly) owner = open%assembly
      if (card%has('INSTANCE')) then
         owner%name = to_upper(card%text('INSTANCE'))
         owner%offset = 0
         i = open%names%find(owner%name)
         if (i > 0) then
            owner = open%instances(i)
         else
            call report%missing(card%place_of('INSTANCE'), 'unknown instance '//owner%name// &
               nearest_known(owner%name, open%names%known()), 'instance', owner%name)
         end if
      end if
      call copy_card(card, owner, all)
      associate (copy => all%keywords(first))
         do k = 1, size(copy%parameters)
            ! The set of the assembly, whose members are those of an instance.
            if (copy%parameters(k)%name == card%name) copy%parameters(k)%text = &
               card%parameters(k)%text
            call members_of_instance(open, copy%parameters(k)%text)
         end do
         do k = 1, copy%data_count
            do i = 1, size(copy%data(k)%fields)
               call members_of_instance(open, copy%data(k)%fields(i)%text)
            end do
         end do
      end associate
   end subroutine take_flat

   !> Adds a card of a part for an instance. Errors in it are reported where that of the part is.
   subroutine copy_card(card, instance, all)
      type(keyword_card_type), intent(in) :: card           !! one of its keyword cards
      type(instance_type), intent(in) :: instance
      type(cards_type), intent(inout) :: all                !! receives the copy
      type(keyword_card_type) :: copy
      type(field_type), allocatable :: fields(:)
      integer :: i, j

      copy = card
      do i = 1, size(copy%parameters)
         select case (copy%parameters(i)%name)   ! names of what the part has for itself
         case ('NSET', 'ELSET', 'SURFACE', 'ORIENTATION', 'REF NODE', 'NODE', 'ROT NODE', &
            'TIE NSET', 'PIN NSET', 'ANALYTICAL SURFACE')
            call prefix(instance, copy%parameters(i)%text)
         case ('NAME')
            if (any(card%name == [character(11) :: 'SURFACE', 'ORIENTATION'])) call &
               prefix(instance, copy%parameters(i)%text)
         case default
            continue
         end select
      end do
      call add_keyword(all, copy)
      do j = 1, size(card%data)
         fields = card%data(j)%fields
         call convert(card, card%data(j), j, instance, fields)
         call add_data(all, fields, card%data(j)%end)
      end do
   end subroutine copy_card

   !> Puts the name of the instance before a name, and adds its offset to a number.
   subroutine prefix(instance, text)
      type(instance_type), intent(in) :: instance
      character(:), allocatable, intent(inout) :: text
      integer :: number
      logical :: is_number

      if (len(text) == 0) return
      call read_integer(text, number, is_number)
      if (is_number) then
         text = to_text(number + instance%offset)
      else if (len(instance%name) > 0) then
         text = instance%name//'.'//text
      end if
   end subroutine prefix

   subroutine convert(card, data, position, instance, fields)
      type(keyword_card_type), intent(in) :: card
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position                       ! of the data card, from 1
      type(instance_type), intent(in) :: instance
      type(field_type), intent(inout) :: fields(:)
      type(instance_type) :: motion
      integer :: i, last, step

      ! Fields that are names or numbers of nodes and elements: those up to the last, by this step.
      last = size(fields)
      step = 1
      motion = instance
      select case (card%name)
      case ('NODE')
         last = 1
         call move_point(data, 2, motion, fields)
      case ('ELEMENT')
         continue
      case ('NSET', 'ELSET')
         if (card%has('GENERATE')) last = 2
      case ('NGEN', 'NFILL', 'TIE', 'CONTACT PAIR')
         last = 2
      case ('ELGEN', 'SURFACE')
         last = 1
         if (chosen(card, 'TYPE', surface_kinds) == 'SEGMENTS') then
            last = 0
            call move_point(data, 2, motion, fields)
            if (size(fields) > 3) call move_point(data, 4, motion, fields)
         end if
      case ('EQUATION')
         step = 3
         if (last == 1) last = 0
      case ('ORIENTATION')
         last = 0
         ! Points from the origin, or on the axis of a cylindrical system; then an angle.
         if (.not. card%has('SYSTEM')) motion%shift = 0.0_dp
         motion%moves = motion%moves .and. position == 1
         call move_point(data, 1, motion, fields)
         call move_point(data, 4, motion, fields)
      case default
         last = 0
      end select
      do i = 1, min(last, size(fields)), step
         call prefix(instance, fields(i)%text)
      end do
   end subroutine convert

   !> Turns and shifts the point whose x is a field; what is no number is reported elsewhere.
   subroutine move_point(data, at, instance, fields)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: at
      type(instance_type), intent(in) :: instance
      type(field_type), intent(inout) :: fields(:)
      real(dp) :: x(2)
      integer :: i
      logical :: valid

      if (.not. instance%moves) return
      do i = 1, 2
         x(i) = 0.0_dp
         if (len(data%text(at + i - 1)) == 0) cycle
         call read_real(data%text(at + i - 1), x(i), valid)
         if (.not. valid) return
      end do
      x = instance%moved(x)
      do i = 1, min(2, size(fields) - at + 1)
         fields(at + i - 1)%text = exact_text(x(i))
      end do
   end subroutine move_point

   !> Writes INSTANCE.number as the number that the node or element has in the whole deck. The name
   !> of the assembly may be before that of the instance or set.
   subroutine members_of_instance(open, text)
      type(reading_type), intent(in) :: open
      character(:), allocatable, intent(inout) :: text
      integer :: dot, i, number
      logical :: is_number

      if (len(open%prefix) > 1 .and. index(to_upper(text), open%prefix) == 1) then
         text = text(len(open%prefix) + 1:)
      end if
      dot = index(text, '.', back=.true.)
      if (dot < 2 .or. dot == len(text)) return
      if (verify(text(dot + 1:), '0123456789') > 0) return
      i = open%names%find(text(:dot - 1))
      if (i == 0) return
      call read_integer(text(dot + 1:), number, is_number)
      if (is_number) text = to_text(number + open%instances(i)%offset)
   end subroutine members_of_instance

end module assembly_cards
