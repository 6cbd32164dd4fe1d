!> Areas of two faces opposite each other, between whose contact points heat crosses a gap.
module gap_areas
   use contact_points, only: contact_points_type
   use kinds, only: dp
   use mesh, only: mesh_type
   use text, only: percent, to_text
   implicit none
   private
   public :: curved_gap_warning

   !> Part by which heat across a gap may be too large. Radiation reaches it at a gap of a tenth of
   !> the radius.
   real(dp), parameter :: too_large = 0.05_dp

contains

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

end module gap_areas
