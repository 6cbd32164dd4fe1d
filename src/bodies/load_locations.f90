!> Locations on which the steps of a model put loads: a kind of load on a component of a node or
!> element. A location that one step loads several times has as many entries, one behind the other.
module load_locations
   use sorting, only: sort_order
   use steps, only: load_type, step_type
   implicit none
   private
   public :: load_locations_type, find_locations, entries_of

   !> Entries, ordered by kind, item and component.
   type :: load_locations_type
      integer, allocatable :: kind(:)        !! (n) load_* constant of steps
      integer, allocatable :: item(:)        !! (n) node or element index
      integer, allocatable :: component(:)   !! (n) as said at the kind
   contains
      procedure :: is_repeated
   end type load_locations_type

contains

   !> Locations of all steps.
   pure function find_locations(steps) result(locations)
      type(step_type), intent(in) :: steps(:)
      type(load_locations_type) :: locations    !! each with the entries of its fullest step
      type(load_type), allocatable :: loads(:), all(:)
      integer, allocatable :: ranks(:), order(:)
      logical, allocatable :: first(:)
      integer :: s, i

      allocate (all(0), ranks(0))
      do s = 1, size(steps)
         if (.not. allocated(steps(s)%loads)) cycle
         loads = steps(s)%loads(location_order(steps(s)%loads))
         all = [all, loads]
         ranks = [ranks, entry_ranks(loads)]
      end do
      order = sort_order(ranks)
      order = order(location_order(all(order)))
      all = all(order)
      ranks = ranks(order)
      allocate (first(size(all)), source=.true.)
      do i = 2, size(all)
         first(i) = ranks(i) /= ranks(i - 1) .or. .not. same_location(all(i), all(i - 1))
      end do
      locations%kind = pack(all%kind, first)
      locations%item = pack(all%item, first)
      locations%component = pack(all%component, first)
   end function find_locations

   !> The order of loads by kind, item and component; loads on one location keep theirs.
   pure function location_order(loads) result(order)
      type(load_type), intent(in) :: loads(:)
      integer :: order(size(loads))

      order = sort_order(loads%component)
      order = order(sort_order(loads(order)%item))
      order = order(sort_order(loads(order)%kind))
   end function location_order

   pure logical function same_location(one, other)
      type(load_type), intent(in) :: one, other

      same_location = one%kind == other%kind .and. one%item == other%item .and. &
         one%component == other%component
   end function same_location

   !> How manieth load of its location each one is.
   pure function entry_ranks(loads) result(ranks)
      type(load_type), intent(in) :: loads(:)   ! in the order of their locations
      integer :: ranks(size(loads))
      integer :: i

      ranks = 1
      do i = 2, size(loads)
         if (same_location(loads(i), loads(i - 1))) ranks(i) = ranks(i - 1) + 1
      end do
   end function entry_ranks

   !> Entry that each load of a step takes.
   pure function entries_of(locations, loads) result(entries)
      type(load_locations_type), intent(in) :: locations !! locations that hold all of the loads
      type(load_type), intent(in) :: loads(:)        !! (m) loads of one step
      integer :: entries(size(loads))                !! (m) each entry once
      integer :: order(size(loads)), i, location

      order = location_order(loads)
      location = 0
      do i = 1, size(loads)
         associate (load => loads(order(i)))
            location = location + 1
            do while (locations%kind(location) /= load%kind .or. locations%item(location) /= &
               load%item .or. locations%component(location) /= load%component)
               location = location + 1
            end do
            entries(order(i)) = location
         end associate
      end do
   end function entries_of

   !> Whether an entry belongs to the location of the entry before it.
   pure logical function is_repeated(self, i)
      class(load_locations_type), intent(in) :: self
      integer, intent(in) :: i                      !! entry

      is_repeated = i > 1
      if (is_repeated) is_repeated = self%kind(i) == self%kind(i - 1) .and. &
         self%item(i) == self%item(i - 1) .and. self%component(i) == self%component(i - 1)
   end function is_repeated

end module load_locations
