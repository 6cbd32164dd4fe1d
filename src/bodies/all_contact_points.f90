!> The contact points of all interfaces in one row, as the solution works on them, and beside them
!> the points of all ties, the nodes that hang and the equations of the deck.
module all_contact_points
   use conductance_laws, only: is_constant, varies_with_temperature
   use contact_pairs, only: make_contact_points
   use contact_points, only: contact_points_type
   use equations, only: equation_type
   use errors, only: error_type
   use hanging_nodes, only: hanging_rows
   use kinds, only: dp
   use model, only: model_type
   use sum_lists, only: sum_list_type
   use temperature_laws, only: law_jumps
   use tie_points, only: joined_ties, make_tie_points, tie_points_type
   use transforms, only: partner_type
   implicit none
   private
   public :: all_contact_points_type, match_surfaces, match_tie, joined_points

   !> The contact points of all interfaces in one row.
   type :: all_contact_points_type
      integer, allocatable :: interface_start(:)     !! (interfaces + 1) first contact point of each
      integer, allocatable :: slave(:), master(:)             !! (m) node indexes
      !> (m, nodes) slave's value less master's, as the mean that the contact point takes of each
      type(sum_list_type) :: difference
      !> (m, nodes) the same of displacements, as in contact_points_type; no sums where no normal of
      !> any contact point turns
      type(sum_list_type) :: along, across
      !> (m, nodes) mean of both; no sums where no conductance law varies with the temperature
      type(sum_list_type) :: mean
      real(dp), allocatable :: weight(:)                      !! (m) tributary areas [length^2]
      real(dp), allocatable :: initial_gap(:)                 !! (m) h [length]
      real(dp), allocatable :: normal(:, :), tangent(:, :)    !! (2, m) unit vectors
      logical, allocatable :: cuts_hats(:) !! (interfaces) whether the edge of contact cuts hats
      !> nodes of both faces of these interfaces; unallocated where there are none
      integer, allocatable :: cut_nodes(:)
      type(tie_points_type) :: ties                           !! points of the ties, no part of m
      type(sum_list_type) :: hanging                          !! hanging nodes, as in hanging_nodes
      type(equation_type), allocatable :: equations(:)        !! equations of the deck
      type(partner_type), allocatable :: partners(:)          !! nodes with axes of their own
   contains
      procedure :: jumps
      procedure :: vary_with_temperature
      procedure :: means
      procedure :: relative
      procedure :: add_forces
      procedure :: nodes_of
      procedure :: means_of
      procedure :: turns
   end type all_contact_points_type

