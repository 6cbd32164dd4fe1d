!> Record of one accepted increment: the only part of the solution that listing, results and
!> verification see.
module records
   use kinds, only: dp
   use field_recovery, only: error_record_type
   use sliding_limits, only: slide_type
   use solution_report, only: solution_report_type, work_record_type
   use state_tables, only: state_table_type
   use zone_edges, only: edges_kept
   implicit none
   private
   public :: increment_record_type, increment_outcome_type, contact_record_type, &
      field_record_type, element_points_record_type, stability_record_type, attempt_record_type, &
      uncertainty_type, body_uncertainty_type, add_attempts, note_failure

   !> Numerical uncertainty (95 %) of a number: how far it may be off to either side.
   type :: uncertainty_type
      real(dp) :: value = 0.0_dp             !! the number; NaN where there is none
      ! These are NaN where there is none.
      real(dp) :: total = 0.0_dp             !! the uncertainty: the sum of the next three
      real(dp) :: change = 0.0_dp            !! by the change on a finer mesh
      real(dp) :: scatter = 0.0_dp           !! by scatter over increments and places between nodes
      real(dp) :: iteration = 0.0_dp         !! by what the fixed point has left
      integer :: no_estimate = 0             !! why there is none, a reason of no_estimates
      !> What one finer mesh tells of a part of those that have none; 0 where it tells nothing
      real(dp) :: at_end = 0.0_dp
   end type uncertainty_type

   !> Those of a body; arrays over `maxima` of field_quantities.
   type :: body_uncertainty_type
      type(uncertainty_type), allocatable :: maxima(:)
      integer, allocatable :: node(:)          !! where they are, 0 where there is none
      !> Nodes at which stress may have no limit and round which it is larger
      integer, allocatable :: corners(:)
   end type body_uncertainty_type

   !> State of one contact interface; arrays over its contact points, in the order of
   !> contact_points_type.
   type :: contact_record_type
      integer, allocatable :: contact_state(:)        !! contact_open, contact_slip or contact_stick
      real(dp), allocatable :: gap(:)                  !! gamma >= 0 open [length]
      real(dp), allocatable :: pressure(:)             !! >= 0 in compression [stress]
      real(dp), allocatable :: shear(:)                !! on the slave, towards growing s [stress]
      real(dp), allocatable :: slip(:)                 !! of the slave since closing [length]
      !> along the tangent, of the slave against the master since the start [length]
      real(dp), allocatable :: movement(:)
      real(dp), allocatable :: smallest_gap(:)         !! smallest gamma so far [length]
      !> Whether nothing is opposite; unallocated where faces do not slide
      logical, allocatable :: is_beyond(:)
      !> Depth that each face has lost; unallocated where faces do not wear [length]
      real(dp), allocatable :: wear_slave(:), wear_master(:)
      real(dp) :: worn_volume(2) = 0.0_dp              !! of slave and master [length^3]
      type(slide_type) :: slide                        !! beyond what its contact points allow
      ! The next four are unallocated without heat.
      real(dp), allocatable :: conductance(:)          !! omega [power/(length^2 temperature)]
      real(dp), allocatable :: heat_flux(:)            !! slave to master [power/length^2]
      real(dp), allocatable :: slave_temperature(:)    !! [temperature]
      real(dp), allocatable :: master_temperature(:)   !! [temperature]
      real(dp) :: normal_force = 0.0_dp             !! sum over the contact points [stress length^2]
      real(dp) :: shear_force = 0.0_dp                 !! alike [stress length^2]
      real(dp) :: heat_rate = 0.0_dp                   !! heat from slave to master [power]
      real(dp) :: edge_contact = 0.0_dp                !! outer edge, zone with largest s; or NaN
      real(dp) :: edge_stick = 0.0_dp                  !! outer edge, widest stick zone; or NaN
      real(dp) :: edges_contact(edges_kept) = 0.0_dp   !! all edges as s, ascending, padded with NaN
      real(dp) :: edges_stick(edges_kept) = 0.0_dp     !! alike
   end type contact_record_type

   !> Fields over the nodes, and over the points where stress and flux are averaged per body and
   !> section.
   type :: field_record_type
      ! Displacement, stress and reaction are unallocated before mechanics is solved.
      real(dp), allocatable :: displacement(:, :)   !! (2, nodes) [length]
      real(dp), allocatable :: temperature(:)       !! (nodes) [temperature]
      real(dp), allocatable :: solid_fraction(:)    !! (nodes) [-]; unallocated where none melts
      !> (4, points) xx, yy, zz, xy; unallocated where nothing needs it, too [stress]
      real(dp), allocatable :: stress(:, :)
      !> (2, points) x, y; unallocated without heat and where nothing needs it [power/length^2]
      real(dp), allocatable :: heat_flux(:, :)
      real(dp), allocatable :: reaction(:, :)       !! (2, nodes) at supports, else 0 [force]
      !> (2, nodes) reaction and applied forces, without those of the contacts [force]
      real(dp), allocatable :: external_force(:, :)
      !> (nodes) heat that enters at prescribed temperatures; unallocated without heat [power]
      real(dp), allocatable :: reaction_heat(:)
      !> (nodes) the same with loads and films, without what crosses the contacts [power]
      real(dp), allocatable :: external_heat(:)
      !> (10, points) plastic strain xx, yy, zz, the angle xy and the equivalent one, then those of
      !> creep; unallocated without laws and where nothing needs it
      real(dp), allocatable :: inelastic_strain(:, :)
      ! Of the leading mode, where stability is analysed.
      real(dp), allocatable :: mode_temperature(:)      !! (nodes) the largest 1
      real(dp), allocatable :: mode_displacement(:, :)  !! (2, nodes) [length/temperature]
   end type field_record_type

   !> Integration points of the elements of a set (*EL PRINT), and their stress, heat flux and
   !> inelastic strains along x and y or the axes of the section's orientation.
   type :: element_points_record_type
      real(dp), allocatable :: position(:, :)     !! (2, points) x, y [length]
      type(field_record_type) :: fields
   end type element_points_record_type

   !> Small motions of a state in time.
   type :: stability_record_type
      logical :: is_known = .false.                 !! whether a leading mode was found
      integer :: unstable_modes = 0                 !! motions that grow
      real(dp) :: growth_rate = 0.0_dp              !! of it, negative: it decays [1/time]
      real(dp) :: period = 0.0_dp                   !! of its oscillation, 0 without one [time]
      !> (2, motions) both of the leading modes, the fastest first; unallocated where none was found
      real(dp), allocatable :: leading(:, :)
      character(:), allocatable :: doubt            !! why it is uncertain; unallocated: it is not
   contains
      procedure :: add_doubt
   end type stability_record_type

   !> An attempt at an increment that failed.
   type :: attempt_record_type
      real(dp) :: time = 0.0_dp              !! total time at which it would have ended [time]
      real(dp) :: increment_size = 0.0_dp    !! its size [time]
      character(:), allocatable :: reason    !! what failed
   end type attempt_record_type

   !> What the summary tells of an accepted increment.
   type, extends(solution_report_type) :: increment_outcome_type
      integer :: step = 0                    !! step number, from 1
      integer :: increment_in_step = 0       !! number in the step, from 1
      logical :: last_of_step = .false.      !! whether the step ends here
      integer :: left_out = 0                !! steps behind it that a *CYCLE leaves out
      real(dp) :: time = 0.0_dp              !! total time [time]
      real(dp) :: load = 0.0_dp              !! value on the load axis
      real(dp), allocatable :: load_factor   !! of a point of a branch; else unallocated [-]
      logical :: is_fold = .false.           !! whether the load factor turns there
      !> (2) when the last point became solid, and the increment in which it did, or none [time]
      real(dp), allocatable :: solid_time(:)
      real(dp) :: heat_in = 0.0_dp           !! sum of the net rates that are positive [power]
      real(dp) :: heat_out = 0.0_dp          !! magnitude of the sum of the negative ones [power]
      character(:), allocatable :: cycle     !! what a cycle did that it ends; unallocated for none
      character(:), allocatable :: many_increments   !! of a step that it ends, why; or unallocated
      !> (2, bodies) largest equivalent plastic and creep strain; unallocated without laws
      real(dp), allocatable :: inelastic_strain(:, :)
      !> (sections) across pre-tension sections; unallocated before mechanics is solved [force]
      real(dp), allocatable :: pre_tension(:)
      real(dp), allocatable :: pre_tension_uncertainties(:)          !! (sections) likewise
      real(dp) :: heat_friction = 0.0_dp     !! made by friction; NaN without it [power]
      type(contact_record_type), allocatable :: contacts(:)     !! one an interface
      !> (quantities, interfaces) of `estimated` of contact_quantities, at the end of a step, with
      !> ERRORS=FULL of any increment; else unallocated
      type(uncertainty_type), allocatable :: uncertainties(:, :)
      type(body_uncertainty_type), allocatable :: body_uncertainties(:)   !! (bodies) likewise
      !> With ERRORS=FULL of `history_estimated` of increment_quantities; else unallocated
      type(uncertainty_type), allocatable :: history_uncertainties(:)
      type(stability_record_type), allocatable :: stability   !! where *STABILITY is due
   end type increment_outcome_type

   !> One accepted increment.
   type, extends(increment_outcome_type) :: increment_record_type
      !> Of a transient: error in time over the range of temperatures, and largest change of one.
      real(dp) :: local_error = 0.0_dp, largest_change = 0.0_dp
      !> Of two stages: error of inelastic strains over the largest elastic one, and largest
      !> difference of creep strains by their rates
      real(dp) :: strain_error = 0.0_dp, creep_difference = 0.0_dp
      real(dp) :: strain_growth(2) = 0.0_dp  !! largest of equivalent plastic and creep strain [-]
      !> Stored, dissipated by plasticity, by creep, by friction, work of loads; unallocated without
      !> laws, and where mechanics is not solved [energy]
      real(dp), allocatable :: energies(:)
      logical :: makes_range = .false.       !! whether the range is mostly what it makes itself
      real(dp) :: useful_increment = 0.0_dp  !! shorter ones overshoot beside a jump [time]
      real(dp) :: heat_stored = 0.0_dp       !! by heat capacities; NaN in a steady step [power]
      real(dp) :: heat_dilatation = 0.0_dp   !! by strains; NaN without DILATATION [power]
      !> Work of friction less that of the drive, over the former, where faces slide and are heated
      real(dp), allocatable :: drive_excess
      real(dp) :: slip_part = 0.0_dp         !! largest slip of a contact point over its spacing
      real(dp) :: heat_imbalance = 0.0_dp    !! of (3.4), relative to the largest rate
      !> Of (3.3) at the end of the increment, relative to the largest rate.
      real(dp) :: heat_imbalance_pointwise = 0.0_dp
      real(dp) :: force_imbalance = 0.0_dp   !! relative to the largest force; NaN where kept
      !> Largest violation of the contact conditions by the recovered displacements, relative; NaN
      !> where they are kept.
      real(dp) :: contact_violation = 0.0_dp
      !> (6, reference nodes of sections) degrees of freedom 3 to 5 and the external forces on them;
      !> unallocated likewise [length], [-], [force], [force length]
      real(dp), allocatable :: along_z(:, :)
      integer :: cut_backs = 0               !! attempts at it that failed before
      !> Solutions that properties over temperature or the heat of strains asked for; 0 without them
      integer :: corrections = 0
      logical :: has_new_operators = .false. !! whether they were formed again
      type(attempt_record_type), allocatable :: failed(:)       !! these; unallocated for none
      type(field_record_type) :: fields = field_record_type()   !! fields
      type(uncertainty_type), allocatable :: check_uncertainties(:)  !! (*VERIFY cards) likewise
      !> With ERRORS=FULL of displacements and temperatures, for *NODE PRINT; else unallocated
      type(field_record_type), allocatable :: field_uncertainties
      !> (3, *NODE PRINT cards) of the sums of RF1, RF2 and RFL, likewise
      real(dp), allocatable :: total_uncertainties(:, :)
      type(contact_record_type), allocatable :: contact_uncertainties(:)   !! for *CONTACT PRINT
      !> Unallocated where the stress is.
      type(error_record_type) :: stress_error = error_record_type()
      !> Unallocated where the heat flux is.
      type(error_record_type) :: heat_flux_error = error_record_type()
      !> One an *EL PRINT of the step, empty where its table is not due; unallocated for none.
      type(element_points_record_type), allocatable :: element_points(:)
      !> Where a restart is due: what the run needs to go on from here
      type(state_table_type), allocatable :: restart
   end type increment_record_type

