!> The contact points of all interfaces in one row, as the solution works on them, and beside them
!> the points of all ties, the nodes that hang and the equations of the deck; and the laws of all
!> contact points, made when a step begins.
module connections
   use conductance_laws, only: conductance_law_type, is_constant, varies_with_temperature
   use contact_definitions, only: is_removed, latest_friction, makes_friction_heat, pairing_nodes, &
      tie_definition_type
   use contact_pairs, only: make_contact_points, make_tie_points
   use contact_points, only: contact_points_type, contact_row_type, join_rows
   use element_kinds, only: side_node_count
   use equations, only: equation_type
   use errors, only: error_type
   use friction_laws, only: friction_heat_type, friction_law_type, unlimited
   use local_refinement, only: hanging_rows
   use kinds, only: dp
   use materials, only: strain_freedoms
   use mesh, only: mesh_type
   use model, only: model_type
   use mortar_segments, only: hat_geometry_type
   use overlap_laws, only: overlap_law_type
   use sliding_faces, only: place_points
   use sum_lists, only: sum_list_type
   use temperature_laws, only: face_temperatures_type, law_at, law_jumps
   use transforms, only: partner_type
   use wear_laws, only: wear_law_type
   implicit none
   private
   public :: connections_type, tie_points_type, match_surfaces, match_tie, join_points, &
      contact_laws_type, laws_of_step

   real(dp), parameter :: opposite = 1.0e-3_dp   !! offset of nodes face to face, of the side

   !> The points of all ties in one row.
   type, extends(contact_row_type) :: tie_points_type
      integer, allocatable :: tie(:)            !! (n) index into the model's ties
      logical, allocatable :: is_opposite(:)    !! (n) whether these two are face to face
      !> (n) whether it is a mortar point of a face without midside nodes
      logical, allocatable :: is_linear(:)
   end type tie_points_type

   !> The contact points of all interfaces in one row, and what else joins nodes.
   type, extends(contact_row_type) :: connections_type
      integer, allocatable :: interface_start(:)     !! (interfaces + 1) first contact point of each
      integer, allocatable :: interface(:)           !! (m) interface of each contact point
      !> (m, nodes) mean of both faces; no sums where no conductance law varies with the temperature
      type(sum_list_type) :: mean
      !> (n) contact points that friction may heat; unallocated without *GAP HEAT GENERATION
      integer, allocatable :: heated(:)
      type(sum_list_type) :: heat_shares   !! (n, nodes) parts of their heat that enter nodes
      !> (interfaces) whether heat is integrated to the edge of contact
      logical, allocatable :: resolves_edge(:)
      type(hat_geometry_type), allocatable :: mortar(:) !! (interfaces) their hat functions
      !> nodes of both faces of these interfaces; unallocated where there are none
      integer, allocatable :: edge_nodes(:)
      type(tie_points_type) :: ties                           !! points of the ties, no part of m
      type(sum_list_type) :: hanging                          !! hanging nodes, as in hanging_nodes
      type(equation_type), allocatable :: equations(:)        !! equations of the deck
      type(equation_type), allocatable :: elongations(:)      !! of springs and trusses
      type(partner_type), allocatable :: partners(:)          !! nodes with axes of their own
      !> degrees of freedom of the strains along z, which all elements of their sections have;
      !> unallocated where there are none
      integer, allocatable :: along_z(:)
   contains
      procedure :: vary_with_temperature
      procedure :: means
   end type connections_type

   !> The laws of the contact points of all interfaces.
   type :: contact_laws_type
      type(conductance_law_type), allocatable :: conductance(:)    !! (m) as the deck has them
      type(friction_law_type), allocatable :: friction(:)          !! (m) of tractions
      !> (m) the same of nodal forces, with the largest one for a shear; unlimited at contact points
      !> of weight 0, over which no traction acts
      type(friction_law_type), allocatable :: nodal_friction(:)
      !> (m) how faces overlap; unallocated where all are hard
      type(overlap_law_type), allocatable :: overlap(:)
      real(dp), allocatable :: reach(:)   !! (m) gap from which on they press [length]
      !> (m) whether the interface is removed, or no master is opposite: its contact points are open
      !> whatever their gaps, and have no conductance
      logical, allocatable :: removed(:)
      ! The next four are unallocated where no faces wear.
      type(wear_law_type), allocatable :: wear(:)         !! (m)
      real(dp), allocatable :: wear_share(:)              !! (m) the slave's part of the depth
      !> (m) part of the depth that is a change of the gap: what a master loses along which a slave
      !> slides by any distance stays where it was
      real(dp), allocatable :: worn_part(:)
      real(dp), allocatable :: wear_count                 !! how often slip counts
      !> (m) speed out of the plane; unallocated where no faces have one [length/time]
      real(dp), allocatable :: speed(:)
      !> (n) heat of friction of points%heated, and the friction that makes it where they slide out
      !> of the plane: in the plane these have none
      type(friction_heat_type), allocatable :: heat(:)
      type(friction_law_type), allocatable :: heating_friction(:)
   contains
      procedure :: conductance_at
   end type contact_laws_type

