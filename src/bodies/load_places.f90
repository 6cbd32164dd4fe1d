!> Places on which the steps of a model put loads: a kind of load on a component of a node or
!> element. A place that one step loads several times has as many entries, one behind the other.
module load_places
   use sorting, only: sort_order
   use steps, only: load_type, step_type
   implicit none
   private
   public :: load_places_type, find_places, entries_of

   !> Entries, ordered by kind, item and component.
   type :: load_places_type
      integer, allocatable :: kind(:)        !! (n) load_* constant of steps
      integer, allocatable :: item(:)        !! (n) node or element index
      integer, allocatable :: component(:)   !! (n) as said at the kind
   contains
      procedure :: is_repeated
   end type load_places_type

contains

   !> Places of all steps.
   pure function find_places(steps) result(places)
      type(step_type), intent(in) :: steps(:)
      type(load_places_type) :: places          !! each with the entries of its fullest step
      type(load_type), allocatable :: loads(:), all(:)
      integer, allocatable :: ranks(:), order(:)
      logical, allocatable :: first(:)
      integer :: s, i

      allocate (all(0), ranks(0))
      do s = 1, size(steps)
         if (.not. allocated(steps(s)%loads)) cycle
         loads = steps(s)%loads(place_order(steps(s)%loads))
         all = [all, loads]
         ranks = [ranks, entry_ranks(loads)]
      end do
      order = sort_order(ranks)
      order = order(place_order(all(order)))
      all = all(order)
      ranks = ranks(order)
      allocate (first(size(all)), source=.true.)
      do i = 2, size(all)
         first(i) = ranks(i) /= ranks(i - 1) .or. .not. same_place(all(i), all(i - 1))
      end do
      places%kind = pack(all%kind, first)
      places%item = pack(all%item, first)
      places%component = pack(all%component, first)
   end function find_places

   !> The order of loads by kind, item and component; loads on one place keep theirs.
   pure function place_order(loads) result(order)
      type(load_type), intent(in) :: loads(:)
      integer :: order(size(loads))

      order = sort_order(loads%component)
      order = order(sort_order(loads(order)%item))
      order = order(sort_order(loads(order)%kind))
   end function place_order

   pure logical function same_place(one, other)
      type(load_type), intent(in) :: one, other

      same_place = one%kind == other%kind .and. one%item == other%item .and. &
         one%component == other%component
   end function same_place

   !> How manieth load of its place each one is.
   pure function entry_ranks(loads) result(ranks)
      type(load_type), intent(in) :: loads(:)   ! in the order of their places
      integer :: ranks(size(loads))
      integer :: i

      ranks = 1
      do i = 2, size(loads)
         if (same_place(loads(i), loads(i - 1))) ranks(i) = ranks(i - 1) + 1
      end do
   end function entry_ranks

   !> Entry that each load of a step takes.
   pure function entries_of(places, loads) result(entries)
      type(load_places_type), intent(in) :: places   !! places that hold all of the loads
      type(load_type), intent(in) :: loads(:)        !! (m) loads of one step
      integer :: entries(size(loads))                !! (m) each entry once
      integer :: order(size(loads)), i, place

      order = place_order(loads)
      place = 0
      do i = 1, size(loads)
         associate (load => loads(order(i)))
            place = place + 1
            do while (places%kind(place) /= load%kind .or. places%item(place) /= load%item .or. &
               places%component(place) /= load%component)
               place = place + 1
            end do
            entries(order(i)) = place
         end associate
      end do
   end function entries_of

   !> Whether an entry belongs to the place of the entry before it.
   pure logical function is_repeated(self, i)
      class(load_places_type), intent(in) :: self
      integer, intent(in) :: i                      !! entry

      is_repeated = i > 1
      if (is_repeated) is_repeated = self%kind(i) == self%kind(i - 1) .and. &
         self%item(i) == self%item(i - 1) .and. self%component(i) == self%component(i - 1)
   end function is_repeated

end module load_places
