!> *PARAMETER: names with values, used as <name> in the deck, and --set that overrides them.
module deck_parameters
   use arithmetic, only: arithmetic_fault_type, evaluate, is_arithmetic
   use card_fields, only: first_text, last_text, without_quotes
   use cards, only: add_note, field_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use kinds, only: dp
   use name_index, only: name_index_type
   use spelling, only: nearest_known
   use text, only: all_digits, append, string_type, to_text, to_upper
   use utf8, only: as_utf8
   implicit none
   private
   public :: deck_parameters_type

   integer, parameter :: longest_text = 10000   !! bytes of a field with all its names replaced

   !> The parameters of a deck.
   type :: deck_parameters_type
      type(name_index_type) :: names                                 !! those that are defined
      type(string_type), allocatable, private :: values(:)           !! their values
      type(name_index_type), private :: settings                     !! names that --set gives
      type(string_type), allocatable, private :: setting_names(:)    !! the same as given
      type(string_type), allocatable, private :: setting_values(:)   !! their values
   contains
      procedure :: take_settings
      procedure :: define
      procedure :: substitute
      procedure :: check_settings
   end type deck_parameters_type

contains

   !> Takes what the command line sets.
   subroutine take_settings(self, settings, report)
      class(deck_parameters_type), intent(inout) :: self
      type(string_type), intent(in) :: settings(:)         !! each NAME=VALUE
      type(deck_report_type), intent(inout) :: report      !! receives errors
      character(:), allocatable :: name, value
      integer :: i, equals

      allocate (self%values(0), self%setting_names(0), self%setting_values(0))
      do i = 1, size(settings)
         equals = index(settings(i)%value, '=')
         name = without_blanks_around(settings(i)%value(:equals - 1))
         value = without_blanks_around(settings(i)%value(equals + 1:))
         if (len(name) == 0) then
            call report%error(place_type(), '--set '//settings(i)%value//' is not NAME=VALUE')
         else if (len(value) == 0) then
            call report%error(place_type(), '--set '//settings(i)%value//' has no value; '// &
               'leave it out for the value of *PARAMETER')
         else if (self%settings%find(name) > 0) then
            call report%error(place_type(), '--set gives '//name//' twice; leave one '// &
               'out (names are case-insensitive)')
         else
            call self%settings%add(name)
            call append(self%setting_names, name)
            call append(self%setting_values, as_utf8(value))
         end if
      end do
   end subroutine take_settings

   !> Takes one field `name = value` of a *PARAMETER card; a value that --set replaces is noted.
   subroutine define(self, given, notes, report)
      class(deck_parameters_type), intent(inout) :: self
      type(field_type), intent(in) :: given                !! as written
      type(string_type), allocatable, intent(inout) :: notes(:)   !! lines for the listing
      type(deck_report_type), intent(inout) :: report      !! receives errors
      character(:), allocatable :: name, value
      type(field_type) :: field
      integer :: earlier, equals, first, setting

      field = given
      call self%substitute(field, report)
      if (field%undefined) then
         call report%lose('parameter')
         return
      end if
      equals = index(field%text, '=')
      if (equals < 2 .or. equals == len(field%text)) then
         call report%error(field%place, '*PARAMETER has name = value')
         return
      end if
      name = to_upper(trim(field%text(:equals - 1)))
      first = equals - 1 + first_text(field%text(equals + 1:))
      value = field%text(first + 1:)
      if (self%names%find(name) > 0) then
         call report%error(field%place, 'parameter '//name//' is defined twice; names '// &
            'are case-insensitive')
         return
      end if
      setting = self%settings%find(name)
      earlier = self%names%find(value)
      if (setting > 0) then
         call add_note(notes, 'parameter '//trim(field%text(:equals - 1))//' = '// &
            self%setting_values(setting)%value//' by --set, in place of '//without_quotes(value))
         value = self%setting_values(setting)%value
      else if (earlier > 0) then
         value = self%values(earlier)%value
      else if (is_arithmetic(value, self%names)) then
         ! Names that were replaced leave no columns to point at.
         if (field%text == given%text) field%place%column = field%place%column + first
         call compute(self, name, field%place, field%text == given%text, report, value)
         if (len(value) == 0) return
      else
         value = without_quotes(value)
      end if
      call self%names%add(name)
      call append(self%values, value)
   end subroutine define

   !> Replaces an expression by its value, which is empty after an error.
   subroutine compute(self, name, place, has_columns, report, value)
      class(deck_parameters_type), intent(in) :: self
      character(*), intent(in) :: name                     ! of the parameter
      type(place_type), intent(in) :: place                ! of the expression
      logical, intent(in) :: has_columns                   ! whether it is as written
      type(deck_report_type), intent(inout) :: report
      character(:), allocatable, intent(inout) :: value
      type(arithmetic_fault_type) :: fault
      type(place_type) :: at
      real(dp) :: number

      call evaluate(value, self%names, self%values, number, fault)
      value = all_digits(number)
      if (.not. allocated(fault%message)) return
      value = ''
      at = place
      if (has_columns) at%column = place%column + fault%at - 1
      if (allocated(fault%unknown)) then
         call report%missing(at, fault%message, 'parameter', fault%unknown)
      else
         call report%error(at, fault%message)
      end if
      call report%lose('parameter', name)
   end subroutine compute

   !> Replaces each <name> in a field by its value; one that is not known leaves no text.
   subroutine substitute(self, field, report)
      class(deck_parameters_type), intent(in) :: self
      type(field_type), intent(inout) :: field
      type(deck_report_type), intent(inout) :: report      !! receives errors
      character(:), allocatable :: done, rest, name
      integer :: left, right, known, column

      left = index(field%text, '<')
      if (left == 0) return
      done = ''
      rest = field%text
      do
         left = index(rest, '<')
         if (left == 0) exit
         column = field%place%column + len(field%text) - len(rest) + left - 1
         right = index(rest, '>')
         if (right < left) then
            call report%error(place_type(field%place%image, column), 'this < has no >')
            call make_undefined(field)
            return
         end if
         name = to_upper(trim(adjustl(rest(left + 1:right - 1))))
         known = self%names%find(name)
         if (known == 0) then
            call report%missing(place_type(field%place%image, column), &
               'no *PARAMETER before this card defines '//name// &
               nearest_known(name, self%names%known()), 'parameter', name)
            call make_undefined(field)
            return
         end if
         done = done//rest(:left - 1)//self%values(known)%value
         rest = rest(right + 1:)
         if (len(done) + len(rest) <= longest_text) cycle
         call report%error(field%place, 'the field has more than '//to_text(longest_text)// &
            ' characters once its names are replaced')
         call make_undefined(field)
         return
      end do
      field%text = done//rest
   end subroutine substitute

   pure subroutine make_undefined(field)
      type(field_type), intent(inout) :: field

      field%text = ''
      field%undefined = .true.
   end subroutine make_undefined

   !> Reports settings that no *PARAMETER of the deck takes.
   subroutine check_settings(self, report)
      class(deck_parameters_type), intent(in) :: self
      type(deck_report_type), intent(inout) :: report      !! receives errors
      integer :: i

      do i = 1, size(self%setting_names)
         associate (name => self%setting_names(i)%value)
            if (self%names%find(name) > 0) cycle
            call report%missing(place_type(), '--set '//name//': no *PARAMETER of the deck has '// &
               'this name'//nearest_known(to_upper(name), self%names%known()), 'parameter', name)
         end associate
      end do
   end subroutine check_settings

   !> A text of the command line without the blanks around it, as fields of a deck are.
   pure function without_blanks_around(string) result(bare)
      character(*), intent(in) :: string
      character(:), allocatable :: bare

      bare = string(first_text(string):last_text(string))
   end function without_blanks_around

end module deck_parameters
