!> All loads and supports of a model at the present instant.
module loads
   use element_kinds, only: axisymmetric
   use kinds, only: dp
   use load_courses, only: load_course_type, step_clock_type
   use mesh, only: face_nodes
   use model, only: model_type
   use side_integrals, only: side_pressure
   use steps, only: dof_temperature, step_type
   implicit none
   private
   public :: loads_type

   !> Courses of the loads; displacements and forces by degree of freedom, temperatures by node,
   !> pressures by face.
   type :: loads_type
      type(load_course_type) :: displacement   !! (2 nodes) prescribed displacements [length]
      type(load_course_type) :: temperature    !! (nodes) prescribed temperatures [temperature]
      type(load_course_type) :: force          !! (2 nodes) nodal forces [force]
      type(load_course_type) :: pressure       !! (4 elements) pressures on faces [stress]
   contains
      procedure :: prepare
      procedure :: begin_step
      procedure :: move_to
      procedure :: nodal_forces
      procedure :: axis_value
   end type loads_type

contains

   !> Starts with nothing given: displacements, forces and pressures from zero, temperatures from
   !> the initial ones.
   pure subroutine prepare(self, model)
      class(loads_type), intent(inout) :: self   !! the loads
      type(model_type), intent(in) :: model      !! the model
      real(dp), allocatable :: zero(:)

      allocate (zero(2*size(model%mesh%node_number)), source=0.0_dp)
      call self%displacement%prepare(zero)
      call self%force%prepare(zero)
      call self%temperature%prepare(model%initial_temperature)
      deallocate (zero)
      allocate (zero(4*size(model%mesh%element_number)), source=0.0_dp)
      call self%pressure%prepare(zero)
   end subroutine prepare

   !> Takes over what the cards of a step give.
   pure subroutine begin_step(self, step)
      class(loads_type), intent(inout) :: self   !! the loads
      type(step_type), intent(in) :: step        !! the step
      integer :: i

      call self%displacement%begin_step()
      call self%temperature%begin_step()
      call self%force%begin_step()
      call self%pressure%begin_step()
      do i = 1, size(step%boundaries)
         associate (card => step%boundaries(i))
            if (card%dof == dof_temperature) then
               call self%temperature%give(card%node, card%value, card%amplitude, card%card)
            else
               call self%displacement%give(2*(card%node - 1) + card%dof, card%value, &
                  card%amplitude, card%card)
            end if
         end associate
      end do
      do i = 1, size(step%nodal_loads)
         associate (card => step%nodal_loads(i))
            call self%force%give(2*(card%node - 1) + card%dof, card%value, card%amplitude, 0)
         end associate
      end do
      do i = 1, size(step%face_loads)
         associate (card => step%face_loads(i))
            call self%pressure%give(4*(card%element - 1) + card%face, card%value, card%amplitude, 0)
         end associate
      end do
   end subroutine begin_step

   !> Moves everything to an instant.
   pure subroutine move_to(self, clock, model)
      class(loads_type), intent(inout) :: self    !! the loads
      type(step_clock_type), intent(in) :: clock  !! the instant
      type(model_type), intent(in) :: model       !! the model

      call self%displacement%move_to(clock, model%amplitudes)
      call self%temperature%move_to(clock, model%amplitudes)
      call self%force%move_to(clock, model%amplitudes)
      call self%pressure%move_to(clock, model%amplitudes)
   end subroutine move_to

   !> Applied nodal forces: concentrated ones and those of the pressures.
   pure function nodal_forces(self, model) result(forces)
      class(loads_type), intent(in) :: self       !! the loads
      type(model_type), intent(in) :: model       !! the model
      real(dp) :: forces(size(self%force%value))  !! (2 nodes) [force]
      real(dp) :: side(2, 3)
      integer :: i, element, nodes(3), q

      forces = self%force%value
      do i = 1, size(self%pressure%value)
         if (.not. self%pressure%active(i)) cycle
         element = (i - 1)/4 + 1
         nodes = model%mesh%element_nodes(face_nodes(:, i - 4*(element - 1)), element)
         side = self%pressure%value(i)*side_pressure(model%mesh%coordinates(:, nodes), &
            model%sections(model%mesh%element_section(element))%thickness, &
            model%mesh%element_plane(element) == axisymmetric)
         do q = 1, 3
            forces(2*nodes(q) - 1:2*nodes(q)) = forces(2*nodes(q) - 1:2*nodes(q)) + side(:, q)
         end do
      end do
   end function nodal_forces

   !> Value on the load axis: the prescribed value of LOAD=, or the time.
   pure function axis_value(self, model, time) result(value)
      class(loads_type), intent(in) :: self       !! the loads
      type(model_type), intent(in) :: model       !! the model
      real(dp), intent(in) :: time                !! total time [time]
      real(dp) :: value                           !! value on the load axis

      if (model%load_node == 0) then
         value = time
      else if (model%load_dof == dof_temperature) then
         value = self%temperature%value(model%load_node)
      else
         value = self%displacement%value(2*(model%load_node - 1) + model%load_dof)
      end if
   end function axis_value

end module loads
