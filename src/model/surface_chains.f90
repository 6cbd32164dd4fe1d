!> Element sides of a surface as lines of nodes, each open or closed.
module surface_chains
   use element_kinds, only: side_node_count, side_nodes
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use mesh, only: mesh_type, surface_type
   use text, only: to_text
   implicit none
   private
   public :: surface_chain_type, chain_faces, align_chain, facing_chain

   !> Part of the length of a line by which coordinates count as different.
   real(dp), parameter :: distinct = 1.0e-9_dp

   !> The nodes along a line of a surface, with the body on the left unless it is turned.
   type :: surface_chain_type
      integer, allocatable :: nodes(:)   !! node indexes, corner first; on a closed face each once
      integer :: side_nodes = 0          !! nodes of a side, 2 or 3
      logical :: closed = .false.        !! closed: the last side leads back to the first node
      logical :: turned = .false.        !! whether it runs against its faces
      !> (2, nodes) unit tangents of a drawing, 0 beyond its ends; unallocated: those of the sides
      real(dp), allocatable :: tangent(:, :)
   end type surface_chain_type

contains

   !> The lines of a surface: corner, midside if there is one, corner, ... An open one begins at the
   !> end that precedes the other, a closed face at the corner that precedes all others, with the
   !> body on its left; lines are in the order of where they begin.
   !> Errors: no sides, sides of 2 and of 3 nodes, more than two sides at a node.
   subroutine chain_faces(mesh, surface, chains, error)
      type(mesh_type), intent(in) :: mesh
      type(surface_type), intent(in) :: surface
      type(surface_chain_type), allocatable, intent(out) :: chains(:)   !! the lines
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: leaving(:), sides(:, :)
      type(surface_chain_type), allocatable :: more(:)
      logical, allocatable :: entered(:), is_left(:)
      integer :: count_sides, first, i, n

      count_sides = size(surface%faces, 2)
      if (count_sides == 0) then
         call set_error(error, status_deck, 'surface '//surface%name//' has no faces', surface%card)
         return
      end if
      associate (counts => side_node_count(mesh%element_kind(surface%faces(1, :))))
         n = counts(1)
         if (any(counts /= n)) then
            call set_error(error, status_deck, 'surface '//surface%name// &
               ' has sides with and without midside nodes; make a surface of each', surface%card)
            return
         end if
      end associate
      allocate (sides(n, count_sides))
      do i = 1, count_sides
         associate (element => surface%faces(1, i), face => surface%faces(2, i))
            sides(:, i) = mesh%element_nodes(side_nodes(mesh%element_kind(element), face), element)
         end associate
      end do
      call join_sides(mesh, surface, sides, leaving, entered, error)
      if (allocated(error)) return
      allocate (chains(0))
      allocate (is_left(count_sides), source=.true.)
      do while (any(is_left))
         first = findloc(is_left .and. .not. entered(sides(1, :)), .true., dim=1)
         if (first == 0) first = findloc(is_left, .true., dim=1)
         allocate (more(size(chains) + 1))
         more(:size(chains)) = chains
         more(size(more)) = chain_from(mesh, sides, leaving, first, is_left)
         call move_alloc(more, chains)
      end do
      call sort_chains(mesh, chains)
   end subroutine chain_faces

   !> The side that leaves each node, and whether one enters it.
   !> Errors: more than one.
   subroutine join_sides(mesh, surface, sides, leaving, entered, error)
      type(mesh_type), intent(in) :: mesh
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: sides(:, :)              ! (nodes, sides)
      integer, allocatable, intent(out) :: leaving(:) ! (nodes) 0 for none
      logical, allocatable, intent(out) :: entered(:) ! (nodes)
      type(error_type), allocatable, intent(out) :: error
      integer :: i, node

      allocate (leaving(size(mesh%node_number)), source=0)
      allocate (entered(size(mesh%node_number)), source=.false.)
      do i = 1, size(sides, 2)
         associate (from => sides(1, i), to => sides(size(sides, 1), i))
            node = 0
            if (leaving(from) > 0) node = from
            if (entered(to)) node = to
            leaving(from) = i
            entered(to) = .true.
         end associate
         if (node == 0) cycle
         call set_error(error, status_deck, 'the faces of surface '//surface%name// &
            ' do not form lines, each beginning where another one ends: too many of them meet '// &
            'at node '//to_text(mesh%node_number(node))//'; leave out those that are not in '// &
            'contact, or make surfaces of them', surface%card)
         return
      end do
   end subroutine join_sides

   !> The line that begins with a side; of a closed one any.
   function chain_from(mesh, sides, leaving, begin, is_left) result(chain)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: sides(:, :)        ! (nodes, sides)
      integer, intent(in) :: leaving(:)         ! (nodes)
      integer, intent(in) :: begin
      logical, intent(inout) :: is_left(:)      ! (sides) loses those of the line
      type(surface_chain_type) :: chain
      logical :: is_own(size(is_left))
      real(dp) :: extent
      integer :: first, i, n, side

      n = size(sides, 1)
      is_own = .false.
      side = begin
      do while (side > 0)
         if (is_own(side)) exit
         is_own(side) = .true.
         side = leaving(sides(n, side))
      end do
      is_left = is_left .and. .not. is_own
      chain%side_nodes = n
      chain%closed = side == begin
      first = begin
      if (chain%closed) then
         ! The corner that precedes all others.
         associate (x => mesh%coordinates(:, sides(1, :)))
            extent = maxval([(maxval(x(i, :), mask=is_own) - minval(x(i, :), mask=is_own), &
               i=1, 2)])
            first = findloc(is_own, .true., dim=1)
            do i = first + 1, size(is_own)
               if (is_own(i) .and. precedes(x(:, i), x(:, first), extent)) first = i
            end do
         end associate
      end if
      allocate (chain%nodes((n - 1)*count(is_own) + 1))
      side = first
      do i = 1, count(is_own)
         chain%nodes((n - 1)*(i - 1) + 1:(n - 1)*i + 1) = sides(:, side)
         side = leaving(sides(n, side))
      end do
      associate (last => size(chain%nodes))
         if (chain%closed) then
            chain%nodes = chain%nodes(:last - 1)
         else
            associate (ends => mesh%coordinates(:, chain%nodes([1, last])))
               chain%turned = precedes(ends(:, 2), ends(:, 1), norm2(ends(:, 2) - ends(:, 1)))
            end associate
            if (chain%turned) chain%nodes = chain%nodes(last:1:-1)
         end if
      end associate
   end function chain_from

   !> Puts lines in the order of where they begin.
   subroutine sort_chains(mesh, chains)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(inout) :: chains(:)
      integer :: i, k, order(size(chains))
      real(dp) :: extent, x(2, size(chains))

      do i = 1, size(chains)
         order(i) = i
         x(:, i) = mesh%coordinates(:, chains(i)%nodes(1))
      end do
      extent = maxval(maxval(x, dim=2) - minval(x, dim=2))
      do i = 2, size(order)
         do k = i, 2, -1
            if (.not. precedes(x(:, order(k)), x(:, order(k - 1)), extent)) exit
            order([k - 1, k]) = order([k, k - 1])
         end do
      end do
      chains = chains(order)
   end subroutine sort_chains

   !> Turns the line of a master to run from the slave's first contact point on: an open one if its
   !> ends so lie nearer to the slave's, a closed face always, for it runs against the slave.
   subroutine align_chain(mesh, slave, master)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: slave
      type(surface_chain_type), intent(inout) :: master   !! as from chain_faces
      real(dp) :: distance(size(master%nodes))
      integer :: n, start

      associate (x => mesh%coordinates)
         n = size(master%nodes)
         if (master%closed) then
            distance = norm2(x(:, master%nodes) - spread(x(:, slave%nodes(1)), 2, n), dim=1)
            start = 1 + (master%side_nodes - 1)*(minloc(distance(::master%side_nodes - 1), dim=1) &
               - 1)
            master%nodes = cshift(master%nodes, start - 1)
            master%nodes(2:) = master%nodes(n:2:-1)
            master%turned = .true.
            ! Squares of these distances, less what they have in common: bodies may lie far apart.
         else if (dot_product(x(:, slave%nodes(size(slave%nodes))) - x(:, slave%nodes(1)), &
            x(:, master%nodes(n)) - x(:, master%nodes(1))) < 0.0_dp) then
            master%nodes = master%nodes(n:1:-1)
            master%turned = .not. master%turned
         end if
      end associate
   end subroutine align_chain

   !> The line whose nodes are paired with those of a slave: the nearest of those with as many, or
   !> of all where none has as many.
   pure integer function facing_chain(mesh, slave, masters) result(facing)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: slave, masters(:)
      real(dp) :: apart(size(masters))
      logical :: fits(size(masters))
      integer :: j

      do j = 1, size(masters)
         associate (n => size(slave%nodes), m => size(masters(j)%nodes), x => mesh%coordinates)
            fits(j) = n == m
            apart(j) = norm2(sum(x(:, slave%nodes), dim=2)/n - sum(x(:, masters(j)%nodes), dim=2)/m)
         end associate
      end do
      facing = minloc(apart, mask=fits .or. .not. any(fits), dim=1)
   end function facing_chain

   !> Whether a point comes before another one: by the smaller x, then by the smaller y.
   pure logical function precedes(a, b, extent)
      real(dp), intent(in) :: a(2), b(2)   ! points [length]
      real(dp), intent(in) :: extent       ! length of the line, by which rounding is judged

      precedes = a(1) < b(1)
      if (abs(a(1) - b(1)) <= distinct*extent) precedes = a(2) < b(2)
   end function precedes

end module surface_chains
