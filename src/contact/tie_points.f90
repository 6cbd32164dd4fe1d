!> What a *TIE holds: points of its slave face whose relative displacements and jumps of temperature
!> are zero. They are made as contact points are: node pairs where the faces match, else mortar
!> points.
module tie_points
   use contact_definitions, only: pairing_nodes, tie_definition_type
   use contact_pairs, only: make_contact_points
   use contact_points, only: contact_points_type
   use element_kinds, only: side_node_count, side_nodes
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use mesh, only: extent_of, mesh_type
   use sum_lists, only: sum_list_type
   use text, only: to_text
   implicit none
   private
   public :: tie_points_type, make_tie_points, joined_ties, tie_words, distance_warning

   real(dp), parameter :: rounding = 1.0e-9_dp   !! relative, of coordinates
   real(dp), parameter :: opposite = 1.0e-3_dp   !! offset of nodes face to face, of the side

   !> The points of all ties in one row.
   type :: tie_points_type
      integer, allocatable :: tie(:)            !! (n) index into the model's ties
      integer, allocatable :: slave(:)          !! (n) node indexes
      integer, allocatable :: master(:)         !! (n) the one opposite, or the nearest one
      logical, allocatable :: is_opposite(:)    !! (n) whether these two are face to face
      !> (n) whether it is a mortar point of a face without midside nodes
      logical, allocatable :: is_linear(:)
      real(dp), allocatable :: weight(:)        !! (n) tributary areas [length^2]
      type(sum_list_type) :: difference         !! (n, nodes) slave's value less master's
   end type tie_points_type

