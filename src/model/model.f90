!> The model: all that the deck says. The deck builder makes it on the deck's mesh; `variations`
!> makes of it the models that are solved. It is read-only afterwards.
module model
   use accuracy_targets, only: accuracy_request_type
   use amplitudes, only: amplitude_type
   use errors, only: place_type
   use contact_definitions, only: brings_friction, contact_definition_type, interaction_type, &
      tie_definition_type
   use controls, only: solver_skyline, tail_by_size, tail_sparse
   use equations, only: coupling_type, equation_type
   use kinds, only: dp
   use load_requests, only: nodal_field_type, requests_type
   use materials, only: follows_temperature, material_type, orientation_type, section_type
   use mesh, only: mesh_type
   use steps, only: step_type
   use text, only: string_type, to_text, to_upper
   use transforms, only: partner_type, transform_type
   implicit none
   private
   public :: model_type, bar_type, refined_region_type, verify_type, unit_labels_type, &
      follows_temperatures, has_friction, has_sparse_tail, needs_full_tail, uncertainty_named

   ! ERRORS= of *OPTIONS: no uncertainties; those of the last increment of each step; of all.
   integer, parameter, public :: uncertainty_no = 0, uncertainty_last = 1, uncertainty_full = 2
   character(*), parameter, public :: uncertainty_words = 'NO/LAST/FULL/YES'

   integer, parameter :: most_at_once = 200   !! contact points that a full matrix is for

   !> Labels of the deck's units (*OPTIONS, UNITS=); empty when not given, the last three also
   !> beside the others.
   type :: unit_labels_type
      character(:), allocatable :: length        !! such as cm
      character(:), allocatable :: stress        !! such as MPa
      character(:), allocatable :: power         !! such as W
      character(:), allocatable :: temperature   !! such as C
      character(:), allocatable :: time          !! such as s
   end type unit_labels_type

   !> *PHYSICAL CONSTANTS.
   type :: physical_constants_type
      logical :: has_absolute_zero = .false.    !! whether it is given
      logical :: has_radiation = .false.        !! whether both are given
      real(dp) :: absolute_zero = 0.0_dp        !! [temperature]
      real(dp) :: stefan_boltzmann = 0.0_dp     !! [power/(length^2 temperature^4)]
   end type physical_constants_type

   !> One *VERIFY data card.
   type :: verify_type
      !> ANALYTIC, EXTERNAL, LEGACY, FIGURE, REGRESSION or NONE
      character(:), allocatable :: kind
      character(:), allocatable :: source     !! where the value comes from
      character(:), allocatable :: quantity   !! dataset or nodal quantity
      !> The value that the quantity reaches at the time that is expected; unallocated where its own
      !> value is [that of the quantity]
      real(dp), allocatable :: level
      character(:), allocatable :: where      !! as written; empty for /history
      logical :: at_last = .false.            !! LAST
      real(dp) :: when = 0.0_dp               !! total time, unless at_last [time]
      logical :: expects = .true.             !! whether a value is expected, or only asked for
      real(dp) :: value = 0.0_dp              !! expected value
      real(dp) :: tolerance = 0.0_dp          !! allowed deviation
      logical :: relative = .true.            !! REL, else ABS
      integer :: line = 0                     !! card number in the deck
      character(:), allocatable :: address    !! file and line, such as deck.inp:36
      integer :: columns(2) = 1               !! columns of quantity and where on that card
   contains
      procedure :: title => title_of_check
   end type verify_type

   !> A spring or a truss, which resists its elongation, a sum of displacements of its nodes; its
   !> force is stiffness*elongation less warm_force*temperature.
   type :: bar_type
      type(equation_type) :: elongation         !! its terms sum up to the elongation [length]
      type(equation_type) :: mean               !! those of the mean temperature
      real(dp) :: stiffness = 0.0_dp            !! of a truss E A/L [force/length]
      real(dp) :: warm_force = 0.0_dp           !! of a truss E A alpha [force/temperature]
      logical :: follows_axes = .false.         !! whether *TRANSFORM turns its displacements
   end type bar_type

   !> Where a model is refined locally, and how often.
   type :: refined_region_type
      integer :: levels = 0              !! number of divisions
      integer, allocatable :: surfaces(:) !! indexes into the mesh's surfaces; unallocated for a set
      integer :: set = 0                 !! index into its element sets
      real(dp) :: distance = 0.0_dp      !! DISTANCE=; 0 where it is not given [length]
      integer :: card = 0                !! card image of the *REFINE
   end type refined_region_type

   !> All that the deck says.
   type :: model_type
      character(:), allocatable :: heading                       !! first *HEADING line
      type(mesh_type) :: mesh                                    !! nodes, elements, sets, surfaces
      type(material_type), allocatable :: materials(:)           !! materials
      type(section_type), allocatable :: sections(:)             !! sections
      type(orientation_type), allocatable :: orientations(:)     !! axes of materials
      type(amplitude_type), allocatable :: amplitudes(:)         !! load curves
      type(interaction_type), allocatable :: interactions(:)     !! surface interactions
      type(contact_definition_type), allocatable :: contacts(:)  !! interfaces
      type(tie_definition_type), allocatable :: ties(:)          !! tied faces
      !> the deck's, then those of couplings and partners on the mesh
      type(equation_type), allocatable :: equations(:)
      integer :: deck_equations = 0                              !! how many are the deck's
      type(bar_type), allocatable :: bars(:)                     !! springs and trusses
      type(transform_type), allocatable :: transforms(:)         !! axes of nodes
      type(partner_type), allocatable :: partners(:)             !! what stands for these nodes
      !> kinematic couplings, then pre-tension sections
      type(coupling_type), allocatable :: couplings(:)
      real(dp), allocatable :: initial_temperature(:)            !! (nodes) [temperature]
      !> steps in their order, with the loads and supports on the mesh
      type(step_type), allocatable :: steps(:)
      type(requests_type), allocatable :: requests               !! loads and supports on any mesh
      type(nodal_field_type), allocatable :: fields(:)           !! *TEMPERATURE
      !> (data cards of *BOUNDARY, by their running numbers) where each is, in words
      type(string_type), allocatable :: boundary_places(:)
      type(verify_type), allocatable :: verifications(:)         !! *VERIFY cards
      type(unit_labels_type) :: units                            !! labels of units
      type(physical_constants_type) :: constants                 !! *PHYSICAL CONSTANTS
      integer :: solver = solver_skyline                         !! one of the solver_* constants
      logical :: has_solver_by_size = .false.                    !! whether its size chose it
      integer :: tail = tail_by_size                             !! one of the tail_* constants
      integer :: uncertainty = uncertainty_last !! one of the uncertainty_* constants
      type(accuracy_request_type) :: accuracy                    !! *ACCURACY
      real(dp) :: memory_needed = 0.0_dp                         !! estimate for a run [byte]
      integer :: written_levels = 0                              !! *REFINE, LEVELS=
      type(refined_region_type), allocatable :: regions(:)       !! *REFINE of surfaces and sets
      integer :: written_order = 2                               !! *OPTIONS, ORDER=
      type(place_type) :: order_place                            !! where it is in the deck
      integer :: refinement_levels = 0                           !! refinements that were made
      integer :: element_order = 2                               !! order that the elements have
      integer :: load_node = 0                                   !! LOAD=: node index, 0 for time
      integer :: load_dof = 0                                    !! LOAD=: 1, 2, dof_temperature
      character(:), allocatable :: load_label                    !! label of the load axis
      type(string_type), allocatable :: notes(:)                 !! defaults used, cards not needed
      type(string_type), allocatable :: warnings(:)              !! warnings, as printed
   end type model_type

