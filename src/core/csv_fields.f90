!> Fields of CSV files.
module csv_fields
   implicit none
   private
   public :: quoted

contains

   !> A text between double quotes, those inside it doubled; nothing for an empty text. An
   !> apostrophe precedes text that a spreadsheet would read as a formula.
   pure function quoted(words) result(field)
      character(*), intent(in) :: words     !! the text
      character(:), allocatable :: field    !! as RFC 4180 has it
      character(*), parameter :: formula_begins = '=+-@'//achar(9)//achar(13)
      integer :: i

      field = ''
      if (len(words) == 0) return
      if (scan(words(:1), formula_begins) > 0) field = "'"
      do i = 1, len(words)
         field = field//words(i:i)
         if (words(i:i) == '"') field = field//'"'
      end do
      field = '"'//field//'"'
   end function quoted

end module csv_fields