contains

   !> The points of one *TIE. Those whose gap exceeds POSITION TOLERANCE= are left out.
   !> Errors: as make_contact_points; no point within the tolerance.
   subroutine make_tie_points(mesh, tie, thickness, points, error)
      type(mesh_type), intent(in) :: mesh
      type(tie_definition_type), intent(in) :: tie
      real(dp), intent(in) :: thickness !! thickness of the slave, not used if axisymmetric [length]
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: nearest

      call make_contact_points(mesh, tie%faces, thickness, points, error)
      if (allocated(error) .or. .not. tie%has_tolerance) return
      nearest = minval(abs(points%initial_gap))
      call keep(abs(points%initial_gap) <= tie%tolerance + rounding*extent_of(mesh%coordinates), &
         points)
      if (size(points%slave_node) == 0) call set_error(error, status_deck, tie%faces%title()// &
         ': no point of the slave is within POSITION TOLERANCE='//to_text(tie%tolerance)// &
         ' of the master, the nearest one is '//to_text(nearest)//' from it', tie%faces%card)
   end subroutine make_tie_points

   !> Keeps some of the points; of their geometry what ties have use for.
   pure subroutine keep(kept, points)
      logical, intent(in) :: kept(:)
      type(contact_points_type), intent(inout) :: points
      type(sum_list_type) :: difference
      integer :: k

      call difference%reserve(count(kept), size(points%difference%value))
      do k = 1, size(kept)
         if (kept(k)) call difference%add(points%difference%values_of(k), &
            points%difference%coefficients_of(k))
      end do
      points%difference = difference
      points%slave_node = pack(points%slave_node, kept)
      points%master_node = pack(points%master_node, kept)
      points%initial_gap = pack(points%initial_gap, kept)
      points%weight = pack(points%weight, kept)
      points%edge = pack(points%edge, kept)
      points%tangent = reshape(pack(points%tangent, spread(kept, 1, 2)), [2, count(kept)])
   end subroutine keep

   !> Puts the points of all ties in one row.
   pure function joined_ties(mesh, ties, of_tie) result(row)
      type(mesh_type), intent(in) :: mesh
      type(tie_definition_type), intent(in) :: ties(:)
      type(contact_points_type), intent(in) :: of_tie(:)    !! (ties) their points
      type(tie_points_type) :: row
      integer :: i

      allocate (row%tie(0), row%slave(0), row%master(0), row%is_opposite(0), row%is_linear(0), &
         row%weight(0))
      call row%difference%reserve(0, 0)
      do i = 1, size(ties)
         associate (points => of_tie(i), &
            face => mesh%surfaces(ties(i)%faces%slave)%faces(:, 1))
            row%tie = [row%tie, spread(i, 1, size(points%slave_node))]
            row%slave = [row%slave, points%slave_node]
            row%master = [row%master, points%master_node]
            row%weight = [row%weight, points%weight]
            row%is_opposite = [row%is_opposite, abs(sum(points%tangent*(mesh%coordinates(:, &
               points%master_node) - mesh%coordinates(:, points%slave_node)), dim=1)) <= &
               opposite*points%edge]
            row%is_linear = [row%is_linear, spread(points%pairing /= pairing_nodes .and. &
               side_node_count(mesh%element_kind(face(1))) == 2, 1, size(points%slave_node))]
            call row%difference%add_sums(points%difference)
         end associate
      end do
   end function joined_ties

   !> Tells what a tie holds: how many points, how far apart, and which part of the slave is free.
   pure function tie_words(mesh, tie, points) result(words)
      type(mesh_type), intent(in) :: mesh
      type(tie_definition_type), intent(in) :: tie
      type(contact_points_type), intent(in) :: points    !! its points
      character(:), allocatable :: words
      integer :: all_nodes
      real(dp) :: apart

      all_nodes = slave_nodes(mesh, tie, points%pairing == pairing_nodes)
      words = tie%faces%title()//': '//to_text(size(points%slave_node))//' '// &
         trim(merge('node pairs   ', 'mortar points', points%pairing == pairing_nodes))
      apart = maxval(abs(points%initial_gap))
      if (apart > rounding*extent_of(mesh%coordinates)) words = words//', up to '// &
         to_text(apart)//' apart; the gap is not closed'
      if (size(points%slave_node) == all_nodes) return
      words = words//'; '//to_text(all_nodes - size(points%slave_node))// &
         trim(merge(' slave nodes  ', ' slave corners', points%pairing == pairing_nodes))// &
         ' are not tied: '
      if (tie%has_tolerance) words = words//'farther from the master than POSITION TOLERANCE='// &
         to_text(tie%tolerance)//', or '
      words = words//'no face of the master lies opposite'
   end function tie_words

   !> Nodes of a slave face, or its corners.
   pure integer function slave_nodes(mesh, tie, with_midside)
      type(mesh_type), intent(in) :: mesh
      type(tie_definition_type), intent(in) :: tie
      logical, intent(in) :: with_midside
      logical :: found(size(mesh%node_number))
      integer :: f

      found = .false.
      associate (faces => mesh%surfaces(tie%faces%slave)%faces)
         do f = 1, size(faces, 2)
            associate (kind => mesh%element_kind(faces(1, f)))
               associate (nodes => mesh%element_nodes(side_nodes(kind, faces(2, f)), faces(1, f)))
                  found(nodes([1, size(nodes)])) = .true.
                  if (with_midside) found(nodes) = .true.
               end associate
            end associate
         end do
      end associate
      slave_nodes = count(found)
   end function slave_nodes

   !> Warns of a tie over a gap wider than the slave's sides, where no tolerance says that it is
   !> meant; empty where there is none.
   pure function distance_warning(mesh, tie, points) result(warning)
      type(mesh_type), intent(in) :: mesh
      type(tie_definition_type), intent(in) :: tie
      type(contact_points_type), intent(in) :: points    !! its points
      character(:), allocatable :: warning
      integer :: k

      warning = ''
      if (tie%has_tolerance) return
      if (all(abs(points%initial_gap) <= points%edge)) return
      k = maxloc(abs(points%initial_gap)/points%edge, dim=1)
      warning = tie%faces%title()//': slave node '// &
         to_text(mesh%node_number(points%slave_node(k)))//' is tied over a gap of '// &
         to_text(abs(points%initial_gap(k)))//', more than the element edge of '// &
         to_text(points%edge(k))//'; POSITION TOLERANCE= limits the distance of tied faces'
   end function distance_warning

end module tie_points