contains

   !> What a check is about, as on its card.
   pure function title_of_check(self) result(title)
      class(verify_type), intent(in) :: self
      character(:), allocatable :: title   !! such as NT, or NT reaches 500

      title = trim(self%quantity)
      if (allocated(self%level)) title = title//' reaches '//to_text(self%level)
   end function title_of_check

   !> The constant that one of the uncertainty_words means, in any case; YES is LAST; -1 for none.
   pure integer function uncertainty_named(word) result(uncertainty)
      character(*), intent(in) :: word

      uncertainty = findloc(['NO  ', 'LAST', 'FULL', 'YES '], to_upper(word), dim=1) - 1
      if (uncertainty > uncertainty_full) uncertainty = uncertainty_last
   end function uncertainty_named

   !> Whether contact points may stick or slip, in some step at least.
   pure logical function has_friction(model)
      type(model_type), intent(in) :: model
      integer :: s

      has_friction = any(model%interactions(model%contacts%interaction)%friction%coefficient > &
         0.0_dp)
      if (size(model%contacts) > 0) has_friction = has_friction .or. &
         any([(brings_friction(model%steps(s)%changes), s=1, size(model%steps))])
   end function has_friction

   !> Whether properties of any body follow its temperatures.
   pure logical function follows_temperatures(model)
      type(model_type), intent(in) :: model

      ! A section of a deck with errors may have none.
      follows_temperatures = any(follows_temperature(model%materials(pack( &
         model%sections%material, model%sections%material > 0))))
   end function follows_temperatures

   !> Whether the contact unknowns are held sparsely, beside the faces of bodies that are reduced in
   !> pieces; else all of them in one full matrix, to which bodies are reduced as a whole. The full
   !> matrix costs less where it is small.
   pure logical function has_sparse_tail(model, points)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: points     !! number of contact points

      has_sparse_tail = model%tail == tail_sparse .or. (model%tail == tail_by_size .and. &
         model%mesh%body_count > 2 .and. points > most_at_once)
      has_sparse_tail = has_sparse_tail .and. points > 0.0_dp .and. .not. needs_full_tail(model)
   end function has_sparse_tail

   !> Whether a deck needs derivatives between all contact points, and with them the full matrix.
   pure logical function needs_full_tail(model)
      type(model_type), intent(in) :: model

      needs_full_tail = any(model%steps%continuation%is_on)
   end function needs_full_tail

end module model
