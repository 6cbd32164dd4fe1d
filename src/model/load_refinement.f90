!> Loads of a model that is refined: on a face they go to the two children at it, on an element to
!> all four; those on nodes stay there, but for temperatures and prescribed values, which new nodes
!> have too.
module load_refinement
   use element_kinds, only: element_corner_count
   use kinds, only: dp
   use mesh_division, only: child_element, division_type, refined_members
   use steps, only: boundary_type, load_body_force, load_body_heat, load_centrifugal, &
      load_face_heat, load_film_coefficient, load_film_sink, load_force, load_gravity, &
      load_nodal_heat, load_pressure, load_temperature, load_traction, load_type, step_type
   implicit none
   private
   public :: refine_loads

contains

   !> Refines the loads of all steps.
   subroutine refine_loads(division, kinds, steps)
      type(division_type), intent(in) :: division
      integer, intent(in) :: kinds(:)               !! (elements) kinds of the elements
      type(step_type), intent(inout) :: steps(:)
      type(load_type), allocatable :: refined(:)
      integer :: s

      do s = 1, size(steps)
         if (allocated(steps(s)%boundaries)) call add_boundaries(division, steps(s)%boundaries)
         if (.not. allocated(steps(s)%loads)) cycle
         call refine_step(division, kinds, steps(s)%loads, refined)
         call move_alloc(refined, steps(s)%loads)
      end do
   end subroutine refine_loads

   subroutine refine_step(division, kinds, loads, refined)
      type(division_type), intent(in) :: division
      integer, intent(in) :: kinds(:)
      type(load_type), intent(in) :: loads(:)
      type(load_type), allocatable, intent(out) :: refined(:)
      type(load_type), allocatable :: added(:)
      integer :: children(4), i, n, parts

      call add_temperatures(division, loads, added)
      allocate(refined(4*size(loads) + size(added)))
      n = 0
      do i = 1, size(loads)
         call find_children(division, kinds, loads(i), children, parts)
         if (parts == 0) then
            parts = 1
            children(1) = loads(i)%item
         end if
         refined(n + 1:n + parts) = loads(i)
         refined(n + 1:n + parts)%item = children(:parts)
         n = n + parts
      end do
      refined(n + 1:n + size(added)) = added
      refined = refined(:n + size(added))
   end subroutine refine_step

   !> Children that a load on an element goes to; none for a load on a node, or on an element that
   !> stays.
   pure subroutine find_children(division, kinds, load, children, parts)
      type(division_type), intent(in) :: division
      integer, intent(in) :: kinds(:)
      type(load_type), intent(in) :: load
      integer, intent(out) :: children(4)
      integer, intent(out) :: parts
      integer :: child, face

      children = 0
      parts = 0
      face = load%component
      if (any(load%kind == [load_force, load_nodal_heat, load_temperature])) return
      if (division%rank(load%item) == 0) return
      select case (load%kind)
      case (load_body_force, load_gravity, load_centrifugal, load_body_heat)
         parts = 4
         children = [(child_element(division, load%item, child), child=1, 4)]
      case (load_pressure, load_traction, load_face_heat, load_film_coefficient, load_film_sink)
         parts = 2
         ! A traction's component counts two directions a face.
         if (load%kind == load_traction) face = (load%component + 1)/2
         children(:2) = [child_element(division, load%item, face), child_element(division, &
            load%item, mod(face, element_corner_count(kinds(load%item))) + 1)]
      case default
         return
      end select
   end subroutine find_children

   !> Temperatures of the new nodes: a new node has one where all nodes of its side or element have
   !> one on the same amplitude.
   subroutine add_temperatures(division, loads, added)
      type(division_type), intent(in) :: division
      type(load_type), intent(in) :: loads(:)
      type(load_type), allocatable, intent(out) :: added(:)
      logical, allocatable :: waiting(:), members(:)
      real(dp), allocatable :: values(:)
      integer :: first, i, node

      allocate(added(0))
      waiting = loads%kind == load_temperature
      do while (any(waiting))
         first = findloc(waiting, .true., dim=1)
         allocate(values(division%nodes), source=0.0_dp)
         allocate(members(division%nodes), source=.false.)
         do i = first, size(loads)
            if (.not. waiting(i) .or. loads(i)%amplitude /= loads(first)%amplitude) cycle
            values(loads(i)%item) = values(loads(i)%item) + loads(i)%value
            members(loads(i)%item) = .true.
            waiting(i) = .false.
         end do
         call spread_over_sides(division, values, members)
         call append(pack([(node, node=1, size(members))], members), values, loads(first), added)
         deallocate(values, members)
      end do
   end subroutine add_temperatures

   !> Prescribed values of the new nodes, likewise.
   subroutine add_boundaries(division, boundaries)
      type(division_type), intent(in) :: division
      type(boundary_type), allocatable, intent(inout) :: boundaries(:)
      type(boundary_type), allocatable :: added(:), more(:)
      logical, allocatable :: waiting(:), members(:)
      real(dp), allocatable :: values(:)
      integer, allocatable :: nodes(:)
      integer :: first, i, node

      allocate(waiting(size(boundaries)), source=.true.)
      allocate(added(0))
      do while (any(waiting))
         first = findloc(waiting, .true., dim=1)
         allocate(values(division%nodes), source=0.0_dp)
         allocate(members(division%nodes), source=.false.)
         do i = first, size(boundaries)
            if (boundaries(i)%dof /= boundaries(first)%dof) cycle
            if (boundaries(i)%amplitude /= boundaries(first)%amplitude) cycle
            values(boundaries(i)%node) = boundaries(i)%value
            members(boundaries(i)%node) = .true.
            waiting(i) = .false.
         end do
         call spread_over_sides(division, values, members)
         nodes = pack([(node, node=1, size(members))], members)
         allocate(more(size(nodes)), source=boundaries(first))
         more%node = nodes
         more%value = values(nodes)
         added = [added, more]
         deallocate(values, members, more)
      end do
      boundaries = [boundaries, added]
   end subroutine add_boundaries

   !> Values at the new nodes of sides and elements whose nodes all have one.
   subroutine spread_over_sides(division, values, members)
      type(division_type), intent(in) :: division
      real(dp), allocatable, intent(inout) :: values(:)   ! (nodes), then of the divided mesh
      logical, allocatable, intent(inout) :: members(:)   ! likewise; which have one, then new ones

      values = division%weights%multiply(values)
      members = refined_members(division, members)
      members(:division%nodes) = .false.
   end subroutine spread_over_sides

   subroutine append(nodes, values, like, loads)
      integer, intent(in) :: nodes(:)
      real(dp), intent(in) :: values(:)
      type(load_type), intent(in) :: like
      type(load_type), allocatable, intent(inout) :: loads(:)
      type(load_type), allocatable :: more(:)
      integer :: before

      before = size(loads)
      allocate(more(before + size(nodes)), source=like)
      more(:before) = loads
      more(before + 1:)%item = nodes
      more(before + 1:)%value = values(nodes)
      call move_alloc(more, loads)
   end subroutine append

end module load_refinement
