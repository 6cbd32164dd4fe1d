!> Contact points that can be solved, but perhaps not as meant: nodes beside each other, bodies
!> inside each other, gaps wide for the curvature of their faces; and what ties hold.
module interface_warnings
   use conductance_laws, only: conductance, conductance_law_type
   use contact_definitions, only: pairing_nodes, tie_definition_type
   use contact_points, only: contact_points_type, small_offset
   use element_kinds, only: side_nodes
   use kinds, only: dp
   use mesh, only: extent_of, mesh_type
   use text, only: few_digits, percent, to_text
   implicit none
   private
   public :: clearance_warning, gap_range, mismatch_of_pairs, offset_warning, overlap_warning
   public :: curved_gap_warning, unresolved_warning
   public :: distance_warning, tie_words

   real(dp), parameter :: rounding = 1.0e-9_dp   !! relative, of coordinates
   !> Part of a side by which faces that follow sliding may be drawn with an overlap: a press fit,
   !> which *CLEARANCE cannot give there.
   real(dp), parameter :: drawn_fit = 0.01_dp
   !> Part of a face by which a clearance may differ from the gap of the mesh: overlaps of press
   !> fits are far smaller, lengths of another unit far larger. A part of an element's side would
   !> depend on how fine the mesh is.
   real(dp), parameter :: far_off = 0.25_dp
   real(dp), parameter :: noticeable = 0.01_dp   !! part of a conductance
   !> Part by which heat across a gap may be too large. Radiation reaches it at a gap of a tenth of
   !> the radius.
   real(dp), parameter :: too_large = 0.05_dp

