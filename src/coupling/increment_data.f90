!> A trial solution of an increment: its data, its workspace, and the state at its end.
module increment_data
   use contact_system, only: closing_law_type, contact_state_type
   use contact_workspace, only: contact_workspace_type
   use controls, only: fixed_point_type, start_type
   use edge_heat, only: edge_integral_type, edge_heat_type
   use field_problem, only: field_load_type, solved_loads_type
   use fixed_point, only: pass_type
   use friction_heating, only: friction_heating_type
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use material_laws, only: law_interval_type
   use solution_report, only: solution_report_type
   use solution_state, only: solution_state_type
   use heat_equation, only: heat_equation_type
   use tail_factors, only: tail_factors_type
   use temperature_laws, only: face_temperatures_type
   implicit none
   private
   public :: contact_scales_type, increment_data_type, increment_workspace_type, load_rate_type, &
      stage_type, trial_type, of_heat, of_mechanics, inside_heat, inside_mechanics, load_places

   !> Places of known loads: those of the unknowns, and those inside of the pieces of bodies.
   integer, parameter :: of_heat = 1, of_mechanics = 2, inside_heat = 3, inside_mechanics = 4
   integer, parameter :: load_places = 4

   !> Largest values of an increment, by which gaps and pressures are small.
   type :: contact_scales_type
      real(dp) :: length = 0.0_dp   !! gap or displacement [length]
      real(dp) :: force = 0.0_dp    !! nodal force at its start [force]
   end type contact_scales_type

   !> Changes of loads with the load factor, to which loads of a branch are proportional.
   type :: load_rate_type
      real(dp), allocatable :: heat(:)    !! (thermal tail) condensed load of (3.4) [power]
      real(dp), allocatable :: force(:)   !! (mechanical tail) condensed load without jumps [force]
      !> (m) mean temperature of the faces without jumps, where laws vary with it
      real(dp), allocatable :: mean(:)
   end type load_rate_type

   !> Data that stay fixed while the increment is solved.
   type :: increment_data_type
      integer :: analysis = 0                        !! one of the analysis_* constants of steps
      type(start_type) :: start                      !! where its fixed point starts
      type(fixed_point_type) :: fixed_point          !! controls of its fixed point
      ! The next six are of the start of the increment, under the laws of its step.
      type(heat_equation_type) :: equation           !! eq. (3.4)
      type(contact_state_type) :: previous           !! contact state
      real(dp), allocatable :: omega_before(:)       !! (m) omega_(i-1)
      logical, allocatable :: resting(:)             !! (m) contact points that rest
      !> Whether the increment before solved heat by a scheme that keeps an imbalance for ever
      logical :: kept_imbalance = .false.
      type(edge_heat_type) :: edge   !! heat at edges; none where (3.4) takes past conductances
      type(friction_heating_type) :: friction        !! heat of friction, made as the trial found
      real(dp) :: size_ratio = 1.0_dp                !! dt_i/dt_(i-1), 1 in the first increment
      !> (m) omega*^0 where the increment was solved before with other corrections of its operators
      real(dp), allocatable :: omega_start(:)
      !> (m) laws of closing contact points that a solution on faces placed elsewhere had
      type(closing_law_type), allocatable :: closing_start(:)
      real(dp) :: same_slip = 0.0_dp        !! as contact_workspace_type has it [length]
      !> Norm of the rates of stored heat on the nodes at its start, 0 where it is not known [power]
      real(dp) :: stored_norm = 0.0_dp
      type(field_load_type) :: heat         !! load of (3.4)
      type(field_load_type) :: force        !! load of (2.4)
      real(dp), allocatable :: held_jump(:) !! (m) jump where both temperatures are prescribed
      real(dp), allocatable :: no_jump_load(:) !! (mechanical tail) condensed load without jumps
      real(dp) :: displacement_scale = 0.0_dp !! largest displacement of the last increment [length]
      !> (m) mean temperature of the faces without jumps, where conductance laws vary with it
      real(dp), allocatable :: welded_mean(:)
      type(contact_scales_type) :: scales            !! set where heat and mechanics are coupled
      !> (m) depth that faces lose for each pressure, where they wear [length/stress]
      real(dp), allocatable :: wear_by_pressure(:)
      logical :: is_corrected = .false.              !! whether its operators are, by its solution
      logical :: follows_branch = .false.            !! whether it is a point of a branch
      type(load_rate_type) :: rate                   !! set for passes on a branch
   end type increment_data_type

   !> A stage of an increment.
   type :: stage_type
      type(step_clock_type) :: clock = step_clock_type()   !! its end
      type(step_clock_type) :: of_increment = step_clock_type()   !! end of the increment
      real(dp) :: size = 0.0_dp                            !! from the end of the one before [time]
      real(dp) :: duration = 0.0_dp                        !! dt of its equations [time]
      type(law_interval_type) :: passing                   !! for the laws of materials
      logical :: strains = .true.                          !! whether equilibrium is solved
      logical :: begins_step = .false.                     !! whether its increment does
      logical :: stores_heat = .false.                     !! whether it is one of a transient
      real(dp), allocatable :: history(:)                  !! h* of the laws of materials, or none
      ! The next three of transients.
      real(dp), allocatable :: temperature(:)              !! (nodes) T* of its equation
      real(dp), allocatable :: displacement(:)             !! (2 nodes) u* likewise
      !> (nodes) heat contents likewise, where properties follow temperatures [energy]
      real(dp), allocatable :: content(:)
      real(dp), allocatable :: worked(:) !! (nodes) heat of inelastic work likewise [energy]
      real(dp), allocatable :: jump(:)   !! (nodes) of temperatures where the step begins
      !> (m) slip that counts as made before it; unallocated for none [length]
      real(dp), allocatable :: slip_before(:)
      logical :: dilates = .false.                         !! whether strains take up heat
      logical :: is_last = .true.                          !! whether the increment ends with it
   end type stage_type

   !> Workspace of a trial solution: all that its passes change, but the state.
   type :: increment_workspace_type
      type(friction_heating_type) :: friction        !! heat of friction; nothing allocated for none
      real(dp), allocatable :: supported(:) !! (nodes) what prescribed temperatures alone make
      type(tail_factors_type) :: tail                !! factors of (3.4) for the last omega*
      real(dp), allocatable :: on_tail(:)            !! (thermal tail) their last solution
      logical :: resolves_edge = .false.             !! whether heat is integrated to the edges
      type(edge_integral_type), allocatable :: edge_integrals(:)   !! of a pass
      type(edge_heat_type) :: edge                   !! heat at edges, also of the last omega*
      type(contact_workspace_type) :: contact        !! laws and factors of the contact
      type(contact_workspace_type) :: sticking           !! with all closed contact points holding
      type(pass_type) :: pass                        !! the last pass
      !> (m) temperatures of the faces that it found, where laws vary with them
      type(face_temperatures_type), allocatable :: faces(:)
      type(solution_report_type) :: record           !! what is told of the way to the solution
   contains
      procedure :: of_motions
   end type increment_workspace_type

   !> A trial solution. A procedure that reads only a part takes that part.
   type :: trial_type
      type(increment_data_type) :: data
      !> (load_places) loads that were solved, those of earlier increments too
      type(solved_loads_type), allocatable :: known(:)
      type(increment_workspace_type) :: workspace
      type(solution_state_type) :: next              !! guess and loads at its end; the solution
   contains
      procedure :: clear
      procedure :: begin_again
   end type trial_type

