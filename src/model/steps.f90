!> Steps of a model: analysis, increments, loads and supports, output requests.
module steps
   use contact_definitions, only: contact_changes_type
   use controls, only: continuation_type, fixed_point_type, implicit_scheme, start_type, &
      thermal_scheme_type
   use kinds, only: dp
   use print_requests, only: print_request_type, time_points_type
   implicit none
   private
   public :: step_type, step_controls_type, boundary_type, load_type, load_kind_count, load_force, &
      load_pressure, load_traction, load_body_force, load_gravity, load_centrifugal, &
      centrifugal_round, load_nodal_heat, load_face_heat, load_body_heat, load_film_coefficient, &
      load_film_sink, load_temperature, acts_on_nodes, loaded_side, analysis_static, &
      analysis_coupled, analysis_heat, dof_temperature, solves_heat, solves_mechanics, &
      adapts_increments, cycle_type, until_strain, until_displacement, until_force, &
      least_increment, smallest_part, increment_growth, planned_increments

   integer, parameter :: analysis_static = 1    !! *STATIC: mechanics at given temperatures
   integer, parameter :: analysis_coupled = 2   !! *COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE
   integer, parameter :: analysis_heat = 3      !! *HEAT TRANSFER, STEADY STATE: gaps stay
   integer, parameter :: dof_temperature = 11   !! degree of freedom 11; 1 and 2 are u_x and u_y

   ! Kinds of loads; behind each its item and component, and the unit of its value. A force or heat
   ! that a node has from another one, which ORDER=1 dropped, has a component above 2, odd and even
   ! as before: it is a location of its own.
   integer, parameter :: load_force = 1             !! node, dof 1 or 2 [force]
   integer, parameter :: load_pressure = 2          !! element, face; towards the body [stress]
   integer, parameter :: load_traction = 3          !! element, 2*(face - 1) + direction [stress]
   integer, parameter :: load_body_force = 4        !! element, direction [force/volume]
   integer, parameter :: load_gravity = 5           !! element, direction [force/mass]
   !> Element; 1 and 2: forces along x and y of a plane that turns round the origin, value the
   !> speed squared; 3 and 4: of its offset from there, value the speed squared times the offset;
   !> centrifugal_round: of a body of revolution [1/time^2, length/time^2]
   integer, parameter :: load_centrifugal = 6
   integer, parameter :: centrifugal_round = 5
   integer, parameter :: load_nodal_heat = 7        !! node, 1; into the body [power]
   integer, parameter :: load_face_heat = 8         !! element, face; into it [power/area]
   integer, parameter :: load_body_heat = 9         !! element, 1 [power/volume]
   integer, parameter :: load_film_coefficient = 10 !! element, face; K_h
   integer, parameter :: load_film_sink = 11        !! element, face; T_h [temperature]
   integer, parameter :: load_temperature = 12      !! node, 1; *TEMPERATURE of a step without heat
   integer, parameter :: load_kind_count = 12       !! number of kinds

   !> Least increment as a part of the period; shorter ones are lost in the rounding of the times.
   real(dp), parameter :: least_increment = 1.0e-9_dp
   !> Smallest increment that steps have by default, as part of their period; in *VISCO, where
   !> stress may relax at once, of the first one
   real(dp), parameter :: smallest_part = 1.0e-5_dp

   real(dp), parameter :: increment_growth = 1.5_dp   !! of increments that grow, as in CalculiX
   real(dp), parameter :: remainder = 1.0e-6_dp       !! of an increment: belongs to the one before

   !> A load on one location, valid from this step on. The loads of a step on one location are added
   !> up.
   type :: load_type
      integer :: kind = 0           !! one of the load_* constants
      integer :: item = 0           !! node or element index
      integer :: component = 1      !! as said at the kind
      real(dp) :: value = 0.0_dp    !! value at the end of the step, or factor of the amplitude
      integer :: amplitude = 0     !! index into model%amplitudes, 0 for the step's own time history
      integer :: card = 0           !! running number of the load's data card, over all steps
   end type load_type

   !> A prescribed displacement or temperature of one node, valid from this step on.
   type :: boundary_type
      integer :: node = 0           !! node index
      integer :: dof = 0            !! 1, 2 or dof_temperature
      real(dp) :: value = 0.0_dp    !! value at the end of the step, before the amplitude
      integer :: amplitude = 0     !! index into model%amplitudes, 0 for the step's own time history
      integer :: card = 0           !! running number of the *BOUNDARY data card, over all steps
      logical :: keeps = .false.    !! FIXED: the value at the start of the step, in place of value
   end type boundary_type

   !> Controls of a step that last until a later one changes them.
   type :: step_controls_type
      type(fixed_point_type) :: fixed_point                  !! fixed point of this step
      type(start_type) :: start                              !! where its fixed point starts
      type(thermal_scheme_type) :: scheme = implicit_scheme  !! scheme of eq. (3.4) of this step
      integer :: restart_frequency = 0       !! states at every n-th increment and the last; 0 none
      real(dp) :: wear_count = 1.0_dp        !! how often its slip counts as wear
      logical :: overlays_restarts = .false. !! whether only the last one of each step is kept
   end type step_controls_type

   ! What *CYCLE waits for, by UNTIL=.
   integer, parameter :: until_strain = 1         !! inelastic strains
   integer, parameter :: until_displacement = 2
   integer, parameter :: until_force = 3          !! forces of the contact points

   !> *CYCLE, of a step with which a cycle ends.
   type :: cycle_type
      integer :: steps = 0                        !! steps of a cycle; 0: none ends with the step
      integer :: last = 0                         !! last step of the last cycle
      integer :: until = until_strain
      real(dp) :: tolerance = 1.0e-6_dp           !! change that is none
   end type cycle_type

   !> One *STEP. Loads are those that its own cards give; what earlier steps gave stays (OP=MOD).
   type, extends(step_controls_type) :: step_type
      integer :: analysis = analysis_static          !! one of the analysis_* constants
      logical :: is_transient = .false.              !! heat is stored: no STEADY STATE
      !> Part of the range of temperatures that an increment of a transient may err by.
      real(dp) :: local_error = 1.0e-3_dp
      type(cycle_type) :: cycle
      logical :: is_viscous = .false.                !! *VISCO: mechanics in real time
      logical :: creeps = .false.                    !! whether materials creep in it
      !> CETOL=, of the creep strains in an increment by the rates of its stages
      real(dp) :: creep_tolerance = huge(1.0_dp)
      logical :: dilates = .false.                   !! DILATATION=YES
      !> STRAIN LIMIT=, of the growth of plastic strains in an increment
      real(dp) :: strain_limit = 0.01_dp
      !> *STABILITY at every n-th increment and the last; 0 never
      integer :: stability_frequency = 0
      integer :: stability_modes = 3                 !! MODES=, leading motions that are told
      real(dp) :: largest_change = huge(1.0_dp)      !! DELTMX=, of a temperature in an increment
      type(continuation_type) :: continuation = continuation_type()
      integer :: max_increments = 100                !! INC=
      logical :: ramped = .true.                     !! loads ramp over the step; else whole at once
      logical :: direct = .false.                    !! DIRECT
      logical :: grows = .false.                     !! increments grow up to the largest
      logical :: nlgeom = .false.                    !! large displacements are asked for
      real(dp) :: first_increment = 1.0_dp           !! size of the increments [time]
      real(dp) :: period = 1.0_dp                    !! length of the step [time]
      real(dp) :: smallest_increment = smallest_part !! >= least_increment of the period [time]
      real(dp) :: largest_increment = 1.0_dp         !! largest increment [time]
      type(boundary_type), allocatable :: boundaries(:)      !! prescribed values
      type(load_type), allocatable :: loads(:)               !! loads that the step gives
      !> Kinds of loads whose former ones end with this step (OP=NEW).
      logical :: ends_loads(load_kind_count) = .false.
      logical :: ends_boundaries = .false.   !! *BOUNDARY, OP=NEW: former prescribed values end
      type(contact_changes_type) :: changes                  !! what it changes of contact
      integer :: field_frequency = 1                 !! fields at every n-th increment and the last
      type(time_points_type) :: field_points         !! and at these instants
      integer :: contact_print_frequency = 0         !! *CONTACT PRINT likewise; 0 never
      type(time_points_type) :: contact_print_points
      type(print_request_type), allocatable :: node_prints(:)     !! *NODE PRINT; or unallocated
      type(print_request_type), allocatable :: element_prints(:)  !! *EL PRINT; or unallocated
   end type step_type