contains

   !> Matches the surfaces of one *CONTACT PAIR, with the thickness of the slave's first element, or
   !> places its contact points on the displaced ones where it follows sliding.
   !> Error: as make_contact_points and place_points.
   subroutine match_surfaces(model, i, points, error, displacement)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                            !! index into model%contacts
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error
      real(dp), intent(in), optional :: displacement(:)   !! (2 nodes), without it none [length]
      real(dp) :: thickness

      thickness = thickness_at(model, model%contacts(i)%slave)
      associate (contact => model%contacts(i))
         if (.not. contact%follows_sliding) then
            call make_contact_points(model%mesh, contact, thickness, points, error)
         else if (present(displacement)) then
            call place_points(model%mesh, contact, thickness, displacement, points, error)
         else
            call place_points(model%mesh, contact, thickness, spread(0.0_dp, 1, &
               2*size(model%mesh%node_number)), points, error)
         end if
      end associate
   end subroutine match_surfaces

   !> Matches the surfaces of one *TIE.
   !> Error: as make_tie_points.
   subroutine match_tie(model, i, points, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                            !! index into model%ties
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error

      call make_tie_points(model%mesh, model%ties(i), &
         thickness_at(model, model%ties(i)%faces%slave), points, error)
   end subroutine match_tie

   !> Thickness of a surface's first element.
   pure real(dp) function thickness_at(model, surface)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface

      thickness_at = 1.0_dp
      associate (faces => model%mesh%surfaces(surface)%faces)
         if (size(faces, 2) > 0) then
            thickness_at = model%sections(model%mesh%element_section(faces(1, 1)))%thickness
         end if
      end associate
   end function thickness_at

   !> Puts the contact points of all interfaces in one row, and those of all ties. The interfaces
   !> keep what the row does not have.
   pure subroutine join_points(interfaces, of_ties, model, row)
      type(contact_points_type), intent(inout) :: interfaces(:) !! in the order of the deck
      type(contact_points_type), intent(in) :: of_ties(:)    !! (ties) in the order of the deck
      type(model_type), intent(in) :: model
      type(connections_type), intent(out) :: row             !! all their contact points
      integer :: i, k

      call join_rows(interfaces%contact_row_type, row)
      row%interface_start = [1]
      do i = 1, size(interfaces)
         row%interface_start = [row%interface_start, row%interface_start(i) + &
            size(interfaces(i)%slave)]
      end do
      row%interface = [(spread(i, 1, size(interfaces(i)%slave)), i=1, size(interfaces))]
      if (any(varies_with_temperature(model%interactions(model%contacts%interaction)%law))) then
         call row%mean%reserve(0, 0)
         do i = 1, size(interfaces)
            associate (slave => interfaces(i)%slave_mean, master => interfaces(i)%master_mean)
               do k = 1, slave%count
                  call row%mean%add([slave%values_of(k), master%values_of(k)], &
                     0.5_dp*[slave%coefficients_of(k), master%coefficients_of(k)])
               end do
            end associate
         end do
      end if
      call share_heat(interfaces, model, row)
      row%ties = joined_ties(model%mesh, model%ties, of_ties)
      row%hanging = hanging_rows(model%mesh)
      allocate (row%equations(0), row%partners(0))
      if (allocated(model%partners)) row%partners = model%partners
      if (allocated(model%equations)) row%equations = model%equations
      allocate (row%elongations(0))
      if (allocated(model%bars)) row%elongations = model%bars%elongation
      row%mortar = interfaces%mortar
      if (any(model%sections%reference(1) > 0)) row%along_z = strain_freedoms(model%sections)
      call find_resolved_faces(model, row)
      do i = 1, size(interfaces)
         interfaces(i)%contact_row_type = contact_row_type()
         interfaces(i)%mortar = hat_geometry_type()
      end do
   end subroutine join_points

   !> Which contact points friction may heat, and how their heat enters the faces.
   pure subroutine share_heat(interfaces, model, row)
      type(contact_points_type), intent(in) :: interfaces(:)
      type(model_type), intent(in) :: model
      type(connections_type), intent(inout) :: row
      integer :: i, k

      if (.not. makes_friction_heat(model%interactions, model%contacts)) return
      allocate (row%heated(0))
      call row%heat_shares%reserve(0, 0)
      do i = 1, size(interfaces)
         associate (slave => interfaces(i)%slave_mean, master => interfaces(i)%master_mean, &
            law => model%interactions(model%contacts(i)%interaction)%heat)
            if (law%efficiency <= 0.0_dp) cycle
            do k = 1, slave%count
               call row%heat_shares%add([slave%values_of(k), master%values_of(k)], &
                  [law%slave_share*slave%coefficients_of(k), (1.0_dp - law%slave_share)* &
                  master%coefficients_of(k)])
            end do
            row%heated = [row%heated, (k, k=row%interface_start(i), row%interface_start(i + 1) - 1)]
         end associate
      end do
   end subroutine share_heat

   !> Puts the points of all ties in one row.
   pure function joined_ties(mesh, ties, of_tie) result(row)
      type(mesh_type), intent(in) :: mesh
      type(tie_definition_type), intent(in) :: ties(:)
      type(contact_points_type), intent(in) :: of_tie(:)    !! (ties) their points
      type(tie_points_type) :: row
      integer :: i

      call join_rows(of_tie%contact_row_type, row)
      row%tie = [(spread(i, 1, size(of_tie(i)%slave)), i=1, size(ties))]
      allocate (row%is_opposite(0), row%is_linear(0))
      do i = 1, size(ties)
         associate (points => of_tie(i), &
            face => mesh%surfaces(ties(i)%faces%slave)%faces(:, 1))
            row%is_opposite = [row%is_opposite, abs(sum(points%tangent*(mesh%coordinates(:, &
               points%master) - mesh%coordinates(:, points%slave)), dim=1)) <= &
               opposite*points%edge]
            row%is_linear = [row%is_linear, spread(points%pairing /= pairing_nodes .and. &
               side_node_count(mesh%element_kind(face(1))) == 2, 1, size(points%slave))]
         end associate
      end do
   end function joined_ties

   !> Heat is integrated to the edge of mortar points whose conductance varies without a jump, where
   !> it follows from gap and pressure alone: the means of the faces (contact_heat) go by jumps of
   !> whole hat functions.
   pure subroutine find_resolved_faces(model, row)
      type(model_type), intent(in) :: model
      type(connections_type), intent(inout) :: row
      integer, allocatable :: nodes(:)
      integer :: i, k

      allocate (row%resolves_edge(size(row%mortar)), source=.false.)
      if (row%vary_with_temperature()) return
      nodes = [integer ::]
      do i = 1, size(row%mortar)
         if (.not. allocated(row%mortar(i)%segments)) cycle
         if (size(row%mortar(i)%hats) < 2) cycle
         associate (law => model%interactions(model%contacts(i)%interaction)%law)
            row%resolves_edge(i) = .not. (law_jumps(law) .or. is_constant(law))
         end associate
         if (.not. row%resolves_edge(i)) cycle
         nodes = [nodes, (row%mortar(i)%segments(k)%nodes, k=1, size(row%mortar(i)%segments))]
      end do
      if (size(nodes) > 0) row%edge_nodes = nodes
   end subroutine find_resolved_faces

   !> Whether the conductance law of some contact point varies with the temperatures of its faces.
   pure logical function vary_with_temperature(self)
      class(connections_type), intent(in) :: self

      vary_with_temperature = allocated(self%mean%start)
   end function vary_with_temperature

   !> Mean of slave's and master's value of a field, at every contact point; 0 where no law asks for
   !> it.
   pure function means(self, field)
      class(connections_type), intent(in) :: self
      real(dp), intent(in) :: field(:)             !! (nodes)
      real(dp) :: means(size(self%slave))          !! (m)

      means = 0.0_dp
      if (self%vary_with_temperature()) call self%mean%add_totals(field, means)
   end function means

   !> The laws of a step.
   pure function laws_of_step(model, points, step) result(laws)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points
      integer, intent(in) :: step                  !! index of the step
      type(contact_laws_type) :: laws
      type(conductance_law_type) :: without_master   ! conducts nothing
      integer :: i

      associate (m => size(points%weight))
         allocate (laws%conductance(m), laws%friction(m))
         allocate (laws%removed(m), source=.false.)
         if (any(model%interactions(model%contacts%interaction)%overlap%is_soft())) then
            allocate (laws%overlap(m))
         end if
      end associate
      call take_wear(model, points, step, laws)
      do i = 1, size(model%contacts)
         associate (first => points%interface_start(i), last => points%interface_start(i + 1) - 1, &
            interaction => model%interactions(model%contacts(i)%interaction))
            laws%removed(first:last) = is_removed(model%steps(:step)%changes, i)
            if (any(laws%removed(first:last))) cycle
            if (allocated(laws%overlap)) laws%overlap(first:last) = interaction%overlap
            laws%conductance(first:last) = interaction%law
            laws%friction(first:last) = latest_friction(model%steps(:step)%changes, &
               model%contacts(i)%interaction, interaction%friction)
         end associate
      end do
      if (allocated(points%is_beyond)) then
         laws%removed = laws%removed .or. points%is_beyond
         where (points%is_beyond) laws%conductance = without_master
      end if
      allocate (laws%reach(size(points%weight)), source=0.0_dp)
      if (allocated(laws%overlap)) laws%reach = laws%overlap%reach()
      laws%nodal_friction = laws%friction
      laws%nodal_friction%largest_shear = unlimited
      where (laws%friction%largest_shear < unlimited .and. points%weight > 0.0_dp) &
         laws%nodal_friction%largest_shear = laws%friction%largest_shear*points%weight
      call take_friction_heat(model, points, laws)
   end function laws_of_step

   !> The laws of wear, also those of removed interfaces, which do not slip.
   pure subroutine take_wear(model, points, step, laws)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points
      integer, intent(in) :: step
      type(contact_laws_type), intent(inout) :: laws

      if (.not. any(model%interactions(model%contacts%interaction)%wear%wears())) return
      laws%wear_count = 1.0_dp
      if (size(model%steps) > 0) laws%wear_count = model%steps(step)%wear_count
      laws%wear = model%interactions(model%contacts(points%interface)%interaction)%wear
      laws%wear_share = laws%wear%slave_share
      laws%worn_part = merge(laws%wear_share, 1.0_dp, &
         model%contacts(points%interface)%follows_sliding)
   end subroutine take_wear

   !> The heat of friction. Faces that slide out of the plane have no friction in it.
   pure subroutine take_friction_heat(model, points, laws)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points
      type(contact_laws_type), intent(inout) :: laws  !! with the friction of the step
      type(friction_heat_type) :: heat(size(points%weight))

      if (.not. any(model%interactions%heat%efficiency > 0.0_dp .or. &
         model%interactions%heat%leaves_plane())) return
      heat = model%interactions(model%contacts(points%interface)%interaction)%heat
      where (heat%angular_velocity > 0.0_dp) &
         heat%speed = heat%angular_velocity*abs(model%mesh%coordinates(1, points%slave))
      laws%speed = max(heat%speed, 0.0_dp)
      if (allocated(points%heated)) then
         laws%heat = heat(points%heated)
         laws%heating_friction = laws%nodal_friction(points%heated)
      end if
      where (heat%leaves_plane())
         laws%friction = friction_law_type()
         laws%nodal_friction = friction_law_type()
      end where
   end subroutine take_friction_heat

   !> The conductance laws with the values that they have at temperatures of the faces.
   pure function conductance_at(self, mean, jump) result(laws)
      class(contact_laws_type), intent(in) :: self
      real(dp), intent(in) :: mean(:)                           !! (m) (T_xi + T_eta)/2
      real(dp), intent(in) :: jump(:)                           !! (m) T_xi - T_eta
      type(conductance_law_type), allocatable :: laws(:)        !! (m)
      integer :: k

      allocate (laws(size(jump)))
      do k = 1, size(jump)
         laws(k) = law_at(self%conductance(k), face_temperatures_type(mean(k), jump(k)))
      end do
   end function conductance_at

end module connections