contains

   !> What small motions about the solution need of it.
   pure function of_motions(self) result(part)
      class(increment_workspace_type), intent(in) :: self
      type(increment_workspace_type) :: part   !! with graphs, faces, friction and contact alone

      if (allocated(self%pass%graph)) part%pass%graph = self%pass%graph
      if (allocated(self%faces)) part%faces = self%faces
      part%friction = self%friction
      part%contact = self%contact
   end function of_motions

   !> Leaves nothing but known loads and the state.
   pure subroutine clear(self)
      class(trial_type), intent(inout) :: self
      type(increment_data_type) :: data
      type(increment_workspace_type) :: workspace

      self%data = data
      self%workspace = workspace
   end subroutine clear

   !> Leaves, for a solution with other corrections, the contact that was found, its factors and
   !> known loads.
   pure subroutine begin_again(self, before)
      class(trial_type), intent(inout) :: self
      type(solution_state_type), intent(in) :: before   !! state at the start of the increment

      self%data%omega_start = self%next%omega
      self%next%contact%slip_origin = before%contact%slip_origin
      self%workspace%friction = friction_heating_type()
      self%workspace%edge = edge_heat_type()
      self%workspace%pass = pass_type()
      self%workspace%record = solution_report_type()
   end subroutine begin_again

end module increment_data
