!> Files of decks: those that a run writes, and those that decks are read from, which no file that
!> is written may replace.
module deck_files
   use batch_table, only: table_name
   use command_line, only: command_type
   use errors, only: error_type, set_error, status_deck
   use file_calls, only: identity_of
   use text, only: append, string_type, to_text
   implicit none
   private
   public :: input_files_type, base_name, results_of, row_file_of, outputs_of, batch_table_of

   !> The files of one deck or more.
   type :: input_files_type
      private
      type(string_type), allocatable :: paths(:)   !! (files) as seen from the current folder
      type(string_type), allocatable :: decks(:)   !! (files) the deck that is read from each
   contains
      procedure :: add
      procedure :: check
   end type input_files_type

contains

   !> Path of a deck's results without extension.
   pure function results_of(path, command) result(results)
      character(*), intent(in) :: path           !! the deck as given
      type(command_type), intent(in) :: command
      character(:), allocatable :: results       !! such as DIR/b for a/b.inp, DIR/b-2 for row 2

      results = command%folder//'/'//base_name(path)
      if (command%row > 0) results = results//'-'//to_text(command%row)
   end function results_of

   !> Path of the results of a run that is a row of a table.
   pure function row_file_of(path, command) result(row)
      character(*), intent(in) :: path           !! the deck as given
      type(command_type), intent(in) :: command
      character(:), allocatable :: row           !! such as DIR/b-2.csv

      row = results_of(path, command)//'.csv'
   end function row_file_of

   !> Path of the table that a batch writes.
   pure function batch_table_of(command) result(table)
      type(command_type), intent(in) :: command
      character(:), allocatable :: table         !! with --table such as DIR/b.table.csv

      table = command%folder//'/'//table_name
      if (command%table /= '') table = command%folder//'/'//base_name(command%decks(1)%value)// &
         '.table.csv'
   end function batch_table_of

   !> Paths of all files that a deck writes, and of the table that a batch writes beside them: no
   !> deck may be lost to a batch of others either.
   pure function outputs_of(path, command) result(outputs)
      character(*), intent(in) :: path           !! the deck as given
      type(command_type), intent(in) :: command
      type(string_type), allocatable :: outputs(:)
      character(*), parameter :: extensions(5) = [character(16) :: '.lst', '.sta', '.cvg', &
         '.vtkhdf', '.contact.vtkhdf']
      integer :: i

      allocate (outputs(size(extensions)))
      do i = 1, size(extensions)
         outputs(i)%value = results_of(path, command)//trim(extensions(i))
      end do
      call append(outputs, batch_table_of(command))
      if (command%row > 0) call append(outputs, row_file_of(path, command))
   end function outputs_of

   !> Name of a deck's results: its file name without folder and extension, or stdin where it is
   !> read from an open file, which has a number only.
   pure function base_name(path) result(name)
      character(*), intent(in) :: path           !! the deck as given
      character(:), allocatable :: name          !! such as b for a/b.inp
      integer :: dot

      if (index(path, '/dev/fd/') == 1 .or. index(path, '/proc/self/fd/') == 1) then
         name = 'stdin'
         return
      end if
      name = path(index(path, '/', back=.true.) + 1:)
      dot = index(name, '.', back=.true.)
      if (dot > 1) name = name(:dot - 1)
   end function base_name

   !> Adds the files of a deck.
   subroutine add(self, deck, paths)
      class(input_files_type), intent(inout) :: self
      character(*), intent(in) :: deck                !! the deck as given
      type(string_type), intent(in) :: paths(:)       !! it and the files that it includes
      integer :: i

      do i = 1, size(paths)
         call append(self%paths, paths(i)%value)
         call append(self%decks, deck)
      end do
   end subroutine add

   !> Compares them with the files that are to be written, before anything is: by what is there, so
   !> that links and other names of a file count too.
   !> Error: status_deck, where one of them would be lost.
   subroutine check(self, outputs, error)
      class(input_files_type), intent(in) :: self
      type(string_type), intent(in) :: outputs(:)           !! paths, of which any may be missing
      type(error_type), allocatable, intent(out) :: error   !! names both files
      type(string_type) :: written(size(outputs))
      character(:), allocatable :: identity
      integer :: i, k

      if (.not. allocated(self%paths)) return
      do k = 1, size(outputs)
         written(k)%value = identity_of(outputs(k)%value)
      end do
      do i = 1, size(self%paths)
         identity = identity_of(self%paths(i)%value)
         do k = size(outputs), 1, -1
            if (identity /= '' .and. identity == written(k)%value) exit
         end do
         if (k == 0) cycle
         call set_error(error, status_deck, '"'//outputs(k)%value//'" would be written over "'// &
            self%paths(i)%value//'", from which the deck '//self%decks(i)%value// &
            ' is read; name another folder with --out or rename the file that is read')
         return
      end do
   end subroutine check

end module deck_files
