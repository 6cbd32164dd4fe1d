!> Mortar integrals: hat functions over the segments that two faces cut from each other.
!>
!> The multipliers of the contact are piecewise linear on the slave face: hat function phi_c of
!> corner c is 1 there and falls linearly in the side's own coordinate xi to 0 at the next corners,
!> also on sides with midside nodes. On a side that the master covers in part the two hats span the
!> covered part alone: spanning the whole side, the hat of a corner far from the master would be
!> small wherever it counts, and its multiplier as large as it likes. A point xi of the slave lies
!> opposite the point of the master that its normal meets; normals are interpolated between the
!> averaged ones of the slave's nodes.
!> The contact conditions of a corner act along the normal midway between those of both faces there.
!> Along the slave's own normal, part of the normal force would count as friction, and exchanging
!> slave and master would change it.
!> With N and M the shape functions of slave and master, dA the area of the face midway between both
!>
!>    w_c = integral phi_c dA,  D_ci = integral phi_c N_i dA,  M_cj = integral phi_c M_j dA,
!>
!> and the same D and M times the normal n(xi) midway between both faces. With the normal of the
!> corner in its place, the mean gap of faces that move apart along their radius would be too small
!> by h^2/12 on sides that turn by the angle h, and the force too: press fits would err by h^2/6.
!>
!> The integrand has kinks where a corner of either face lies, so it is integrated from kink to kink
!> (a segment); a rule on whole sides of the slave fails the patch test by 0.1 to 0.3 %.
!>
!> B. I. Wohlmuth, Acta Numerica 20 (2011) 569; A. Popp, B. I. Wohlmuth, M. W. Gee, W. A. Wall, SIAM
!> J. Sci. Comput. 34 (2012) B421 (linear multipliers on quadratic sides).
module mortar_segments
   use chain_geometry, only: length_between, side_positions, two_pi
   use kinds, only: dp
   use mortar_sides, only: face_line_type, hats, outward_normals, project, slave_side_type
   use quadrature, only: gauss_point_10, gauss_weight_10
   use shape_functions, only: side_shape, side_slope
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: mortar_integrals_type, integrate_segments

   !> The integrals. Corners of the slave are counted along its line.
   type :: mortar_integrals_type
      real(dp), allocatable :: weight(:)   !! (corners) w_c [length^2]
      !> (corners) w_c if the master covered the whole of the sides that it does cover in part
      real(dp), allocatable :: whole(:)
      !> (2, corners) where the hat function is 1: the corner, or the end of the cover [length]
      real(dp), allocatable :: position(:, :)
      real(dp), allocatable :: beyond(:)   !! (corners) how far along the line it lies from there
      !> (2, corners) unit normal midway between those of both faces, outward from the slave
      real(dp), allocatable :: normal(:, :)
      type(sparse_matrix_type) :: slave    !! (corners, nodes of the slave) D [length^2]
      type(sparse_matrix_type) :: master   !! (corners, nodes of the master) M [length^2]
      !> the same times the components of n
      type(sparse_matrix_type) :: slave_normal(2), master_normal(2)
   end type mortar_integrals_type

   !> What has been summed.
   type :: segment_sums_type
      real(dp), allocatable :: weight(:), whole(:)
      real(dp), allocatable :: apart(:)       !! (corners) from the covered part, as a coordinate
      real(dp), allocatable :: position(:, :), beyond(:)   !! of mortar_integrals_type
      !> (2, corners) normals of slave and master there
      real(dp), allocatable :: normal(:, :), facing(:, :)
      type(triplet_list_type) :: slave(0:2), master(0:2)   !! without n, with its components
   end type segment_sums_type

