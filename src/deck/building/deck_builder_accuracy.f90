!> *ACCURACY -> targets of the errors.
module deck_builder_accuracy
   use accuracy_targets, only: accuracy_target_type
   use card_parameters, only: take_from
   use card_values, only: check_extra, need_field
   use cards, only: cards_type, data_card_type, field_place, field_text, has_field, &
      keyword_card_type
   use deck_context, only: report_unknown
   use deck_report, only: deck_report_type
   use kinds, only: dp
   use model, only: model_type
   use named_items, only: find_named
   use quantity_types, only: find_quantity, quantity_type
   use spelling, only: known_choices
   use text, only: string_type, to_upper
   implicit none
   private
   public :: build_accuracy

contains

   !> Reads the targets of all cards.
   subroutine build_accuracy(cards, estimated, model, report)
      type(cards_type), intent(in) :: cards
      type(quantity_type), intent(in) :: estimated(:)      !! quantities whose errors are estimated
      type(model_type), intent(inout) :: model             !! receives the targets
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: k, j

      do k = 1, size(cards%keywords)
         associate (card => cards%keywords(k))
            if (card%name /= 'ACCURACY') cycle
            if (.not. allocated(model%accuracy%targets)) then
               allocate (model%accuracy%targets(0))
               call check_deck(card, model, report)
            end if
            call take_from(1, card, 'ROUNDS', report, model%accuracy%rounds)
            do j = card%first_data, card%last_data
               call build_target(cards%data(j), estimated, model, report)
            end do
         end associate
      end do
   end subroutine build_accuracy

   !> The targets need an interface and estimates.
   subroutine check_deck(card, model, report)
      type(keyword_card_type), intent(in) :: card
      type(model_type), intent(in) :: model
      type(deck_report_type), intent(inout) :: report

      if (size(model%contacts) == 0) call report%missing(card%place, 'the deck has no *CONTACT '// &
         'PAIR: there is no quantity that *ACCURACY could name')
      if (.not. model%estimates_errors) call report%error(card%place, '*ACCURACY needs '// &
         'estimated errors; leave ERRORS=NO out of *OPTIONS')
   end subroutine check_deck

   !> quantity, target, REL|ABS, interface.
   subroutine build_target(data, estimated, model, report)
      type(data_card_type), intent(in) :: data
      type(quantity_type), intent(in) :: estimated(:)
      type(model_type), intent(inout) :: model
      type(deck_report_type), intent(inout) :: report
      type(accuracy_target_type) :: target
      integer :: errors, i
      logical :: valid

      errors = report%error_count()
      call read_quantity(data, estimated, report, target%quantity)
      valid = .true.
      call need_field(data, 2, 'target', report, target%bound, valid)
      if (valid .and. target%bound <= 0.0_dp) call report%error(field_place(data, 2), &
         'the target must be above 0')
      select case (to_upper(field_text(data, 3)))
      case ('ABS')
         target%is_relative = .false.
      case ('', 'REL')
         target%is_relative = .true.
         if (target%bound >= 1.0_dp) call report%error(field_place(data, 2), &
            'a target relative to the value must be below 1; 0.01 is 1 %')
      case default
         call report%error(field_place(data, 3), ''''//field_text(data, 3)// &
            ''' is neither REL nor ABS')
      end select
      target%interface = 0
      if (has_field(data, 4) .and. size(model%contacts) > 0) then
         target%interface = find_named(model%contacts, field_text(data, 4))
         if (target%interface == 0) call report_unknown('contact pair', field_text(data, 4), &
            model%contacts, field_place(data, 4), report)
      end if
      do i = 1, size(model%accuracy%targets)
         associate (other => model%accuracy%targets(i))
            if (other%quantity == target%quantity .and. any(target%interface == [0, &
               other%interface] .or. other%interface == 0)) call report%error(field_place(data, &
               1), 'an earlier card has a target of '//target%quantity//' already')
         end associate
      end do
      call check_extra(data, 4, 'quantity, target, REL or ABS, contact pair', report)
      if (report%error_count() == errors) model%accuracy%targets = [model%accuracy%targets, target]
   end subroutine build_target

   subroutine read_quantity(data, estimated, report, name)
      type(data_card_type), intent(in) :: data
      type(quantity_type), intent(in) :: estimated(:)
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable, intent(out) :: name
      type(string_type) :: names(size(estimated))
      integer :: i
      logical :: valid

      valid = .true.
      name = ''
      call need_field(data, 1, 'quantity', report, name, valid)
      if (.not. valid) return
      i = find_quantity(estimated, name)
      if (i > 0) then
         name = trim(estimated(i)%name)
         return
      end if
      do i = 1, size(names)
         names(i)%value = trim(estimated(i)%name)
      end do
      call report%error(field_place(data, 1), 'no error of '//name//' is estimated'// &
         known_choices(name, names))
   end subroutine read_quantity

end module deck_builder_accuracy
