!> What lines of the surfaces of an interface hide from each other. Where these consist of several
!> lines, a slave meets the nearest of those of the master that face it, and a master the nearest of
!> those of the slave: no body is seen through another one, nor from the wall of a hole through the
!> body around.
module hidden_segments
   use chain_geometry, only: side_positions, side_total
   use kinds, only: dp
   use mortar_sides, only: beside_line, face_line_type, insert_kinks, no_segment, opposite_at, &
      project, slave_side_type
   use shape_functions, only: side_shape, side_slope
   implicit none
   private
   public :: hide_segments

   real(dp), parameter :: at_end = 1.0e-9_dp   !! of a side's coordinate: rounding

contains

   !> Takes away what another line of the slave or of the master hides.
   pure subroutine hide_segments(side, master, other, is_master)
      type(slave_side_type), intent(inout) :: side(:)   !! of the slave, with their segments
      type(face_line_type), intent(in) :: master, other
      logical, intent(in) :: is_master                  !! whether the other line is the master's
      real(dp), allocatable :: kinks(:)
      integer, allocatable :: opposite(:)
      real(dp) :: way(2), xi
      integer :: j, s

      do s = 1, size(side)
         if (all(side(s)%opposite == 0)) cycle
         kinks = side(s)%kinks
         call insert_kinks(side(s), other, kinks)
         allocate (opposite(size(kinks) - 1), source=0)
         do j = 1, size(opposite)
            if (kinks(j + 1) - kinks(j) <= no_segment) cycle
            xi = 0.5_dp*(kinks(j) + kinks(j + 1))
            opposite(j) = opposite_at(side(s), xi)
            if (opposite(j) == 0) cycle
            way = way_to(side(s), xi, master, opposite(j))
            if (is_hidden(side(s), xi, way, other, is_master)) opposite(j) = 0
         end do
         side(s)%covered = [1.0_dp, -1.0_dp]
         do j = 1, size(opposite)
            if (opposite(j) > 0) side(s)%covered = [min(side(s)%covered(1), kinks(j)), &
               max(side(s)%covered(2), kinks(j + 1))]
         end do
         call move_alloc(kinks, side(s)%kinks)
         call move_alloc(opposite, side(s)%opposite)
      end do
   end subroutine hide_segments

   !> The way from a point of the slave to the point of a side that its normal meets.
   pure function way_to(side, xi, line, facing) result(way)
      type(slave_side_type), intent(in) :: side
      real(dp), intent(in) :: xi
      type(face_line_type), intent(in) :: line
      integer, intent(in) :: facing                     ! side of the line
      real(dp) :: way(2)
      real(dp) :: eta

      eta = 0.0_dp
      associate (x => line%x(:, side_positions(facing, line%side_nodes, size(line%x, 2))))
         call project(side, xi, x, eta)
         way = matmul(x, side_shape(line%side_nodes, eta)) - &
            matmul(side%x, side_shape(size(side%nodes), xi))
      end associate
   end function way_to

   !> Whether another line of the master that faces the slave is nearer to it, or another line of
   !> the slave that faces the master is nearer to that.
   pure logical function is_hidden(side, xi, way, other, is_master)
      type(slave_side_type), intent(in) :: side
      real(dp), intent(in) :: xi, way(2)
      type(face_line_type), intent(in) :: other
      logical, intent(in) :: is_master
      real(dp) :: apart(2), beside_it(size(other%x, 2)), eta, facing
      integer :: nodes(other%side_nodes), s

      is_hidden = .false.
      associate (psi => side_shape(size(side%nodes), xi))
         beside_it = beside_line(matmul(side%normal, psi), matmul(side%x, psi), other%x)
      end associate
      do s = 1, side_total(size(other%x, 2), other%side_nodes, other%closed)
         nodes = side_positions(s, other%side_nodes, size(other%x, 2))
         if (beside_it(nodes(1))*beside_it(nodes(size(nodes))) > 0.0_dp) cycle
         eta = 0.0_dp
         call project(side, xi, other%x(:, nodes), eta)
         if (abs(eta) > 1.0_dp + at_end) cycle
         facing = other%outward*dot_product(beside_it(nodes), side_slope(size(nodes), eta))
         if (facing >= 0.0_dp .eqv. is_master) cycle
         apart = way_to(side, xi, other, s)
         if (.not. is_master) apart = apart - way
         is_hidden = norm2(apart) < norm2(way)
         if (is_hidden) return
      end do
   end function is_hidden

end module hidden_segments
