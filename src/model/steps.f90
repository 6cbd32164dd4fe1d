!> Steps of a model: analysis, increments, loads and supports, output requests.
module steps
   use controls, only: fixed_point_type, thermal_scheme_type, implicit_scheme
   use kinds, only: dp
   implicit none
   private
   public :: step_type, boundary_type, nodal_load_type, face_load_type
   public :: analysis_static, analysis_coupled, dof_temperature

   integer, parameter :: analysis_static = 1    !! *STATIC: mechanics at given temperatures
   integer, parameter :: analysis_coupled = 2   !! *COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE
   integer, parameter :: dof_temperature = 11   !! degree of freedom 11; 1 and 2 are u_x and u_y

   !> A prescribed displacement or temperature of one node, valid from this step on.
   type :: boundary_type
      integer :: node = 0           !! node index
      integer :: dof = 0            !! 1, 2 or dof_temperature
      real(dp) :: value = 0.0_dp    !! value at the end of the step, before the amplitude
      integer :: amplitude = 0      !! index into model%amplitudes, 0 for the step's own course
      integer :: card = 0           !! running number of the *BOUNDARY data card, over all steps
   end type boundary_type

   !> A force on one node (*CLOAD).
   type :: nodal_load_type
      integer :: node = 0           !! node index
      integer :: dof = 0            !! 1 or 2
      real(dp) :: value = 0.0_dp    !! force [stress length thickness]
      integer :: amplitude = 0      !! index into model%amplitudes, 0 for the step's own course
   end type nodal_load_type

   !> A pressure on one element face (*DLOAD, Pn).
   type :: face_load_type
      integer :: element = 0        !! element index
      integer :: face = 0           !! 1..4
      real(dp) :: value = 0.0_dp    !! pressure, positive towards the body [stress]
      integer :: amplitude = 0      !! index into model%amplitudes, 0 for the step's own course
   end type face_load_type

   !> One *STEP. Loads are those that its own cards give; what earlier steps gave stays (OP=MOD).
   type :: step_type
      integer :: analysis = analysis_static          !! one of the analysis_* constants
      integer :: max_increments = 100                !! INC=
      logical :: ramped = .true.                     !! loads ramp over the step; else whole at once
      logical :: direct = .false.                    !! DIRECT
      real(dp) :: first_increment = 1.0_dp           !! size of the increments [time]
      real(dp) :: period = 1.0_dp                    !! length of the step [time]
      real(dp) :: smallest_increment = 1.0e-5_dp     !! smallest increment [time]
      real(dp) :: largest_increment = 1.0_dp         !! largest increment [time]
      type(boundary_type), allocatable :: boundaries(:)      !! prescribed values
      type(nodal_load_type), allocatable :: nodal_loads(:)   !! forces
      type(face_load_type), allocatable :: face_loads(:)     !! pressures
      type(fixed_point_type) :: fixed_point                  !! fixed point of this step
      type(thermal_scheme_type) :: scheme = implicit_scheme  !! scheme of eq. (3.4) of this step
      integer :: field_frequency = 1                 !! fields at every n-th increment and the last
      integer :: contact_print_frequency = 0         !! *CONTACT PRINT likewise; 0 never
   end type step_type

end module steps
