!> *TIE -> faces that are tied.
module deck_builder_ties
   use card_parameters, only: choose, has_parameter, parameter_place, parameter_text, take_parameter
   use card_values, only: check_extra
   use cards, only: cards_type, field_place, keyword_card_type
   use contact_definitions, only: tie_definition_type
   use deck_builder_contact, only: read_surface
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use model, only: model_type
   use text, only: to_upper
   implicit none
   private
   public :: build_ties

contains

   !> Takes all ties, one for each data card.
   subroutine build_ties(cards, context, model, report)
      type(cards_type), intent(in) :: cards
      type(deck_context_type), intent(inout) :: context    !! receives notes
      type(model_type), intent(inout) :: model             !! receives the ties
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: i, k, n

      n = 0
      do k = 1, size(cards%keywords)
         if (cards%keywords(k)%name == 'TIE') n = n + max(0, cards%keywords(k)%last_data - &
            cards%keywords(k)%first_data + 1)
      end do
      allocate(model%ties(n))
      n = 0
      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (card%name /= 'TIE') cycle
            call check_card(card, model%ties(:n), context, report)
            do i = card%first_data, card%last_data
               n = n + 1
               call build_tie(cards, card, i, context, model, report, model%ties(n))
            end do
         end associate
      end do
   end subroutine build_ties

   !> What a card says for all its ties: a name of its own, no node is moved.
   subroutine check_card(card, ties, context, report)
      type(keyword_card_type), intent(in) :: card
      type(tie_definition_type), intent(in) :: ties(:)     ! those of the cards before
      type(deck_context_type), intent(inout) :: context
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable :: adjust
      integer :: i

      call choose(card, 'ADJUST', 'YES/NO', report, adjust)
      if (.not. allocated(adjust)) adjust = 'NO'
      if (adjust == 'YES') call context%note('*TIE, ADJUST=YES: nodes are not moved, an '// &
         'initial gap is not closed')
      if (.not. has_parameter(card, 'NAME')) return
      do i = 1, size(ties)
         if (to_upper(ties(i)%faces%name) /= to_upper(parameter_text(card, 'NAME'))) cycle
         call report%error(parameter_place(card, 'NAME'), ties(i)%faces%title()// &
            ' is defined twice')
         return
      end do
   end subroutine check_card

   subroutine build_tie(cards, card, data_card, context, model, report, tie)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: data_card
      type(deck_context_type), intent(inout) :: context
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(tie_definition_type), intent(out) :: tie

      tie%faces%is_tied = .true.
      tie%faces%card = card%place%image
      tie%faces%name = parameter_text(card, 'NAME')
      tie%has_tolerance = has_parameter(card, 'POSITION TOLERANCE')
      call take_parameter(card, 'POSITION TOLERANCE', report, tie%tolerance)
      if (tie%tolerance < 0.0_dp) call report%error(parameter_place(card, &
         'POSITION TOLERANCE'), 'POSITION TOLERANCE is a distance, 0 or more')
      associate (data => cards%data(data_card))
         call read_surface(data, 1, 'slave surface', model%mesh, report, tie%faces%slave)
         call read_surface(data, 2, 'master surface', model%mesh, report, tie%faces%master)
         call check_extra(data, 2, 'slave surface, master surface', report)
         if (tie%faces%slave > 0 .and. tie%faces%slave == tie%faces%master) then
            call report%error(field_place(data, 2), 'a surface cannot be tied to itself')
         end if
         if (has_parameter(card, 'NAME')) return
         if (size(data%fields) > 0) tie%faces%name = data%fields(1)%text
         call context%note('*TIE without NAME=: '//tie%faces%name//', the slave surface')
      end associate
   end subroutine build_tie

end module deck_builder_ties
