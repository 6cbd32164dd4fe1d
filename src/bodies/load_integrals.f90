!> Nodal forces, heat rates and film matrices of a unit load on one location.
module load_integrals
   use element_integrals, only: body_moments, body_weights, side_mass, side_pressure, side_weights
   use element_kinds, only: axisymmetric, element_node_count, side_nodes
   use kinds, only: dp
   use model, only: model_type
   use steps, only: load_body_force, load_body_heat, load_centrifugal, load_face_heat, load_force, &
      load_gravity, load_nodal_heat, load_pressure, load_traction
   implicit none
   private
   public :: unit_forces, unit_heat, film_side

contains

   !> Nodal forces of a unit load; none of a load that is not mechanical.
   pure subroutine unit_forces(model, kind, item, component, nodes, forces)
      type(model_type), intent(in) :: model
      integer, intent(in) :: kind                      !! load_* constant of steps
      integer, intent(in) :: item                      !! node or element index
      integer, intent(in) :: component                 !! as said at the kind
      integer, allocatable, intent(out) :: nodes(:)    !! (n) nodes with a force
      real(dp), allocatable, intent(out) :: forces(:, :) !! (2, n) [force per unit of the load]
      real(dp), allocatable :: x(:, :)

      select case (kind)
      case (load_force)
         nodes = [item]
         allocate (forces(2, 1), source=0.0_dp)
         forces(2 - mod(component, 2), 1) = 1.0_dp
      case (load_pressure)
         nodes = nodes_of_side(model, item, component)
         x = model%mesh%coordinates(:, nodes)
         forces = side_pressure(x, thickness(model, item), is_round(model, item))
      case (load_traction)
         nodes = nodes_of_side(model, item, (component + 1)/2)
         allocate (forces(2, size(nodes)), source=0.0_dp)
         x = model%mesh%coordinates(:, nodes)
         forces(2 - mod(component, 2), :) = side_weights(x, thickness(model, item), &
            is_round(model, item))
      case (load_body_force, load_gravity, load_centrifugal)
         nodes = nodes_of_element(model, item)
         allocate (forces(2, size(nodes)), source=0.0_dp)
         x = model%mesh%coordinates(:, nodes)
         associate (element_kind => model%mesh%element_kind(item))
            if (kind == load_centrifugal) then
               forces = turning_forces(element_kind, x, component, thickness(model, item), &
                  is_round(model, item))
            else
               forces(component, :) = body_weights(element_kind, x, thickness(model, item), &
                  is_round(model, item))
            end if
         end associate
         if (kind /= load_body_force) forces = density(model, item)*forces
      case default
         allocate (nodes(0), forces(2, 0))
      end select
   end subroutine unit_forces

   !> Nodal forces of one component of load_centrifugal, by the density.
   pure function turning_forces(kind, x, component, thickness, round) result(forces)
      integer, intent(in) :: kind, component
      real(dp), intent(in) :: x(:, :), thickness
      logical, intent(in) :: round
      real(dp) :: forces(2, element_node_count(kind))
      real(dp) :: moments(3, element_node_count(kind))

      moments = body_moments(kind, x, thickness, round)
      forces = 0.0_dp
      select case (component)
      case (1, 2)
         forces(component, :) = moments(component + 1, :)
      case (3, 4)
         forces(component - 2, :) = moments(1, :)
      case default
         forces(1, :) = moments(2, :)
      end select
   end function turning_forces

   !> Nodal heat rates of a unit load; none of a load that is no heat.
   pure subroutine unit_heat(model, kind, item, component, nodes, heat)
      type(model_type), intent(in) :: model
      integer, intent(in) :: kind                      !! load_* constant of steps
      integer, intent(in) :: item                      !! node or element index
      integer, intent(in) :: component                 !! as said at the kind
      integer, allocatable, intent(out) :: nodes(:)    !! (n) nodes with heat
      real(dp), allocatable, intent(out) :: heat(:)    !! (n) [power per unit of the load]

      select case (kind)
      case (load_nodal_heat)
         nodes = [item]
         heat = [1.0_dp]
      case (load_face_heat)
         nodes = nodes_of_side(model, item, component)
         heat = side_weights(model%mesh%coordinates(:, nodes), thickness(model, item), &
            is_round(model, item))
      case (load_body_heat)
         nodes = nodes_of_element(model, item)
         heat = body_weights(model%mesh%element_kind(item), model%mesh%coordinates(:, nodes), &
            thickness(model, item), is_round(model, item))
      case default
         allocate (nodes(0), heat(0))
      end select
   end subroutine unit_heat

   !> Integral of psi^p psi^q over a side with a unit film coefficient.
   pure subroutine film_side(model, element, side, nodes, mass)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element                   !! element index
      integer, intent(in) :: side                      !! its side
      integer, allocatable, intent(out) :: nodes(:)    !! (n) nodes of the side
      real(dp), allocatable, intent(out) :: mass(:, :) !! (n, n) [length^2]

      nodes = nodes_of_side(model, element, side)
      mass = side_mass(model%mesh%coordinates(:, nodes), thickness(model, element), &
         is_round(model, element))
   end subroutine film_side

   pure function nodes_of_side(model, element, side) result(nodes)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element, side
      integer, allocatable :: nodes(:)

      nodes = model%mesh%element_nodes(side_nodes(model%mesh%element_kind(element), side), element)
   end function nodes_of_side

   pure function nodes_of_element(model, element) result(nodes)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element
      integer, allocatable :: nodes(:)

      nodes = model%mesh%element_nodes( &
         :element_node_count(model%mesh%element_kind(element)), element)
   end function nodes_of_element

   pure function thickness(model, element) result(length)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element
      real(dp) :: length

      length = model%sections(model%mesh%element_section(element))%thickness
   end function thickness

   pure function density(model, element) result(mass)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element
      real(dp) :: mass

      mass = model%materials(model%sections(model%mesh%element_section(element))%material)%density
   end function density

   pure logical function is_round(model, element)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element

      is_round = model%mesh%element_plane(element) == axisymmetric
   end function is_round

end module load_integrals
