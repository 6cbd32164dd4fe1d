!> Whether two lines of nodes can be matched, and how it is said where they cannot.
module interface_checks
   use chain_geometry, only: chain_tangents, side_positions, side_total, turns_back
   use contact_definitions, only: contact_definition_type
   use contact_points, only: contact_points_type
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use mesh, only: extent_of, mesh_type
   use surface_chains, only: surface_chain_type
   use text, only: to_text
   implicit none
   private
   public :: check_folds, check_shared, compare_lines, check_sides, check_opposite
   public :: check_corner, check_covered, check_idle, blame_corner

   !> Cosine between outward normals from which on faces look the same way: curved faces that part
   !> far from the contact may be at right angles there.
   real(dp), parameter :: same_way = 0.1_dp

   !> Rounding of a mean cosine.
   real(dp), parameter :: no_cosine = 1.0e-9_dp

   !> Part of the model's extent within which two nodes coincide.
   real(dp), parameter :: same_position = 1.0e-9_dp

   !> Cosine of a turn of a surface between two faces, 60 degrees, from which on the faces behind it
   !> may have been named by mistake.
   real(dp), parameter :: sharp_turn = 0.5_dp

   character(*), parameter :: way_out = '; mesh both surfaces with the same divisions, so that '// &
      'their nodes face each other, or take PAIRING=SURFACES'