contains

   !> Matches the surfaces of one *CONTACT PAIR, with the thickness of the slave's first element.
   !> Error: as make_contact_points.
   subroutine match_surfaces(model, i, points, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                            !! index into model%contacts
      type(contact_points_type), intent(out) :: points
      type(error_type), allocatable, intent(out) :: error

      call make_contact_points(model%mesh, model%contacts(i), &
         thickness_at(model, model%contacts(i)%slave), points, error)
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

   !> Puts the contact points of all interfaces in one row, and those of all ties.
   pure function joined_points(interfaces, of_ties, model) result(row)
      type(contact_points_type), intent(in) :: interfaces(:) !! in the order of the deck
      type(contact_points_type), intent(in) :: of_ties(:)    !! (ties) in the order of the deck
      type(model_type), intent(in) :: model
      type(all_contact_points_type) :: row                  !! all their contact points
      integer :: i, first, k, last, m

      allocate (row%interface_start(size(interfaces) + 1))
      row%interface_start(1) = 1
      do i = 1, size(interfaces)
         row%interface_start(i + 1) = row%interface_start(i) + size(interfaces(i)%slave_node)
      end do
      m = row%interface_start(size(interfaces) + 1) - 1
      allocate (row%slave(m), row%master(m), row%weight(m), row%initial_gap(m), row%normal(2, m), &
         row%tangent(2, m))
      call row%difference%reserve(m, 2*m)
      if (any([(interfaces(i)%across%count > 0, i=1, size(interfaces))])) then
         call row%along%reserve(m, 2*m)
         call row%across%reserve(m, 2*m)
      end if
      do i = 1, size(interfaces)
         first = row%interface_start(i)
         last = row%interface_start(i + 1) - 1
         row%slave(first:last) = interfaces(i)%slave_node
         row%master(first:last) = interfaces(i)%master_node
         row%weight(first:last) = interfaces(i)%weight
         row%initial_gap(first:last) = interfaces(i)%initial_gap
         row%normal(:, first:last) = interfaces(i)%normal
         row%tangent(:, first:last) = interfaces(i)%tangent
         call row%difference%add_sums(interfaces(i)%difference)
         if (.not. row%turns()) cycle
         if (interfaces(i)%across%count > 0) then
            call row%along%add_sums(interfaces(i)%along)
            call row%across%add_sums(interfaces(i)%across)
         else
            call row%along%add_sums(interfaces(i)%difference)
            do k = first, last
               call row%across%add([integer ::], [real(dp) ::])
            end do
         end if
      end do
      if (any(varies_with_temperature(model%interactions(model%contacts%interaction)%law))) then
         row%mean = means_of_faces(interfaces)
      end if
      row%ties = joined_ties(model%mesh, model%ties, of_ties)
      row%hanging = hanging_rows(model%mesh)
      allocate (row%equations(0), row%partners(0))
      if (allocated(model%partners)) row%partners = model%partners
      if (allocated(model%equations)) row%equations = model%equations
      call find_cut_faces(model, interfaces, row)
   end function joined_points

   !> The mean of slave's and master's value at all contact points.
   pure function means_of_faces(interfaces) result(means)
      type(contact_points_type), intent(in) :: interfaces(:)
      type(sum_list_type) :: means
      integer :: i, k

      call means%reserve(0, 0)
      do i = 1, size(interfaces)
         associate (slave => interfaces(i)%slave_mean, master => interfaces(i)%master_mean)
            do k = 1, slave%count
               call means%add([slave%values_of(k), master%values_of(k)], &
                  0.5_dp*[slave%coefficients_of(k), master%coefficients_of(k)])
            end do
         end associate
      end do
   end function means_of_faces

   !> Hats are cut of mortar points whose conductance varies without a jump, where it follows from
   !> gap and pressure alone: the means of the faces (gap_temperatures) go by jumps of whole hats.
   pure subroutine find_cut_faces(model, interfaces, row)
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:)
      type(all_contact_points_type), intent(inout) :: row
      integer, allocatable :: nodes(:)
      integer :: i, k

      allocate (row%cuts_hats(size(interfaces)), source=.false.)
      if (row%vary_with_temperature()) return
      nodes = [integer ::]
      do i = 1, size(interfaces)
         if (.not. allocated(interfaces(i)%segments)) cycle
         if (size(interfaces(i)%slave_node) < 2) cycle
         associate (law => model%interactions(model%contacts(i)%interaction)%law)
            row%cuts_hats(i) = .not. (law_jumps(law) .or. is_constant(law))
         end associate
         if (.not. row%cuts_hats(i)) cycle
         nodes = [nodes, (interfaces(i)%segments(k)%nodes, k=1, &
            size(interfaces(i)%segments))]
      end do
      if (size(nodes) > 0) row%cut_nodes = nodes
   end subroutine find_cut_faces

   !> Whether the normal turns along the face of some contact point.
   pure logical function turns(self)
      class(all_contact_points_type), intent(in) :: self

      turns = allocated(self%across%start)
   end function turns

   !> Slave's value less master's of a field, at every contact point.
   pure function jumps(self, field)
      class(all_contact_points_type), intent(in) :: self
      real(dp), intent(in) :: field(:)             !! (nodes)
      real(dp) :: jumps(size(self%slave))          !! (m)

      jumps = 0.0_dp
      call self%difference%add_totals(field, jumps)
   end function jumps

   !> Whether the conductance law of some contact point varies with the temperatures of its faces.
   pure logical function vary_with_temperature(self)
      class(all_contact_points_type), intent(in) :: self

      vary_with_temperature = allocated(self%mean%start)
   end function vary_with_temperature

   !> Mean of slave's and master's value of a field, at every contact point; 0 where no law asks for
   !> it.
   pure function means(self, field)
      class(all_contact_points_type), intent(in) :: self
      real(dp), intent(in) :: field(:)             !! (nodes)
      real(dp) :: means(size(self%slave))          !! (m)

      means = 0.0_dp
      if (self%vary_with_temperature()) call self%mean%add_totals(field, means)
   end function means

   !> Slave's displacement less master's, at every contact point, in the directions of its normal:
   !> the mean of displacements that are turned with the face.
   pure function relative(self, displacement)
      class(all_contact_points_type), intent(in) :: self
      real(dp), intent(in) :: displacement(:)      !! (2 nodes) [length]
      real(dp) :: relative(2, size(self%slave))    !! (2, m) [length]
      real(dp) :: across(2, size(self%slave))

      relative(1, :) = self%jumps(displacement(1::2))
      relative(2, :) = self%jumps(displacement(2::2))
      if (.not. self%turns()) return
      relative = 0.0_dp
      across = 0.0_dp
      call self%along%add_totals(displacement(1::2), relative(1, :))
      call self%along%add_totals(displacement(2::2), relative(2, :))
      call self%across%add_totals(displacement(1::2), across(1, :))
      call self%across%add_totals(displacement(2::2), across(2, :))
      relative = relative + reshape([across(2, :), -across(1, :)], shape(across), order=[2, 1])
   end function relative

   !> Adds the nodal forces of forces on the slave at the contact points, and of their opposites on
   !> the master.
   pure subroutine add_forces(self, on_slave, forces)
      class(all_contact_points_type), intent(in) :: self
      real(dp), intent(in) :: on_slave(:, :)       !! (2, m) [force]
      real(dp), intent(inout) :: forces(:)         !! (2 nodes) [force]

      if (.not. self%turns()) then
         call self%difference%add_shares(on_slave(1, :), forces(1::2))
         call self%difference%add_shares(on_slave(2, :), forces(2::2))
         return
      end if
      call self%along%add_shares(on_slave(1, :), forces(1::2))
      call self%along%add_shares(on_slave(2, :), forces(2::2))
      call self%across%add_shares(on_slave(1, :), forces(2::2))
      call self%across%add_shares(-on_slave(2, :), forces(1::2))
   end subroutine add_forces

   !> The nodes whose values a contact point takes.
   pure function nodes_of(self, k) result(nodes)
      class(all_contact_points_type), intent(in) :: self
      integer, intent(in) :: k                     !! a contact point
      integer, allocatable :: nodes(:)

      nodes = self%difference%values_of(k)
   end function nodes_of

   !> What a contact point takes of its nodes' displacements: slave's less master's along an axis
   !> are along.u of that axis, and across.u of the other one, added for x and subtracted for y.
   pure subroutine means_of(self, k, nodes, along, across)
      class(all_contact_points_type), intent(in) :: self
      integer, intent(in) :: k                     !! a contact point
      integer, allocatable, intent(out) :: nodes(:)   !! (n) each once
      real(dp), allocatable, intent(out) :: along(:)  !! (n)
      real(dp), allocatable, intent(out) :: across(:) !! (n) zero where no normal turns
      integer :: i

      if (.not. self%turns()) then
         nodes = self%nodes_of(k)
         along = self%difference%coefficients_of(k)
         across = 0.0_dp*along
         return
      end if
      associate (straight => self%along%values_of(k), turned => self%across%values_of(k))
         nodes = [straight, pack(turned, [(all(straight /= turned(i)), i=1, size(turned))])]
         along = [(sum(self%along%coefficients_of(k), mask=straight == nodes(i)), &
            i=1, size(nodes))]
         across = [(sum(self%across%coefficients_of(k), mask=turned == nodes(i)), &
            i=1, size(nodes))]
      end associate
   end subroutine means_of

end module all_contact_points
