!> The maxima of a body in words, for summary and listing: values with their bounds, where they are,
!> and the singular corners that were left out.
module body_lines
   use mesh, only: mesh_type
   use records, only: body_errors_type
   use text, only: to_text
   implicit none
   private
   public :: place_words, corner_words

   integer, parameter :: most_corners = 3   !! that are named

contains

   !> Where the maxima are.
   pure function place_words(mesh, node) result(words)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node                  !! index
      character(:), allocatable :: words           !! such as 'node 12 (2, 0)'

      words = 'node '//to_text(mesh%node_number(node))//' ('//to_text(mesh%coordinates(1, node))// &
         ', '//to_text(mesh%coordinates(2, node))//')'
   end function place_words

   !> The singular corners round which stress is larger; nothing without any.
   pure function corner_words(mesh, errors) result(words)
      type(mesh_type), intent(in) :: mesh
      type(body_errors_type), intent(in) :: errors
      character(:), allocatable :: words
      integer :: i

      words = ''
      if (size(errors%corners) == 0) return
      words = 'singular corner, round which stress is larger, may have no limit and has no '// &
         'bound: '
      do i = 1, min(size(errors%corners), most_corners)
         if (i > 1) words = words//', '
         words = words//place_words(mesh, errors%corners(i))
      end do
      if (size(errors%corners) > most_corners) words = words//' and '// &
         to_text(size(errors%corners) - most_corners)//' more'
   end function corner_words

end module body_lines
