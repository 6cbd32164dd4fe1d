!> Description of a reported quantity besides its value: an entry of the tables in src/records,
!> which hold the quantities themselves.
module quantity_types
   use kinds, only: dp
   use text, only: to_upper
   implicit none
   private
   public :: quantity_type, find_quantity, of_history, of_bodies, of_passes, of_interface, &
      of_contact_points, of_nodes, of_points, of_elements, of_sections, of_references, of_motions, &
      needs_nothing, needs_temperature, needs_heat, needs_mechanics, needs_coupling, &
      needs_storage, needs_dilatation, needs_friction, needs_friction_heat, needs_wear, &
      needs_stability, needs_branch, needs_sections, needs_plasticity, needs_creep, needs_laws, &
      needs_references, needs_melting, last_need

   integer, parameter :: name_length = 25

   ! Where a quantity has its numbers; each is a group of the result file, but for the nodes.
   integer, parameter :: of_history = 1     !! an increment: /history
   integer, parameter :: of_bodies = 2      !! an increment and body, its errors: /history
   integer, parameter :: of_passes = 3      !! a pass of the fixed point: /convergence
   integer, parameter :: of_interface = 4   !! an increment and interface: /contact/<name>
   integer, parameter :: of_contact_points = 5 !! an increment and contact point: /contact/<name>
   integer, parameter :: of_nodes = 6       !! an increment and node, of *VERIFY alone
   integer, parameter :: of_points = 7      !! an increment and point: /VTKHDF/PointData
   integer, parameter :: of_elements = 8    !! an increment and element: /VTKHDF/CellData
   integer, parameter :: of_sections = 9    !! an increment and pre-tension section: /history
   integer, parameter :: of_references = 10 !! an increment and REF NODE of a section: /history
   integer, parameter :: of_motions = 11    !! an analysis and leading motion: /stability

   ! Fields that a step must solve for a quantity to have a value; a deck none of whose steps does
   ! so has no dataset of it.
   integer, parameter :: needs_nothing = 0
   integer, parameter :: needs_temperature = 1   !! heat, or expansion at a given temperature
   integer, parameter :: needs_heat = 2
   integer, parameter :: needs_mechanics = 3
   integer, parameter :: needs_coupling = 4      !! both, and contact
   integer, parameter :: needs_storage = 5       !! a step that stores heat
   integer, parameter :: needs_dilatation = 6    !! DILATATION=YES
   integer, parameter :: needs_friction_heat = 7 !! heat, and *GAP HEAT GENERATION
   integer, parameter :: needs_stability = 8     !! *STABILITY: /stability in place of /history
   integer, parameter :: needs_branch = 9        !! *CONTINUATION
   integer, parameter :: needs_sections = 10     !! mechanics and *PRE-TENSION SECTION
   integer, parameter :: needs_plasticity = 11   !! mechanics and *PLASTIC
   integer, parameter :: needs_creep = 12        !! mechanics and *CREEP
   integer, parameter :: needs_laws = 13         !! one of both
   integer, parameter :: needs_references = 14   !! mechanics and generalized plane strain
   integer, parameter :: needs_wear = 15         !! mechanics and *WEAR
   integer, parameter :: needs_melting = 16      !! heat and *LATENT HEAT
   integer, parameter :: needs_friction = 17     !! one of both, or mechanics and friction
   integer, parameter :: last_need = needs_friction

   type :: quantity_type
      character(name_length) :: name           !! of its dataset, in *VERIFY and in tables of errors
      integer :: kind                          !! one of the of_* constants
      character(32) :: unit                    !! in those of the deck; '-' for a pure number
      integer :: needs = needs_nothing         !! one of the needs_* constants
      integer :: values = 1                    !! numbers of one increment, interface, point, ...
      !> Words before its value in the block of an increment of the listing; blank: not there.
      character(30) :: label = ''
      !> Head of its column in tables: the passes, the contact points, the rows of a trade; blank:
      !> no column. Of the maximum of a body its name in *VERIFY.
      character(14) :: head = ''
      integer :: width = 0                     !! characters of that column; in a trade it is fixed
      logical :: is_plain = .false.            !! no exponent there
      logical :: is_integer = .false.          !! has no values between two contact points either
      logical :: is_geometry = .false.         !! that of the undeformed mesh
      logical :: is_on_faces = .false.         !! also a field over the nodes of both faces
      logical :: is_published = .true.         !! in the result file and in *VERIFY
      logical :: is_estimated = .false.        !! it has an uncertainty, of an interface or body
      logical :: is_traded = .false.           !! rows of a trade are judged by it
      logical :: is_of_friction = .false.      !! 0 without friction
      !> Power of the spacing with which errors of the mesh are taken to fall (uncertainty_rule)
      real(dp) :: order = 0.8_dp
      !> Of an edge of a zone: how far it is known on a mesh, in spacings about it, of the contact
      !> points for contact, of the nodes for stick; of an instant, in its increment
      !> (uncertainty_rule); 0 for others.
      real(dp) :: resolution = 0.0_dp
      logical :: follows_path = .false.        !! with friction its errors build up along the path
      ! In the result file, as attributes of its dataset.
      character(120) :: description = ''       !! what it is, with its sign and codes
      character(80) :: components = ''         !! their names, where `values` have such
   end type quantity_type

contains

   !> Index of the quantity that a name means in any case; 0 for one that is not known.
   pure integer function find_quantity(list, name)
      type(quantity_type), intent(in) :: list(:)
      character(*), intent(in) :: name

      do find_quantity = size(list), 1, -1
         if (to_upper(trim(list(find_quantity)%name)) == to_upper(trim(name))) return
      end do
   end function find_quantity

end module quantity_types