contains

   !> Says where nodes do not lie opposite each other, so that node pairs are not accurate.
   pure function mismatch_of_pairs(mesh, points) result(reason)
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points    !! node pairs of one interface
      character(:), allocatable :: reason                !! empty where all lie opposite
      real(dp) :: part(size(points%edge))
      integer :: k

      call find_offsets(mesh, points, part, reason)
      if (any(part > small_offset)) return
      reason = ''
      if (any(norm2(points%tangent, dim=1) <= 0.5_dp)) then
         k = minloc(norm2(points%tangent, dim=1), dim=1)
         reason = nodes_of(mesh, points, k)//' have no common normal'
      end if
   end function mismatch_of_pairs

   !> How far the nodes lie beside each other. Offsets up to half the gap, as of curved faces that
   !> part far from the contact, count as none in the node spacing.
   pure subroutine find_offsets(mesh, points, part, words)
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points
      real(dp), intent(out) :: part(:)                   ! (m) of the node spacing
      character(:), allocatable, intent(out) :: words    ! says where they lie farthest
      real(dp) :: apart(2), offset(size(part))           ! [length]
      integer :: k

      do k = 1, size(offset)
         apart = mesh%coordinates(:, points%master(k)) - &
            mesh%coordinates(:, points%slave(k))
         offset(k) = abs(dot_product(points%tangent(:, k), apart))
         part(k) = offset(k)/(points%edge(k)/(points%side_nodes - 1))
         if (offset(k) <= 0.5_dp*abs(normal_distance(mesh, points, k))) part(k) = 0.0_dp
      end do
      words = ''
      ! The first of those that are largest but for rounding.
      k = findloc(part >= (1.0_dp - rounding)*maxval(part), .true., dim=1)
      if (k > 0) words = nodes_of(mesh, points, k)//' are offset by '//to_text(offset(k))// &
         ', '//percent(part(k))//' of the node spacing'
   end subroutine find_offsets

   !> Names the node pair whose nodes lie farthest beside each other, as a part of the node spacing.
   pure function offset_warning(mesh, points) result(warning)
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points    !! contact points of one interface
      character(:), allocatable :: warning               !! empty where all lie opposite
      character(:), allocatable :: words
      real(dp) :: part(size(points%edge))

      warning = ''
      if (points%pairing /= pairing_nodes .or. points%is_rigid .or. points%follows_sliding) return
      call find_offsets(mesh, points, part, words)
      if (count(part > small_offset) == 0) return
      warning = 'contact pair '//points%name//': '//words// &
         ' (contact points with more than '//percent(small_offset)//': '// &
         to_text(count(part > small_offset))//'); their contact forces are not in one line, '// &
         'and a moment of force times offset is lost; put the nodes opposite each other '// &
         'or take PAIRING=SURFACES'
   end function offset_warning

   !> Names the contact point whose faces overlap most, where that is more than the rounding of
   !> coordinates; where they follow sliding, more than a drawn press fit.
   pure function overlap_warning(mesh, points) result(warning)
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points    !! contact points of one interface
      character(:), allocatable :: warning               !! empty where none do
      real(dp) :: none(size(points%edge))
      integer :: k

      warning = ''
      if (all(points%initial_gap >= 0.0_dp)) return   ! without a search of all nodes
      none = rounding*extent_of(mesh%coordinates)
      if (points%follows_sliding) none = drawn_fit*points%edge
      if (all(-points%initial_gap <= none)) return
      k = minloc(points%initial_gap, dim=1)
      warning = 'contact pair '//points%name//': the faces overlap by '// &
         to_text(-points%initial_gap(k))//' at '//nodes_of(mesh, points, k)// &
         ', where the element edge is '//to_text(points%edge(k))//'; they are pressed apart as '// &
         'soon as the pair acts: check the positions of the bodies'
      if (.not. points%follows_sliding) warning = warning//', or give the overlap by *CLEARANCE'
   end function overlap_warning

   !> Names the widest gap that the mesh cannot tell from none, where it conducts less than faces
   !> that touch: gaps of chords between curved faces with other divisions, and of coordinates in
   !> single precision. Mechanics closes them, heat alone does not.
   pure function unresolved_warning(mesh, points, law) result(warning)
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points     !! contact points of one interface
      type(conductance_law_type), intent(in) :: law       !! at some temperature
      character(:), allocatable :: warning                !! empty where there is none
      real(dp) :: closed
      logical :: lost(size(points%edge))
      integer :: k

      warning = ''
      closed = conductance(law, .true., 0.0_dp, 0.0_dp)
      do k = 1, size(lost)
         lost(k) = points%initial_gap(k) > 0.0_dp .and. points%initial_gap(k) <= points%finest_gap &
            .and. conductance(law, .false., points%initial_gap(k), 0.0_dp) < &
            (1 - noticeable)*closed
      end do
      if (.not. any(lost)) return
      k = maxloc(points%initial_gap, mask=lost, dim=1)
      associate (gap => points%initial_gap(k))
         warning = 'contact pair '//points%name//': '//to_text(count(lost))//' of '// &
            to_text(size(lost))//' contact points are open by up to '//to_text(gap)//', at '// &
            nodes_of(mesh, points, k)//'. Chords of curved faces or decimals of coordinates '// &
            'leave up to '//few_digits(points%finest_gap)//' between faces that touch; without '// &
            'mechanics these gaps stay open and conduct '// &
            percent(conductance(law, .false., gap, 0.0_dp)/closed)//' of what '// &
            'touching faces conduct. If the faces touch, put ADJUST='// &
            few_digits(1.1_dp*gap)//' on *CONTACT PAIR, or give both the same divisions'
      end associate
   end function unresolved_warning

   !> Names the contact point whose faces are nearest to each other, where *CLEARANCE hides that
   !> none lie as it says: the gap of the mesh differs from it by more than a part of the face.
   pure function clearance_warning(mesh, points) result(warning)
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points    !! contact points of one *CLEARANCE
      character(:), allocatable :: warning               !! empty where some do
      real(dp) :: gap(size(points%edge)), length, off(size(points%edge))
      integer :: k

      warning = ''
      if (points%is_rigid) return
      gap = [(normal_distance(mesh, points, k), k=1, size(gap))]
      off = abs(gap - points%initial_gap)
      ! A face may have a single contact point.
      length = max(points%length(), maxval(points%edge))
      if (any(off <= far_off*length)) return
      k = minloc(off, dim=1)
      warning = 'overlap by '//to_text(-gap(k))
      if (gap(k) > 0.0_dp) warning = 'are '//to_text(gap(k))//' apart'
      warning = 'contact pair '//points%name//': the faces '//warning//' at '// &
         nodes_of(mesh, points, k)//', but *CLEARANCE makes it '// &
         to_text(points%initial_gap(k))//'; the face is '//to_text(length)//' long: check the '// &
         'positions of the bodies, and that all lengths of the deck have one unit'
   end function clearance_warning

   !> Distance from slave node to master node along the normal, negative where they overlap.
   pure real(dp) function normal_distance(mesh, points, k) result(distance)
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: k

      distance = dot_product(points%normal(:, k), mesh%coordinates(:, points%master(k)) - &
         mesh%coordinates(:, points%slave(k)))
   end function normal_distance

   !> Smallest and largest initial gap; one within the rounding of coordinates is 0.
   pure function gap_range(mesh, points) result(range)
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points    !! contact points of one interface
      real(dp) :: range(2)                               !! [length]

      range = [minval(points%initial_gap), maxval(points%initial_gap)]
      where (abs(range) <= rounding*extent_of(mesh%coordinates)) range = 0.0_dp
   end function gap_range

   pure function nodes_of(mesh, points, k) result(words)
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: k
      character(:), allocatable :: words

      words = 'slave node '//to_text(mesh%node_number(points%slave(k)))// &
         ' and master node '//to_text(mesh%node_number(points%master(k)))
   end function nodes_of

   !> Warns of a gap so wide for the curvature of its faces that heat across it is too large. It
   !> crosses the mean of both areas, A1 < A2, as between flat faces. Between concentric ones
   !> conduction crosses (A2 - A1)/ln(A2/A1), and radiation as little as A1, which is that of black
   !> faces.
   pure function curved_gap_warning(mesh, points, radiates) result(warning)
      type(mesh_type), intent(in) :: mesh
      type(contact_points_type), intent(in) :: points    !! contact points of one interface
      logical, intent(in) :: radiates                    !! whether the faces radiate
      character(:), allocatable :: warning               !! empty where the faces are flat enough
      real(dp) :: areas(2), excess, largest, part
      integer :: k, worst

      warning = ''
      largest = too_large
      worst = 0
      do k = 1, size(points%edge) - 1
         if (.not. points%on_one_piece(k, k + 1)) cycle
         if (allocated(points%is_beyond)) then
            if (any(points%is_beyond(k:k + 1))) cycle
         end if
         areas = facing_areas(points, k)
         if (minval(areas) <= 0.0_dp) cycle
         part = maxval(areas)/minval(areas) - 1.0_dp
         excess = part/2
         if (.not. radiates) excess = excess_of_conduction(part)
         if (excess <= largest) cycle
         largest = excess
         worst = k
      end do
      if (worst == 0) return
      areas = facing_areas(points, worst)
      warning = 'contact pair '//points%name//': the gap at slave node '// &
         to_text(mesh%node_number(points%slave(worst)))//', '// &
         to_text(points%initial_gap(worst))//', is wide for the curvature of the faces, whose '// &
         'areas differ by '//percent(maxval(areas)/minval(areas) - 1.0_dp)//'; heat crosses it '// &
         'as between flat faces of the mean area, '
      if (radiates) then
         warning = warning//'so radiation between round ones is up to '//percent(largest)// &
            ' too large: lower the emissivity, unless it or the view factors account for that'
      else
         warning = warning//'so conduction between round ones is '//percent(largest)// &
            ' too large: lower the conductance, unless it accounts for that'
      end if
   end function curved_gap_warning

   !> Areas of slave and master between a contact point and the next one, per thickness, or per
   !> angle about the axis.
   pure function facing_areas(points, k) result(areas)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: k
      real(dp) :: areas(2)
      real(dp) :: ends(2, 2)
      integer :: face

      do face = 1, 2
         ends = points%position(:, k:k + 1)
         if (face == 2) ends = ends + points%normal(:, k:k + 1)* &
            spread(max(points%initial_gap(k:k + 1), 0.0_dp), 1, 2)
         areas(face) = norm2(ends(:, 2) - ends(:, 1))
         if (points%about_axis) areas(face) = areas(face)*sum(ends(1, :))/2
      end do
   end function facing_areas

   !> Mean of two areas over their logarithmic mean, less 1; by a series where they all but agree.
   pure real(dp) function excess_of_conduction(part) result(excess)
      real(dp), intent(in) :: part                 ! of the smaller area by which they differ

      excess = part**2/12
      ! Below, the rounding of the quotient is larger than the next term of the series.
      if (part > 1.0e-4_dp) excess = (1.0_dp + part/2)*log(1.0_dp + part)/part - 1.0_dp
   end function excess_of_conduction

   !> Tells what a tie holds: how many points, how far apart, and which part of the slave is free.
   pure function tie_words(mesh, tie, points) result(words)
      type(mesh_type), intent(in) :: mesh
      type(tie_definition_type), intent(in) :: tie
      type(contact_points_type), intent(in) :: points    !! its points
      character(:), allocatable :: words
      integer :: all_nodes
      real(dp) :: apart

      all_nodes = slave_nodes(mesh, tie, points%pairing == pairing_nodes)
      words = tie%faces%title()//': '//to_text(size(points%slave))//' '// &
         trim(merge('node pairs   ', 'mortar points', points%pairing == pairing_nodes))
      apart = maxval(abs(points%initial_gap))
      if (apart > rounding*extent_of(mesh%coordinates)) words = words//', up to '// &
         to_text(apart)//' apart; the gap is not closed'
      if (size(points%slave) == all_nodes) return
      words = words//'; '//to_text(all_nodes - size(points%slave))// &
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
         to_text(mesh%node_number(points%slave(k)))//' is tied over a gap of '// &
         to_text(abs(points%initial_gap(k)))//', more than the element edge of '// &
         to_text(points%edge(k))//'; POSITION TOLERANCE= limits the distance of tied faces'
   end function distance_warning

end module interface_warnings
