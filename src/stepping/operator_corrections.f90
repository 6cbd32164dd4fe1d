!> Heat and forces of bodies beyond their linear operators K, B and C, of (3.3) and (2.4), which
!> were formed at earlier temperatures, strains and histories. They stand on the right of the
!> equations of a stage, and are corrected until they are those of its solution.
!>
!> True fluxes and stresses are taken at the integration points and gathered on the nodes; what the
!> operators have instead is K T, and K u - B (T - T_0), so that a solution balances the true ones.
!> Heat is stored as enthalpy, H(T) = integral of rho c, so that the heat of an increment is a
!> difference of contents. Heat that strains take up (DILATATION) is corrected in the same way.
!>
!> A correction is the fixed point of linear solutions, and is mixed after Anderson. Where
!> properties alone vary and one does not reduce what is left over to 0.3 of the one before, the
!> operators are to be formed again. Laws of materials need more passes, which still cost less than
!> factors: operators are formed, with the tangents of the laws, after 25 passes, or six that each
!> leave more than 0.7. After fewer the mixing knows too little of points that yield and stop in
!> turn, and passes with the tangents of such a pass go round.
!>
!> Operators that are far too soft, formed where points yielded or were molten that now resist, lead
!> astray: what is left over grows. New ones are then formed at the pass that left least over. If
!> these lead astray, too, or to nothing better, the next ones have half of the elasticity, with
!> which points that unload do not diverge. These converge slowly: once they have led to something
!> better, the next ones have the least part of it again.
module operator_corrections
   use anderson_mixing, only: mixing_type
   use element_kinds, only: element_node_count
   use errors, only: error_type, set_error, status_no_convergence
   use field_problem, only: largest_of
   use field_quantities, only: von_mises
   use heat_equation, only: heat_equation_type
   use increment_data, only: stage_type
   use kinds, only: dp
   use materials, only: has_law, heats_by_work, varies
   use mesh, only: nodes_per_element
   use mesh_bodies, only: body_name
   use model, only: model_type
   use material_laws, only: law_points_type
   use material_points, only: least_elastic_part => elastic_part, material_points_type
   use point_histories, only: point_history_type
   use melting, only: melting_type
   use quadrature, only: integration_rules, load_rules, most => most_points_of_rule
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   use text, only: to_text
   implicit none
   private
   public :: corrections_type

   real(dp), parameter :: settled = 1.0e-9_dp  !! part of heat and forces that is left over
   !> Part of terms that cancel which is their rounding: sqrt(n) epsilon in a solution of n = 2e5
   !> unknowns
   real(dp), parameter :: rounding = 1.0e-13_dp
   integer, parameter :: most_passes = 60
   integer, parameter :: passes_per_part = 15    !! after which nodes that melt move half as far
   real(dp), parameter :: contracts = 0.3_dp    !! part of what is left over, from pass to pass
   ! Of laws.
   real(dp), parameter :: slow = 0.7_dp         !! part that is left over by a slow pass
   real(dp), parameter :: grows = 2.0_dp        !! factor at which the mixing starts again
   real(dp), parameter :: astray = 1.0e-4_dp    !! least that operators leave over which lead astray
   real(dp), parameter :: safe_part = 0.5_dp    !! of the elasticity in tangents behind such ones
   real(dp), parameter :: least_rank = 1.0e-8_dp   !! tolerance of the mixing
   real(dp), parameter :: most_ahead = 10.0_dp   !! times as long may one be that goes on as before
   integer, parameter :: most_slow = 6, most_with_operators = 25   !! passes

   !> Fields at points, and the elements of the bodies whose materials vary.
   type :: corrections_type
      private
      type(material_points_type), allocatable, public :: points   !! of integration
      type(material_points_type), allocatable :: contents         !! of heat contents
      integer, allocatable :: elements(:)
      type(melting_type), public :: melting        !! of the stage
      type(stage_type) :: stage                    !! that is corrected
      type(point_history_type) :: history          !! of it
      real(dp), allocatable :: initial_force(:)    !! (2 nodes) of initial stresses, or none [force]
      logical, allocatable :: follows(:)           !! (nodes) of these bodies
      !> (4 nodes) of a stage: rate of heat taken up, heat beyond conduction, forces along x and y
      real(dp), allocatable :: values(:)
      real(dp), allocatable :: heat_before(:)      !! (nodes) beyond conduction at its start
      real(dp), allocatable :: strain_before(:)    !! (nodes) taken up by strains at T*, u*
      real(dp), allocatable :: scale(:)            !! (4 nodes) of the values
      type(mixing_type) :: mixing
      real(dp) :: left_over = 0.0_dp               !! of the last pass, in scales
      integer :: slow_passes = 0                   !! since operators were formed
      real(dp) :: renewed_with = 0.0_dp            !! what was left over where they were
      real(dp) :: elastic_part = least_elastic_part   !! that tangents have of the elasticity
      ! Of the pass of the stage that left least over, since nodes last passed solidus or liquidus:
      real(dp) :: least_left_over = huge(1.0_dp)   !! in scales
      real(dp), allocatable :: temperature(:), displacement(:)   !! (nodes), (2 nodes) [length]
      real(dp) :: largest_force = 0.0_dp           !! at a node of an element, of stresses [force]
      logical, public :: has_laws = .false.        !! whether any material has
      logical, public :: heats = .false.           !! whether inelastic work heats bodies
      integer :: failed_element = 0                !! index of the first whose law found no stress
      integer, public :: passes = 0                !! of the stage
      logical, public :: is_settled = .false.      !! whether a solution is that of its corrections
      logical, public :: asks_operators = .false.  !! whether operators are to be formed at it
      logical, public :: goes_back = .false.       !! or at the pass that left least over
      logical, public :: asks_capacity = .false.   !! whether C alone is, where other nodes melt
      integer, public :: renewed_at = 0            !! pass after which they were last, in the stage
      logical, public :: corrects = .false.        !! whether the run has anything to correct
      !> Largest equivalent stress over 3 G that laws found last, an elastic strain
      real(dp), public :: elastic_strain = 0.0_dp
   contains
      procedure :: prepare
      procedure :: begin
      procedure :: begin_again
      procedure :: give
      procedure :: correct
      procedure :: renew
      procedure :: foresee_melting
      procedure :: go_back
      procedure :: heat_beyond
      procedure :: true_contents
      procedure :: keep
      procedure :: largest_growth
      procedure :: yields
      procedure :: inelastic_heat
      procedure :: find_tangents
   end type corrections_type

