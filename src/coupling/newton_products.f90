!> Newton's step where a matrix between all contact points is not formed (newton), and likewise that
!> of a path (homotopy):
!>
!>    (M/tau + J) dz = -r,    J = diag(opening') - D (I - K)^-1 diag(omega'),
!>
!> by GMRES from products with J, each a solution on the thermal tail and one of the contact system.
!> K is the derivative of the conductances by each other by way of the temperatures; the heat of
!> friction follows (friction_tangent). The equations are divided by the contact points' own
!> derivatives. These are found several at a time, of points that are far from each other, and so
!> but nearly.
module newton_products
   use arnoldi, only: arnoldi_type
   use contact_heat, only: find_edge_loads, heat_by_omega, tail_of_heats, with_temperatures
   use contact_operator, only: opening_changes
   use friction_tangent, only: friction_tangent_type
   use gmres, only: gmres_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: trial_type
   use kinds, only: dp
   use newton, only: inertias, leaves_rest, longest_time_step
   use path_steps, only: path_step_type
   use reduced_bodies, only: reduced_bodies_type
   implicit none
   private
   public :: find_newton_step

   integer, parameter :: apart = 16             !! contact points from one to the next found with it
   integer, parameter :: most_products = 300
   real(dp), parameter :: solved = 1.0e-8_dp    !! residual of a step, relative
   real(dp), parameter :: rough = 1.0e-2_dp     !! residual of eigenvalues, beside 1
   real(dp), parameter :: least_own = 1.0e-3_dp !! own derivative that divides an equation, beside 1

   !> What products take, beside the pass.
   type :: opening_tangent_type
      type(friction_tangent_type) :: of_contact   !! with the heat of friction that follows it
      real(dp), allocatable :: coordinate(:)      !! (m) z [length]
      real(dp), allocatable :: rate(:)            !! (m) load of the thermal tail per omega
      integer, allocatable :: at_edge(:)          !! (n) contact points that move edges
      real(dp), allocatable :: load(:, :)         !! (tail, n) what they load beyond that
   end type opening_tangent_type

