!> Melting in a stage. Latent heat is held by nodes, each with a part of its elements' volumes, so
!> that a front passes one after the other; heat contents without it stay as they are.
!>
!> The latent content of a node turns sharply at solidus and liquidus, so that its slope at the last
!> solution would lead from one side to the other and back. Newton's method is led by heat instead:
!> a solution T of the content and slope that a node has at a temperature T' moves T' to the
!> temperature that has the heat of T and of the content there by the slope. A node that cools below
!> the liquidus thus stops in the interval until it has given off its latent heat. C has the slopes
!> at T': within the interval that of the content, else none. A stage begins with T' that are
!> foreseen, so that most fronts are found by one solution.
!>
!> C. R. Swaminathan, V. R. Voller, Metall. Trans. B 23 (1992) 651.
module melting
   use element_kinds, only: element_node_count
   use kinds, only: dp
   use materials, only: heat_capacity, heat_content, latent_content, material_type, melted_to, &
      melting_row, melts, solid_fraction
   use mesh, only: nodes_per_element
   use model, only: model_type
   use sparse_matrix, only: sparse_matrix_type
   use thermal_matrix, only: lumped_volumes
   implicit none
   private
   public :: melting_type, solid_fractions

   !> Part of the largest latent content below which that of a rounded temperature has no meaning,
   !> where the interval is a part of it in which temperatures change
   real(dp), parameter :: rounding = 1.0e-13_dp

   integer, parameter :: most_sweeps = 24        !! that foresee a front
   integer, parameter :: most_elements = 2       !! that a front passes in a stage as foreseen
   real(dp), parameter :: faster = 2.0_dp        !! than foreseen, a change that finds a front
   integer, parameter :: quiet_sweeps = 4        !! in which no node enters or leaves an interval
   real(dp), parameter :: resting = 1.0e-4_dp    !! part of a node's latent heat that moves none

   !> A node of a material that melts.
   type :: melting_node_type
      integer :: node = 0                !! index
      integer :: material = 0            !! index
      integer :: row = 0                 !! latent heat that T' is in the interval of, or 0
      real(dp) :: at = 0.0_dp            !! T' [temperature]
      logical :: at_front = .true.       !! whether a front may have been there since the start
      real(dp) :: volume = 0.0_dp        !! its part of the elements of the material [length^3]
   end type melting_node_type

   !> The nodes of all materials that melt.
   type :: melting_type
      type(melting_node_type), allocatable, private :: nodes(:)
      logical :: acts = .false.          !! whether there are any in steps that store heat
      logical :: changes_rows = .false.  !! whether the last move led into or out of intervals
      logical :: jumps = .false.         !! whether any passed over a solidus or liquidus
   contains
      procedure :: prepare
      procedure :: begin
      procedure :: foresee
      procedure :: move
      procedure :: slopes
      procedure :: contents
      procedure :: linear_excess
      procedure :: unresolved
      procedure :: find_solid_time
   end type melting_type

