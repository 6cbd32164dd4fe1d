!> Where one face of an interface ends at a corner of its body and the other one goes on, as a punch
!> on a wider body: judged by the outlines of the bodies beyond the ends of node pairs.
module face_ends
   use element_kinds, only: element_corner_count
   use kinds, only: dp
   use mesh, only: mesh_type
   use surface_chains, only: surface_chain_type
   implicit none
   private
   public :: one_goes_on

   !> Angle of a body from which on its outline goes on at a node: it turns away by 45 degrees.
   real(dp), parameter :: going_on = 0.75_dp*acos(-1.0_dp)

contains

   !> Whether one face ends and the other goes on, at the first and at the last nodes of two lines.
   pure function one_goes_on(mesh, slave, master) result(at_corner)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: slave
      type(surface_chain_type), intent(in) :: master   !! along the slave, of equally many nodes
      logical :: at_corner(2)
      integer :: ends(2), i

      at_corner = .false.
      if (slave%closed .or. master%closed) return
      ends = [1, size(slave%nodes)]
      do i = 1, 2
         at_corner(i) = body_angle(mesh, slave%nodes(ends(i))) > going_on .neqv. &
            body_angle(mesh, master%nodes(ends(i))) > going_on
      end do
   end function one_goes_on

   !> Angle that the elements at a corner fill.
   pure real(dp) function body_angle(mesh, node)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node
      integer :: e, k

      body_angle = 0.0_dp
      do e = 1, size(mesh%element_number)
         associate (n => element_corner_count(mesh%element_kind(e)))
            k = findloc(mesh%element_nodes(:n, e), node, dim=1)
            if (k == 0) cycle
            associate (x => mesh%coordinates(:, mesh%element_nodes(:n, e)))
               associate (leaving => x(:, mod(k, n) + 1) - x(:, k), &
                  entering => x(:, mod(k + n - 2, n) + 1) - x(:, k))
                  body_angle = body_angle + atan2(leaving(1)*entering(2) - &
                     leaving(2)*entering(1), dot_product(leaving, entering))
               end associate
            end associate
         end associate
      end do
   end function body_angle

end module face_ends
