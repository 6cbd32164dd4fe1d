!> Numbers the unknowns of a field problem with contact, and writes every degree of freedom by them;
!> what the numbering means stands in equation_map.
module equation_numbering
   use equation_map, only: equation_map_type
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use pair_rings, only: close_rings
   use ring_links, only: ring_link_type
   implicit none
   private
   public :: make_map, least_slant

   !> Component of a normal along the only free axis that is rounding: the normal motion of such a
   !> pair is prescribed.
   real(dp), parameter :: least_slant = 1.0e-9_dp
   !> Sum of direction cosines that is rounding, where a walk round a ring comes back.
   real(dp), parameter :: negligible = 1.0e-14_dp

contains

   !> Numbers the unknowns. Degree of freedom c of node i is components*(i - 1) + c. Where both
   !> nodes of a pair are prescribed along one axis, its relative value along the normal is the part
   !> that the motion along the other axis adds, and it has none along the tangent.
   !> Error: a pair whose normal motion is prescribed on both nodes.
   subroutine make_map(used, prescribed, slave, master, frame, on_tail, map, error, slave_leads)
      logical, intent(in) :: used(:)                      !! (nodes) whether a node carries unknowns
      logical, intent(in) :: prescribed(:)                !! (dofs) prescribed values
      integer, intent(in) :: slave(:)                     !! (m) slave nodes of the pairs
      integer, intent(in) :: master(:)                    !! (m) master nodes of the pairs
      real(dp), intent(in) :: frame(:, :, :) !! (components, components, m) columns: unit vectors
      logical, intent(in) :: on_tail(:, :) !! (components, m) relative values that contact acts on
      type(equation_map_type), intent(out) :: map         !! the numbering
      type(error_type), allocatable, intent(out) :: error !! see above
      !> (m) whether the slave is to lead where neither node is prescribed; else the master does.
      logical, intent(in), optional :: slave_leads(:)
      logical :: closes(size(slave)), held(size(frame, 1), size(slave)), leads(size(slave))
      real(dp) :: ways(size(frame, 1), size(frame, 2), size(slave))
      integer :: components, k, tied(size(slave)), twins

      leads = .false.
      if (present(slave_leads)) leads = slave_leads

      call find_ways(prescribed, slave, master, frame, held, ways, error)
      if (allocated(error)) return
      components = size(frame, 1)
      closes = close_rings(slave, master, reshape(prescribed, [components, size(used)]))
      tied = slave
      twins = 0
      do k = 1, size(slave)
         if (.not. closes(k)) cycle
         twins = twins + 1
         tied(k) = size(used) + twins
      end do
      call tie_nodes(map, [used, spread(.true., 1, twins)], &
         [prescribed, spread(.false., 1, components*twins)], tied, master, ways, held, &
         on_tail, closes, leads)
      call make_links(map, slave, master, tied, components)
   end subroutine make_map

   !> Writes every degree of freedom by the unknowns.
   pure subroutine tie_nodes(map, used, prescribed, slave, master, frame, held, on_tail, closes, &
      slave_leads)
      type(equation_map_type), intent(inout) :: map
      logical, intent(in) :: used(:)
      logical, intent(in) :: prescribed(:)
      integer, intent(in) :: slave(:), master(:)
      real(dp), intent(in) :: frame(:, :, :)
      logical, intent(in) :: held(:, :), on_tail(:, :), closes(:), slave_leads(:)
      integer :: order(size(slave), size(frame, 1)), length(size(prescribed))
      logical :: from_slave(size(slave), size(frame, 1)), follows(size(prescribed))
      integer :: c, components, dof, node

      components = size(frame, 1)
      follows = prescribed
      length = 0
      do c = 1, components
         call order_pairs(components, c, prescribed, slave, master, slave_leads, order(:, c), &
            from_slave(:, c), follows, length)
      end do
      associate (dofs => size(prescribed), most_terms => 1 + components*maxval([0, length]))
         allocate (map%term_count(dofs), map%base(dofs), source=0)
         allocate (map%term(most_terms, dofs), source=0)
         allocate (map%coefficient(most_terms, dofs), source=0.0_dp)
      end associate
      do node = 1, size(used)
         do dof = components*(node - 1) + 1, components*node
            if (prescribed(dof)) map%base(dof) = dof
            if (.not. (follows(dof) .or. .not. used(node))) call own_unknown(map, dof)
         end do
      end do
      call number_relative(map, held, on_tail, closes)
      do c = 1, components
         call relate_all(map, components, c, slave, master, frame, order(:, c), from_slave(:, c))
      end do
   end subroutine tie_nodes

   !> Puts the pairs in an order in which each one's leading node, of one component, comes before
   !> the following one. Prescribed nodes lead; where there is none, the first pair's master, or its
   !> slave where that is to. Pairs that are prescribed on both nodes come last, as order 0. No pair
   !> closes a ring.
   pure subroutine order_pairs(components, c, prescribed, slave, master, slave_leads, order, &
      from_slave, follows, length)
      integer, intent(in) :: components, c
      logical, intent(in) :: prescribed(:)
      integer, intent(in) :: slave(:), master(:)
      logical, intent(in) :: slave_leads(:)
      integer, intent(out) :: order(:)
      logical, intent(out) :: from_slave(:)
      logical, intent(inout) :: follows(:)
      integer, intent(inout) :: length(:)
      logical :: placed(size(slave)), reached(size(prescribed)/components)
      integer :: first, found, k, leader, follower, s, m

      reached = prescribed(c::components)
      placed = reached(slave) .and. reached(master)
      from_slave = .false.
      order = 0
      found = 0
      do while (.not. all(placed))
         first = found
         do k = 1, size(slave)
            if (placed(k)) cycle
            s = slave(k)
            m = master(k)
            if (.not. (reached(s) .or. reached(m))) cycle
            from_slave(k) = reached(s)
            leader = merge(s, m, reached(s))
            follower = merge(m, s, reached(s))
            reached(follower) = .true.
            found = found + 1
            order(found) = k
            placed(k) = .true.
            follows(components*(follower - 1) + c) = .true.
            length(components*(follower - 1) + c) = length(components*(leader - 1) + c) + 1
         end do
         if (found > first) cycle
         k = findloc(placed, .false., dim=1)
         reached(merge(slave(k), master(k), slave_leads(k))) = .true.
      end do
   end subroutine order_pairs

   !> Writes one component of all following nodes by the leading ones.
   pure subroutine relate_all(map, components, c, slave, master, frame, order, from_slave)
      type(equation_map_type), intent(inout) :: map
      integer, intent(in) :: components, c
      integer, intent(in) :: slave(:), master(:)
      real(dp), intent(in) :: frame(:, :, :)
      integer, intent(in) :: order(:)
      logical, intent(in) :: from_slave(:)
      integer :: i, k, slave_dof, master_dof

      do i = 1, size(order)
         k = order(i)
         if (k == 0) return
         slave_dof = components*(slave(k) - 1) + c
         master_dof = components*(master(k) - 1) + c
         if (from_slave(k)) then
            call relate(map, slave_dof, master_dof, -frame(c, :, k), map%relative(:, k))
         else
            call relate(map, master_dof, slave_dof, frame(c, :, k), map%relative(:, k))
         end if
      end do
   end subroutine relate_all

   pure subroutine own_unknown(map, dof)
      type(equation_map_type), intent(inout) :: map
      integer, intent(in) :: dof

      map%equations = map%equations + 1
      map%term_count(dof) = 1
      map%term(1, dof) = map%equations
      map%coefficient(1, dof) = 1.0_dp
   end subroutine own_unknown

   !> Relative values that are prescribed, because both nodes are, and the ways in which the other
   !> ones move a slave: the columns of its frame, and for a pair with one free axis along this.
   !> Error: as make_map.
   subroutine find_ways(prescribed, slave, master, frame, held, ways, error)
      logical, intent(in) :: prescribed(:)
      integer, intent(in) :: slave(:), master(:)
      real(dp), intent(in) :: frame(:, :, :)
      logical, intent(out) :: held(:, :)
      real(dp), intent(out) :: ways(:, :, :)
      type(error_type), allocatable, intent(out) :: error
      logical :: both(size(frame, 1))
      integer :: c, components, free, k

      components = size(frame, 1)
      held = .false.
      ways = frame
      do k = 1, size(slave)
         both = [(prescribed(components*(slave(k) - 1) + c) .and. &
            prescribed(components*(master(k) - 1) + c), c=1, components)]
         if (.not. any(both)) cycle
         held(components, k) = .true.
         if (components == 1) cycle
         free = findloc(both, .false., dim=1)
         if (free > 0) held(1, k) = abs(frame(free, 1, k)) <= least_slant
         if (free == 0 .or. held(1, k)) then
            call set_error(error, status_deck, &
               'a contact pair whose normal motion is prescribed on both nodes')
            return
         end if
         ways(:, 1, k) = 0.0_dp
         ways(free, 1, k) = 1.0_dp/frame(free, 1, k)
      end do
   end subroutine find_ways

   !> Numbers the relative values: first those that stay free, then the tail. On it the forces of
   !> the links stand behind the relative values that stiffness holds and before those of the pairs
   !> that close rings, which only the links hold: factors without pivoting then have no zero pivot.
   pure subroutine number_relative(map, held, on_tail, closes)
      type(equation_map_type), intent(inout) :: map
      logical, intent(in) :: held(:, :), on_tail(:, :), closes(:)
      logical :: chosen(size(held, 1), size(held, 2)), closing(size(held, 1), size(held, 2))
      integer :: free, i

      allocate (map%relative(size(held, 1), size(held, 2)), source=0)
      allocate (map%links(size(held, 1)*count(closes)))
      closing = spread(closes, 1, size(held, 1))
      chosen = .not. (held .or. on_tail .or. closing)
      call number_chosen(map, chosen)
      free = map%equations
      chosen = on_tail .and. .not. (held .or. closing)
      call number_chosen(map, chosen)
      map%links%force = [(map%equations + i, i=1, size(map%links))]
      map%equations = map%equations + size(map%links)
      chosen = closing .and. .not. held
      call number_chosen(map, chosen)
      map%tail = map%equations - free
   end subroutine number_relative

   !> Numbers some of the relative values behind what is numbered already.
   pure subroutine number_chosen(map, chosen)
      type(equation_map_type), intent(inout) :: map
      logical, intent(in) :: chosen(:, :)
      integer :: c, k

      do k = 1, size(chosen, 2)
         do c = 1, size(chosen, 1)
            if (.not. chosen(c, k)) cycle
            map%equations = map%equations + 1
            map%relative(c, k) = map%equations
         end do
      end do
   end subroutine number_chosen

   !> Writes the following degree of freedom of a pair by the leading one and the relative values.
   pure subroutine relate(map, leader, follower, direction, relative)
      type(equation_map_type), intent(inout) :: map
      integer, intent(in) :: leader, follower
      real(dp), intent(in) :: direction(:)
      integer, intent(in) :: relative(:)
      integer :: c, n

      map%base(follower) = map%base(leader)
      n = map%term_count(leader)
      map%term(:n, follower) = map%term(:n, leader)
      map%coefficient(:n, follower) = map%coefficient(:n, leader)
      do c = 1, size(relative)
         if (relative(c) == 0 .or. abs(direction(c)) <= 0.0_dp) cycle
         n = n + 1
         map%term(n, follower) = relative(c)
         map%coefficient(n, follower) = direction(c)
      end do
      map%term_count(follower) = n
   end subroutine relate

   !> Links from the slaves of the pairs that close rings to their twins.
   pure subroutine make_links(map, slave, master, tied, components)
      type(equation_map_type), intent(inout) :: map
      integer, intent(in) :: slave(:), master(:)
      integer, intent(in) :: tied(:)
      integer, intent(in) :: components
      type(ring_link_type) :: link
      integer :: c, k, n

      map%in_ring = tied /= slave
      n = 0
      do k = 1, size(slave)
         if (tied(k) == slave(k)) cycle
         do c = 1, components
            n = n + 1
            link = map%links(n)
            link%nodes = [slave(k), master(k)]
            call stretch(map, components*(tied(k) - 1) + c, components*(slave(k) - 1) + c, link)
            map%links(n) = link
         end do
      end do
   end subroutine make_links

   !> Writes the difference of two degrees of freedom by the unknowns; what both have cancels.
   pure subroutine stretch(map, plus, minus, link)
      type(equation_map_type), intent(inout) :: map
      integer, intent(in) :: plus, minus
      type(ring_link_type), intent(inout) :: link
      real(dp) :: total(map%equations)
      integer :: t

      total = 0.0_dp
      do t = 1, map%term_count(plus)
         associate (x => total(map%term(t, plus)))
            x = x + map%coefficient(t, plus)
         end associate
      end do
      do t = 1, map%term_count(minus)
         associate (x => total(map%term(t, minus)))
            x = x - map%coefficient(t, minus)
         end associate
      end do
      link%term = pack([(t, t=1, size(total))], abs(total) > negligible)
      link%coefficient = total(link%term)
      if (map%base(plus) /= map%base(minus)) link%base = [map%base(plus), map%base(minus)]
      do t = 1, size(link%term)
         map%in_ring = map%in_ring .or. any(map%relative == link%term(t), dim=1)
      end do
   end subroutine stretch

end module equation_numbering