contains

   !> The step of the last pass, Newton's or that of a path, and what else the method takes from
   !> there: the contact points' own derivatives and the conductances of the bodies about them. No
   !> step where D does not exist.
   subroutine find_newton_step(bodies, heat, trial, follows_edges)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      !> as the pass left it; with tau, which is shortened to where the step leads on
      type(trial_type), intent(inout) :: trial
      logical, intent(in) :: follows_edges   !! whether J has the edges of contact
      type(opening_tangent_type) :: tangent

      call tangent%of_contact%make(bodies, heat, trial%workspace, trial%next%contact)
      if (.not. tangent%of_contact%exists) return
      associate (pass => trial%workspace%pass)
         tangent%coordinate = pass%coordinates()
         tangent%rate = heat_by_omega(bodies, trial%data, trial%workspace, trial%next%jump)
         allocate (tangent%at_edge(0), tangent%load(bodies%thermal%map%tail, 0))
         call find_own(bodies, heat, trial, tangent, pass%own, pass%body)
         if (follows_edges .and. allocated(trial%workspace%edge%point)) call find_edge_loads( &
            bodies, trial%data, trial%workspace, trial%next%jump, tangent%at_edge, tangent%load)
         if (allocated(pass%path_step)) then
            call step_on_path(bodies, heat, trial, tangent, pass%path_step)
         else
            call step_by_newton(bodies, heat, trial, tangent)
         end if
      end associate
   end subroutine find_newton_step

   !> Newton's step.
   subroutine step_by_newton(bodies, heat, trial, tangent)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(inout) :: trial
      type(opening_tangent_type), intent(in) :: tangent
      real(dp), dimension(size(trial%next%omega)) :: advance, diagonal, inertia, rest, slope
      logical :: is_left(size(trial%next%omega))
      type(gmres_type) :: gmres

      associate (pass => trial%workspace%pass)
         advance = pass%graph%advance(tangent%coordinate)
         slope = pass%graph%derivative(tangent%coordinate)
         rest = pass%graph%opening(tangent%coordinate) - pass%opening
         diagonal = advance - pass%own*slope
         is_left = .false.
         inertia = inertias(pass%graph, tangent%coordinate, diagonal)
         if (pass%time_step < huge(1.0_dp)) then
            pass%time_step = min(pass%time_step, stable_time_step())
            inertia = inertia/pass%time_step
         else
            inertia = 0.0_dp
         end if
         is_left = leaves_rest(pass%graph, tangent%coordinate, abs(diagonal), rest)
         rest = -rest
         where (is_left)
            rest = pass%graph%coordinate_of_opening(rest) - tangent%coordinate
            pass%own = 0.0_dp
            inertia = 0.0_dp
            diagonal = 1.0_dp
         end where
         diagonal = diagonal + inertia
         where (abs(diagonal) < least_own) diagonal = 1.0_dp
         call gmres%begin(rest/diagonal, solved, min(size(rest), most_products))
         do while (gmres%wants_product)
            call gmres%take((by_jacobian(gmres%vector) + inertia*gmres%vector)/diagonal)
         end do
         pass%step = gmres%solution()
      end associate
   contains
      !> J times a change of the coordinates.
      function by_jacobian(change) result(product)
         real(dp), intent(in) :: change(:)
         real(dp) :: product(size(change))

         product = merge(change, advance*change - by_laws(bodies, heat, trial, tangent, &
            slope*change), is_left)
      end function by_jacobian

      !> As newton has it, of roughly known eigenvalues.
      function stable_time_step() result(tau)
         real(dp) :: tau
         type(arnoldi_type) :: modes

         call modes%begin(size(rest), 0.0_dp, enough=rough)
         do while (modes%wants_product)
            call modes%take(-by_jacobian(modes%vector)/inertia)
         end do
         tau = huge(1.0_dp)
         if (modes%found) tau = longest_time_step(modes%value)
      end function stable_time_step
   end subroutine step_by_newton

   !> Correction and tangent of a path.
   subroutine step_on_path(bodies, heat, trial, tangent, step)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(in) :: trial
      type(opening_tangent_type), intent(in) :: tangent
      type(path_step_type), intent(inout) :: step     ! with its equation
      real(dp), dimension(size(step%equation%border)) :: product, scale
      real(dp) :: x(size(scale), 2)
      type(gmres_type) :: gmres
      integer :: k, n

      associate (equation => step%equation, own => trial%workspace%pass%own)
         n = size(own)
         ! Positive, for the sign of the determinant.
         scale(:n) = abs(equation%advance - own*equation%slope)
         where (scale(:n) < least_own*maxval(equation%advance)) scale(:n) = maxval(equation%advance)
         scale(n + 1) = 1.0_dp
         x = 0.0_dp
         x(:n, 1) = equation%rest/scale(:n)
         x(n + 1, 2) = 1.0_dp
         step%sound = .true.
         do k = 1, 2
            call gmres%begin(x(:, k), solved, min(n + 1, most_products))
            do while (gmres%wants_product)
               associate (vector => gmres%vector)
                  product(:n) = equation%advance*vector(:n) - by_laws(bodies, heat, trial, &
                     tangent, equation%slope*vector(:n)) + equation%by_parameter*vector(n + 1)
                  product(n + 1) = dot_product(equation%border, vector)
               end associate
               call gmres%take(product/scale)
            end do
            x(:, k) = gmres%solution()
            step%sound = step%sound .and. gmres%residual <= rough
         end do
      end associate
      if (.not. step%sound) return
      step%change = x(:, 1)
      step%tangent = x(:, 2)/norm2(x(:, 2))
      step%is_reversed = gmres%negative_determinant()
   end subroutine step_on_path

   !> Changes of the openings with the laws' own changes of the conductances: D (I - K)^-1.
   function by_laws(bodies, heat, trial, tangent, change) result(of_opening)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(in) :: trial
      type(opening_tangent_type), intent(in) :: tangent
      real(dp), intent(in) :: change(:)                        ! (m)
      real(dp) :: of_opening(size(change)), found(size(change), 1)
      real(dp), allocatable :: of_tail(:, :)

      call find_changes(bodies, heat, trial, tangent, with_temperatures(bodies, heat, &
         trial%workspace, tangent%coordinate, tangent%rate, change, tangent%of_contact), of_tail, &
         found)
      of_opening = found(:, 1)
   end function by_laws

   !> Own derivatives of the openings, and the conductances of the bodies about the contact points,
   !> 1 where that means nothing.
   subroutine find_own(bodies, heat, trial, tangent, own, body)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(in) :: trial
      type(opening_tangent_type), intent(in) :: tangent
      real(dp), allocatable, intent(out) :: own(:), body(:)    ! (m)
      real(dp), allocatable :: of_tail(:, :)
      real(dp) :: change(size(tangent%rate), 1)
      integer :: place(size(tangent%rate)), i, k

      allocate (own(size(place)), source=0.0_dp)
      allocate (body(size(place)), source=1.0_dp)
      associate (start => bodies%points%interface_start, workspace => trial%workspace)
         ! Neighbouring interfaces apart.
         place = [(modulo(k - start(bodies%points%interface(k)), apart) + apart* &
            modulo(bodies%points%interface(k), 2), k=1, size(place))]
         do i = 0, maxval(place)
            call find_changes(bodies, heat, trial, tangent, merge(1.0_dp, 0.0_dp, place == i), &
               of_tail, change)
            do k = 1, size(place)
               if (place(k) /= i .or. abs(tangent%rate(k)) <= 0.0_dp) cycle
               own(k) = change(k, 1)
               associate (j => bodies%jump_index(k))
                  body(k) = (tangent%rate(k)/of_tail(j, 1) - workspace%tail%diagonal(j))/ &
                     bodies%points%weight(k)
               end associate
            end do
         end do
      end associate
      where (body <= 0.0_dp) body = 1.0_dp
   end subroutine find_own

   !> What conductances make of the thermal tail while the heat of friction stays, and of the
   !> openings where it follows.
   subroutine find_changes(bodies, heat, trial, tangent, of_omega, of_tail, of_opening)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(in) :: trial
      type(opening_tangent_type), intent(in) :: tangent
      real(dp), intent(in) :: of_omega(:)                      ! (m)
      real(dp), allocatable, intent(out) :: of_tail(:, :)      ! (thermal tail, 1)
      real(dp), intent(out) :: of_opening(:, :)                ! (m, 1)
      real(dp), allocatable :: load(:, :), with_friction(:, :)

      of_tail = tail_of_heats(bodies, trial%workspace, tangent%rate*of_omega, &
         matmul(tangent%load, of_omega(tangent%at_edge)))
      load = heat%loads_of_tail(bodies, of_tail)
      with_friction = of_tail
      call tangent%of_contact%follow(bodies, heat, trial%workspace, with_friction, load)
      call opening_changes(bodies, trial%workspace%pass%graph, tangent%of_contact%contact, &
         trial%next%contact, load, of_opening)
   end subroutine find_changes

end module newton_products