contains

   !> Finds the nodes that melt, none where no step stores heat.
   pure subroutine prepare(self, model)
      class(melting_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp) :: lumped(nodes_per_element), volume(size(model%mesh%node_number))
      integer :: e, i, m, n

      allocate (self%nodes(0))
      if (any(model%steps%is_transient)) then
         associate (mesh => model%mesh, sections => model%sections)
            do m = 1, size(model%materials)
               if (.not. melts(model%materials(m))) cycle
               volume = 0.0_dp
               do e = 1, size(mesh%element_kind)
                  if (sections(mesh%element_section(e))%material /= m) cycle
                  n = element_node_count(mesh%element_kind(e))
                  lumped = lumped_volumes(mesh, sections, e)
                  associate (nodes => mesh%element_nodes(:n, e))
                     volume(nodes) = volume(nodes) + lumped(:n)
                  end associate
               end do
               self%nodes = [self%nodes, pack([(melting_node_type(i, m, volume=volume(i)), i=1, &
                  size(volume))], volume > 0.0_dp)]
            end do
         end associate
      end if
      self%acts = size(self%nodes) > 0
   end subroutine prepare

   !> Starts a stage at the heat that nodes come to. A node at a solidus or liquidus is within the
   !> interval, unless its heat leads out of it.
   pure subroutine begin(self, model, change, heat, temperature)
      class(melting_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: change(:)                    !! (nodes) without melting [temperature]
      real(dp), intent(in) :: heat(:)                        !! (nodes) gained besides [energy]
      real(dp), intent(inout) :: temperature(:)              !! (nodes) at its start, then foreseen
      real(dp) :: latent, start(size(temperature))
      logical :: is_foreseen
      integer :: i

      start = temperature
      is_foreseen = any(abs(change) > 0.0_dp)
      temperature = start + change
      do i = 1, size(self%nodes)
         associate (node => self%nodes(i))
            associate (material => model%materials(node%material), there => temperature(node%node))
               node%at_front = .not. is_foreseen .or. comes_to_turn(material, start(node%node), &
                  change(node%node))
               if (.not. node%at_front) then
                  node%at = there
                  node%row = melting_row(material, there)
                  cycle
               end if
               latent = latent_content(material, start(node%node))
               call melted_to(material, heat_capacity(material), there + heat(node%node)/( &
                  heat_capacity(material)*node%volume), latent, node%at, node%row)
               there = node%at
            end associate
         end associate
      end do
   end subroutine begin

   !> Whether a temperature may come to a solidus or liquidus.
   pure logical function comes_to_turn(material, temperature, change)
      type(material_type), intent(in) :: material
      real(dp), intent(in) :: temperature                    ! at the start of a stage
      real(dp), intent(in) :: change                         ! as foreseen

      associate (melting => material%melting, there => temperature, reach => faster*abs(change))
         comes_to_turn = any(abs(melting%solidus - there) <= reach .or. &
            abs(melting%liquidus - there) <= reach)
      end associate
   end function comes_to_turn

   !> Foresees T' at the end of a stage by sweeps to and fro over the equation of heat without
   !> melting, which solve the row of a node together with its latent heat (Gauss and Seidel). Nodes
   !> whose neighbours stay rest, and those far from where fronts may have been. They end when none
   !> has entered or left an interval for some.
   pure subroutine foresee(self, model, matrix, rhs, duration, moves, temperature)
      class(melting_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(sparse_matrix_type), intent(in) :: matrix         !! (nodes, nodes) [power/temperature]
      real(dp), intent(in) :: rhs(:)                         !! (nodes) beside L/duration [power]
      real(dp), intent(in) :: duration                       !! [time]
      logical, intent(in) :: moves(:)                        !! (nodes) those that are solved for
      real(dp), intent(inout) :: temperature(:)              !! (nodes) from begin, then foreseen
      real(dp) :: held(size(rhs)), left_over, own, small(size(rhs))
      logical :: near(size(rhs), 0:most_elements), waits(size(rhs))
      integer, allocatable :: rows(:)
      integer :: at(size(rhs)), i, k, l, moved, within, sweep

      at = 0
      small = 0.0_dp
      near = .false.
      held = self%contents(model, temperature)/duration
      do k = 1, size(self%nodes)
         associate (node => self%nodes(k))
            at(node%node) = k
            near(node%node, 0) = node%at_front
            small(node%node) = resting*node%volume*sum(model%materials(node%material)%melting% &
               content)/duration
         end associate
      end do
      do l = 1, most_elements
         near(:, l) = near(:, l - 1)
         do i = 1, size(rhs)
            if (.not. near(i, l - 1)) cycle
            do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
               near(matrix%column(k), l) = .true.
            end do
         end do
      end do
      rows = pack([(i, i=1, size(rhs))], near(:, most_elements) .and. moves)
      waits = .false.
      waits(rows) = .true.
      moved = 0
      do sweep = 1, most_sweeps
         if (sweep - moved > quiet_sweeps) exit
         do k = 1, size(rows)
            i = rows(merge(k, size(rows) + 1 - k, modulo(sweep, 2) == 1))
            if (.not. waits(i)) cycle
            waits(i) = .false.
            left_over = rhs(i) - held(i)
            own = 0.0_dp
            do l = matrix%row_start(i), matrix%row_start(i + 1) - 1
               left_over = left_over - matrix%value(l)*temperature(matrix%column(l))
               if (matrix%column(l) == i) own = matrix%value(l)
            end do
            if (abs(left_over) <= small(i)) cycle
            do l = matrix%row_start(i), matrix%row_start(i + 1) - 1
               waits(matrix%column(l)) = matrix%column(l) /= i
            end do
            left_over = left_over + held(i) + own*temperature(i)
            temperature(i) = left_over/own
            if (at(i) == 0) cycle
            associate (node => self%nodes(at(i)))
               call melted_to(model%materials(node%material), own*duration/node%volume, &
                  temperature(i), 0.0_dp, node%at, within)
               if (within /= node%row) moved = sweep
               node%row = within
               temperature(i) = node%at
               held(i) = left_over - own*node%at
            end associate
         end do
      end do
   end subroutine foresee

   !> Moves T' to a solution, or by a part of the heat that is between both.
   pure subroutine move(self, model, temperature, part)
      class(melting_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)                 !! (nodes)
      real(dp), intent(in) :: part                           !! of the heat, 1 for all
      real(dp) :: content, least, start
      integer :: i, row

      self%changes_rows = .false.
      self%jumps = .false.
      do i = 1, size(self%nodes)
         associate (node => self%nodes(i))
            associate (material => model%materials(node%material), there => temperature(node%node))
               content = linear_content(model, node, there)
               least = rounding*maxval(material%melting%capacity)*abs(there)
               if (abs(content - latent_content(material, there)) <= least) then
                  node%at = there
                  cycle
               end if
               self%jumps = .true.
               start = latent_content(material, node%at)
               call melted_to(material, heat_capacity(material), (1.0_dp - part)*node%at + &
                  part*there, (1.0_dp - part)*start + part*content, node%at, row)
               self%changes_rows = self%changes_rows .or. row /= node%row
               node%row = row
            end associate
         end associate
      end do
   end subroutine move

   !> What C has of melting, on the nodes.
   pure function slopes(self, model)
      class(melting_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(dp) :: slopes(size(model%mesh%node_number))       !! (nodes) [energy/temperature]
      integer :: i

      slopes = 0.0_dp
      do i = 1, size(self%nodes)
         associate (node => self%nodes(i))
            if (node%row > 0) slopes(node%node) = slopes(node%node) + node%volume* &
               model%materials(node%material)%melting(node%row)%capacity
         end associate
      end do
   end function slopes

   !> Latent heat on the nodes.
   pure function contents(self, model, temperature)
      class(melting_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)                 !! (nodes)
      real(dp) :: contents(size(temperature))                !! (nodes) [energy]
      integer :: i

      contents = 0.0_dp
      do i = 1, size(self%nodes)
         associate (node => self%nodes(i))
            contents(node%node) = contents(node%node) + node%volume*latent_content( &
               model%materials(node%material), temperature(node%node))
         end associate
      end do
   end function contents

   !> What content and slope at T' give beyond the latent heat.
   pure function linear_excess(self, model, temperature) result(excess)
      class(melting_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)                 !! (nodes)
      real(dp) :: excess(size(temperature))                  !! (nodes) [energy]
      integer :: i

      excess = 0.0_dp
      do i = 1, size(self%nodes)
         associate (node => self%nodes(i), there => temperature(self%nodes(i)%node))
            excess(node%node) = excess(node%node) + node%volume*(linear_content(model, node, &
               there) - latent_content(model%materials(node%material), there))
         end associate
      end do
   end function linear_excess

   !> Latent heat of a unit volume by content and slope at T'.
   pure real(dp) function linear_content(model, node, temperature) result(content)
      type(model_type), intent(in) :: model
      type(melting_node_type), intent(in) :: node
      real(dp), intent(in) :: temperature

      associate (material => model%materials(node%material))
         content = latent_content(material, node%at)
         if (node%row > 0) content = content + material%melting(node%row)%capacity* &
            (temperature - node%at)
      end associate
   end function linear_content

   !> Heat that has no meaning at a node, because temperatures within the interval are rounded.
   pure real(dp) function unresolved(self, model, temperature) result(heat)
      class(melting_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)                 !! (nodes)
      integer :: i

      heat = 0.0_dp
      do i = 1, size(self%nodes)
         associate (node => self%nodes(i))
            heat = max(heat, rounding*node%volume*maxval(model%materials(node%material)%melting% &
               capacity)*abs(temperature(node%node)))
         end associate
      end do
   end function unresolved

   !> When the last node became solid: heat is taken to be straight in an increment. What was solid
   !> before stays so.
   pure subroutine find_solid_time(self, model, temperatures, instants, solid_time)
      class(melting_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperatures(:, :)             !! (nodes, 2) at both ends
      real(dp), intent(in) :: instants(2)                    !! of these [time]
      real(dp), allocatable, intent(inout) :: solid_time(:)  !! (2) as of the state [time]
      real(dp) :: contents(2), part
      integer :: i, k

      part = -1.0_dp
      do i = 1, size(self%nodes)
         associate (node => self%nodes(i))
            associate (material => model%materials(node%material))
               do k = 1, 2
                  contents(k) = latent_content(material, temperatures(node%node, k)) + &
                     heat_content(material, temperatures(node%node, k)) - &
                     heat_content(material, material%melting(1)%solidus)
               end do
            end associate
         end associate
         if (contents(2) > 0.0_dp) then
            if (allocated(solid_time)) deallocate (solid_time)
            return
         end if
         if (contents(1) > 0.0_dp) part = max(part, contents(1)/(contents(1) - contents(2)))
      end do
      if (part >= 0.0_dp) solid_time = [instants(1) + part*(instants(2) - instants(1)), &
         instants(2) - instants(1)]
   end subroutine find_solid_time

   !> Solid fractions on the nodes, 1 where nothing melts.
   pure function solid_fractions(model, temperature) result(fraction)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)                 !! (nodes)
      real(dp) :: fraction(size(temperature))                !! (nodes) [-]
      logical :: is_in(size(temperature))
      integer :: e, i, m

      fraction = 1.0_dp
      do m = 1, size(model%materials)
         if (.not. melts(model%materials(m))) cycle
         is_in = .false.
         do e = 1, size(model%mesh%element_kind)
            if (model%sections(model%mesh%element_section(e))%material == m) is_in( &
               model%mesh%element_nodes(:element_node_count(model%mesh%element_kind(e)), e)) = &
               .true.
         end do
         do i = 1, size(temperature)
            if (is_in(i)) fraction(i) = solid_fraction(model%materials(m), temperature(i))
         end do
      end do
   end function solid_fractions

end module melting
