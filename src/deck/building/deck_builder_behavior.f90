!> *SURFACE BEHAVIOR: parameters of a penalty, which are ignored, and laws of faces that overlap.
module deck_builder_behavior
   use card_parameters, only: choice
   use card_values, only: read_row, read_rows
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
      type(deck_type), intent(inout) :: deck
      type(overlap_law_type), intent(out) :: law           !! of hard faces, or of soft ones
      character(:), allocatable :: kind
      real(dp) :: values(2)
      logical :: valid

      kind = to_upper(card%text('PRESSURE-OVERCLOSURE'))
      if (kind == 'TIED') then
         call deck%error(card%place_of('PRESSURE-OVERCLOSURE'), 'PRESSURE-OVERCLOSURE='//kind// &
            ' is refused: tied faces do not open; take *TIE')
         return
      end if
      kind = choice(card, 'PRESSURE-OVERCLOSURE', 'LINEAR/HARD/EXPONENTIAL/TABULAR', deck, '')
      select case (kind)
      case ('EXPONENTIAL', 'TABULAR')
         if (size(card%data) == 0) then
            call deck%error(card%place, '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE='//kind// &
               ' has no data: '//trim(merge('c0, p0                                ', &
               'pressure, overlap; a card for each row', kind == 'EXPONENTIAL')))
         else if (kind == 'EXPONENTIAL') then
            ! The pressure at the clearance c0 is a hundredth of p0.
            call read_row(card%data(1), 'clearance c0 >0/pressure p0 >0', deck, values, valid)
            law%clearance = values(1)
            law%touching_pressure = values(2)
            if (size(card%data) > 1) call deck%error(card%data(2)%place(1), &
               'an exponential law has one card: c0, p0')
         else
            call read_table(card%data, deck, law)
         end if
      case default
         call deck%note('*SURFACE BEHAVIOR is ignored: contact is exact')
      end select
   end subroutine build_behavior

   !> Rows of pressure, from 0 on, and overlap; both rise.
   subroutine read_table(rows, deck, law)
      type(data_card_type), intent(in) :: rows(:)
      type(deck_type), intent(inout) :: deck
      type(overlap_law_type), intent(inout) :: law
      real(dp) :: values(2, size(rows))
      integer :: i
      logical :: valid

      call read_rows(rows, 'pressure/overlap', deck, values, valid)
      law%pressure = values(1, :)
      law%overlap = values(2, :)
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
