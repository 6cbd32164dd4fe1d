!> A model on the same mesh with elements of first order: elements lose their midside nodes, and
!> the model the nodes that only were such. A force or heat on one of these goes half and half to
!> the corners of its side, as the shape functions of the side without it have it.
module order_reduction
   use element_kinds, only: element_corner_count, linear_kind, side_node_count, side_nodes
   use local_refinement, only: hanging_count, place_hanging
   use kinds, only: dp
   use load_application, only: make_explicit
   use load_requests, only: request_list_type, request_type
   use mesh, only: mesh_type
   use model, only: model_type
   use steps, only: acts_on_nodes
   implicit none
   private
   public :: reduce_order, side_corners

contains

   !> Makes all elements of a model linear ones. Its loads and supports must be applied, and its
   !> bodies found, anew afterwards. Refinement comes before it, so that new corners lie on the
   !> curved sides of the deck.
   pure subroutine reduce_order(model)
      type(model_type), intent(inout) :: model   !! with its loads, without partners of nodes
      integer :: corners(2, size(model%mesh%node_number)), i, n
      integer :: new_index(0:size(model%mesh%node_number))   ! 0 for what drops out, and for none
      logical :: stays(size(model%mesh%node_number))

      corners = side_corners(model%mesh)
      stays = corners(1, :) == 0
      new_index(0) = 0
      new_index(1:) = unpack([(n, n=1, count(stays))], stays, 0)
      call make_explicit(model)
      call share_loads(corners, new_index, model%requests%loads)
      call drop_requests(new_index, model%requests%supports)
      call drop_requests(new_index, model%requests%temperatures)
      do i = 1, size(model%fields)
         model%fields(i)%values = pack(model%fields(i)%values, stays)
         model%fields(i)%given = pack(model%fields(i)%given, stays)
      end do
      model%initial_temperature = pack(model%initial_temperature, stays)
      do i = 1, model%deck_equations
         call model%equations(i)%replace(corners, new_index(1:))
      end do
      do i = 1, size(model%bars)
         call model%bars(i)%elongation%replace(corners, new_index(1:))
         if (allocated(model%bars(i)%mean%node)) call model%bars(i)%mean%replace(corners, &
            new_index(1:))
      end do
      model%couplings%reference = new_index(model%couplings%reference)
      do i = 1, size(model%couplings)
         associate (coupling => model%couplings(i))
            coupling%rotation = new_index(coupling%rotation)
            coupling%rotation_node = new_index(coupling%rotation_node)
            if (allocated(coupling%nodes)) coupling%nodes = pack(new_index(coupling%nodes), &
               new_index(coupling%nodes) > 0)
         end associate
      end do
      do i = 1, size(model%mesh%surfaces)
         if (.not. allocated(model%mesh%surfaces(i)%drawing)) cycle
         associate (line => model%mesh%surfaces(i)%drawing)
            line%reference = new_index(line%reference)
            line%rotation = new_index(line%rotation)
         end associate
      end do
      do i = 1, size(model%sections)
         model%sections(i)%reference = new_index(model%sections(i)%reference)
      end do
      model%load_node = new_index(model%load_node)
      call reduce_mesh(new_index, model%mesh)
      model%element_order = 1
   end subroutine reduce_order

   !> The corners of the side in whose middle a node lies; zero for nodes that are corners of an
   !> element, or in no element.
   pure function side_corners(mesh) result(corners)
      type(mesh_type), intent(in) :: mesh                 !! the mesh; unknown nodes are zero
      integer :: corners(2, size(mesh%node_number))       !! (2, nodes)
      integer :: e, f, nodes(3)

      corners = 0
      do e = 1, size(mesh%element_number)
         associate (kind => mesh%element_kind(e))
            if (side_node_count(kind) == 2) cycle
            do f = 1, element_corner_count(kind)
               nodes = mesh%element_nodes(side_nodes(kind, f), e)
               if (all(nodes > 0)) corners(:, nodes(2)) = nodes([1, 3])
            end do
         end associate
      end do
      do e = 1, size(mesh%element_number)
         do f = 1, element_corner_count(mesh%element_kind(e))
            if (mesh%element_nodes(f, e) > 0) corners(:, mesh%element_nodes(f, e)) = 0
         end do
      end do
   end function side_corners

   pure subroutine reduce_mesh(new_index, mesh)
      integer, intent(in) :: new_index(0:)  ! (nodes) zero for those that drop out
      type(mesh_type), intent(inout) :: mesh
      integer :: e, i, corners
      integer, allocatable :: kept(:)

      do i = 1, size(mesh%node_sets)
         mesh%node_sets(i)%members = new_index(mesh%node_sets(i)%members)
         mesh%node_sets(i)%members = pack(mesh%node_sets(i)%members, mesh%node_sets(i)%members > 0)
      end do
      kept = pack([(i, i=1, ubound(new_index, 1))], new_index(1:) > 0)
      mesh%coordinates = mesh%coordinates(:, kept)
      mesh%node_number = mesh%node_number(kept)
      do e = 1, size(mesh%element_number)
         corners = element_corner_count(mesh%element_kind(e))
         mesh%element_nodes(:corners, e) = new_index(mesh%element_nodes(:corners, e))
         mesh%element_nodes(corners + 1:, e) = 0
      end do
      mesh%element_kind = linear_kind(mesh%element_kind)
      do i = 1, hanging_count(mesh)
         mesh%hanging_sides(:, i) = new_index(mesh%hanging_sides(:, i))
      end do
      call place_hanging(mesh)
   end subroutine reduce_mesh

   !> Drops what is given for single nodes that drop out.
   pure subroutine drop_requests(new_index, list)
      integer, intent(in) :: new_index(0:)   ! (nodes) zero for those that drop out
      type(request_list_type), intent(inout) :: list
      type(request_list_type) :: kept
      integer :: i

      do i = 1, list%count
         associate (request => list%items(i))
            if (request%set == 0) request%item = new_index(request%item)
            if (request%set > 0 .or. request%item > 0) call kept%add(request)
         end associate
      end do
      list = kept
   end subroutine drop_requests

   !> Loads of single nodes follow them, or are shared; those of elements stay. A share is a
   !> location of its own, told by the node that it comes from, so that what a later step gives
   !> there replaces it.
   pure subroutine share_loads(corners, new_index, loads)
      integer, intent(in) :: corners(:, :)   ! (2, nodes) as of side_corners
      integer, intent(in) :: new_index(0:)   ! (nodes) zero for those that drop out
      type(request_list_type), intent(inout) :: loads
      type(request_list_type) :: shared
      type(request_type) :: share
      integer :: i, k

      do i = 1, loads%count
         associate (load => loads%items(i))
            share = load
            if (.not. acts_on_nodes(load%kind)) then
               call shared%add(load)
            else if (new_index(load%item) > 0) then
               share%item = new_index(load%item)
               call shared%add(share)
            else
               share%component = load%component + 2*load%item
               share%value = 0.5_dp*load%value
               do k = 1, 2
                  share%item = new_index(corners(k, load%item))
                  call shared%add(share)
               end do
            end if
         end associate
      end do
      loads = shared
   end subroutine share_loads

end module order_reduction
