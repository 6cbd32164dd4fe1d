!> L of section 2: from the conductance to the temperature jumps, eq. (3.4) on the tail, and how the
!> jumps follow the conductance.
!>
!> Where laws vary with the temperatures of the faces, the conductances follow them, omega = W(z,
!> T(omega)): z are the coordinates of the contact points on the graphs of their laws
!> (conductance_graph), T the temperatures that (3.4) gives with the conductances. Newton's method
!> in log omega, in which radiation and gases are nearly straight, has the derivative
!>
!>    dW/domega = W_T dT/domega + W_d dd/domega,   T the means, d the jumps of the faces,
!>
!> at constant z. It is a part of the derivative of the contact operator too.
module contact_heat
   use column_panels, only: crout_flops
   use conductance_graph, only: conductance_graph_type
   use conductance_laws, only: conductance
   use dense, only: lu_type, product_of
   use edge_heat, only: find_heat_by_opening
   use errors, only: check_finite, error_type, set_error, status_no_convergence
   use friction_tangent, only: friction_tangent_type
   use gmres, only: gmres_type
   use heat_equation, only: heat_across
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: increment_data_type, increment_workspace_type
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   use temperature_laws, only: temperature_derivatives
   use text, only: to_text
   implicit none
   private
   public :: jump_derivatives_type, temperature_jumps, jump_derivatives, heat_by_omega, &
      take_temperatures, settle_conductance, at_own_temperatures, derivative_by_temperature, &
      changes_by_temperature, changes_by_faces, find_edge_loads, tail_of_heats, with_temperatures

   !> How the unknowns of the tail follow the conductance of each contact point that carries heat.
   type :: jump_derivatives_type
      integer, allocatable :: active(:)        !! (n) the contact points
      real(dp), allocatable :: of_tail(:, :)   !! (tail, n)
      real(dp), allocatable :: heat(:)         !! (n) load of the tail per omega
      !> (points that friction may heat, n) their heat, where it follows
      real(dp), allocatable :: friction_heat(:, :)
      !> (e) contact points that move edges; what that makes is in e more columns of of_tail
      integer, allocatable :: at_edge(:)
   end type jump_derivatives_type

   integer, parameter :: most_steps = 100            !! solutions of (3.4)
   real(dp), parameter :: longest_step = 2.0_dp      !! of any log omega
   real(dp), parameter :: rounding = 1.0e-13_dp      !! relative change of omega that is none
   real(dp), parameter :: converged = 1.0e-10_dp     !! the same, where it falls no more
   real(dp), parameter :: shortest = 1.0e-3_dp       !! part of a step below which none is tried
   integer, parameter :: most_products = 200         !! for one step
   real(dp), parameter :: solved = 1.0e-12_dp        !! residual of a step by products, relative

