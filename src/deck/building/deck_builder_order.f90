!> ORDER= of *OPTIONS: the model with elements of first order.
module deck_builder_order
   use deck_context, only: deck_context_type
   use deck_report, only: deck_report_type
   use mesh, only: mesh_type
   use shape_checks, only: check_corners
   use model, only: model_type
   use order_reduction, only: reduce_order, side_corners
   use text, only: to_text
   implicit none
   private
   public :: apply_order, find_dropped

contains

   !> Finds the nodes of the deck that ORDER=1 drops. Refined elements have the midside nodes of the
   !> deck at their corners: then all of them stay.
   subroutine find_dropped(context, mesh)
      type(deck_context_type), intent(inout) :: context   !! order, levels; receives dropped
      type(mesh_type), intent(in) :: mesh                 !! the mesh of the deck
      integer :: corners(2, size(mesh%node_number))

      corners = 0
      if (context%order == 1 .and. context%levels == 0) corners = side_corners(mesh)
      context%dropped = corners(1, :) > 0
   end subroutine find_dropped

   !> Makes the elements of the model linear ones where ORDER=1 asks for it.
   subroutine apply_order(context, model, report)
      type(deck_context_type), intent(inout) :: context   !! order; receives a note
      type(model_type), intent(inout) :: model            !! the model, refined, with all its loads
      type(deck_report_type), intent(inout) :: report     !! receives errors
      integer :: nodes

      if (context%order /= 1) return
      nodes = size(model%mesh%node_number)
      call reduce_order(model)
      nodes = nodes - size(model%mesh%node_number)
      if (nodes == 0) then
         call context%note('ORDER=1 changes nothing: no element has midside nodes')
         return
      end if
      call context%note('ORDER=1: elements without midside nodes; '//to_text(nodes)// &
         ' nodes are dropped')
      call check_corners(context%order_place, model%mesh, report)
   end subroutine apply_order

end module deck_builder_order
