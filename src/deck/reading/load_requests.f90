!> Cards of the form "node or set, component, value", kept until the mesh is final.
module load_requests
   use deck_source, only: place_type
   use kinds, only: dp
   implicit none
   private
   public :: request_type, request_list_type

   !> What one data card asks for, for one component.
   type :: request_type
      integer :: step = 0           !! index of the step; 0 before the first
      integer :: kind = 0           !! kind of the load; 0 for prescribed and initial values
      integer :: item = 0           !! index of the node or element, 0 for a set
      integer :: set = 0            !! index of the set, 0 for a single item
      integer :: component = 0      !! degree of freedom, face, ...: as said at the kind
      real(dp) :: value = 0.0_dp    !! value
      integer :: amplitude = 0      !! index into model%amplitudes, 0 for none
      integer :: card = 0           !! running number of the data card
      type(place_type) :: place     !! where the data card begins
   end type request_type

   !> A list of them.
   type :: request_list_type
      integer :: count = 0                           !! number of requests
      type(request_type), allocatable :: items(:)    !! (capacity) the requests
   contains
      procedure :: add
   end type request_list_type

contains

   !> Adds a request.
   subroutine add(self, request)
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
