!> Materials that carry no stress above a temperature, and begin anew where they cool below it.
!>
!> The history of the law of the solid is followed by the strain without stress, the elastic strain
!> that thermoelasticity has where the material becomes solid, and by the temperature of the point.
!> Above the annealing temperature that strain follows the deformation, and what was plastic or
!> crept is 0. It is taken where the temperature passes, strains and temperatures being straight in
!> an increment: the part of it that lies below alone makes stress. Where that is less than a
!> hundredth, what is missing makes a drag, so that a melt that nothing holds stays where it is, and
!> a point that is about to become solid is no softer than the melt beside it; no stress of the drag
!> is left once the increment is over.
module annealing
   use kinds, only: dp
   use material_laws, only: law_interval_type, law_points_type, material_law_type
   implicit none
   private
   public :: annealed_law

   real(dp), parameter :: drag = 1.0e-2_dp   !! part of an increment that a melt resists
   integer, parameter :: numbers = 5   !! of the history: xx, yy, zz, the angle xy, temperature

contains

   !> The law of a solid, or of an elastic material, that an annealing temperature ends.
   function annealed_law(solid, temperature) result(law)
      type(material_law_type), intent(in) :: solid
      real(dp), intent(in) :: temperature
      type(material_law_type) :: law

      law = solid
      law%respond_solid => solid%respond
      law%respond => respond
      law%anneal_temperature = temperature
      law%annealing = solid%history_count + 1
      law%history_count = solid%history_count + numbers
      if (.not. allocated(law%of_time)) allocate (law%of_time(0))
      law%of_time = [law%of_time, spread(.false., 1, numbers)]
   end function annealed_law

   pure subroutine respond(law, points, interval, history)
      type(material_law_type), intent(in) :: law
      type(law_points_type), intent(inout) :: points
      type(law_interval_type), intent(in) :: interval
      real(dp), intent(inout) :: history(:, :)
      type(law_points_type) :: melt
      real(dp) :: elastic(4), part(size(points%temperature))
      integer :: g

      ! Part of the increment in which a point is solid.
      part = 1.0_dp
      melt = points
      do g = 1, points%count
         associate (free => history(law%annealing:law%annealing + 3, g), here => &
            points%temperature(g), before => history(law%annealing + 4, g))
            melt%stress(g, :) = points%stress(g, :) - matmul(points%tangent(:, :, g), free)
            if (max(before, here) >= law%anneal_temperature) then
               call forget(law, history(:, g))
               elastic = strain_of(points%tangent(:, :, g), points%stress(g, :))
               part(g) = 0.0_dp
               if (here < law%anneal_temperature) part(g) = (law%anneal_temperature - here)/ &
                  (before - here)
               free = elastic - part(g)*(elastic - free)
            end if
            before = here
            points%stress(g, :) = points%stress(g, :) - matmul(points%tangent(:, :, g), free)
         end associate
      end do
      if (associated(law%respond_solid)) call law%respond_solid(law, points, interval, &
         history(:law%annealing - 1, :))
      do g = 1, points%count
         if (part(g) <= 0.0_dp) then
            points%stress(g, :) = 0.0_dp
            call forget(law, history(:, g))
         end if
         points%stiffness(g) = max(part(g), drag)
         associate (dragged => points%stiffness(g) - part(g))
            points%stress(g, :) = points%stress(g, :) + dragged*melt%stress(g, :)
            points%tangent(:, :, g) = part(g)*points%tangent(:, :, g) + &
               dragged*melt%tangent(:, :, g)
         end associate
      end do
   end subroutine respond

   !> Forgets what a solid remembers, but for the work that was done on it.
   pure subroutine forget(law, history)
      type(material_law_type), intent(in) :: law
      real(dp), intent(inout) :: history(:)
      integer :: i

      do i = 1, law%annealing - 1
         if (law%work == 0 .or. i < law%work .or. i > law%work + 1) history(i) = 0.0_dp
      end do
   end subroutine forget

   !> Elastic strain of a stress; 0 across the plane in plane stress.
   pure function strain_of(elasticity, stress) result(strain)
      real(dp), intent(in) :: elasticity(4, 4), stress(4)
      real(dp) :: strain(4)
      real(dp) :: a(4, 5)
      integer :: i, k

      a(:, :4) = elasticity
      a(:, 5) = stress
      ! Gauss and Jordan; the matrix is positive definite but for a row of zeros.
      do k = 1, 4
         if (a(k, k) <= 0.0_dp) cycle
         a(k, :) = a(k, :)/a(k, k)
         do i = 1, 4
            if (i /= k) a(i, :) = a(i, :) - a(i, k)*a(k, :)
         end do
      end do
      strain = a(:, 5)
      if (elasticity(3, 3) <= 0.0_dp) strain(3) = 0.0_dp
   end function strain_of

end module annealing
