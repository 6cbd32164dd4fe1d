!> Warnings of increments, gathered over a run: each kind is told once, with the increments that had
!> it.
module warning_summary
   use solution_report, only: warning_type
   use text, only: append, string_type, to_text
   implicit none
   private
   public :: warning_summary_type

   !> Warnings of one kind.
   type :: kind_type
      type(warning_type) :: worst            !! the worst of them; of equals the first
      integer :: at = 0                      !! increment that had it
      integer :: first = 0, last = 0         !! increments
      integer :: count = 0                   !! increments that had one
   end type kind_type

   !> All kinds of a run, in the order of their first increments.
   type :: warning_summary_type
      private
      type(kind_type), allocatable :: kinds(:)
   contains
      procedure :: take
      procedure :: lines
   end type warning_summary_type

contains

   !> Takes the warnings of an increment.
   pure subroutine take(self, increment, warnings)
      class(warning_summary_type), intent(inout) :: self
      integer, intent(in) :: increment               !! its running number
      type(warning_type), intent(in) :: warnings(:)
      integer :: i

      do i = 1, size(warnings)
         call take_one(self, increment, warnings(i))
      end do
   end subroutine take

   pure subroutine take_one(self, increment, warning)
      class(warning_summary_type), intent(inout) :: self
      integer, intent(in) :: increment
      type(warning_type), intent(in) :: warning
      type(kind_type), allocatable :: more(:)
      integer :: k, n

      n = 0
      if (allocated(self%kinds)) n = size(self%kinds)
      do k = 1, n
         if (self%kinds(k)%worst%is_like(warning)) exit
      end do
      if (k > n) then
         allocate (more(n + 1))
         if (n > 0) more(:n) = self%kinds
         more(k)%first = increment
         more(k)%at = increment
         more(k)%worst = warning
         call move_alloc(more, self%kinds)
      end if
      associate (kind => self%kinds(k))
         if (kind%last < increment) kind%count = kind%count + 1
         kind%last = increment
         if (warning%severity <= kind%worst%severity) return
         kind%worst = warning
         kind%at = increment
      end associate
   end subroutine take_one

   !> One line a kind, such as `increments 13 to 21, worst at 17: ...`.
   pure function lines(self)
      class(warning_summary_type), intent(in) :: self
      type(string_type), allocatable :: lines(:)
      integer :: k

      allocate (lines(0))
      if (.not. allocated(self%kinds)) return
      do k = 1, size(self%kinds)
         call append(lines, when(self%kinds(k))//': '//self%kinds(k)%worst%words())
      end do
   end function lines

   pure function when(kind) result(words)
      type(kind_type), intent(in) :: kind
      character(:), allocatable :: words

      words = 'increment '//to_text(kind%first)
      if (kind%last == kind%first) return
      words = 'increments '//to_text(kind%first)//' to '//to_text(kind%last)
      if (kind%count <= kind%last - kind%first) words = to_text(kind%count)//' of the '//words
      if (kind%worst%has_value) words = words//', worst at '//to_text(kind%at)
   end function when

end module warning_summary
