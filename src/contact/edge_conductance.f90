!> Conductance of the contact points at an edge of contact: the mean of the law over the part of the
!> face that a point stands for, closed up to the edge and open beyond it.
module edge_conductance
   use conductance_laws, only: conductance, conductance_law_type
   use kinds, only: dp
   use quadrature, only: gauss_point_3, gauss_weight_3
   implicit none
   private
   public :: cut_at_edges

contains

   pure subroutine cut_at_edges(s, bounds, hats, closed, gap, pressure, law, omega)
      real(dp), intent(in) :: s(:), bounds(:)
      logical, intent(in) :: hats
      logical, intent(in) :: closed(:)
      real(dp), intent(in) :: gap(:), pressure(:)
      type(conductance_law_type), intent(in) :: law
      real(dp), intent(inout) :: omega(:)
      real(dp) :: mirrored(size(s))
      integer :: k, m

      m = size(s)
      do k = 1, m - 1
         if (closed(k) .and. .not. closed(k + 1)) then
            call cut(s, bounds, hats, closed, gap, pressure, law, k, omega)
         else if (closed(k + 1) .and. .not. closed(k)) then
            mirrored = omega(m:1:-1)
            call cut(-s(m:1:-1), -bounds(m+1:1:-1), hats, closed(m:1:-1), gap(m:1:-1), &
               pressure(m:1:-1), law, m - k, mirrored)
            omega = mirrored(m:1:-1)
         end if
      end do
   end subroutine cut_at_edges

   pure subroutine cut(s, bounds, hats, closed, gap, pressure, law, k, omega)
      real(dp), intent(in) :: s(:), bounds(:)
      logical, intent(in) :: hats
      logical, intent(in) :: closed(:)
      real(dp), intent(in) :: gap(:), pressure(:)
      type(conductance_law_type), intent(in) :: law
      integer, intent(in) :: k
      real(dp), intent(inout) :: omega(:)
      real(dp) :: a, factor, ends(6), total, area, u, x, dx, w
      integer :: c, i, g, m
      real(dp) :: lo, hi, t

      m = size(s)
      if (k + 2 > m) return
      if (closed(k + 2)) return
      call find_edge(s, hats, gap, k, a, factor)
      if (factor <= 0.0_dp) return
      do c = max(k - 1, 1), min(k + 3, m)
         lo = merge(s(max(c - 1, 1)), bounds(c), hats)
         hi = merge(s(min(c + 1, m)), bounds(c + 1), hats)
         if (a <= lo .or. a >= hi) cycle
         ends = [lo, s(c), s(k), a, hi, hi]
         call order(ends(1:5))
         total = 0.0_dp
         area = 0.0_dp
         do i = 1, 4
            if (ends(i + 1) - ends(i) <= 0.0_dp) cycle
            if (ends(i) < lo .or. ends(i+1) > hi) cycle
            do g = 1, 3
               u = 0.5_dp*(1 + gauss_point_3(g))
               if (abs(ends(i + 1) - a) <= 0.0_dp) then
                  t = ends(i + 1) - ends(i)
                  x = a - t*u**2
                  dx = t*u*gauss_weight_3(g)
               else if (abs(ends(i) - a) <= 0.0_dp) then
                  t = ends(i + 1) - ends(i)
                  x = a + t*u**2
                  dx = t*u*gauss_weight_3(g)
               else
                  t = ends(i + 1) - ends(i)
                  x = ends(i) + t*u
                  dx = 0.5_dp*t*gauss_weight_3(g)
               end if
               w = 1.0_dp
               if (hats) then
                  if (x < s(c)) then
                     w = (x - lo)/(s(c) - lo)
                  else
                     w = (hi - x)/(hi - s(c))
                  end if
               end if
               area = area + w*dx
               total = total + w*dx*local(x)
            end do
         end do
         if (area > 0.0_dp) omega(c) = total/area
      end do
   contains
      pure real(dp) function local(x)
         real(dp), intent(in) :: x
         if (x >= a) then
            local = conductance(law, .false., factor*(x - a)**1.5_dp, 0.0_dp)
         else if (x > s(k)) then
            local = conductance(law, .true., 0.0_dp, pressure(k)*sqrt((a - x)/(a - s(k))))
         else if (k > 1) then
            local = conductance(law, .true., 0.0_dp, pressure(k) + (pressure(max(k - 1,1)) - pressure(k))* &
               (s(k) - x)/(s(k) - s(max(k - 1,1))))
         else
            local = conductance(law, .true., 0.0_dp, pressure(k))
         end if
      end function local
   end subroutine cut

   pure subroutine find_edge(s, hats, gap, k, a, factor)
      real(dp), intent(in) :: s(:), gap(:)
      logical, intent(in) :: hats
      integer, intent(in) :: k
      real(dp), intent(out) :: a, factor
      real(dp) :: g1, g2, lo, hi
      integer :: step

      factor = 0.0_dp
      a = s(k)
      if (gap(k + 2) <= gap(k + 1) .or. gap(k + 1) < 0.0_dp) return
      if (.not. hats) then
         g1 = gap(k + 1)**(2.0_dp/3.0_dp)
         g2 = gap(k + 2)**(2.0_dp/3.0_dp)
         a = s(k + 1) - (s(k + 2) - s(k + 1))*g1/(g2 - g1)
         a = max(a, s(k) + 1.0e-9_dp*(s(k + 1) - s(k)))
         factor = gap(k + 2)/(s(k + 2) - a)**1.5_dp
         return
      end if
      if (k + 3 > size(s)) return
      lo = s(k)
      hi = s(k + 2)
      do step = 1, 50
         a = 0.5_dp*(lo + hi)
         if (mean(s(k:k + 2), a)*gap(k + 2) > gap(k + 1)*mean(s(k + 1:k + 3), a)) then
            lo = a
         else
            hi = a
         end if
      end do
      a = max(a, s(k) + 1.0e-9_dp*(s(k + 1) - s(k)))
      factor = gap(k + 2)/mean(s(k + 1:k + 3), a)
   end subroutine find_edge

   pure real(dp) function mean(s, a)
      real(dp), intent(in) :: s(3), a
      real(dp) :: f(3)

      f = max(s - a, 0.0_dp)**3.5_dp/8.75_dp
      mean = 2*((f(3) - f(2))/(s(3) - s(2)) - (f(2) - f(1))/(s(2) - s(1)))/(s(3) - s(1))
   end function mean

   pure subroutine order(x)
      real(dp), intent(inout) :: x(:)
      integer :: i, j
      real(dp) :: t
      do i = 2, size(x)
         t = x(i)
         do j = i - 1, 1, -1
            if (x(j) <= t) exit
            x(j + 1) = x(j)
         end do
         x(j + 1) = t
      end do
   end subroutine order

end module edge_conductance