contains

   !> Integrates over all segments.
   pure subroutine integrate_segments(slave, master, side, thickness, about_axis, integrals)
      type(face_line_type), intent(in) :: slave, master
      type(slave_side_type), intent(in) :: side(:)  !! of the slave
      real(dp), intent(in) :: thickness       !! not used about an axis [length]
      logical, intent(in) :: about_axis       !! whether areas are swept round the axis x = 0
      type(mortar_integrals_type), intent(out) :: integrals
      real(dp) :: master_normal(2, size(master%x, 2)), normal(2, size(slave%x, 2)), section
      integer :: corners, k, s
      integer, allocatable :: segments(:)
      type(segment_sums_type) :: sums

      corners = size(side) + merge(0, 1, slave%closed)
      allocate (sums%weight(corners), sums%whole(corners), sums%beyond(corners), source=0.0_dp)
      allocate (sums%apart(corners), source=huge(1.0_dp))
      normal = outward_normals(slave)
      sums%normal = normal(:, ::slave%side_nodes - 1)
      sums%position = slave%x(:, ::slave%side_nodes - 1)
      allocate (sums%facing, source=0.0_dp*sums%normal)
      master_normal = outward_normals(master)
      allocate (segments(size(side)))
      do s = 1, size(side)
         segments(s) = size(side(s)%kinks) - 1
      end do
      do k = 0, 2
         call sums%slave(k)%reserve(2*slave%side_nodes*sum(segments))
         call sums%master(k)%reserve(2*master%side_nodes*sum(segments))
      end do
      section = merge(0.0_dp, thickness, about_axis)
      do s = 1, size(side)
         do k = 1, segments(s)
            call add_segment(side(s), k, master, master_normal, section, sums)
         end do
      end do
      integrals%weight = sums%weight
      integrals%whole = sums%whole
      integrals%position = sums%position
      integrals%beyond = sums%beyond
      integrals%normal = sums%normal - sums%facing
      do k = 1, corners
         integrals%normal(:, k) = integrals%normal(:, k)/norm2(integrals%normal(:, k))
      end do
      integrals%slave = sums%slave(0)%compress(corners, size(slave%x, 2))
      integrals%master = sums%master(0)%compress(corners, size(master%x, 2))
      do k = 1, 2
         integrals%slave_normal(k) = sums%slave(k)%compress(corners, size(slave%x, 2))
         integrals%master_normal(k) = sums%master(k)%compress(corners, size(master%x, 2))
      end do
   end subroutine integrate_segments

   !> Adds the integrals over one segment; without a master opposite, the area of the hats alone.
   pure subroutine add_segment(side, segment, master, master_normal, section, sums)
      type(slave_side_type), intent(in) :: side
      integer, intent(in) :: segment
      type(face_line_type), intent(in) :: master
      real(dp), intent(in) :: master_normal(:, :)  ! (2, nodes)
      real(dp), intent(in) :: section         ! thickness, 0 about an axis [length]
      type(segment_sums_type), intent(inout) :: sums
      real(dp) :: area, ends(2), eta, factor(0:2), hat(2), radius, xi
      real(dp) :: psi(size(side%nodes)), psi_master(master%side_nodes)
      real(dp) :: of_slave(2, size(psi), 0:2), of_master(2, size(psi_master), 0:2)
      integer :: facing(master%side_nodes), g, i, k

      if (side%covered(1) > side%covered(2)) return
      ends = side%kinks(segment:segment + 1)
      facing = side_positions(max(side%opposite(segment), 1), master%side_nodes, size(master%x, 2))
      eta = 0.0_dp
      of_slave = 0.0_dp
      of_master = 0.0_dp
      do g = 1, size(gauss_point_10)
         xi = 0.5_dp*(ends(1) + ends(2) + (ends(2) - ends(1))*gauss_point_10(g))
         psi = side_shape(size(psi), xi)
         area = 0.5_dp*(ends(2) - ends(1))*gauss_weight_10(g)* &
            norm2(matmul(side%x, side_slope(size(psi), xi)))
         radius = dot_product(psi, side%x(1, :))
         if (side%opposite(segment) > 0) then
            call project(side, xi, master%x(:, facing), eta)
            psi_master = side_shape(size(psi_master), eta)
            radius = 0.5_dp*(radius + dot_product(psi_master, master%x(1, facing)))
         end if
         area = area*merge(section, two_pi*abs(radius), section > 0.0_dp)
         sums%whole(side%corners) = sums%whole(side%corners) + area*0.5_dp*[1.0_dp - xi, &
            1.0_dp + xi]
         if (side%opposite(segment) == 0) cycle
         hat = hats(side, xi)
         sums%weight(side%corners) = sums%weight(side%corners) + area*hat
         factor = [1.0_dp, midway(matmul(side%normal, psi), &
            matmul(master_normal(:, facing), psi_master))]
         do k = 0, 2
            do i = 1, size(psi)
               of_slave(:, i, k) = of_slave(:, i, k) + factor(k)*area*hat*psi(i)
            end do
            do i = 1, size(psi_master)
               of_master(:, i, k) = of_master(:, i, k) + factor(k)*area*hat*psi_master(i)
            end do
         end do
      end do
      if (side%opposite(segment) == 0) return
      do k = 0, 2
         call sums%slave(k)%add_block(side%corners, side%nodes, of_slave(:, :, k))
         call sums%master(k)%add_block(side%corners, facing, of_master(:, :, k))
      end do
      call find_positions(side, segment, master%x(:, facing), master_normal(:, facing), sums)
   end subroutine add_segment

   !> Where the hats of a side's corners are 1, and the normals there, if this segment lies nearer
   !> to the corner than those before.
   pure subroutine find_positions(side, segment, x, master_normal, sums)
      type(slave_side_type), intent(in) :: side
      integer, intent(in) :: segment
      real(dp), intent(in) :: x(:, :), master_normal(:, :)  ! (2, nodes) of the side opposite
      type(segment_sums_type), intent(inout) :: sums
      real(dp) :: eta, from, normal(2), xi
      integer :: c

      do c = 1, 2
         xi = side%kinks(segment + c - 1)
         from = 2*c - 3.0_dp
         associate (corner => side%corners(c), psi => side_shape(size(side%nodes), xi))
            if (abs(xi - from) >= sums%apart(corner)) cycle
            sums%apart(corner) = abs(xi - from)
            sums%position(:, corner) = matmul(side%x, psi)
            sums%beyond(corner) = length_between(side%x, from, xi)
            normal = matmul(side%normal, psi)
            sums%normal(:, corner) = normal/norm2(normal)
            eta = 0.0_dp
            call project(side, xi, x, eta)
            sums%facing(:, corner) = matmul(master_normal, side_shape(size(x, 2), eta))
         end associate
      end do
   end subroutine find_positions

   !> Unit normal midway between those of slave and master, which may have any length.
   pure function midway(slave, master) result(normal)
      real(dp), intent(in) :: slave(2), master(2)
      real(dp) :: normal(2)

      normal = slave/norm2(slave) - master/norm2(master)
      normal = normal/norm2(normal)
   end function midway

end module mortar_segments
