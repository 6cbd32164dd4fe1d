!> Balances of heat and force that can fail: the reactions of each body alone, on the recovered
!> fields, against what the reduced system says crosses the contacts.
module balances
   use contact_states, only: contact_state_type, contact_open, contact_slip, contact_stick
   use friction_laws, only: friction_bound, friction_law_type
   use kinds, only: dp
   use all_contact_points, only: all_contact_points_type
   implicit none
   private
   public :: scales_type, heat_residual, force_residual, imbalance
   public :: contact_violation

   !> What displacements and forces are measured by.
   type :: scales_type
      real(dp) :: length = 1.0_dp   !! largest displacement [length]
      real(dp) :: force = 1.0_dp    !! largest force [force]
   end type scales_type

contains

   !> Heat that the supports of each node must supply: K T - Q plus what leaves through the contact
   !> points, by the reduced system.
   pure function heat_residual(conducted, load, points, contact_heat) result(residual)
      real(dp), intent(in) :: conducted(:)       !! (nodes) K T of the bodies alone [power]
      real(dp), intent(in) :: load(:)            !! (nodes) Q [power]
      type(all_contact_points_type), intent(in) :: points
      real(dp), intent(in) :: contact_heat(:)    !! (m) heat from slave to master [power]
      real(dp) :: residual(size(conducted)) !! (nodes) zero where not prescribed [power]

      residual = conducted - load
      call points%difference%add_shares(contact_heat, residual)
   end function heat_residual

   !> Force that the supports of each degree of freedom must supply: K u - f less the contact forces
   !> of the reduced system.
   pure function force_residual(internal, load, points, state) result(residual)
      real(dp), intent(in) :: internal(:) !! (2 nodes) K u less the thermal load [force]
      real(dp), intent(in) :: load(:)                !! (2 nodes) applied forces [force]
      type(all_contact_points_type), intent(in) :: points
      type(contact_state_type), intent(in) :: state  !! contact forces
      real(dp) :: residual(size(internal)) !! (2 nodes) zero where not prescribed [force]
      real(dp) :: from_slave(2, size(points%slave))

      residual = internal - load
      from_slave = spread(state%force, 1, 2)*points%normal - &
         spread(state%shear_force, 1, 2)*points%tangent
      call points%add_forces(from_slave, residual)
   end function force_residual

   !> Largest imbalance, relative: of any single unsupported row, and per body and direction of the
   !> supports' reactions against all that is applied to the body, by loads and through its
   !> contacts. Along the radius of an axisymmetric body there is no such sum: the hoop stress takes
   !> part of it.
   pure function imbalance(internal, residual, supported, node_body, summed, scale) &
      result(relative)
      real(dp), intent(in) :: internal(:)      !! (components*nodes) of the bodies alone, K T or K u
      real(dp), intent(in) :: residual(:)      !! (components*nodes) as from the functions above
      logical, intent(in) :: supported(:)      !! (components*nodes) prescribed rows
      integer, intent(in) :: node_body(:)      !! (nodes) body of each node, 0 for none
      logical, intent(in) :: summed(:)         !! (components) directions with a sum per body
      real(dp), intent(in) :: scale            !! largest rate or force of the increment
      real(dp) :: relative                     !! relative imbalance
      real(dp) :: total(0:maxval(node_body), size(summed)), applied, reaction
      integer :: c, components, i, node

      components = size(summed)
      total = 0.0_dp
      relative = 0.0_dp
      do node = 1, size(node_body)
         do c = 1, components
            i = components*(node - 1) + c
            applied = internal(i) - residual(i)
            reaction = merge(residual(i), 0.0_dp, supported(i))
            total(node_body(node), c) = total(node_body(node), c) + applied + reaction
            if (.not. supported(i)) relative = max(relative, abs(residual(i)))
         end do
      end do
      do c = 1, components
         if (summed(c)) relative = max(relative, maxval(abs(total(:, c))))
      end do
      if (scale > 0.0_dp) relative = relative/scale
   end function imbalance

   !> Largest violation of the contact conditions (1.6) by gaps and tractions computed afresh from
   !> the recovered displacements, relative to the largest displacement and force. Where a row is
   !> supported on one body, the traction is taken from the other; where on both, the reduced
   !> system's is.
   pure function contact_violation(positions, residual, supported, points, state, friction, &
      scales) result(violation)
      !> (2, m) gaps, 0 where an interface is removed, and tangential positions by these
      !> displacements [length]
      real(dp), intent(in) :: positions(:, :)
      !> (2 nodes) as from force_residual, without the forces of ties [force]
      real(dp), intent(in) :: residual(:)
      logical, intent(in) :: supported(:)            !! (2 nodes) prescribed rows
      type(all_contact_points_type), intent(in) :: points
      type(contact_state_type), intent(in) :: state  !! the state that is checked
      !> (m) of nodal forces, none where the tangent is no unknown
      type(friction_law_type), intent(in) :: friction(:)
      type(scales_type), intent(in) :: scales
      real(dp) :: violation                          !! relative
      real(dp) :: force(2), gap, normal_force, shear_force, slip, cone
      integer :: c, k, slave_dof, master_dof

      violation = 0.0_dp
      do k = 1, size(points%slave)
         ! A node may be in several contact points: what they leave over goes to each of them.
         force = state%shear_force(k)*points%tangent(:, k) - state%force(k)*points%normal(:, k)
         do c = 1, 2
            slave_dof = 2*points%slave(k) - 2 + c
            master_dof = 2*points%master(k) - 2 + c
            if (.not. supported(slave_dof)) then
               force(c) = force(c) + residual(slave_dof)
            else if (.not. supported(master_dof)) then
               force(c) = force(c) - residual(master_dof)
            end if
         end do
         gap = positions(1, k)/scales%length
         slip = (positions(2, k) - state%reference(k))/scales%length
         normal_force = -dot_product(force, points%normal(:, k))/scales%force
         shear_force = dot_product(force, points%tangent(:, k))/scales%force
         cone = friction_bound(friction(k)%coefficient, friction(k)%largest_shear, &
            normal_force*scales%force)/scales%force
         if (state%contact_state(k) == contact_open) then
            violation = max(violation, -gap, abs(normal_force), abs(shear_force))
            cycle
         end if
         violation = max(violation, abs(gap), -normal_force)
         if (friction(k)%coefficient <= 0.0_dp) cycle
         if (state%contact_state(k) == contact_slip) then
            violation = max(violation, abs(abs(shear_force) - cone))
            violation = max(violation, min(slip*sign(1.0_dp, shear_force), abs(shear_force)))
         end if
         if (state%contact_state(k) == contact_stick) then
            violation = max(violation, abs(shear_force) - cone, abs(slip))
         end if
      end do
   end function contact_violation

end module balances
