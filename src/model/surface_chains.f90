!> Element sides of a surface as one line of nodes, open or closed.
module surface_chains
   use element_kinds, only: side_node_count, side_nodes
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use mesh, only: mesh_type, surface_type
   use text, only: to_text
   implicit none
   private
   public :: surface_chain_type, chain_faces, aligned_chains

   !> Part of the length of a line by which coordinates count as different.
   real(dp), parameter :: distinct = 1.0e-9_dp

   !> The nodes along a surface, with the body on the left.
   type :: surface_chain_type
      integer, allocatable :: nodes(:)   !! node indexes, corner first; on a closed face each once
      integer :: side_nodes = 0          !! nodes of a side, 2 or 3
      logical :: closed = .false.        !! closed: the last side leads back to the first node
      logical :: turned = .false.        !! whether it runs against its faces
      !> (2, nodes) unit tangents of a drawing, 0 beyond its ends; unallocated: those of the sides
      real(dp), allocatable :: tangent(:, :)
   end type surface_chain_type

contains

   !> Nodes along a surface: corner, midside if there is one, corner, ... Each side is followed by
   !> the one that begins at its second corner, so the line runs with the body on its left. A closed
   !> face begins at the corner that precedes all others.
   !> Errors: no sides, sides of 2 and of 3 nodes, sides that do not form one line.
   subroutine chain_faces(mesh, surface, chain, error)
      type(mesh_type), intent(in) :: mesh
      type(surface_type), intent(in) :: surface
      type(surface_chain_type), intent(out) :: chain      !! the line
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: leaving(:), sides(:, :)
      integer :: count_sides, first, i, n, side

      count_sides = size(surface%faces, 2)
      if (count_sides == 0) then
         call set_error(error, status_deck, 'surface '//surface%name//' has no faces', &
            surface%card)
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
      call find_first(mesh, sides, leaving, first)
      chain%side_nodes = n
      allocate (chain%nodes((n - 1)*count_sides + 1))
      side = first
      do i = 1, count_sides
         if (side == 0) exit
         chain%nodes((n - 1)*(i - 1) + 1:(n - 1)*i + 1) = sides(:, side)
         side = leaving(sides(n, side))
         if (side == first .and. i < count_sides) exit
      end do
      if (i <= count_sides) then
         call set_error(error, status_deck, 'surface '//surface%name// &
            ' is not one line of faces, each beginning where another one ends'// &
            first_break(mesh, surface, sides)//', each on a data card of *CONTACT PAIR or *TIE', &
            surface%card)
         return
      end if
      chain%closed = side == first
      if (chain%closed) chain%nodes = chain%nodes(:size(chain%nodes) - 1)
   end subroutine chain_faces

   !> Turns both lines to run from the slave's first contact point on: an open one if its ends so
   !> lie nearer to the slave's, a closed face of the master always, for it runs against the slave.
   subroutine aligned_chains(mesh, slave, master)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(inout) :: slave, master   !! as from chain_faces
      real(dp) :: distance(size(master%nodes))
      integer :: n, start

      associate (x => mesh%coordinates)
         if (.not. slave%closed) then
            n = size(slave%nodes)
            associate (first => x(:, slave%nodes(1)), last => x(:, slave%nodes(n)))
               slave%turned = precedes(last, first, norm2(last - first))
            end associate
            if (slave%turned) slave%nodes = slave%nodes(n:1:-1)
         end if
         n = size(master%nodes)
         distance = norm2(x(:, master%nodes) - spread(x(:, slave%nodes(1)), 2, n), dim=1)
         if (master%closed) then
            start = 1 + (master%side_nodes - 1)*(minloc(distance(::master%side_nodes - 1), dim=1) &
               - 1)
            master%nodes = cshift(master%nodes, start - 1)
            master%nodes(2:) = master%nodes(n:2:-1)
            master%turned = .true.
         else
            ! Squares of these distances, less what they have in common: bodies may lie far apart.
            master%turned = dot_product(x(:, slave%nodes(size(slave%nodes))) - &
               x(:, slave%nodes(1)), x(:, master%nodes(n)) - x(:, master%nodes(1))) < 0.0_dp
            if (master%turned) master%nodes = master%nodes(n:1:-1)
         end if
      end associate
   end subroutine aligned_chains

   !> The side that leaves each node, and the side to begin with: that whose first corner no other
   !> side reaches, on a closed face that of the preceding corner, 0 where the line branches.
   subroutine find_first(mesh, sides, leaving, first)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: sides(:, :)
      integer, allocatable, intent(out) :: leaving(:)
      integer, intent(out) :: first
      logical, allocatable :: entered(:)
      real(dp) :: extent
      integer :: i, n
      logical :: branched

      n = size(sides, 1)
      branched = .false.
      allocate (leaving(size(mesh%node_number)), source=0)
      allocate (entered(size(mesh%node_number)), source=.false.)
      do i = 1, size(sides, 2)
         branched = branched .or. leaving(sides(1, i)) /= 0 .or. entered(sides(n, i))
         leaving(sides(1, i)) = i
         entered(sides(n, i)) = .true.
      end do
      first = 0
      if (branched) return
      do i = 1, size(sides, 2)
         if (.not. entered(sides(1, i))) first = i
      end do
      if (first > 0) return
      associate (x => mesh%coordinates(:, sides(1, :)))
         extent = maxval(maxval(x, dim=2) - minval(x, dim=2))
         first = 1
         do i = 2, size(sides, 2)
            if (precedes(x(:, i), x(:, first), extent)) first = i
         end do
      end associate
   end subroutine find_first

   !> Tells where a line breaks: at a node at which more than two sides meet, or between two nodes,
   !> and then the face that each piece begins with.
   function first_break(mesh, surface, sides) result(words)
      type(mesh_type), intent(in) :: mesh
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: sides(:, :)            ! (nodes, sides)
      character(:), allocatable :: words
      integer, allocatable :: begins(:), entered(:), left(:)
      integer :: finish, i, n

      n = size(sides, 1)
      allocate (entered(size(mesh%node_number)), left(size(mesh%node_number)), source=0)
      do i = 1, size(sides, 2)
         left(sides(1, i)) = left(sides(1, i)) + 1
         entered(sides(n, i)) = entered(sides(n, i)) + 1
      end do
      words = ''
      i = findloc(entered > 1 .or. left > 1, .true., dim=1)
      if (i > 0) words = ': too many of them meet at node '//to_text(mesh%node_number(i))
      begins = pack([(i, i=1, size(sides, 2))], entered(sides(1, :)) == 0)
      if (len(words) > 0 .or. size(begins) < 2) then
         words = words//'; name the pieces as surfaces of their own'
         return
      end if
      finish = findloc(left(sides(n, :)) == 0, .true., dim=1)
      words = ': it ends at node '//to_text(mesh%node_number(sides(n, finish)))// &
         ' and begins again at node '//to_text(mesh%node_number(sides(1, begins(size(begins)))))// &
         '; name its '//to_text(size(begins))//' pieces as surfaces of their own, which begin with'
      do i = 1, size(begins)
         associate (face => surface%faces(:, begins(i)))
            words = words//trim(merge(' and', merge('    ', ',   ', i == 1), i == size(begins)))// &
               ' S'//to_text(face(2))//' of '//to_text(mesh%element_number(face(1)))
         end associate
      end do
   end function first_break

   !> Whether a point comes before another one: by the smaller x, then by the smaller y.
   pure logical function precedes(a, b, extent)
      real(dp), intent(in) :: a(2), b(2)   ! points [length]
      real(dp), intent(in) :: extent       ! length of the line, by which rounding is judged

      precedes = a(1) < b(1)
      if (abs(a(1) - b(1)) <= distinct*extent) precedes = a(2) < b(2)
   end function precedes

end module surface_chains