contains

   !> Forms what stays.
   subroutine prepare(self, model, initial_force)
      class(corrections_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp), allocatable, intent(in) :: initial_force(:)  !! (2 nodes) or none [force]
      logical :: follows(0:model%mesh%body_count)      ! bodies, none of them first
      integer, allocatable :: bodies(:)
      integer :: e, i

      follows = .false.
      associate (mesh => model%mesh)
         do e = 1, size(mesh%element_body)
            if (varies(model%materials(model%sections(mesh%element_section(e))% &
               material))) follows(mesh%element_body(e)) = .true.
         end do
         ! Bodies that have a strain along z in common follow together, chains of them, too.
         do e = 1, size(model%sections)
            do i = 1, size(model%sections)
               if (model%sections(i)%reference(1) == 0) cycle
               bodies = pack(mesh%element_body, model%sections(mesh%element_section)% &
                  reference(1) == model%sections(i)%reference(1))
               if (any(follows(bodies))) follows(bodies) = .true.
            end do
         end do
         self%elements = pack([(e, e=1, size(mesh%element_body))], follows(mesh%element_body))
         self%follows = follows(mesh%node_body)
         do e = 1, size(self%elements)
            associate (own => model%sections(mesh%element_section(self%elements(e)))%reference)
               if (own(1) > 0) self%follows(own) = .true.
            end associate
         end do
      end associate
      if (allocated(initial_force)) self%initial_force = initial_force
      call self%melting%prepare(model)
      self%corrects = any(follows) .or. any(model%steps%dilates) .or. self%melting%acts
      self%has_laws = any(has_law(model%materials))
      self%heats = any(heats_by_work(model%materials)) .and. any(model%steps%is_transient)
      if (.not. any(follows)) return
      allocate (self%points, self%contents)
      self%points%has_inverses = .false.
      self%contents%has_inverses = .false.
      call self%points%prepare(model%mesh, model%sections, model%materials, model%orientations, &
         integration_rules())
      if (any(model%steps%is_transient)) call self%contents%prepare(model%mesh, model%sections, &
         model%materials, model%orientations, load_rules())
   end subroutine prepare

   !> Starts a stage, from the corrections of the last increments where these are of the present
   !> operators.
   subroutine begin(self, model, bodies, stage, before, takes_past)
      class(corrections_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(stage_type), intent(in) :: stage
      type(solution_state_type), intent(in) :: before        !! state at its start
      logical, intent(in) :: takes_past                      !! whether K T_i stands in eq. (3.4)
      real(dp), allocatable :: displacement(:)               ! from which it begins
      logical :: goes_on

      call self%begin_again()
      self%stage = stage
      if (allocated(self%strain_before)) deallocate (self%strain_before)
      self%history%law_interval_type = stage%passing
      self%history%duration = stage%duration
      if (allocated(stage%history)) then
         self%history%before = stage%history
         self%history%after = stage%history
      end if
      if (stage%dilates) self%strain_before = bodies%dilatation%taken_up(bodies%thermal_load, &
         stage%displacement, stage%temperature)
      ! Where nodes melt corrections are of another C.
      goes_on = allocated(before%corrections) .and. .not. (foresees(self, before) .or. &
         self%melting%acts)
      if (goes_on .and. allocated(bodies%operators_at)) goes_on = &
         bodies%has_operators_of(before%operators_at, before%tangent)
      if (takes_past .or. .not. goes_on) self%heat_before = self%heat_beyond(model, bodies, &
         before%temperature)
      if (.not. goes_on) then
         displacement = before%displacement
         if (foresees(self, before)) displacement = displacement + stage%size/ &
            before%increment_size*(displacement - before%displacement_before)
         self%values = corrections_of(self, model, bodies, before%temperature, displacement)
      else
         self%values = before%corrections
         associate (n => size(before%temperature), ahead => stage%size/before%increment_size)
            if (.not. takes_past) self%heat_before = self%values(n + 1:2*n)
            if (ahead > most_ahead) then
               ! What a far shorter increment took up may be a jump: no rate of this one.
               self%values(:n) = self%values(:n)/ahead
            else if (allocated(before%corrections_before)) then
               self%values = self%values + ahead*(before%corrections - before%corrections_before)
            end if
         end associate
      end if
   end subroutine begin

   !> Starts a stage that is solved again from the corrections of its last solution, so that they,
   !> and the operators, settle with what it is solved again for.
   subroutine begin_again(self)
      class(corrections_type), intent(inout) :: self

      self%passes = 0
      self%renewed_at = 0
      self%slow_passes = 0
      self%left_over = 0.0_dp
      self%least_left_over = huge(1.0_dp)
      self%elastic_part = least_elastic_part
      call start_mixing(self)
      if (allocated(self%scale)) deallocate (self%scale)
   end subroutine begin_again

   !> Whether laws go on from displacements that go on as they did, whatever the operators were.
   !> Plastic flow stops where loads turn round: without a time it is not foreseen.
   pure logical function foresees(self, before)
      class(corrections_type), intent(in) :: self
      type(solution_state_type), intent(in) :: before

      foresees = self%has_laws .and. allocated(before%displacement_before) .and. .not. &
         self%stage%begins_step .and. self%stage%passing%real_part > 0.0_dp
   end function foresees

   !> Gives a stage its corrections: heat to its equation, forces to its state.
   subroutine give(self, equation, next)
      class(corrections_type), intent(in) :: self
      type(heat_equation_type), intent(inout) :: equation
      type(solution_state_type), intent(inout) :: next

      associate (n => size(next%temperature))
         if (equation%duration > 0.0_dp) equation%taken_up = equation%duration/ &
            equation%scheme%a(1)*self%values(:n)
         if (size(self%elements) == 0) return
         equation%beyond_old = self%heat_before
         equation%beyond = self%values(n + 1:2*n)
         next%forces_beyond = self%values(2*n + 1:)
      end associate
   end subroutine give

   !> Corrects to a solution, unless what is left over is rounding.
   !> Error: no convergence.
   subroutine correct(self, model, bodies, next, tolerance, error)
      class(corrections_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: next          !! solved with the present corrections
      real(dp), intent(in) :: tolerance                      !! of that solution, where it is rough
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: words
      real(dp), allocatable :: left_over(:), x(:)
      real(dp) :: last

      self%passes = self%passes + 1
      left_over = corrections_of(self, model, bodies, next%temperature, &
         next%displacement) - self%values
      if (.not. allocated(self%scale)) self%scale = scales_of(self, model, bodies, next)
      last = self%left_over
      left_over = left_over/self%scale
      self%left_over = maxval(abs(left_over))
      self%asks_operators = .false.
      self%goes_back = .false.
      self%asks_capacity = .false.
      self%melting%jumps = .false.
      self%is_settled = self%failed_element == 0 .and. self%left_over <= max(settled, tolerance)
      if (self%is_settled) return
      if (self%failed_element > 0) then
         call lead_back(self)
         if (.not. self%goes_back) call set_error(error, status_no_convergence, &
            words_of_law(self, model, next%temperature))
         return
      end if
      ! Fronts that go to and fro between solutions are met halfway, or before.
      if (self%melting%acts .and. self%stage%stores_heat) call self%melting%move(model, &
         next%temperature, 0.5_dp**(self%passes/passes_per_part))
      if (self%left_over < self%least_left_over) then
         self%least_left_over = self%left_over
         self%temperature = next%temperature
         self%displacement = next%displacement
      end if
      self%asks_capacity = self%melting%jumps .and. self%melting%changes_rows
      if (size(self%elements) > 0 .and. .not. self%melting%jumps) call judge_pass(self, last)
      if (self%asks_operators) return
      if (self%passes > most_passes .or. .not. self%left_over < huge(last)) then
         words = 'heat and stress of bodies do not follow their temperatures'
         if (self%has_laws) words = &
            'stresses of bodies that yield or creep do not follow their strains'
         associate (n => size(self%follows), i => maxloc(abs(left_over), dim=1))
            words = words//' within '//to_text(most_passes)//' corrections; most is left over '// &
               words_of_place(model, merge(1 + modulo(i - 1, n), (i - 2*n + 1)/2, i <= 2*n))
         end associate
         call set_error(error, status_no_convergence, words)
         return
      end if
      if (self%melting%jumps) self%least_left_over = huge(1.0_dp)
      if (self%asks_capacity) return
      if (self%melting%jumps) then
         call start_mixing(self)
         self%values = self%values + left_over*self%scale
         call lead_melting(self, model, next%temperature)
         return
      end if
      x = self%values/self%scale
      self%values = (x + self%mixing%step(x, left_over, spread(1.0_dp, 1, size(x))))*self%scale
   end subroutine correct

   !> Judges a pass by what it left over: whether operators are to be formed at its solution, or the
   !> mixing starts again. Properties at other temperatures are no tangent, which a law has: without
   !> one operators are formed once.
   subroutine judge_pass(self, last)
      type(corrections_type), intent(inout) :: self
      real(dp), intent(in) :: last                           ! left over by the pass before

      associate (passes => self%passes - self%renewed_at, left_over => self%left_over, &
         is_renewed => self%renewed_at > 0)
         if (.not. self%has_laws) then
            self%asks_operators = passes > 1 .and. .not. is_renewed .and. left_over > contracts*last
            return
         end if
         if (passes > 1 .and. left_over > slow*last) self%slow_passes = self%slow_passes + 1
         if (passes > 1 .and. left_over > grows*last) call start_mixing(self)
         self%asks_operators = passes > most_with_operators .or. self%slow_passes >= most_slow
         if (last > 0.0_dp .and. left_over > max(grows*last, astray) .or. &
            self%asks_operators .and. is_renewed .and. self%least_left_over > contracts* &
            self%renewed_with) call lead_back(self)
         if (self%asks_operators .and. .not. self%goes_back .and. left_over <= contracts* &
            self%renewed_with) self%elastic_part = least_elastic_part
      end associate
   end subroutine judge_pass

   !> Asks for operators at the pass that left least over, if there is any, and these have not had
   !> half of the elasticity before.
   subroutine lead_back(self)
      type(corrections_type), intent(inout) :: self

      self%goes_back = self%elastic_part < safe_part .and. self%passes <= most_passes .and. &
         self%least_left_over < huge(self%left_over)
      if (.not. self%goes_back) return
      self%asks_operators = .true.
      if (self%renewed_at > 0) self%elastic_part = safe_part
   end subroutine lead_back

   !> Makes the pass that left least over the last one.
   subroutine go_back(self, next)
      class(corrections_type), intent(inout) :: self
      type(solution_state_type), intent(inout) :: next       !! receives its solution

      next%temperature = self%temperature
      next%displacement = self%displacement
      self%left_over = self%least_left_over
   end subroutine go_back

   !> Which law found no stress, and where.
   function words_of_law(self, model, temperature) result(words)
      type(corrections_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)                 ! (nodes)
      character(:), allocatable :: words

      associate (mesh => model%mesh, e => self%failed_element)
         associate (nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e), &
            material => model%materials(model%sections(mesh%element_section(e))%material))
            words = 'the law of a material'
            if (allocated(material%name)) words = 'the law of '//material%name
            words = words//' finds no stress for the strain of element '// &
               to_text(mesh%element_number(e))//' '//words_of_place(model, nodes(1))// &
               ', temperature '//to_text(sum(temperature(nodes))/size(nodes))// &
               '; are its data in the units of the deck?'
         end associate
      end associate
   end function words_of_law

   !> Where a node lies.
   function words_of_place(model, node) result(words)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node                            ! index
      character(:), allocatable :: words

      words = 'at x = '//to_text(model%mesh%coordinates(1, node))//', y = '// &
         to_text(model%mesh%coordinates(2, node))
      if (model%mesh%node_body(node) > 0) words = words//' in '//body_name(model, &
         model%mesh%node_body(node))
   end function words_of_place

   !> Forgets the passes before.
   subroutine start_mixing(self)
      type(corrections_type), intent(inout) :: self

      self%mixing = mixing_type()
      if (self%has_laws) self%mixing%rank_tolerance = least_rank
   end subroutine start_mixing

   !> Gives corrections at a solution the latent heat that leads the next one.
   subroutine lead_melting(self, model, temperature)
      type(corrections_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)                 ! (nodes)

      associate (n => size(temperature))
         self%values(:n) = self%values(:n) + self%melting%linear_excess(model, temperature)/ &
            self%stage%duration
      end associate
   end subroutine lead_melting

   !> Gives corrections that a stage begins with without melting the slopes that it has foreseen.
   subroutine foresee_melting(self, model, slopes, temperature)
      class(corrections_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: slopes(:)                      !! (nodes) [energy/temperature]
      real(dp), intent(in) :: temperature(:)                 !! (nodes) at its start

      associate (n => size(temperature))
         self%values(:n) = self%values(:n) - slopes*(temperature - self%stage%temperature)/ &
            self%stage%duration
      end associate
      call lead_melting(self, model, temperature)
   end subroutine foresee_melting

   !> Goes on with operators, or C alone, that were formed at a solution.
   subroutine renew(self, model, bodies, before, at)
      class(corrections_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies        !! with them
      type(solution_state_type), intent(in) :: before        !! state at the start of the stage
      type(solution_state_type), intent(in) :: at            !! the solution

      ! Where a front passed on, they are of another state.
      self%renewed_at = merge(self%passes, 0, self%asks_operators)
      self%slow_passes = 0
      self%renewed_with = self%left_over
      call start_mixing(self)
      if (self%asks_operators) deallocate (self%scale)
      self%heat_before = self%heat_beyond(model, bodies, before%temperature)
      self%values = corrections_of(self, model, bodies, at%temperature, at%displacement)
      if (self%asks_capacity) call lead_melting(self, model, at%temperature)
   end subroutine renew

   !> Keeps the corrections of a stage in its state, for the next one to begin with.
   subroutine keep(self, bodies, before, next)
      class(corrections_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: before
      type(solution_state_type), intent(inout) :: next

      if (self%melting%acts) then
         next%temperature_before = before%temperature
      else
         next%corrections = self%values
      end if
      if (allocated(next%corrections_before)) deallocate (next%corrections_before)
      if (self%has_laws) then
         next%displacement_before = before%displacement
      else if (self%renewed_at == 0 .and. allocated(before%corrections)) then
         next%corrections_before = before%corrections
      end if
      if (allocated(bodies%operators_at)) next%operators_at = bodies%operators_at
      if (allocated(bodies%tangent)) next%tangent = bodies%tangent
      if (allocated(self%history%after) .and. self%stage%strains) next%history = self%history%after
   end subroutine keep

   !> How much the equivalent plastic and creep strains grow at most from one state to another [-].
   pure function largest_growth(self, model, state, before) result(growth)
      class(corrections_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: state, before
      real(dp) :: growth(2)

      growth = 0.0_dp
      if (allocated(state%history)) growth = maxval(self%points%largest_growth(model%mesh, &
         state%history, before%history), 2)
   end function largest_growth

   !> Whether bodies yield in the last pass, or find no stress there where nothing creeps.
   pure logical function yields(self, model)
      class(corrections_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(dp) :: growth(2, model%mesh%body_count)

      yields = any(model%materials%law%strains(1) > 0) .and. allocated(self%history%after)
      if (.not. yields) return
      growth = self%points%largest_growth(model%mesh, self%history%after, self%history%before)
      yields = any(growth(1, :) > 0.0_dp)
      if (self%failed_element > 0) yields = all(model%materials%law%strains(2) == 0)
   end function yields

   !> Corrections that temperatures and displacements at the end of a stage ask for.
   function corrections_of(self, model, bodies, temperature, displacement) result(values)
      class(corrections_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:), displacement(:)
      real(dp), allocatable :: values(:)                     ! (4 nodes)
      real(dp) :: of_capacity(size(temperature))   ! what C has of it, melting or not [energy]
      integer :: n

      n = size(temperature)
      allocate (values(4*n), source=0.0_dp)
      values(n + 1:2*n) = heat_beyond(self, model, bodies, temperature)
      values(2*n + 1:) = forces_beyond(self, model, bodies, temperature, displacement)
      if (.not. self%stage%stores_heat) return
      of_capacity = 0.0_dp
      if (allocated(bodies%melting)) of_capacity = bodies%melting*(temperature - &
         self%stage%temperature)
      if (any(self%follows)) of_capacity = merge(bodies%capacity%multiply(temperature - &
         self%stage%temperature), of_capacity, self%follows)
      if (allocated(self%stage%content)) values(:n) = true_contents(self, model, temperature) - &
         self%stage%content - of_capacity
      if (allocated(self%strain_before)) values(:n) = values(:n) + bodies%dilatation%taken_up( &
         bodies%thermal_load, displacement, temperature) - self%strain_before
      if (allocated(self%stage%worked) .and. self%stage%strains) values(:n) = values(:n) - ( &
         self%inelastic_heat(model, self%history%after) - self%stage%worked)
      values(:n) = values(:n)/self%stage%duration
   end function corrections_of

   !> Heat that inelastic work has made, on the nodes.
   pure function inelastic_heat(self, model, remembered) result(heat)
      class(corrections_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: remembered(:)                  !! (numbers) by all points
      real(dp) :: heat(size(model%mesh%node_number))         !! (nodes) [energy]
      real(dp) :: work(most, 2)
      integer :: g, i

      heat = 0.0_dp
      do i = 1, size(self%elements)
         associate (mesh => model%mesh, points => self%points, e => self%elements(i))
            if (.not. points%follows_law(mesh, e)) cycle
            work = points%inelastic_work(mesh, e, remembered)
            associate (rule => points%rules(mesh%element_kind(e)), first => points%first(e), &
               law => points%library(points%sections(mesh%element_section(e))%material)%law)
               do g = 1, rule%count
                  associate (nodes => mesh%element_nodes(:rule%nodes, e))
                     heat(nodes) = heat(nodes) + law%heat_fraction*sum(work(g, :))* &
                        points%volume(first + g - 1)*rule%shape(g, :rule%nodes)
                  end associate
               end do
            end associate
         end associate
      end do
   end function inelastic_heat

   !> Heat that K conducts beyond the bodies.
   function heat_beyond(self, model, bodies, temperature) result(heat)
      class(corrections_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:)                 !! (nodes)
      real(dp) :: heat(size(temperature))                    !! (nodes) [power]
      real(dp) :: flux(most, 2), of_nodes(8)
      integer :: i

      heat = 0.0_dp
      if (size(self%elements) == 0 .or. .not. allocated(bodies%thermal%matrix%value)) return
      call self%points%set_temperature(model%mesh, temperature, model%initial_temperature)
      heat = bodies%thermal%matrix%multiply(temperature)
      flux = 0.0_dp
      do i = 1, size(self%elements)
         associate (mesh => model%mesh, e => self%elements(i), nodes => model%mesh%element_nodes( &
            :element_node_count(model%mesh%element_kind(self%elements(i))), self%elements(i)))
            call self%points%heat_flux(mesh, e, temperature, flux)
            of_nodes = self%points%nodal_heat(mesh, e, flux)
            heat(nodes) = heat(nodes) - of_nodes(:size(nodes))
         end associate
      end do
      heat = merge(heat, 0.0_dp, self%follows)
   end function heat_beyond

   !> Forces that the stiffness and the thermal load have beyond the bodies.
   function forces_beyond(self, model, bodies, temperature, displacement) result(forces)
      type(corrections_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:)                 ! (nodes)
      real(dp), intent(in) :: displacement(:)                ! (2 nodes) [length]
      real(dp) :: forces(size(displacement))                 ! (2 nodes) [force]
      real(dp), dimension(2, size(temperature)) :: balance, u
      real(dp) :: sums(size(displacement))
      type(law_points_type) :: points
      real(dp) :: of_nodes(2, nodes_per_element + 2), warming(size(temperature))
      integer :: i

      forces = 0.0_dp
      if (allocated(self%initial_force)) forces = self%initial_force
      if (size(self%elements) == 0 .or. .not. allocated(bodies%mechanical%matrix%value)) return
      self%failed_element = 0
      self%elastic_strain = 0.0_dp
      self%largest_force = 0.0_dp
      call self%points%set_temperature(model%mesh, temperature, model%initial_temperature)
      warming = temperature - model%initial_temperature
      u = reshape(displacement, shape(u))
      ! What the operators have, bars aside, for the forces of the stresses.
      sums = bodies%mechanical%matrix%multiply(displacement)
      if (allocated(bodies%bar_stiffness%value)) sums = sums - &
         bodies%bar_stiffness%multiply(displacement)
      if (allocated(bodies%thermal_load%value)) sums = sums - bodies%thermal_load%multiply(warming)
      if (allocated(bodies%bar_load%value)) sums = sums + bodies%bar_load%multiply(warming)
      balance = reshape(sums, shape(balance))
      do i = 1, size(self%elements)
         associate (mesh => model%mesh, e => self%elements(i), nodes => model%mesh%element_nodes( &
            :element_node_count(model%mesh%element_kind(self%elements(i))), self%elements(i)))
            call self%points%respond(mesh, e, u, warming, self%history, points)
            if (points%failed .and. self%failed_element == 0) self%failed_element = e
            if (self%points%follows_law(mesh, e)) self%elastic_strain = max(self%elastic_strain, &
               maxval(von_mises(transpose(points%stress(:points%count, :))))/ &
               (3*self%points%materials(self%points%at_point(e, 1))%elasticity(4, 4)))
            of_nodes = self%points%nodal_forces(mesh, e, points%stress)
            self%largest_force = max(self%largest_force, maxval(abs(of_nodes(:, :size(nodes)))))
            balance(:, nodes) = balance(:, nodes) - of_nodes(:, :size(nodes))
            associate (along_z => model%sections(mesh%element_section(e))%reference)
               if (along_z(1) > 0) balance(:, along_z) = balance(:, along_z) - &
                  of_nodes(:, nodes_per_element + 1:)
            end associate
         end associate
      end do
      forces = merge([balance], forces, [spread(self%follows, 1, 2)])
   end function forces_beyond

   !> Tangents of the stress at a solution, where materials have laws.
   subroutine find_tangents(self, model, at, tangent)
      class(corrections_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: at            !! the solution
      !> (16*materials of the points), or none [stress]
      real(dp), allocatable, intent(out) :: tangent(:)
      type(law_points_type) :: points
      real(dp) :: u(2, size(at%temperature))
      integer :: g, i

      if (.not. allocated(self%history%before)) return
      u = reshape(at%displacement, shape(u))
      call self%points%set_temperature(model%mesh, at%temperature, model%initial_temperature)
      allocate (tangent(16*size(self%points%materials)), source=0.0_dp)
      do i = 1, size(self%elements)
         associate (e => self%elements(i))
            if (.not. self%points%follows_law(model%mesh, e)) cycle
            call self%points%respond(model%mesh, e, u, at%temperature - &
               model%initial_temperature, self%history, points)
            do g = 1, points%count
               associate (own => self%points%at_point(e, g))
                  ! The part that energy has: operators are symmetric. A part of the elasticity
                  ! keeps them regular.
                  tangent(16*own - 15:16*own) = [(1.0_dp - self%elastic_part)/2*(points%tangent(:, &
                     :, g) + transpose(points%tangent(:, :, g))) + &
                     self%elastic_part*points%stiffness(g)*self%points%materials(own)%elasticity]
               end associate
            end do
         end associate
      end do
   end subroutine find_tangents

   !> Heat contents of the bodies whose materials vary, and latent heat of all, on the nodes.
   pure function true_contents(self, model, temperature) result(contents)
      class(corrections_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)                 !! (nodes) [temperature]
      real(dp) :: contents(size(temperature))                !! (nodes) [energy]
      integer :: i

      contents = 0.0_dp
      do i = 1, size(self%elements)
         call self%contents%add_contents(model%mesh, self%elements(i), temperature, contents)
      end do
      if (self%melting%acts) contents = contents + self%melting%contents(model, temperature)
   end function true_contents

   !> Largest heat and forces of a solution, by which what is left over is small; at least those of
   !> which the rounding of their terms is the settled part.
   function scales_of(self, model, bodies, next) result(scale)
      class(corrections_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: next
      real(dp) :: scale(size(self%values)), heat, force, least(2)

      least = rounding/settled*largest_terms(self, model, bodies, next)
      associate (n => size(next%temperature))
         heat = max(maxval(abs(self%values(:2*n))), least(1))
         if (allocated(bodies%thermal%matrix%value)) heat = max(heat, &
            maxval(abs(bodies%thermal%matrix%multiply(next%temperature))))
         if (self%stage%stores_heat) heat = max(heat, maxval(abs(bodies%capacity%multiply( &
            next%temperature - self%stage%temperature)))/self%stage%duration)
         if (allocated(self%strain_before)) heat = max(heat, maxval(abs( &
            bodies%dilatation%of_strains(bodies%thermal_load, next%displacement - &
            self%stage%displacement)))/self%stage%duration)
         if (self%has_laws) then
            ! Inelastic strains may be far larger than the elastic ones.
            force = max(self%largest_force, least(2))
         else
            force = least(2)
            if (allocated(bodies%mechanical%matrix%value)) force = max(force, maxval(abs( &
               bodies%evened(self%values(2*n + 1:)))), maxval(abs(bodies%evened( &
               bodies%mechanical%matrix%multiply(next%displacement)))))
         end if
         scale(:2*n) = max(heat, tiny(heat))
         scale(2*n + 1:) = max(force, tiny(force))
         if (allocated(bodies%mechanical%lever)) scale(2*n + bodies%points%along_z) = &
            scale(2*n + 1)*bodies%mechanical%lever
      end associate
   end function scales_of

   !> Largest terms of which heat and forces are sums. They cancel where a body has one temperature,
   !> or moves as a whole.
   pure function largest_terms(self, model, bodies, next) result(terms)
      type(corrections_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: next
      real(dp) :: terms(2)                                   ! [power], [force]
      real(dp) :: shift, stored, thermal_load, warmth

      warmth = maxval(abs(next%temperature))
      shift = bodies%largest_displacement(next%displacement)
      thermal_load = 0.0_dp
      if (allocated(bodies%thermal_load%value)) thermal_load = &
         largest_of(bodies%thermal_load, bodies%points%along_z)
      terms(1) = bodies%thermal%largest_entry*warmth
      if (self%stage%stores_heat) then
         stored = max(maxval(abs(self%stage%content)), maxval(bodies%capacity%multiply( &
            abs(next%temperature))))
         if (self%stage%dilates) stored = max(stored, maxval(bodies%capacity%multiply( &
            bodies%dilatation%absolute)), maxval(bodies%dilatation%absolute)*thermal_load*shift)
         if (self%melting%acts) stored = max(stored, self%melting%unresolved(model, &
            next%temperature)/rounding)
         terms(1) = max(terms(1), stored/self%stage%duration)
      end if
      terms(2) = max(bodies%mechanical%largest_entry*shift, thermal_load*max(warmth, &
         maxval(abs(model%initial_temperature)), maxval(abs(model%materials%no_strain))))
      if (allocated(self%initial_force)) terms(2) = max(terms(2), &
         maxval(abs(bodies%evened(self%initial_force))))
   end function largest_terms

end module operator_corrections