contains

   !> Number of increments of a step that is neither cut back nor lands on an instant.
   elemental function planned_increments(step) result(planned)
      type(step_type), intent(in) :: step
      real(dp) :: planned                   !! not rounded where the increments are fixed
      real(dp) :: time, increment

      planned = step%period/step%first_increment
      if (.not. step%grows) return
      planned = 0.0_dp
      time = 0.0_dp
      increment = step%first_increment
      do while (increment < step%largest_increment .and. time < step%period - remainder*increment)
         planned = planned + 1.0_dp
         time = time + increment
         increment = min(increment_growth*increment, step%largest_increment)
      end do
      planned = planned + ceiling(max((step%period - time)/increment - remainder, 0.0_dp))
   end function planned_increments

   !> Whether the increments of a step follow the error that they make in time.
   elemental logical function adapts_increments(step)
      type(step_type), intent(in) :: step

      adapts_increments = (step%is_transient .or. step%is_viscous .and. step%scheme%stages == 2) &
         .and. .not. step%direct
   end function adapts_increments

   !> Whether the item of a kind of load is a node.
   elemental logical function acts_on_nodes(kind)
      integer, intent(in) :: kind            !! one of the load_* constants

      acts_on_nodes = any(kind == [load_force, load_nodal_heat, load_temperature])
   end function acts_on_nodes

   !> The side of its element that a load acts on; 0 for a load on a node or a whole element.
   elemental integer function loaded_side(kind, component)
      integer, intent(in) :: kind            !! one of the load_* constants
      integer, intent(in) :: component       !! as said at the kind

      select case (kind)
      case (load_pressure, load_face_heat, load_film_coefficient, load_film_sink)
         loaded_side = component
      case (load_traction)
         loaded_side = (component + 1)/2
      case default
         loaded_side = 0
      end select
   end function loaded_side

   !> Whether an analysis solves heat.
   elemental function solves_heat(analysis) result(heat)
      integer, intent(in) :: analysis   !! one of the analysis_* constants
      logical :: heat                   !! temperatures are unknown

      heat = analysis /= analysis_static
   end function solves_heat

   !> Whether an analysis solves mechanics.
   elemental function solves_mechanics(analysis) result(mechanics)
      integer, intent(in) :: analysis   !! one of the analysis_* constants
      logical :: mechanics              !! displacements are unknown

      mechanics = analysis /= analysis_heat
   end function solves_mechanics

end module steps
