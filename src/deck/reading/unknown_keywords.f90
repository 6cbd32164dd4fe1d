!> What is said of keywords and parameters that nobody knows: which they likely are by their
!> spelling, or what to write in their place by their meaning.
module unknown_keywords
   use cards, only: keyword_card_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use foreign_keywords, only: misspelt_foreign
   use keyword_meanings, only: is_meaning, keyword_advice, parameter_advice
   use keywords, only: built, find_parameter, keyword_names, known_keywords, &
      known_parameter_type, parameter_names, refused
   use spelling, only: edit_distance, is_slip, nearest_name
   use text, only: string_type, to_upper
   implicit none
   private
   public :: report_unknown_keyword, report_unknown_parameter

contains

   !> Reports a keyword that nobody knows, with the known one that it likely is by its spelling, or
   !> with what to write in its place by its meaning. All its cards are one mistake.
   subroutine report_unknown_keyword(name, is_text, report, card)
      character(*), intent(in) :: name
      logical, intent(in) :: is_text   ! whether a blank follows the star
      type(deck_report_type), intent(inout) :: report
      type(keyword_card_type), intent(inout) :: card
      type(string_type), allocatable :: names(:)
      character(:), allocatable :: hint
      integer :: i

      names = keyword_names()
      i = nearest_name(name, names)
      hint = keyword_advice(name)
      if (is_slip(name, names(i)%value) .and. .not. is_meaning(name)) then
         card%meant = names(i)%value
         if (known_keywords(i)%status /= refused) card%known = i
         hint = 'the nearest known is *'//names(i)%value
      else if (len(hint) > 0) then
         continue
      else if (is_text) then
         hint = 'a comment begins with **'
      else if (len(misspelt_foreign(name)) > 0) then
         hint = 'the nearest known is *'//misspelt_foreign(name)
      else if (is_near(name, names(i)%value)) then
         hint = 'the nearest known is *'//names(i)%value
      else
         hint = 'docs/deck.md lists those that are known'
      end if
      call report%error(card%place, 'unknown keyword *'//to_upper(name)//'; '//hint, &
         'keyword '//to_upper(name))
   end subroutine report_unknown_keyword

   !> Reports a parameter that the keyword does not have, and finds the one that it likely is. On
   !> all cards of the keyword it is one mistake.
   subroutine report_unknown_parameter(name, place, report, card, known)
      character(*), intent(in) :: name
      type(place_type), intent(in) :: place
      type(deck_report_type), intent(inout) :: report
      type(keyword_card_type), intent(in) :: card
      type(known_parameter_type), intent(inout) :: known
      type(string_type), allocatable :: names(:)
      character(:), allocatable :: group, hint
      integer :: i

      group = 'parameter '//to_upper(trim(name))//' of *'//card%name
      names = parameter_names(card%known)
      hint = parameter_advice(card%name, name)
      i = nearest_name(name, names)
      if (i > 0) then
         if (is_slip(name, names(i)%value)) known = find_parameter(card%known, names(i)%value)
         if (len(known%name) > 0 .or. (len(hint) == 0 .and. is_near(name, names(i)%value))) then
            hint = 'the nearest known is '//names(i)%value
         end if
      end if
      if (len(hint) == 0 .and. size(names) > 0) hint = listed(card%known, names)
      if (len(hint) == 0) then
         call report%error(place, 'unknown parameter '//to_upper(trim(name))//'; *'// &
            card%name//' has none', group)
      else
         call report%error(place, 'unknown parameter '//to_upper(trim(name))//' of *'// &
            card%name//'; '//hint, group)
      end if
   end subroutine report_unknown_parameter

   !> The parameters that a keyword takes; empty where none of them means anything.
   pure function listed(keyword, names) result(list)
      integer, intent(in) :: keyword
      type(string_type), intent(in) :: names(:)
      character(:), allocatable :: list
      type(known_parameter_type) :: parameter
      integer :: i

      list = ''
      do i = 1, size(names)
         parameter = find_parameter(keyword, names(i)%value)
         if (parameter%status == built) list = list//', '//parameter%name
      end do
      if (len(list) > 0) list = 'it takes '//list(3:)
   end function listed

   !> Whether a name is near enough to a known one to be worth naming: half of its letters agree.
   pure logical function is_near(name, known)
      character(*), intent(in) :: name, known

      is_near = 2*edit_distance(to_upper(name), known) <= len(name)
   end function is_near

end module unknown_keywords
