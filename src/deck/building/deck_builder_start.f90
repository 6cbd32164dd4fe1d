!> *START: where the fixed point of an increment starts.
module deck_builder_start
   use card_parameters, only: choose, lacks_parameter
   use card_values, only: check_extra, need_field
   use cards, only: cards_type, data_card_type, field_place, keyword_card_type
   use controls, only: start_both, start_closed, start_given, start_open, start_previous, start_type
   use deck_context, only: report_unknown
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use model, only: model_type
   use text, only: string_type, to_upper
   implicit none
   private
   public :: build_start

contains

   !> Takes one *START; after an error the start stays as it was.
   subroutine build_start(cards, card, model, report, start)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model              !! its interfaces
      type(deck_report_type), intent(inout) :: report    !! receives errors
      type(start_type), intent(inout) :: start           !! receives the start
      character(:), allocatable :: from

      from = ''
      if (lacks_parameter(card, 'FROM')) call report%error(card%place, '*START needs FROM=')
      call choose(card, 'FROM', 'PREVIOUS/OPEN/CLOSED/BOTH/GIVEN', report, from)
      if (from == 'GIVEN') then
         call build_given(cards, card, model, report, start)
         return
      else if (card%last_data >= card%first_data .and. from /= '') then
         call report%error(field_place(cards%data(card%first_data), 1), &
            'extra data card; *START has them with FROM=GIVEN only')
      end if
      select case (from)
      case ('PREVIOUS')
         start%kind = start_previous
      case ('OPEN')
         start%kind = start_open
      case ('CLOSED')
         start%kind = start_closed
      case ('BOTH')
         start%kind = start_both
      case default
         return
      end select
   end subroutine build_start

   !> Interface and conductance, a card each.
   subroutine build_given(cards, card, model, report, start)
      type(cards_type), intent(in) :: cards
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      type(start_type), intent(inout) :: start
      real(dp) :: given(size(model%contacts)), value
      integer :: i, k
      logical :: sound, valid

      given = 0.0_dp
      sound = .true.
      do k = card%first_data, card%last_data
         associate (data => cards%data(k))
            valid = .true.
            call find_contact(data, model, report, i, valid)
            value = 0.0_dp
            call need_field(data, 2, 'conductance', report, value, valid)
            call check_extra(data, 2, 'contact pair, conductance', report)
            if (valid .and. value <= 0.0_dp) then
               call report%error(field_place(data, 2), 'the conductance must be positive')
               valid = .false.
            end if
            if (valid) given(i) = value
            sound = sound .and. valid
         end associate
      end do
      if (.not. sound) return
      do i = 1, size(given)
         if (given(i) > 0.0_dp) cycle
         call report%error(card%place, '*START, FROM=GIVEN gives no conductance to '// &
            model%contacts(i)%name)
         return
      end do
      start = start_type(kind=start_given, conductance=given)
   end subroutine build_given

   !> The interface that a card names.
   subroutine find_contact(data, model, report, contact, valid)
      type(data_card_type), intent(in) :: data
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report
      integer, intent(out) :: contact
      logical, intent(inout) :: valid
      character(:), allocatable :: name
      type(string_type) :: names(size(model%contacts))
      integer :: i

      contact = 0
      name = ''
      call need_field(data, 1, 'contact pair', report, name, valid)
      if (.not. valid) return
      do i = 1, size(names)
         names(i)%value = model%contacts(i)%name
         if (to_upper(names(i)%value) == to_upper(name)) contact = i
      end do
      if (contact > 0) return
      call report_unknown('contact pair', name, names, field_place(data, 1), report)
      valid = .false.
   end subroutine find_contact

end module deck_builder_start
