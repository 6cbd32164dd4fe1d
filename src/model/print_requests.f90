!> Tables of nodes and of integration points that the deck asks for (*NODE PRINT, *EL PRINT).
module print_requests
   use kinds, only: dp
   use mesh, only: set_type
   use text, only: named_type
   implicit none
   private
   public :: print_request_type, time_points_type

   !> One *TIME POINTS, instants of output; without times where a card names none.
   type, extends(named_type) :: time_points_type
      logical :: total_time = .false.       !! whether times are total ones, not those of the step
      real(dp), allocatable :: times(:)     !! (points) ascending [time]
   contains
      procedure :: in_step
   end type time_points_type

   !> One card: a table of the nodes, or of the integration points of the elements, of a set.
   type :: print_request_type
      integer :: set = 0                     !! index into the node or element sets; 0: all
      integer :: frequency = 1               !! every n-th increment and the last; 0 never
      type(time_points_type) :: points       !! and at these instants
      character(5), allocatable :: keys(:)   !! of the quantities, each once, as on the card
      logical :: each_node = .true.          !! RF and RFL of every node
      logical :: totals = .false.            !! sums of them over the set
      !> What points have along the axes of the section's orientation, vectors along those of the
      !> nodes, else along x and y.
      logical :: local_axes = .false.
   contains
      procedure :: members
      procedure :: name_of_set
   end type print_request_type

contains

   !> The nodes or elements of a table.
   pure function members(self, sets, count)
      class(print_request_type), intent(in) :: self
      type(set_type), intent(in) :: sets(:)     !! node or element sets of the mesh
      integer, intent(in) :: count              !! its nodes or elements
      integer, allocatable :: members(:)        !! indexes of nodes or elements
      integer :: i

      if (self%set > 0) then
         members = sets(self%set)%members
      else
         members = [(i, i=1, count)]
      end if
   end function members

   !> The name of its set; that of all nodes or elements is ALL.
   pure function name_of_set(self, sets) result(name)
      class(print_request_type), intent(in) :: self
      type(set_type), intent(in) :: sets(:)     !! node or element sets of the mesh
      character(:), allocatable :: name

      name = 'ALL'
      if (self%set > 0) name = sets(self%set)%name
   end function name_of_set

   !> The instants from the start of a step.
   pure function in_step(self, step_start) result(times)
      class(time_points_type), intent(in) :: self
      real(dp), intent(in) :: step_start     !! total time at the start of the step [time]
      real(dp), allocatable :: times(:)      !! [time]

      allocate (times(0))
      if (allocated(self%times)) times = self%times - merge(step_start, 0.0_dp, self%total_time)
   end function in_step

end module print_requests