contains

   !> L: the jumps for a given conductance, eq. (3.4) on the tail. Only the columns from the first
   !> changed one on are factored again.
   subroutine temperature_jumps(bodies, heat, data, omega, workspace, jump)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      real(dp), intent(in) :: omega(:)                           !! (m) omega*
      type(increment_workspace_type), intent(inout) :: workspace !! receives factors
      real(dp), intent(out) :: jump(:)                           !! (m) T_xi - T_eta [temperature]
      real(dp) :: x(bodies%thermal%map%tail), diagonal(bodies%thermal%map%tail)
      real(dp) :: of_point(size(omega)), history(size(omega))
      real(dp), allocatable :: of_edge(:)
      integer :: k

      associate (tail_index => bodies%jump_index, tail => workspace%tail, &
         work => workspace%record%work)
         of_point = data%equation%contact_diagonal(omega)
         history = data%equation%contact_history(omega)
         x = data%heat%condensed
         if (allocated(workspace%friction%heat)) x = x + heat%friction_on_tail(bodies, &
            workspace%friction%parts(2, :)*workspace%friction%heat)
         diagonal = 0.0_dp
         do k = 1, size(omega)
            if (tail_index(k) == 0) cycle
            diagonal(tail_index(k)) = of_point(k)
            x(tail_index(k)) = x(tail_index(k)) + history(k)
         end do
         if (allocated(workspace%edge%point)) then
            associate (j => tail_index(workspace%edge%point), own => heat%schur%diagonal())
               diagonal(j) = own(j)
            end associate
         end if
         call tail%refactor(heat%schur, diagonal)
         work%columns_again = work%columns_again + size(x) + 1 - tail%first_changed
         work%columns_full = work%columns_full + bodies%thermal%map%equations
         associate (first_row => tail%first_row, n => size(x))
            work%flops_again = work%flops_again + crout_flops(first_row, n, tail%first_changed)
            work%flops_full = work%flops_full + heat%full_flops() + crout_flops(first_row, n, 1)
         end associate
         if (allocated(workspace%edge%point)) then
            call solve_with_edge(bodies, data%heat%given, diagonal, workspace, x, of_edge)
         else
            call tail%solve(x)
         end if
         jump = data%held_jump
         do k = 1, size(omega)
            if (tail_index(k) > 0) jump(k) = x(tail_index(k))
         end do
         if (allocated(of_edge)) jump(workspace%edge%point) = of_edge
         workspace%on_tail = x
      end associate
   end subroutine temperature_jumps

   !> Solves on the tail with heat at edges. The jumps there have the diagonal of the bodies in the
   !> factors; it is taken off again, and the heat at the edges put in its place.
   subroutine solve_with_edge(bodies, prescribed, diagonal, workspace, x, jump)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: prescribed(:)                      !! (nodes) temperatures
      real(dp), intent(in) :: diagonal(:)                        !! (tail)
      type(increment_workspace_type), intent(inout) :: workspace
      real(dp), intent(inout) :: x(:)                            !! (tail) heat in, solution out
      real(dp), allocatable, intent(out) :: jump(:)              !! (points at edges)
      real(dp) :: sums(size(x), 2*size(workspace%edge%point)), given(size(workspace%edge%point))
      real(dp), dimension(size(given)) :: heat, back
      integer :: i, n, t

      n = size(given)
      sums = 0.0_dp
      given = 0.0_dp
      if (.not. allocated(workspace%supported)) workspace%supported = &
         bodies%thermal%map%supported(prescribed)
      associate (at_edge => workspace%edge, map => bodies%thermal%map)
         heat = heat_across(bodies%points%weight(at_edge%point), at_edge%conductance, 1.0_dp)
         back = -diagonal(bodies%jump_index(at_edge%point))
         do i = 1, n
            sums(bodies%jump_index(at_edge%point(i)), n + i) = 1.0_dp
            associate (nodes => at_edge%jump%values_of(i), share => at_edge%jump%coefficients_of(i))
               given(i) = dot_product(share, workspace%supported(nodes))
               do t = 1, size(nodes)
                  associate (k => map%tail_index(map%by_unknowns%values_of(nodes(t))), &
                     part => map%by_unknowns%coefficients_of(nodes(t)))
                     sums(k, i) = sums(k, i) + share(t)*part
                  end associate
               end do
            end associate
            x = x - heat(i)*given(i)*sums(:, i)
         end do
         call workspace%tail%add_sums(sums, [heat, back])
         call workspace%tail%solve(x)
         jump = matmul(x, sums(:, :n)) + given
      end associate
   end subroutine solve_with_edge

   !> The derivatives by the conductance, with the factors of the last pass:
   !>
   !>    dtheta = -(S_T + diag(d))^-1 diag(weight (a3 theta + b3 theta_i)/a1) domega.
   subroutine jump_derivatives(bodies, data, workspace, jump, by_omega)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      real(dp), intent(in) :: jump(:)                         !! (m) T_xi - T_eta [temperature]
      type(jump_derivatives_type), intent(out) :: by_omega
      real(dp) :: heat(size(jump))
      integer :: k

      heat = heat_by_omega(bodies, data, workspace, jump)
      by_omega%active = pack([(k, k=1, size(jump))], abs(heat) > 0.0_dp)
      by_omega%heat = heat(by_omega%active)
      allocate (by_omega%of_tail(bodies%thermal%map%tail, size(by_omega%active)), source=0.0_dp)
      do k = 1, size(by_omega%active)
         by_omega%of_tail(bodies%jump_index(by_omega%active(k)), k) = by_omega%heat(k)
      end do
      call workspace%tail%solve_columns(by_omega%of_tail)
   end subroutine jump_derivatives

   !> What the conductances of contact points, by their coordinates, load the tail with beyond
   !> heat_by_omega: their openings move edges of contact, and the heat there.
   subroutine find_edge_loads(bodies, data, workspace, jump, point, load)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      real(dp), intent(in) :: jump(:)                         !! (m) T_xi - T_eta [temperature]
      integer, allocatable, intent(out) :: point(:)           !! (n) contact points
      real(dp), allocatable, intent(out) :: load(:, :)        !! (thermal tail, n)
      real(dp), dimension(size(jump)) :: by_omega, coordinate, slope
      real(dp), allocatable :: heat(:, :), temperature(:)
      real(dp) :: unknowns(bodies%thermal%map%equations)
      integer :: k

      associate (map => bodies%thermal%map, graph => workspace%pass%graph)
         coordinate = workspace%pass%coordinates()
         slope = graph%derivative(coordinate)
         by_omega = heat_by_omega(bodies, data, workspace, jump)
         ! Nodes at edges need no other unknowns.
         unknowns = 0.0_dp
         unknowns(map%equations - map%tail + 1:) = workspace%on_tail
         temperature = map%expand(unknowns, data%heat%given)
         call find_heat_by_opening(bodies, graph, graph%opening(coordinate), &
            graph%rests(coordinate) .or. abs(slope) <= 0.0_dp, temperature, point, heat)
         allocate (load(map%tail, size(point)))
         do k = 1, size(point)
            unknowns = map%restrict(heat(:, k))
            load(:, k) = unknowns(map%equations - map%tail + 1:)/slope(point(k))
            if (any(workspace%edge%point == point(k))) then
               associate (own => load(bodies%jump_index(point(k)), k))
                  own = own - by_omega(point(k))
               end associate
            end if
         end do
      end associate
   end subroutine find_edge_loads

   !> Load of the tail per conductance of each contact point, 0 where it has no jump.
   pure function heat_by_omega(bodies, data, workspace, jump) result(heat)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      real(dp), intent(in) :: jump(:)                         !! (m) T_xi - T_eta [temperature]
      real(dp) :: heat(size(jump))                            !! (m)

      heat = -data%equation%crossing_by_omega(jump)
      associate (edge => workspace%edge)
         if (allocated(edge%point)) heat(edge%point) = heat(edge%point)*edge%own
      end associate
      where (bodies%jump_index == 0) heat = 0.0_dp
   end function heat_by_omega

   !> Unknowns of the thermal tail with heats at the contact points, by the last pass's factors.
   function tail_of_heats(bodies, workspace, heats, load) result(of_tail)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      real(dp), intent(in) :: heats(:)                        !! (m)
      real(dp), intent(in), optional :: load(:)               !! (thermal tail) more heat
      real(dp) :: of_tail(bodies%thermal%map%tail, 1)
      integer :: k

      of_tail = 0.0_dp
      if (present(load)) of_tail(:, 1) = load
      do k = 1, size(heats)
         associate (j => bodies%jump_index(k))
            if (j > 0) of_tail(j, 1) = of_tail(j, 1) + heats(k)
         end associate
      end do
      call workspace%tail%solve_columns(of_tail)
   end function tail_of_heats

   !> Changes of the conductances with the laws' own changes dW: domega = dW + (dW/domega) domega.
   function with_temperatures(bodies, heat, workspace, coordinate, rate, change, tangent) &
      result(of_omega)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      real(dp), intent(in) :: coordinate(:)                    !! (m) z [length]
      real(dp), intent(in) :: rate(:)                          !! (m) as from heat_by_omega
      real(dp), intent(in) :: change(:)                        !! (m) dW
      !> of the contact, whose heat of friction follows; absent where that stays
      type(friction_tangent_type), intent(in), optional :: tangent
      real(dp) :: of_omega(size(change)), part(size(change), 1)
      real(dp), allocatable :: load(:, :), of_tail(:, :)
      type(gmres_type) :: gmres

      of_omega = change
      if (.not. bodies%points%vary_with_temperature()) return
      call gmres%begin(change, solved, min(size(change), most_products))
      do while (gmres%wants_product)
         of_tail = tail_of_heats(bodies, workspace, rate*gmres%vector)
         if (present(tangent)) then
            if (tangent%makes_heat) then
               load = heat%loads_of_tail(bodies, of_tail)
               call tangent%follow(bodies, heat, workspace, of_tail, load)
            end if
         end if
         part = changes_by_temperature(bodies, heat, workspace, coordinate, of_tail)
         call gmres%take(gmres%vector - part(:, 1))
      end do
      of_omega = gmres%solution()
   end function with_temperatures

   !> Temperatures of the faces with given jumps, and the laws at these.
   subroutine take_temperatures(bodies, heat, data, jump, workspace)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      real(dp), intent(in) :: jump(:)                            !! (m) T_xi - T_eta [temperature]
      type(increment_workspace_type), intent(inout) :: workspace !! receives faces and laws

      if (.not. allocated(workspace%faces)) allocate (workspace%faces(size(jump)))
      associate (faces => workspace%faces, by_tail => heat%means_of_tail(bodies, &
         reshape(workspace%on_tail, [size(workspace%on_tail), 1])))
         faces%mean = data%welded_mean + by_tail(:, 1)
         faces%jump = jump
         if (allocated(workspace%friction%heat) .and. .not. heat%schur%is_sparse()) then
            faces%mean = faces%mean + matmul(heat%friction_mean, &
               workspace%friction%parts(2, :)*workspace%friction%heat)
         end if
         workspace%pass%graph%law = bodies%laws%conductance_at(faces%mean, faces%jump)
      end associate
   end subroutine take_temperatures

   !> Conductances and jumps with the coordinates of a pass: the solution of (3.4) whose
   !> conductances follow the temperatures. The factors are left of these conductances.
   !> Errors: no convergence, jumps that overflow.
   subroutine settle_conductance(bodies, heat, data, workspace, jump, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      !> coordinates and a guess of omega in; omega, temperatures, laws and factors out
      type(increment_workspace_type), intent(inout) :: workspace
      real(dp), intent(out) :: jump(:)                           !! (m) T_xi - T_eta [temperature]
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(size(jump)) :: base, step, wanted
      real(dp) :: last, part, residual
      integer :: i

      part = 1.0_dp
      last = huge(last)
      do i = 1, most_steps
         call temperature_jumps(bodies, heat, data, workspace%pass%omega, workspace, jump)
         call check_finite(jump, 'temperature jumps', status_no_convergence, error)
         if (allocated(error)) return
         call take_temperatures(bodies, heat, data, jump, workspace)
         wanted = workspace%pass%graph%omega(workspace%pass%coordinate)
         residual = maxval([0.0_dp, abs(log_ratio(wanted, workspace%pass%omega))])
         if (residual <= rounding .or. (residual <= converged .and. residual >= 0.5_dp*last)) return
         if (residual < last .or. part < shortest) then
            step = newton_step(bodies, heat, data, workspace, jump, wanted)
            base = workspace%pass%omega
            last = residual
            part = 1.0_dp
         else
            part = 0.5_dp*part
         end if
         workspace%pass%omega = merge(base*exp(part*step), wanted, base > 0.0_dp .and. &
            wanted > 0.0_dp)
      end do
      call set_error(error, status_no_convergence, 'conductances and temperatures of the faces '// &
         'do not converge together; last residual '//to_text(residual))
   end subroutine settle_conductance

   !> log(wanted/omega); 1 where only one of both carries no heat.
   elemental function log_ratio(wanted, omega)
      real(dp), intent(in) :: wanted, omega
      real(dp) :: log_ratio

      if (wanted > 0.0_dp .and. omega > 0.0_dp) then
         log_ratio = log(wanted/omega)
      else
         log_ratio = merge(1.0_dp, 0.0_dp, max(wanted, omega) > 0.0_dp)
      end if
   end function log_ratio

   !> Newton's step of log omega: with changes W dlog omega for unknowns its equation is that of
   !> with_temperatures.
   function newton_step(bodies, heat, data, workspace, jump, wanted) result(step)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(in) :: workspace
      real(dp), intent(in) :: jump(:), wanted(:)            ! wanted: (m) W
      real(dp), dimension(size(wanted)) :: rate, scale, step

      associate (omega => workspace%pass%omega)
         scale = merge(wanted, 1.0_dp, wanted > 0.0_dp .and. omega > 0.0_dp)
         rate = merge(heat_by_omega(bodies, data, workspace, jump)*omega/scale, 0.0_dp, &
            wanted > 0.0_dp)
         step = with_temperatures(bodies, heat, workspace, workspace%pass%coordinate, rate, &
            scale*log_ratio(wanted, omega))/scale
      end associate
      step = min(max(step, -longest_step), longest_step)
   end function newton_step

   !> dW/domega of the solution that the factors belong to.
   function derivative_by_temperature(bodies, heat, workspace, coordinate, by_omega) &
      result(derivative)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace  !! graphs, temperatures of the faces
      real(dp), intent(in) :: coordinate(:)                    !! (m) z [length]
      type(jump_derivatives_type), intent(in) :: by_omega
      real(dp) :: derivative(size(coordinate), size(coordinate))   !! (m, m)

      derivative = 0.0_dp
      derivative(:, by_omega%active) = changes_by_temperature(bodies, heat, workspace, coordinate, &
         by_omega%of_tail, by_omega%friction_heat)
   end function derivative_by_temperature

   !> dW with the unknowns of the thermal tail, with the heat of friction, and with the means of the
   !> faces without jumps.
   function changes_by_temperature(bodies, heat, workspace, coordinate, of_tail, friction_heat, &
      mean) result(change)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace  !! graphs, temperatures of the faces
      real(dp), intent(in) :: coordinate(:)                    !! (m) z [length]
      real(dp), intent(in) :: of_tail(:, :)                    !! (thermal tail, n)
      real(dp), intent(in), optional :: friction_heat(:, :)             !! (heats, n)
      real(dp), intent(in), optional :: mean(:)                !! (m) [temperature]
      real(dp) :: change(size(coordinate), size(of_tail, 2))   !! (m, n)
      real(dp) :: jump(size(coordinate), size(of_tail, 2))
      integer :: k

      change = heat%means_of_tail(bodies, of_tail)
      if (present(friction_heat) .and. .not. heat%schur%is_sparse()) change = change + &
         product_of(heat%friction_mean, workspace%friction%entering_part(friction_heat))
      if (present(mean)) change = change + spread(mean, 2, size(change, 2))
      jump = 0.0_dp
      do k = 1, size(coordinate)
         if (bodies%jump_index(k) > 0) jump(k, :) = of_tail(bodies%jump_index(k), :)
      end do
      change = changes_by_faces(bodies, workspace, coordinate, change, jump)
   end function changes_by_temperature

   !> dW with the temperatures of the faces.
   pure function changes_by_faces(bodies, workspace, coordinate, mean, jump) result(change)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_workspace_type), intent(in) :: workspace  !! graphs, temperatures of the faces
      real(dp), intent(in) :: coordinate(:)                    !! (m) z [length]
      real(dp), intent(in) :: mean(:, :), jump(:, :)           !! (m, n) their changes
      real(dp) :: change(size(mean, 1), size(mean, 2))         !! (m, n)
      real(dp) :: by_faces(2)
      integer :: k

      do k = 1, size(coordinate)
         by_faces = graph_derivatives(workspace%pass%graph(k), coordinate(k))
         change(k, :) = by_faces(1)*mean(k, :) + by_faces(2)*jump(k, :)
      end do
   contains
      !> Derivatives of omega by mean and jump at a coordinate.
      pure function graph_derivatives(graph, at) result(by)
         type(conductance_graph_type), intent(in) :: graph
         real(dp), intent(in) :: at
         real(dp) :: by(2), weights(2), ends(2)

         associate (law => bodies%laws%conductance(k), faces => workspace%faces(k))
            if (graph%rests(at)) then
               ends = [conductance(graph%law, .true., 0.0_dp, 0.0_dp), &
                  conductance(graph%law, .false., 0.0_dp, 0.0_dp)]
               weights = [-at, graph%width + at]/graph%width* &
                  ((graph%omega(at) + graph%body)/(ends + graph%body))**2
               by = weights(1)*temperature_derivatives(law, faces, .true., 0.0_dp, 0.0_dp) + &
                  weights(2)*temperature_derivatives(law, faces, .false., 0.0_dp, 0.0_dp)
            else
               by = temperature_derivatives(law, faces, at < 0.0_dp, max(at, 0.0_dp), &
                  -graph%modulus*(at + graph%width))
            end if
         end associate
      end function graph_derivatives
   end function changes_by_faces

   !> The derivative of the openings by the conductances that coordinates give, the temperatures
   !> following: of D domega with domega = dW + (dW/domega) domega.
   subroutine at_own_temperatures(by_temperature, derivative)
      real(dp), intent(in) :: by_temperature(:, :)                   !! (m, m) dW/domega
      real(dp), allocatable, intent(inout) :: derivative(:, :)       !! (m, m) D in
      real(dp) :: matrix(size(derivative, 1), size(derivative, 1)), rows(size(matrix, 1), &
         size(matrix, 1))
      type(lu_type) :: lu
      logical :: singular
      integer :: k

      matrix = -transpose(by_temperature)
      do k = 1, size(matrix, 1)
         matrix(k, k) = matrix(k, k) + 1.0_dp
      end do
      call lu%factor(matrix, singular)
      if (singular) then
         deallocate (derivative)
         return
      end if
      rows = transpose(derivative)
      call lu%solve(rows)
      derivative = transpose(rows)
   end subroutine at_own_temperatures

end module contact_heat
