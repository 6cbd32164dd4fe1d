!> Which faces of some master surfaces lie opposite a slave surface, and which faces lie on others.
module facing_faces
   use element_kinds, only: element_corner_count, side_nodes
   use kinds, only: dp
   use mesh, only: mesh_type
   implicit none
   private
   public :: find_facing, lie_on

   !> Part of the largest coordinate by which two places in a deck are the same: six digits
   real(dp), parameter :: digits = 1.0e-6_dp
   real(dp), parameter :: little = 0.05_dp   !! part of a face that neither overlap nor gap show

   !> A face as a straight line, with its body on the left.
   type :: line_type
      real(dp) :: start(2)            !! [length]
      real(dp) :: along(2)            !! unit vector
      real(dp) :: length = 0.0_dp     !! [length]
      real(dp) :: depth = 0.0_dp      !! of its element behind it [length]
   end type line_type

contains

   !> The surface whose faces are the nearest to most of the slave, and those of its faces that are
   !> opposite the slave.
   pure subroutine find_facing(mesh, slave, masters, chosen, faces)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: slave                       !! index of its surface
      integer, intent(in) :: masters(:)                  !! indexes of surfaces
      integer, intent(out) :: chosen                     !! one of these; 0 where none is opposite
      integer, allocatable, intent(out) :: faces(:, :)   !! (2, n) as in a surface
      type(line_type), allocatable :: others(:), own(:)
      logical, allocatable :: is_opposite(:, :)
      integer, allocatable :: of(:), all_faces(:, :)
      real(dp) :: nearest(size(masters)), share(size(masters)), gap, overlap, same
      integer :: i, k, m

      of = [(spread(m, 1, size(mesh%surfaces(masters(m))%faces, 2)), m=1, size(masters))]
      all_faces = reshape([(mesh%surfaces(masters(m))%faces, m=1, size(masters))], [2, size(of)])
      others = lines_of(mesh, all_faces)
      own = lines_of(mesh, mesh%surfaces(slave)%faces)
      same = digits*maxval(abs(mesh%coordinates))
      allocate (is_opposite(size(of), size(own)))
      share = 0.0_dp
      do i = 1, size(own)
         nearest = huge(1.0_dp)
         do k = 1, size(of)
            call measure(own(i), others(k), gap, overlap)
            is_opposite(k, i) = overlap > same .and. 2.0_dp*gap > -own(i)%depth
            if (is_opposite(k, i)) nearest(of(k)) = min(nearest(of(k)), abs(gap))
         end do
         m = minloc(nearest, dim=1)
         if (nearest(m) < huge(1.0_dp)) share(m) = share(m) + own(i)%length
      end do
      chosen = maxloc(share, dim=1)
      faces = all_faces(:, pack([(k, k=1, size(of))], of == chosen .and. any(is_opposite, dim=2)))
      chosen = masters(chosen)
      if (all(share <= 0.0_dp)) chosen = 0
   end subroutine find_facing

   !> Whether each face lies on some of the others, or overlaps their bodies, before any load.
   pure function lie_on(mesh, faces, others)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: faces(:, :), others(:, :)   !! (2, n) as in a surface
      logical :: lie_on(size(faces, 2))
      type(line_type) :: own(size(faces, 2)), opposite(size(others, 2))
      real(dp) :: gap, overlap
      integer :: i, k

      own = lines_of(mesh, faces)
      opposite = lines_of(mesh, others)
      lie_on = .false.
      do i = 1, size(own)
         do k = 1, size(opposite)
            call measure(own(i), opposite(k), gap, overlap)
            lie_on(i) = overlap > little*own(i)%length .and. gap <= little*own(i)%length .and. &
               2.0_dp*gap > -own(i)%depth
            if (lie_on(i)) exit
         end do
      end do
   end function lie_on

   pure function lines_of(mesh, faces) result(lines)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: faces(:, :)
      type(line_type) :: lines(size(faces, 2))
      integer, allocatable :: ends(:)
      integer :: corner, i

      do i = 1, size(lines)
         associate (element => faces(1, i), kind => mesh%element_kind(faces(1, i)))
            ends = mesh%element_nodes(side_nodes(kind, faces(2, i)), element)
            associate (a => mesh%coordinates(:, ends(1)), b => &
               mesh%coordinates(:, ends(size(ends))), line => lines(i))
               line%start = a
               line%length = norm2(b - a)
               line%along = (b - a)/line%length
               do corner = 1, element_corner_count(kind)
                  line%depth = max(line%depth, -dot_product(outward(line), &
                     mesh%coordinates(:, mesh%element_nodes(corner, element)) - a))
               end do
            end associate
         end associate
      end do
   end function lines_of

   !> Unit vector from the body.
   pure function outward(line)
      type(line_type), intent(in) :: line
      real(dp) :: outward(2)

      outward = [line%along(2), -line%along(1)]
   end function outward

   !> The gap to a face that looks towards another one, and the length over which they overlap, 0
   !> where it looks away.
   pure subroutine measure(slave, master, gap, overlap)
      type(line_type), intent(in) :: slave, master
      real(dp), intent(out) :: gap, overlap    ! [length]
      real(dp) :: from, middle, slope, to

      gap = 0.0_dp
      overlap = 0.0_dp
      slope = -dot_product(slave%along, master%along)   ! cosine between inward and outward normal
      if (slope <= 0.0_dp) return
      ! Along the slave; the master runs against it.
      to = dot_product(master%start - slave%start, slave%along)
      from = max(to - master%length*slope, 0.0_dp)
      middle = 0.5_dp*(from + min(to, slave%length))
      overlap = min(to, slave%length) - from
      gap = dot_product(outward(slave), master%start + (to - middle)/slope*master%along - &
         slave%start)
   end subroutine measure

end module facing_faces
