!> Files that decks are read from, which no file that is written may replace.
module input_files
   use errors, only: error_type, set_error, status_deck
   use file_identities, only: file_identity_type, identity_of, is_working_file, real_path_of
   use text, only: append, string_type
   implicit none
   private
   public :: input_files_type

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
      type(file_identity_type) :: written(size(outputs))
      integer :: i, k

      if (.not. allocated(self%paths)) return
      do k = 1, size(outputs)
         written(k) = identity_of(outputs(k)%value)
      end do
      do i = 1, size(self%paths)
         k = findloc(written%is_same(identity_of(self%paths(i)%value)), .true., dim=1)
         if (k == 0) k = first_cleared(outputs, self%paths(i)%value)
         if (k == 0) cycle
         call set_error(error, status_deck, '"'//outputs(k)%value//'" would be written over "'// &
            self%paths(i)%value//'", from which the deck '//self%decks(i)%value// &
            ' is read; name another folder with --out or rename the file that is read')
         return
      end do
   end subroutine check

   !> The first output beside which leftovers of killed runs are removed, an input among them; 0
   !> for none.
   integer function first_cleared(outputs, input)
      type(string_type), intent(in) :: outputs(:)
      character(*), intent(in) :: input
      character(:), allocatable :: real_path

      real_path = real_path_of(input)
      do first_cleared = size(outputs), 1, -1
         if (is_working_file(real_path, outputs(first_cleared)%value)) return
      end do
   end function first_cleared

end module input_files
