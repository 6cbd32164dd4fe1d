!> *SURFACE BEHAVIOR: parameters of a penalty, which are ignored, and laws of faces that overlap.
module deck_builder_behavior
   use card_parameters, only: choose
   use card_values, only: check_extra, need_field
   use cards, only: data_card_type, keyword_card_type
   use deck_context, only: deck_type
   use kinds, only: dp
   use overlap_laws, only: overlap_law_type
   use text, only: to_text, to_upper
   implicit none
   private
   public :: build_behavior

contains

   !> Reads one *SURFACE BEHAVIOR.
   subroutine build_behavior(card, deck, law)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck   !! receives notes and errors
      type(overlap_law_type), intent(out) :: law           !! of hard faces, or of soft ones
      character(:), allocatable :: kind

      kind = to_upper(card%text('PRESSURE-OVERCLOSURE'))
      if (kind == 'TIED') then
         call deck%error(card%place_of('PRESSURE-OVERCLOSURE'), 'PRESSURE-OVERCLOSURE='//kind// &
            ' is refused: tied faces do not open; take *TIE')
         return
      end if
      call choose(card, 'PRESSURE-OVERCLOSURE', 'LINEAR/HARD/EXPONENTIAL/TABULAR', deck, kind)
      select case (kind)
      case ('EXPONENTIAL', 'TABULAR')
         if (size(card%data) == 0) then
            call deck%error(card%place, '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE='//kind// &
               ' has no data: '//trim(merge('c0, p0                                ', &
               'pressure, overlap; a card for each row', kind == 'EXPONENTIAL')))
         else if (kind == 'EXPONENTIAL') then
            call read_exponential(card, deck, law)
         else
            call read_table(card%data, deck, law)
         end if
      case default
         call deck%note('*SURFACE BEHAVIOR is ignored: contact is exact')
      end select
   end subroutine build_behavior

   !> c0, at which the pressure is a hundredth of p0, and p0.
   subroutine read_exponential(card, deck, law)
      type(keyword_card_type), intent(in) :: card
      type(deck_type), intent(inout) :: deck
      type(overlap_law_type), intent(inout) :: law
      logical :: valid

      valid = .true.
      associate (data => card%data(1))
         call need_positive(data, 1, 'clearance c0', deck, law%clearance, valid)
         call need_positive(data, 2, 'pressure p0', deck, law%touching_pressure, valid)
         call check_extra(data, 2, 'clearance c0, pressure p0', deck)
      end associate
      if (size(card%data) > 1) call deck%error(card%data(2)%place(1), 'an exponential law has '// &
         'one card: c0, p0')
   end subroutine read_exponential

   !> Reads a field that is above 0.
   subroutine need_positive(data, position, name, deck, value, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: position
      character(*), intent(in) :: name
      type(deck_type), intent(inout) :: deck
      real(dp), intent(inout) :: value
      logical, intent(inout) :: valid

      call need_field(data, position, name, deck, value, valid)
      if (.not. valid .or. value > 0.0_dp) return
      call deck%error(data%place(position), 'the '//name//' must be positive')
      valid = .false.
   end subroutine need_positive

   !> Rows of pressure, from 0 on, and overlap; both rise.
   subroutine read_table(rows, deck, law)
      type(data_card_type), intent(in) :: rows(:)
      type(deck_type), intent(inout) :: deck
      type(overlap_law_type), intent(inout) :: law
      integer :: i
      logical :: valid

      allocate (law%pressure(size(rows)), law%overlap(size(rows)), source=0.0_dp)
      valid = .true.
      do i = 1, size(rows)
         call need_field(rows(i), 1, 'pressure', deck, law%pressure(i), valid)
         call need_field(rows(i), 2, 'overlap', deck, law%overlap(i), valid)
         call check_extra(rows(i), 2, 'pressure, overlap', deck)
      end do
      if (.not. valid) return
      if (abs(law%pressure(1)) > 0.0_dp) call deck%error(rows(1)%place(1), 'the first row must '// &
         'have pressure 0, and the overlap from which faces press')
      if (size(rows) == 1) call deck%error(rows(1)%place(1), 'a table of pressure and overlap '// &
         'needs two rows or more')
      do i = 2, size(rows)
         if (law%pressure(i) <= law%pressure(i - 1)) call deck%error(rows(i)%place(1), &
            'pressures must rise: '//to_text(law%pressure(i))//' follows '// &
            to_text(law%pressure(i - 1)))
         if (law%overlap(i) <= law%overlap(i - 1)) call deck%error(rows(i)%place(2), 'overlaps '// &
            'must rise: '//to_text(law%overlap(i))//' follows '//to_text(law%overlap(i - 1))// &
            '; each card is pressure, overlap')
      end do
   end subroutine read_table

end module deck_builder_behavior
