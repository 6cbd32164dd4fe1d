!> Newton's method for omega = U(omega), semismooth (Qi & Sun 1993), with the exact derivative of
!> the contact state and of the conductance laws.
!>
!> Unknowns are the coordinates z of the contact points on the graphs of their laws
!> (conductance_graph), in which the equation is
!>
!>    r(z) = opening(z) - H(L(omega(z))) = 0,    J = diag(opening') - D diag(omega'),
!>
!> D being the derivative of the openings H(L(omega)) by omega. Each contact point then goes along
!> the curve of its own law, not along the tangent (conductance_graph, `moved`).
!>
!> A pass is taken unless earlier ones, all but one, were better by both of its measures: |r|, and
!> the mismatch of the shares omega/(omega + body) by which the heat goes (a filter: Gould, Leyffer
!> & Toint 2004). Else its step is shortened. Where a short one does not help either, the method
!> goes over to pseudo-transient continuation: (M/tau + J) dz = -r, implicit Euler steps of M dz/dt
!> = -r whose tau grows as |r| falls (Kelley & Keyes 1998). That leads to a state which is stable in
!> this sense, and there the steps are Newton's again. Where all passes are used up, or the heat of
!> several of them runs away, the method follows a path that leads to a solution wherever it starts
!> (homotopy). On a sparse tail J is not formed: steps, also those of the path, come from products
!> with it (newton_products).
module newton
   use conductance_graph, only: conductance_graph_type
   use dense, only: eigenvalues, lu_type
   use fixed_point, only: accelerator_type, pass_type
   use homotopy, only: homotopy_type
   use kinds, only: dp
   use path_steps, only: path_step_type
   implicit none
   private
   public :: newton_type, inertias, leaves_rest, longest_time_step

   real(dp), parameter :: least_fall = 0.1_dp         !! of a measure by a full step, needed
   integer, parameter :: patience = 1           !! better passes in spite of which one is taken
   real(dp), parameter :: shortest = 0.2_dp           !! part of a step below which it is given up
   real(dp), parameter :: retreating = 0.25_dp !! part of it left where no contact zones were found
   real(dp), parameter :: last_retreat = 1.0e-4_dp    !! part of it that is tried last then
   real(dp), parameter :: first_time_step = 0.3_dp    !! tau at first
   real(dp), parameter :: growth = 2.0_dp             !! of tau where |r| stays
   real(dp), parameter :: growth_limits(2) = [0.1_dp, 4.0_dp]   !! of tau in a step
   real(dp), parameter :: endless = 1.0e4_dp          !! tau above which a step is Newton's
   real(dp), parameter :: rounding = 1.0e-15_dp       !! |r| that is rounding, relative

   !> Memory of the method.
   type, extends(accelerator_type) :: newton_type
      integer :: most_steps = huge(1)   !! passes after which steps have failed
      type(homotopy_type), allocatable, private :: path   !! once they have failed
      real(dp), allocatable, private :: coordinate(:)  !! (m) z of the last pass taken [length]
      real(dp), allocatable, private :: rest(:)        !! (m) r there [length]
      real(dp), allocatable, private :: jacobian(:, :) !! (m, m) J there; unallocated if unknown
      real(dp), allocatable, private :: full_step(:)   !! (m) dz there from products with J
      real(dp), allocatable, private :: own(:)         !! (m) derivative of opening k by omega k
      !> (m) conductance of the bodies about a contact point
      real(dp), allocatable, private :: body(:)
      real(dp), allocatable, private :: step(:)        !! (m) dz of the present step [length]
      real(dp), allocatable, private :: filter(:, :)   !! (2, passes taken) their measures
      real(dp), private :: part = 1.0_dp               !! part of the present step that is tried
      real(dp), private :: time_step = huge(1.0_dp)    !! tau; huge for Newton's method
   contains
      procedure :: asks_derivative
      procedure :: prepare_step
      procedure :: next
   end type newton_type

