!> How the contact unknowns are held: all of them in one full matrix, to which bodies are reduced as
!> a whole, or sparsely, beside the faces of bodies that are reduced in pieces. The full matrix
!> costs less where it is small.
module tail_choice
   use controls, only: tail_by_size, tail_sparse
   use kinds, only: dp
   use model, only: model_type
   implicit none
   private
   public :: has_sparse_tail, needs_full_tail

   integer, parameter :: most_at_once = 200   !! contact points that a full matrix is for

contains

   !> Whether the contact unknowns are held sparsely.
   pure logical function has_sparse_tail(model, points)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: points     !! number of contact points

      has_sparse_tail = model%tail == tail_sparse .or. (model%tail == tail_by_size .and. &
         model%mesh%body_count > 2 .and. points > most_at_once)
      has_sparse_tail = has_sparse_tail .and. points > 0.0_dp .and. .not. needs_full_tail(model)
   end function has_sparse_tail

   !> Whether a deck needs derivatives between all contact points, and with them the full matrix.
   pure logical function needs_full_tail(model)
      type(model_type), intent(in) :: model

      needs_full_tail = any(model%steps%continuation%is_on)
   end function needs_full_tail

end module tail_choice
