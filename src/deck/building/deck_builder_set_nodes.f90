!> The nodes of the element set or the surface that an *NSET card names.
module deck_builder_set_nodes
   use card_parameters, only: has_parameter, parameter_place, parameter_text
   use cards, only: keyword_card_type
   use deck_context, only: deck_context_type, find_set, report_unknown, set_names
   use deck_report, only: deck_report_type
   use element_kinds, only: side_nodes
   use mesh, only: mesh_type
   use text, only: string_type, to_upper
   implicit none
   private
   public :: find_nodes

contains

   !> Finds these nodes; none where the card names neither a set nor a surface.
   subroutine find_nodes(card, context, mesh, report, nodes)
      type(keyword_card_type), intent(in) :: card             !! the *NSET card
      type(deck_context_type), intent(in) :: context          !! lines of element sets
      type(mesh_type), intent(in) :: mesh                     !! element sets and surfaces
      type(deck_report_type), intent(inout) :: report         !! receives errors
      integer, allocatable, intent(out) :: nodes(:)           !! node indexes, some repeatedly
      integer, allocatable :: more(:)

      allocate(nodes(0))
      if (has_parameter(card, 'ELSET')) then
         call find_element_nodes(card, context, mesh, report, more)
         nodes = more
      end if
      if (has_parameter(card, 'SURFACE')) then
         call find_surface_nodes(card, mesh, report, more)
         nodes = [nodes, more]
      end if
   end subroutine find_nodes

   subroutine find_element_nodes(card, context, mesh, report, nodes)
      type(keyword_card_type), intent(in) :: card
      type(deck_context_type), intent(in) :: context
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      integer, allocatable, intent(out) :: nodes(:)
      character(:), allocatable :: name
      integer :: set, lines

      allocate(nodes(0))
      name = to_upper(parameter_text(card, 'ELSET'))
      set = find_set(mesh%element_sets, name)
      if (set == 0) then
         call report_unknown('element set', name, set_names(mesh%element_sets), &
            parameter_place(card, 'ELSET'), report)
         return
      end if
      associate (members => mesh%element_sets(set)%members)
         nodes = pack(mesh%element_nodes(:, members), mesh%element_nodes(:, members) > 0)
      end associate
      lines = find_set(context%line_sets, name)
      if (lines == 0) return
      associate (members => context%line_sets(lines)%members)
         nodes = [nodes, pack(context%line_nodes(:, members), context%line_nodes(:, members) > 0)]
      end associate
   end subroutine find_element_nodes

   subroutine find_surface_nodes(card, mesh, report, nodes)
      type(keyword_card_type), intent(in) :: card
      type(mesh_type), intent(in) :: mesh
      type(deck_report_type), intent(inout) :: report
      integer, allocatable, intent(out) :: nodes(:)
      type(string_type) :: names(size(mesh%surfaces))
      character(:), allocatable :: name
      integer :: surface, i, element

      allocate(nodes(0))
      name = to_upper(parameter_text(card, 'SURFACE'))
      surface = 0
      do i = 1, size(names)
         names(i)%value = mesh%surfaces(i)%name
         if (names(i)%value == name) surface = i
      end do
      if (surface == 0) then
         call report_unknown('surface', name, names, parameter_place(card, 'SURFACE'), report)
         return
      end if
      do i = 1, size(mesh%surfaces(surface)%faces, 2)
         element = mesh%surfaces(surface)%faces(1, i)
         nodes = [nodes, mesh%element_nodes(side_nodes(mesh%element_kind(element), &
            mesh%surfaces(surface)%faces(2, i)), element)]
      end do
      nodes = pack(nodes, nodes > 0)
   end subroutine find_surface_nodes

end module deck_builder_set_nodes
