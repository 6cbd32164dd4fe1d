!> What the quantities of an increment would be if the elements at the faces of interfaces and ties
!> were divided into four: the increment is solved on the divided mesh, from the displacements and
!> temperatures that the run had before it.
!>
!> It serves where the finer mesh cannot be relaxed (refinement_error): with mortar points and ties.
!> Only few elements are divided, so its factors take little.
module divided_faces
   use mesh_bodies, only: find_bodies
   use companion_steps, only: implicit_state, implicit_step
   use contact_states, only: contact_open
   use errors, only: error_type
   use heat_reduction, only: heat_reduction_type
   use increments, only: simulation_type
   use initial_state, only: make_initial_state
   use interface_quantities, only: quantities_of_state
   use kinds, only: dp
   use load_histories, only: end_of_step
   use local_refinement, only: choose_neighbours, elements_at_surfaces
   use mesh_division, only: divide, division_type
   use model, only: model_type
   use all_contact_points, only: all_contact_points_type
   use refinement, only: refine_chosen
   use solution_state, only: solution_state_type
   use steps, only: step_type
   implicit none
   private
   public :: divided_faces_type

   !> The divided model and its run, of which only the ends of steps are solved.
   type :: divided_faces_type
      private
      type(model_type) :: model
      type(division_type) :: division
      type(simulation_type) :: run
      type(solution_state_type) :: initial      !! state before the first increment
      !> heat of both meshes with the films at the end, where the runs' have others
      type(heat_reduction_type) :: heat, coarse_heat
   contains
      procedure :: start
      procedure :: begin_step
      procedure :: find_change
      procedure :: release
   end type divided_faces_type

contains

   !> Divides the elements, and prepares what solving increments takes of a run.
   !> Errors: as reduced_bodies' prepare.
   subroutine start(self, model, error)
      class(divided_faces_type), intent(inout) :: self    !! fresh
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical :: chosen(size(model%mesh%element_number))

      chosen = elements_at_surfaces(model%mesh, [model%contacts%slave, model%contacts%master, &
         model%ties%faces%slave, model%ties%faces%master])
      call choose_neighbours(model, chosen)
      self%division = divide(model%mesh, chosen)
      self%model = model
      call refine_chosen(self%model, chosen)
      call find_bodies(self%model%mesh)
      call self%run%bodies%prepare(self%model, error)
      if (allocated(error)) return
      call self%run%loads%prepare(self%model)
      call self%run%bodies%points%enter_step(self%model, 1)
      self%initial = make_initial_state(self%model, self%run%bodies)
      self%run%state = self%initial
   end subroutine start

   !> Enters a step as the run did.
   !> Errors: as simulation_type's enter_step.
   subroutine begin_step(self, step, before, error)
      class(divided_faces_type), intent(inout) :: self
      integer, intent(in) :: step
      type(solution_state_type), intent(in) :: before     !! the run's state before the step
      type(error_type), allocatable, intent(out) :: error

      call take_fields(self, before, self%run%state)
      if (step > self%run%control%step) call self%run%enter_step(self%model, error)
   end subroutine begin_step

   !> What the quantities of the interfaces change by, at the end of a step, in the equilibrium of
   !> heat on both meshes.
   !> Errors: as simulation_type's reduce, or the increment has no solution.
   subroutine find_change(self, simulation, model, previous, change, error)
      class(divided_faces_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation     !! the run at the end
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: previous   !! state before the last increment
      real(dp), intent(out) :: change(:, :)               !! (quantities, interfaces)
      type(error_type), allocatable, intent(out) :: error
      type(solution_state_type) :: before, next
      type(step_type) :: step
      real(dp) :: values(size(change, 1), size(change, 2))

      call self%run%reduce(self%model, error)
      if (allocated(error)) return
      call self%run%loads%move_to(end_of_step(model%steps, self%run%control%step), self%model)
      before = prolonged(self, simulation%bodies%points, previous)
      next = before
      next%increment_size = simulation%state%increment_size
      next%sources%load = self%run%loads%heat_load()
      next%sources%film = self%run%loads%film_matrix()
      next%force_load = self%run%loads%nodal_forces()
      step = implicit_step(model%steps(self%run%control%step))
      call implicit_state(self%run, self%heat, self%model, step, before, next, error)
      if (allocated(error)) return
      call quantities_of_state(self%run%bodies, next, change)
      next = simulation%state
      call implicit_state(simulation, self%coarse_heat, model, step, previous, next, error)
      if (allocated(error)) return
      call quantities_of_state(simulation%bodies, next, values)
      change = change - values
   end subroutine find_change

   !> Frees the factors.
   subroutine release(self)
      class(divided_faces_type), intent(inout) :: self

      call self%run%release()
      call self%heat%release()
      call self%coarse_heat%release()
   end subroutine release

   !> The fields of the run on the divided mesh.
   subroutine take_fields(self, state, divided)
      type(divided_faces_type), intent(in) :: self
      type(solution_state_type), intent(in) :: state
      type(solution_state_type), intent(inout) :: divided

      divided%temperature = self%division%prolong(state%temperature, 1)
      divided%displacement = self%division%prolong(state%displacement, 2)
   end subroutine take_fields

   !> The state of the run on the divided mesh: fields, and contact states of the nearest contact
   !> points; friction counts from the relative displacements of the fields.
   function prolonged(self, points, state) result(divided)
      type(divided_faces_type), intent(in) :: self
      type(all_contact_points_type), intent(in) :: points  !! of the run
      type(solution_state_type), intent(in) :: state
      type(solution_state_type) :: divided
      integer, allocatable :: nearest(:)

      divided = self%initial
      call take_fields(self, state, divided)
      if (.not. state%has_mechanics) return
      divided%has_mechanics = .true.
      divided%increment_size = state%increment_size
      associate (fine => self%run%bodies%points, contact => divided%contact)
         nearest = nearest_points(self, points)
         contact%contact_state = state%contact%contact_state(nearest)
         contact%direction = state%contact%direction(nearest)
         associate (relative => fine%relative(divided%displacement))
            contact%tangential = sum(fine%tangent*relative, dim=1)
            contact%approach = sum(fine%normal*relative, dim=1)
         end associate
         contact%reference = contact%tangential
         contact%slip_origin = contact%tangential
         contact%gap = merge(0.0_dp, max(0.0_dp, self%run%loads%present_gaps(fine) - &
            contact%approach), contact%contact_state /= contact_open)
         divided%omega = state%omega(nearest)
         divided%omega_before = divided%omega
         divided%jump = fine%jumps(divided%temperature)
      end associate
   end function prolonged

   !> The contact point of the run that is nearest to each one of the divided mesh.
   pure function nearest_points(self, points) result(nearest)
      type(divided_faces_type), intent(in) :: self
      type(all_contact_points_type), intent(in) :: points
      integer :: nearest(size(self%run%bodies%points%slave))
      integer :: first, i, k, last

      associate (row => self%run%bodies%points, x => self%model%mesh%coordinates)
         do i = 1, size(row%interface_start) - 1
            first = points%interface_start(i)
            last = points%interface_start(i + 1) - 1
            do k = row%interface_start(i), row%interface_start(i + 1) - 1
               nearest(k) = first - 1 + minloc(norm2(x(:, points%slave(first:last)) - &
                  spread(x(:, row%slave(k)), 2, last - first + 1), dim=1), dim=1)
            end do
         end do
      end associate
   end function nearest_points

end module divided_faces