contains

   !> Adds a reason for which small motions are uncertain.
   pure subroutine add_doubt(self, reason)
      class(stability_record_type), intent(inout) :: self
      character(*), intent(in) :: reason           !! a clause

      if (allocated(self%doubt)) then
         self%doubt = self%doubt//'; '//reason
      else
         self%doubt = reason
      end if
   end subroutine add_doubt

   !> Puts the attempts at an increment that failed, with their passes and their work, before those
   !> of the last one.
   pure subroutine add_attempts(before, record)
      type(increment_record_type), intent(in) :: before      !! what came of the attempts before
      type(increment_record_type), intent(inout) :: record   !! what came of the last one

      if (allocated(record%iterations)) record%iterations%cut_backs = record%cut_backs
      if (allocated(before%failed)) record%failed = before%failed
      if (allocated(before%iterations)) then
         if (allocated(record%iterations)) then
            record%iterations = [before%iterations, record%iterations]
         else
            record%iterations = before%iterations
         end if
      end if
      record%work = work_record_type(record%work%columns_again + before%work%columns_again, &
         record%work%columns_full + before%work%columns_full, record%work%flops_again + &
         before%work%flops_again, record%work%flops_full + before%work%flops_full)
   end subroutine add_attempts

   !> Notes that the last attempt at an increment failed.
   pure subroutine note_failure(record, increment_size, reason)
      type(increment_record_type), intent(inout) :: record
      real(dp), intent(in) :: increment_size                 !! size of the attempt [time]
      character(*), intent(in) :: reason                     !! what failed
      type(attempt_record_type) :: attempt

      attempt%time = record%time
      attempt%increment_size = increment_size
      attempt%reason = reason
      if (.not. allocated(record%failed)) allocate (record%failed(0))
      record%failed = [record%failed, attempt]
   end subroutine note_failure

end module records