contains

   !> The two lines have no nodes in common but ends.
   subroutine check_shared(mesh, definition, slave, master, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      type(surface_chain_type), intent(in) :: slave           !! line of the slave
      type(surface_chain_type), intent(in) :: master !! line of the master, along the slave's
      type(error_type), allocatable, intent(out) :: error     !! the node
      logical :: of_slave(size(mesh%node_number))
      integer :: inner, k

      inner = 0
      of_slave = .false.
      of_slave(slave%nodes) = .true.
      do k = 1, size(master%nodes)
         associate (node => master%nodes(k))
            if (.not. of_slave(node)) then
               inner = inner + 1
            else if (slave%closed .or. master%closed .or. .not. ((k == 1 .and. &
               node == slave%nodes(1)) .or. (k == size(master%nodes) .and. &
               node == slave%nodes(size(slave%nodes))))) then
               call set_error(error, status_deck, definition%title()//': node '// &
                  to_text(mesh%node_number(node))//' belongs to both surfaces; only common '// &
                  'ends, as at the tip of a crack, may: end them there')
               return
            end if
         end associate
      end do
      if (inner == 0) call set_error(error, status_deck, definition%title()// &
         ': both surfaces consist of the same nodes')
   end subroutine check_shared

   !> Refuses a line whose side runs back: it has no normal there.
   subroutine check_folds(mesh, title, chain, error)
      type(mesh_type), intent(in) :: mesh
      character(*), intent(in) :: title                    !! of the *CONTACT PAIR
      type(surface_chain_type), intent(in) :: chain        !! line of the slave or of the master
      type(error_type), allocatable, intent(out) :: error  !! the midside node
      integer :: position(chain%side_nodes), side

      do side = 1, side_total(size(chain%nodes), chain%side_nodes, chain%closed)
         position = side_positions(side, chain%side_nodes, size(chain%nodes))
         associate (nodes => chain%nodes(position))
            if (.not. turns_back(mesh%coordinates(:, nodes))) cycle
            call set_error(error, status_deck, title//': the side from node '// &
               to_text(mesh%node_number(nodes(1)))//' to node '// &
               to_text(mesh%node_number(nodes(size(nodes))))//' runs back behind node '// &
               to_text(mesh%node_number(nodes(2)))//': move that node to the middle of the side')
            return
         end associate
      end do
   end subroutine check_folds

   !> Says how two lines are not of one kind or have different numbers of nodes, and what to do for
   !> node pairs.
   subroutine compare_lines(mesh, definition, slave, master, message, advice)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition    !! the *CONTACT PAIR
      type(surface_chain_type), intent(in) :: slave, master      !! their lines
      character(:), allocatable, intent(out) :: message          !! empty where they are alike
      character(:), allocatable, intent(out) :: advice           !! from its semicolon on

      message = ''
      advice = way_out
      associate (slave_name => mesh%surfaces(definition%slave)%name, &
         master_name => mesh%surfaces(definition%master)%name)
         if (slave%side_nodes /= master%side_nodes) then
            message = 'surface '//slave_name//' has sides of '//to_text(slave%side_nodes)// &
               ' nodes, surface '//master_name//' of '//to_text(master%side_nodes)
            advice = '; mesh both with elements with midside nodes, or both without, '// &
               'or take PAIRING=SURFACES'
         else if (slave%closed .neqv. master%closed) then
            message = 'one of the surfaces '//slave_name//' and '//master_name// &
               ' is a closed ring, the other one an open line'
            advice = '; let both be rings or both open, or take PAIRING=SURFACES'
         else if (size(slave%nodes) /= size(master%nodes)) then
            message = to_text(size(slave%nodes))//' slave nodes but '// &
               to_text(size(master%nodes))//' master nodes; '
            if (size(slave%nodes) > size(master%nodes)) then
               message = message//'slave node '//to_text(first_alone(mesh, slave%nodes, &
                  master%nodes))//' has no partner'
            else
               message = message//'master node '//to_text(first_alone(mesh, master%nodes, &
                  slave%nodes))//' has no partner'
            end if
         end if
      end associate
   end subroutine compare_lines

   !> Number of the first node of the longer line that has no partner: to the node of the other line
   !> that is nearest to it, another one is nearer.
   pure integer function first_alone(mesh, long, short)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: long(:), short(:)
      integer :: k, partner

      do k = 1, size(long)
         partner = nearest_position(mesh, short, long(k))
         if (nearest_position(mesh, long, short(partner)) /= k) exit
      end do
      first_alone = mesh%node_number(long(min(k, size(long))))
   end function first_alone

   !> Position of the node that is nearest to another node.
   pure integer function nearest_position(mesh, nodes, node)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: nodes(:), node

      nearest_position = minloc((mesh%coordinates(1, nodes) - mesh%coordinates(1, node))**2 + &
         (mesh%coordinates(2, nodes) - mesh%coordinates(2, node))**2, dim=1)
   end function nearest_position

   !> Refuses faces that look the same way somewhere, and those that do not face each other on the
   !> average: their normals are at 90 degrees or less.
   subroutine check_sides(mesh, definition, slave, master, compared, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition   !! the *CONTACT PAIR
      type(surface_chain_type), intent(in) :: slave       !! line of the slave
      type(surface_chain_type), intent(in) :: master      !! line of the master
      integer, intent(in) :: compared(2)                  !! first and last contact point looked at
      type(error_type), allocatable, intent(out) :: error !! the first such contact point
      real(dp) :: cosine, total, outward(2)
      integer :: k

      associate (slave_tangent => chain_tangents(mesh%coordinates(:, slave%nodes), &
         slave%side_nodes, slave%closed), &
         master_tangent => chain_tangents(mesh%coordinates(:, master%nodes), &
         master%side_nodes, master%closed))
         total = 0.0_dp
         do k = compared(1), compared(2)
            cosine = dot_product(slave_tangent(:, k), master_tangent(:, k))
            if (slave%turned .neqv. master%turned) cosine = -cosine
            total = total + cosine
            if (cosine <= same_way) cycle
            call set_error(error, status_deck, definition%title()// &
               ': at slave node '//to_text(mesh%node_number(slave%nodes(k)))// &
               ' and master node '//to_text(mesh%node_number(master%nodes(k)))// &
               ' both surfaces face the same way')
            outward = [slave_tangent(2, k), -slave_tangent(1, k)]
            if (slave%turned) outward = -outward
            call blame_side(mesh, definition, dot_product(outward, &
               mesh%coordinates(:, master%nodes(k)) - mesh%coordinates(:, slave%nodes(k))), error)
            return
         end do
      end associate
      if (total < -no_cosine*(compared(2) - compared(1) + 1)) return
      call set_error(error, status_deck, definition%title()//': surfaces '// &
         mesh%surfaces(definition%slave)%name//' and '//mesh%surfaces(definition%master)%name// &
         ' do not face each other: their outward normals are at 90 degrees or less on the '// &
         'average; name the faces opposite each other')
   end subroutine check_sides

   !> Puts the blame on the surface that looks away from the other one, if one does.
   subroutine blame_side(mesh, definition, ahead, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition
      real(dp), intent(in) :: ahead     ! how far the master lies in front of the slave [length]
      type(error_type), intent(inout) :: error
      integer :: surface

      if (abs(ahead) <= same_position*extent_of(mesh%coordinates)) then
         error%message = error%message//'; name the faces opposite each other'
         return
      end if
      surface = merge(definition%master, definition%slave, ahead > 0.0_dp)
      error%card = mesh%surfaces(surface)%card
      error%message = error%message//': surface '//mesh%surfaces(surface)%name// &
         ' looks away from the other one; name the faces opposite it'
   end subroutine blame_side

   !> Where surfaces do not fit, the fault may be a face round the corner: puts the blame on the
   !> surface that turns sharply, if only one does.
   subroutine blame_corner(mesh, definition, slave, master, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      type(surface_chain_type), intent(in) :: slave           !! line of the slave
      type(surface_chain_type), intent(in) :: master          !! line of the master
      type(error_type), intent(inout) :: error                !! how they do not fit
      integer :: node, surface

      if ((sharp_corner(mesh, slave) > 0) .eqv. (sharp_corner(mesh, master) > 0)) return
      node = max(sharp_corner(mesh, slave), sharp_corner(mesh, master))
      surface = merge(definition%slave, definition%master, sharp_corner(mesh, slave) > 0)
      error%card = mesh%surfaces(surface)%card
      if (index(error%message, way_out) > 0) error%message = &
         error%message(:index(error%message, way_out) - 1)
      error%message = error%message//'; surface '//mesh%surfaces(surface)%name// &
         ' goes round a corner at node '//to_text(mesh%node_number(node))// &
         ': leave out the faces behind it that are not in contact'
   end subroutine blame_corner

   !> The first node at which an open line turns sharply between two faces; 0 where there is none.
   pure integer function sharp_corner(mesh, chain)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: chain
      integer :: k, step

      sharp_corner = 0
      if (chain%closed) return
      step = chain%side_nodes - 1
      do k = 1 + step, size(chain%nodes) - step, step
         associate (before => mesh%coordinates(:, chain%nodes(k)) - &
            mesh%coordinates(:, chain%nodes(k - step)), &
            behind => mesh%coordinates(:, chain%nodes(k + step)) - &
            mesh%coordinates(:, chain%nodes(k)))
            if (dot_product(before, behind) >= sharp_turn*norm2(before)*norm2(behind)) cycle
         end associate
         sharp_corner = chain%nodes(k)
         return
      end do
   end function sharp_corner

   !> Refuses a contact point whose tangential offset exceeds half of its element's edge or of its
   !> gap.
   subroutine check_opposite(mesh, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points     !! node pairs of one interface
      type(error_type), allocatable, intent(out) :: error !! the first such contact point
      real(dp) :: offset(size(points%slave))
      integer :: k

      associate (slave => points%slave, master => points%master)
         offset = abs(sum(points%tangent*(mesh%coordinates(:, master) - &
            mesh%coordinates(:, slave)), dim=1))
         k = findloc(offset > 0.5_dp*max(points%edge, abs(points%initial_gap)) .or. &
            norm2(points%tangent, dim=1) < 0.5_dp, .true., dim=1)
         if (k == 0) return
         call set_error(error, status_deck, 'contact pair '//points%name//': slave node '// &
            to_text(mesh%node_number(slave(k)))//' and master node '// &
            to_text(mesh%node_number(master(k)))//' are not opposite each other'//way_out)
      end associate
   end subroutine check_opposite

   !> Refuses a slave face that goes round a corner: its normals there would point nowhere.
   subroutine check_corner(mesh, definition, slave, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      type(surface_chain_type), intent(in) :: slave           !! line of the slave
      type(error_type), allocatable, intent(out) :: error     !! the corner
      integer :: node

      node = sharp_corner(mesh, slave)
      if (node == 0) return
      associate (surface => mesh%surfaces(definition%slave))
         call set_error(error, status_deck, definition%title()// &
            ': the slave surface '//surface%name//' goes round a corner at node '// &
            to_text(mesh%node_number(node))//': leave out the faces behind it that are not in '// &
            'contact, or make a surface of each side', surface%card)
      end associate
   end subroutine check_corner

   !> Refuses faces of which none lies opposite the other surface.
   subroutine check_covered(mesh, definition, slave, master, points, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition !! the *CONTACT PAIR
      type(surface_chain_type), intent(in) :: slave, master   !! their lines
      integer, intent(in) :: points                           !! contact points found
      type(error_type), allocatable, intent(out) :: error

      if (points > 0) return
      call set_error(error, status_deck, definition%title()// &
         ': no face of the master lies opposite the slave, along the normals of the slave')
      call blame_side(mesh, definition, ahead_of(mesh, slave, master%nodes), error)
   end subroutine check_covered

   !> Names the lines of two surfaces that take no part; refuses those that look away from the other
   !> surface.
   subroutine check_idle(mesh, definition, slaves, masters, meets, idle, error)
      type(mesh_type), intent(in) :: mesh
      type(contact_definition_type), intent(in) :: definition   !! the *CONTACT PAIR
      type(surface_chain_type), intent(in) :: slaves(:), masters(:)   !! lines of both surfaces
      logical, intent(in) :: meets(:, :)      !! (slaves, masters) whether they have contact points
      character(:), allocatable, intent(inout) :: idle          !! receives words on the lines
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(slaves)
         if (.not. any(meets(i, :)) .and. .not. allocated(error)) call name_line(slaves(i), &
            definition%slave, masters)
      end do
      do i = 1, size(masters)
         if (.not. any(meets(:, i)) .and. .not. allocated(error)) call name_line(masters(i), &
            definition%master, slaves)
      end do

   contains
      subroutine name_line(line, surface, others)
         type(surface_chain_type), intent(in) :: line
         integer, intent(in) :: surface
         type(surface_chain_type), intent(in) :: others(:)
         character(:), allocatable :: words
         integer :: k

         words = 'the line of surface '//mesh%surfaces(surface)%name//' from node '// &
            to_text(mesh%node_number(line%nodes(1)))//' to node '// &
            to_text(mesh%node_number(line%nodes(size(line%nodes))))
         if (ahead_of(mesh, line, [(others(k)%nodes, k=1, size(others))]) < &
            -same_position*extent_of(mesh%coordinates)) then
            call set_error(error, status_deck, definition%title()//': '//words// &
               ' looks away from the other surface; name the faces opposite it', &
               mesh%surfaces(surface)%card)
            return
         end if
         if (allocated(idle)) words = idle//', '//words
         idle = words
      end subroutine name_line
   end subroutine check_idle

   !> How far the middle of some nodes lies in front of a line, seen from its middle.
   pure real(dp) function ahead_of(mesh, line, nodes) result(ahead)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: line
      integer, intent(in) :: nodes(:)
      real(dp) :: tangents(2, size(line%nodes)), outward(2)
      integer :: k

      tangents = chain_tangents(mesh%coordinates(:, line%nodes), line%side_nodes, line%closed)
      k = (size(line%nodes) + 1)/2
      outward = [tangents(2, k), -tangents(1, k)]
      if (line%turned) outward = -outward
      ahead = dot_product(outward, sum(mesh%coordinates(:, nodes), dim=2)/size(nodes) - &
         mesh%coordinates(:, line%nodes(k)))
   end function ahead_of

end module interface_checks
