!> Loads, supports and initial temperatures as a deck asks for them: a node, an element or a set of
!> the deck's mesh, a component and a value. They hold for any division of that mesh.
module load_requests
   use errors, only: place_type
   use kinds, only: dp
   use mesh, only: set_type
   implicit none
   private
   public :: target_type, request_type, request_list_type, requests_type, nodal_field_type

   !> A node, an element or a set of the deck's mesh.
   type :: target_type
      integer :: item = 0           !! index of the deck's node or element, 0 for a set
      integer :: set = 0            !! index of the set, 0 for a single item
   contains
      procedure :: members
   end type target_type

   !> A request of one data card, for one component.
   type, extends(target_type) :: request_type
      integer :: step = 0           !! index of the step; 0 before the first
      integer :: kind = 0           !! kind of the load; 0 for prescribed and initial values
      integer :: component = 0      !! degree of freedom, face, ...: as said at the kind
      real(dp) :: value = 0.0_dp    !! value
      integer :: amplitude = 0      !! index into model%amplitudes, 0 for none
      integer :: card = 0           !! running number of the data card
      logical :: keeps = .false.    !! *BOUNDARY, FIXED: the value at the start of the step
      type(place_type) :: place     !! where the data card begins
   end type request_type

   !> A list of them.
   type :: request_list_type
      integer :: count = 0                           !! number of requests
      type(request_type), allocatable :: items(:)    !! (capacity) the requests
   contains
      procedure :: add
   end type request_list_type

   !> All that a deck asks for.
   type :: requests_type
      type(request_list_type) :: supports       !! *BOUNDARY
      type(request_list_type) :: loads          !! all other loads but *TEMPERATURE
      type(request_list_type) :: temperatures   !! *INITIAL CONDITIONS, TYPE=TEMPERATURE
   end type requests_type

   !> Temperatures that *TEMPERATURE gives in a step, on one amplitude. The division of a mesh gives
   !> new nodes those between the nodes of their side.
   type :: nodal_field_type
      integer :: step = 0                       !! index of the step
      integer :: amplitude = 0                  !! index into model%amplitudes, or 0
      integer :: card = 0                       !! running number of its last data card
      logical, allocatable :: given(:)          !! (nodes) whether a node has a value
      real(dp), allocatable :: values(:)        !! (nodes) 0 where not given [temperature]
   end type nodal_field_type

contains

   !> The nodes or elements of the deck that it names.
   pure function members(self, sets)
      class(target_type), intent(in) :: self
      type(set_type), intent(in) :: sets(:)     !! of nodes or of elements
      integer, allocatable :: members(:)

      members = [self%item]
      if (self%set > 0) members = sets(self%set)%members
   end function members

   !> Adds a request.
   pure subroutine add(self, request)
      class(request_list_type), intent(inout) :: self
      type(request_type), intent(in) :: request         !! what is added
      type(request_type), allocatable :: more(:)

      if (.not. allocated(self%items)) allocate(self%items(64))
      if (self%count == size(self%items)) then
         allocate(more(2*self%count))
         more(:self%count) = self%items
         call move_alloc(more, self%items)
      end if
      self%count = self%count + 1
      self%items(self%count) = request
   end subroutine add

end module load_requests