contains

   !> Whether next wants the derivative of this pass: it is taken, and there are laws to follow.
   pure function asks_derivative(self, pass) result(asks)
      class(newton_type), intent(in) :: self   !! memory of the method
      type(pass_type), intent(in) :: pass      !! the last pass
      logical :: asks                          !! pass%derivative is to be set

      asks = allocated(self%path)
      if (asks) return
      asks = takes(self, pass)
      if (asks) asks = any(abs(pass%graph%derivative(pass%coordinates())) > 0.0_dp)
   end function asks_derivative

   !> What a step by products needs of the method: tau, or on a path its equation.
   subroutine prepare_step(self, pass)
      class(newton_type), intent(inout) :: self   !! memory of the method
      type(pass_type), intent(inout) :: pass      !! the last pass

      if (allocated(self%path)) then
         pass%path_step = path_step_type()
         allocate (pass%path_step%equation)
         call self%path%equation(pass%graph, self%body, pass%opening, pass%path_step%equation)
      else
         pass%time_step = time_step_of(self, pass)
      end if
   end subroutine prepare_step

   !> tau of the step from a pass that is taken.
   pure real(dp) function time_step_of(self, pass) result(tau)
      class(newton_type), intent(in) :: self   !! memory of the method
      type(pass_type), intent(in) :: pass      !! the last pass
      real(dp) :: fall

      tau = self%time_step
      if (tau < endless) then
         fall = norm2(self%rest)/max(norm2(residual(pass)), tiny(1.0_dp))
         tau = tau*min(max(growth*fall, growth_limits(1)), growth_limits(2))
      end if
      if (tau >= endless) tau = huge(1.0_dp)
   end function time_step_of

   !> Whether a pass is taken.
   pure function takes(self, pass)
      class(newton_type), intent(in) :: self
      type(pass_type), intent(in) :: pass
      logical :: takes
      real(dp) :: found(2)
      integer :: better, i

      takes = .true.
      if (.not. allocated(self%filter)) return
      found = measures(self, pass)
      better = 0
      do i = 1, size(self%filter, 2)
         if (all(found > (1.0_dp - least_fall*self%part)*self%filter(:, i))) better = better + 1
      end do
      takes = better <= patience .or. self%time_step < endless .or. &
         found(1) <= rounding*norm2(pass%opening)
   end function takes

   !> How far a pass is from the solution, in the openings and in the shares.
   pure function measures(self, pass)
      class(newton_type), intent(in) :: self
      type(pass_type), intent(in) :: pass
      real(dp) :: measures(2)

      measures(1) = norm2(residual(pass))
      measures(2) = norm2(self%body*(pass%image - pass%omega)/((pass%image + self%body)* &
         (pass%omega + self%body)))
   end function measures

   !> r of a pass.
   pure function residual(pass) result(r)
      type(pass_type), intent(in) :: pass
      real(dp) :: r(size(pass%omega))   !! (m) [length]

      r = pass%graph%opening(pass%coordinates()) - pass%opening
   end function residual

   !> A new step from a pass that is taken; else, and where the contact zones were not found, a
   !> shorter one.
   subroutine next(self, pass)
      class(newton_type), intent(inout) :: self   !! memory of the method
      type(pass_type), intent(inout) :: pass      !! the last pass in, next omega* out
      real(dp) :: ratio

      if (.not. pass%found) then
         call retreat(self, pass)
         return
      else if (allocated(self%path)) then
         call self%path%next(pass%graph, self%body, pass%opening, pass%derivative, &
            pass%coordinate, pass%path_step)
         pass%omega = pass%graph%omega(pass%coordinate)
         return
      end if
      if (takes(self, pass)) then
         self%time_step = time_step_of(self, pass)
         if (allocated(pass%step)) self%time_step = pass%time_step
         call take(self, pass)
         call make_step(self, pass%graph)
      else
         ! Where the parabola through |r|^2 is lowest.
         ratio = (norm2(self%rest)/norm2(residual(pass)))**2
         self%part = self%part*min(max(self%part*ratio/(1.0_dp + (2.0_dp*self%part - 1.0_dp)* &
            ratio), 0.1_dp), 0.5_dp)
         if (self%part < shortest) then
            self%time_step = first_time_step
            call make_step(self, pass%graph)
            ! The products are those of the last pass: back to where the step began.
            if (allocated(self%full_step)) then
               self%time_step = first_time_step/growth
               self%step = 0.0_dp
            end if
         end if
      end if
      call try(self, pass)
      if (pass%iteration < self%most_steps .and. .not. pass%is_lost) return
      allocate (self%path)
      self%follows_path = .true.
      call self%path%begin(pass%graph, pass%opening, pass%coordinate)
      pass%omega = pass%graph%omega(pass%coordinate)
   end subroutine next

   !> A shorter step, if there is one.
   subroutine retreat(self, pass)
      class(newton_type), intent(inout) :: self
      type(pass_type), intent(inout) :: pass

      if (allocated(self%path)) then
         call self%path%retreat(pass%graph, self%body, pass%coordinate, self%retreats)
         if (self%retreats) pass%omega = pass%graph%omega(pass%coordinate)
         return
      end if
      self%retreats = allocated(self%step) .and. self%part > last_retreat
      if (.not. self%retreats) return
      self%part = retreating*self%part
      call try(self, pass)
   end subroutine retreat

   !> Takes a pass.
   subroutine take(self, pass)
      class(newton_type), intent(inout) :: self
      type(pass_type), intent(in) :: pass
      real(dp) :: derivative(size(pass%omega))
      integer :: k

      self%rest = residual(pass)
      self%coordinate = pass%coordinates()
      if (.not. allocated(self%filter)) then
         allocate (self%body(size(derivative)), source=1.0_dp)
         allocate (self%filter(2, 0))
      end if
      if ((allocated(pass%derivative) .or. allocated(pass%step)) .and. &
         .not. allocated(self%own)) then
         self%body = pass%body
         self%filter = reshape([real(dp) ::], [2, 0])
      end if
      self%filter = reshape([self%filter, measures(self, pass)], [2, size(self%filter, 2) + 1])
      if (allocated(self%jacobian)) deallocate (self%jacobian)
      if (allocated(self%full_step)) deallocate (self%full_step)
      if (allocated(pass%step)) then
         self%full_step = pass%step
         self%own = pass%own
      end if
      if (.not. allocated(pass%derivative)) return
      derivative = pass%graph%derivative(self%coordinate)
      self%own = [(pass%derivative(k, k), k=1, size(derivative))]
      allocate (self%jacobian, mold=pass%derivative)
      do k = 1, size(derivative)
         self%jacobian(:, k) = -pass%derivative(:, k)*derivative(k)
         self%jacobian(k, k) = self%jacobian(k, k) + pass%graph(k)%advance(self%coordinate(k))
      end do
   end subroutine take

   !> The next omega*. Without a derivative every contact point goes to the opening that was found.
   subroutine try(self, pass)
      class(newton_type), intent(inout) :: self
      type(pass_type), intent(inout) :: pass

      associate (graph => pass%graph)
         if (allocated(self%jacobian) .or. allocated(self%full_step)) then
            pass%coordinate = graph%moved(self%coordinate, self%part*self%step, self%body, self%own)
         else
            pass%coordinate = graph%coordinate_of_opening(graph%opening(self%coordinate) + &
               self%step)
         end if
         pass%omega = graph%omega(pass%coordinate)
      end associate
      self%g = spread(self%part, 1, size(pass%omega))
   end subroutine try

   !> dz from the pass that was taken last; the image where the derivative is not known.
   subroutine make_step(self, graph)
      class(newton_type), intent(inout) :: self
      type(conductance_graph_type), intent(in) :: graph(:)
      real(dp) :: matrix(size(self%rest), size(self%rest)), step(size(self%rest), 1)
      real(dp) :: inertia(size(self%rest))
      type(lu_type) :: lu
      logical :: singular
      integer :: k

      self%part = 1.0_dp
      self%step = -self%rest
      if (allocated(self%full_step)) self%step = self%full_step
      if (.not. allocated(self%jacobian)) return
      inertia = inertias(graph, self%coordinate, [(self%jacobian(k, k), k=1, size(step))])
      if (self%time_step < endless) self%time_step = min(self%time_step, &
         stable_time_step(self, inertia))
      matrix = self%jacobian
      step(:, 1) = -self%rest
      do k = 1, size(step)
         if (self%time_step < endless) matrix(k, k) = matrix(k, k) + &
            inertia(k)/self%time_step
         if (.not. leaves_rest(graph(k), self%coordinate(k), sum(abs(self%jacobian(k, :))), &
            self%rest(k))) cycle
         matrix(k, :) = 0.0_dp
         matrix(k, k) = 1.0_dp
         self%own(k) = 0.0_dp
         step(k, 1) = graph(k)%coordinate_of_opening(-self%rest(k)) - self%coordinate(k)
      end do
      call lu%factor(matrix, singular)
      if (singular) return
      call lu%solve(step)
      self%step = step(:, 1)
   end subroutine make_step

   !> Whether a contact point does not rest any more: no conductance at which it may rest brings its
   !> opening to 0.
   elemental logical function leaves_rest(graph, coordinate, row, rest)
      type(conductance_graph_type), intent(in) :: graph
      real(dp), intent(in) :: coordinate       !! z [length]
      real(dp), intent(in) :: row              !! sum of the magnitudes of its row of J
      real(dp), intent(in) :: rest             !! its r [length]

      leaves_rest = graph%rests(coordinate)
      if (leaves_rest) leaves_rest = row*graph%width <= abs(rest)
   end function leaves_rest

   !> The diagonal of M: 1, and for a contact point at rest what makes the time in which it goes
   !> through its rest that of the others, however long the rest is.
   elemental real(dp) function inertias(graph, coordinate, own) result(inertia)
      type(conductance_graph_type), intent(in) :: graph
      real(dp), intent(in) :: coordinate       !! z [length]
      real(dp), intent(in) :: own              !! its diagonal entry of J

      inertia = 1.0_dp
      if (graph%rests(coordinate) .and. abs(own) > 0.0_dp) inertia = abs(own)
   end function inertias

   !> As longest_time_step; huge where the eigenvalues are not found.
   function stable_time_step(self, inertia) result(tau)
      type(newton_type), intent(in) :: self
      real(dp), intent(in) :: inertia(:)
      real(dp) :: tau
      real(dp), allocatable :: real_part(:), imaginary_part(:)
      logical :: found

      tau = huge(1.0_dp)
      call eigenvalues(-self%jacobian/spread(inertia, 2, size(inertia)), real_part, &
         imaginary_part, found)
      if (found) tau = longest_time_step(cmplx(real_part, imaginary_part, dp))
   end function stable_time_step

   !> Largest tau with which (M/tau + J) dz = -r leads where M dz/dt = -r does: half of that at
   !> which the matrix is singular. Where heat closes the gap it crosses, J has negative eigenvalues
   !> on the way, and a longer step goes backwards.
   pure real(dp) function longest_time_step(values) result(tau)
      complex(dp), intent(in) :: values(:)     !! eigenvalues of -M^-1 J, the outer ones

      tau = 0.5_dp/max(maxval(real(values, dp), mask=abs(aimag(values)) <= real(values, dp)), &
         tiny(1.0_dp))
   end function longest_time_step

end module newton
