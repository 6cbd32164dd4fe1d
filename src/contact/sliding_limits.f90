!> How far faces may slide on each other with contact points of the undeformed mesh.
!>
!> A contact point compares two points that lie opposite each other in the mesh. Where the slave
!> has slid by s along the face, the master opposite is that of the arc length s farther on. That
!> matters where
!>
!> - no master is there any more;
!> - a master that deforms and conducts is another one: s exceeds the spacing of nodes, and is no
!>   small part of the length in contact, within which fields change;
!> - the gap of the mesh is another one, h(s_k + s), because slopes or curvatures of the faces
!>   differ: to the second order it changes by s h' + s^2 h''/2. Half of the first term is in the
!>   linear theory, whose normals are midway between those of both faces. For a cylinder of radius R
!>   on a plane the edge a of contact has h = a^2/(2R), and the change there over that is 2s/a.
module sliding_limits
   use conductance_laws, only: line_value
   use contact_points, only: contact_points_type
   use kinds, only: dp
   use text, only: to_text
   implicit none
   private
   public :: slide_type, worst_slide

   !> Part of the gaps that the contact closes by which sliding may change them. A cylinder on a
   !> plane may so slide by a twentieth of half the width of its contact.
   real(dp), parameter :: small_change = 0.1_dp
   !> Part of the length in contact that may slide past the end of the master, or farther than the
   !> spacing of nodes.
   real(dp), parameter :: small_part = 0.05_dp

   !> The contact point that slides farthest beyond a limit.
   type :: slide_type
      integer :: point = 0                 !! 0 where none does
      real(dp) :: slip = 0.0_dp            !! along the face since the start [length]
      real(dp) :: excess = 0.0_dp          !! what it does over the limit [-], above 1
      character(:), allocatable :: words   !! what it does
   end type slide_type

contains

   !> The worst of the contact points that touch.
   pure function worst_slide(points, closed, movement) result(slide)
      type(contact_points_type), intent(in) :: points   !! contact points of one interface
      logical, intent(in) :: closed(:)                  !! (m) those that touch
      real(dp), intent(in) :: movement(:)  !! (m) of the slave along its tangent [length]
      type(slide_type) :: slide
      integer :: i
      integer, allocatable :: ends(:)

      ends = points%ends()
      do i = 1, size(ends), 2
         if (any(closed(ends(i):ends(i + 1)))) call find_worst(points, points%to_end(i:i + 1), &
            closed(ends(i):ends(i + 1)), movement(ends(i):ends(i + 1)), ends(i) - 1, slide)
      end do
   end function worst_slide

   !> The worst of a piece, if it is worse than those before.
   pure subroutine find_worst(points, to_end, closed, movement, earlier, slide)
      type(contact_points_type), intent(in) :: points   ! contact points of all pieces
      real(dp), intent(in) :: to_end(2)                 ! of the piece [length]
      logical, intent(in) :: closed(:)                  ! (n) those of the piece that touch
      real(dp), intent(in) :: movement(:)               ! (n) [length]
      integer, intent(in) :: earlier                    ! contact points of pieces before
      type(slide_type), intent(inout) :: slide
      real(dp), dimension(size(closed)) :: change, edge, gap, length, past, s, spacing
      real(dp) :: closes
      integer :: k

      s = points%arc_length(earlier + 1:earlier + size(s))
      gap = points%initial_gap(earlier + 1:earlier + size(s))
      edge = points%edge(earlier + 1:earlier + size(s))
      length = max(edge, maxval(s, mask=closed) - minval(s, mask=closed))
      past = max(0.0_dp, -movement - (s - s(1)) - to_end(1), movement + s - s(size(s)) - to_end(2))
      call take(slide, past/(small_part*length), 'slides past the end of the master surface by ', &
         past, ', more than a twentieth of the length in contact; extend the master, or '// &
         'exchange slave and master')
      if (.not. points%is_rigid) then
         spacing = edge/((points%side_nodes - 1)*points%node_spacings)
         spacing = max(spacing, small_part*length)
         call take(slide, abs(movement)/spacing, 'slides farther than the spacing of its nodes '// &
            'and a twentieth of the length in contact, ', spacing, &
            '; take SLIDING=FINITE, or draw the bodies where they slide to')
      end if
      change = [(abs(line_value(s, gap, s(k) + movement(k)) - gap(k)), k=1, size(closed))]
      closes = max(points%finest_gap, closed_gap(gap, closed))
      call take(slide, change/(small_change*closes), 'slides to where the gap of the mesh '// &
         'differs by ', change, ', more than a tenth of what the contact closes, '// &
         to_text(closes)//'; take SLIDING=FINITE, or draw the bodies where they slide to')

   contains
      !> Takes the contact point that exceeds a limit most, if it does so more than the one before.
      pure subroutine take(slide, over_limit, before, value, behind)
         type(slide_type), intent(inout) :: slide
         real(dp), intent(in) :: over_limit(:), value(:)   ! (m)
         character(*), intent(in) :: before, behind
         integer :: k

         k = maxloc(over_limit, mask=closed, dim=1)
         if (over_limit(k) <= max(1.0_dp, slide%excess)) return
         slide%point = earlier + k
         slide%slip = abs(movement(k))
         slide%excess = over_limit(k)
         slide%words = before//to_text(value(k))//behind
      end subroutine take
   end subroutine find_worst

   !> How different the gaps are that the contact closes, with those of its open neighbours, for a
   !> zone may end anywhere before them; or the largest overlap that it presses apart.
   pure real(dp) function closed_gap(gap, closed)
      real(dp), intent(in) :: gap(:)                    ! (n) of a piece [length]
      logical, intent(in) :: closed(:)
      logical :: near(size(closed))

      near = closed
      near(2:) = near(2:) .or. closed(:size(closed) - 1)
      near(:size(closed) - 1) = near(:size(closed) - 1) .or. closed(2:)
      closed_gap = max(maxval(gap, mask=near) - minval(gap, mask=near), -minval(gap, mask=closed))
   end function closed_gap

end module sliding_limits
