!> Equilibrium reduced to the contact points: factors, the contact system from their Schur
!> complement, and why a stiffness is singular although the rigid motions of its bodies are held.
module equilibrium_reduction
   use connections, only: connections_type
   use field_constraints, only: cycle_compliance, in_cycle, stiffness_alone
   use contact_system, only: contact_system_type
   use errors, only: error_type, status_deck
   use field_problem, only: field_problem_type, field_reduction_type
   use kinds, only: dp
   use linear_constraints, only: linear_constraints_type, node_stiffness
   use mesh, only: extent_of
   use mesh_bodies, only: body_name
   use model, only: model_type
   use sparse_matrix, only: sparse_matrix_type
   use sum_lists, only: sum_list_type
   use text, only: to_text
   implicit none
   private
   public :: equilibrium_reduction_type

   !> Part of the bodies' stiffness at its nodes below which a contact point's is rounding.
   real(dp), parameter :: strainless = 1.0e-10_dp

   !> Equilibrium, (2.4), reduced for a set of supports.
   type, extends(field_reduction_type) :: equilibrium_reduction_type
      type(contact_system_type) :: contact                !! partial solution of (2.4)
   contains
      procedure :: reduce
   end type equilibrium_reduction_type

   real(dp), parameter :: rounding = 1.0e-15_dp  !! of coordinates, in the extent of the model

   !> Ratio of the stiffnesses of two bodies from which rounding of the one hides the other
   real(dp), parameter :: hidden = 1.0e12_dp

contains

   !> Factors the stiffness, and forms the contact system, nothing closed.
   !> Errors: unconstrained bodies, a failure of the solver.
   subroutine reduce(self, model, mechanical, points, rigid, node_rank, error)
      class(equilibrium_reduction_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(field_problem_type), intent(in) :: mechanical  !! equilibrium, numbered
      type(connections_type), intent(in) :: points !! all contact points
      type(sum_list_type), intent(in) :: rigid !! (motions, 2 nodes) that the supports leave free
      !> (nodes) ranks in nested dissection, where they are known
      integer, allocatable, intent(in) :: node_rank(:)
      type(error_type), allocatable, intent(out) :: error
      type(contact_system_type) :: former, fresh
      character(:), allocatable :: words

      if (mechanical%division%cuts_bodies()) call self%release_tail()
      call self%factor(mechanical, sparse_matrix_type(), model%solver, node_rank, error)
      if (allocated(error)) then
         words = weakness_of_bodies(model)
         if (len(words) == 0) words = lost_place(model, self%lost_node)
         if (error%status == status_deck .and. len(words) > 0) error%message = &
            error%message//'; '//words
         return
      end if
      if (self%contact%schur%is_sparse()) former = self%contact
      self%contact = fresh
      associate (contact => self%contact, map => mechanical%map)
         contact%interface_start = points%interface_start
         contact%normal = map%tail_index(map%introduced(1::2))
         contact%tangent = merge(map%tail_index(map%introduced(2::2)), 0, map%acts(2::2))
         call move_alloc(self%schur%full, contact%schur%full)
         contact%schur%sparse = self%schur%sparse
         contact%schur%order = self%schur%order
         contact%schur%rank = self%schur%rank
         contact%own = contact%schur%diagonal()
         call set_motions(points, map, rigid, contact)
         call set_cycles(mechanical, points, contact)
         if (contact%schur%is_sparse()) call contact%set_fronts(former, error)
      end associate
      self%contact%least_length = rounding*extent_of(model%mesh%coordinates)
   end subroutine reduce

   !> The rigid motions that the supports leave free, on the tail. In exact arithmetic they need no
   !> force; what a full S makes of them is rounding, and is taken from it.
   pure subroutine set_motions(points, map, rigid, contact)
      type(connections_type), intent(in) :: points
      type(linear_constraints_type), intent(in) :: map
      type(sum_list_type), intent(in) :: rigid
      type(contact_system_type), intent(inout) :: contact
      type(sum_list_type) :: on_tail
      real(dp), allocatable :: forces(:, :)
      real(dp) :: field(size(map%by_unknowns%start) - 1), motion(contact%schur%order), &
         relative(2, size(points%slave))
      integer :: dof(contact%schur%order), i, k

      dof = 0
      if (contact%schur%is_sparse()) dof = face_freedoms(map, contact%schur%order)
      call on_tail%reserve(rigid%count, 2*size(rigid%value))
      do i = 1, rigid%count
         field = 0.0_dp
         field(rigid%values_of(i)) = rigid%coefficients_of(i)
         motion = 0.0_dp
         relative = points%relative(field)
         do k = 1, size(points%slave)
            motion(contact%normal(k)) = dot_product(points%normal(:, k), relative(:, k))
            ! One without friction is an unknown of a sparse tail, too.
            associate (row => map%tail_index(map%introduced(2*k)))
               if (row > 0) motion(row) = dot_product(points%tangent(:, k), relative(:, k))
            end associate
         end do
         associate (by => map%by_unknowns)
            do k = 1, size(dof)
               if (dof(k) > 0) motion(k) = field(dof(k))/by%coefficient(by%start(dof(k)))
            end do
         end associate
         call on_tail%add([(k, k=1, size(motion))], motion)
      end do
      call contact%motions%set(on_tail, contact%schur%order, .not. contact%schur%is_sparse())
      if (contact%schur%is_sparse() .or. contact%motions%basis%count == 0) return
      associate (z => contact%motions%basis%as_columns(contact%schur%order))
         forces = matmul(contact%schur%full, z)
         contact%schur%full = contact%schur%full - matmul(forces, transpose(z)) - &
            matmul(z, transpose(forces)) + &
            matmul(z, matmul(matmul(transpose(z), forces), transpose(z)))
      end associate
      contact%own = contact%schur%diagonal()
   end subroutine set_motions

   !> Degree of freedom that a row of the tail is, where it is that of a face node; else 0.
   pure function face_freedoms(map, tail) result(freedom)
      type(linear_constraints_type), intent(in) :: map
      integer, intent(in) :: tail
      integer :: freedom(tail)
      logical :: is_face(tail)
      integer :: dof

      is_face = .true.
      is_face(pack(map%tail_index(map%introduced), map%tail_index(map%introduced) > 0)) = .false.
      freedom = 0
      associate (by => map%by_unknowns)
         do dof = 1, by%count
            if (by%start(dof + 1) - by%start(dof) /= 1) cycle
            associate (k => map%tail_index(by%value(by%start(dof))))
               if (k == 0) cycle
               if (is_face(k)) freedom(k) = dof
            end associate
         end do
      end associate
   end function face_freedoms

   !> The links of the cycles, the compliance of their stuck contact points, and what each contact
   !> point has for stiffness alone.
   pure subroutine set_cycles(mechanical, points, contact)
      type(field_problem_type), intent(in) :: mechanical
      type(connections_type), intent(in) :: points
      type(contact_system_type), intent(inout) :: contact
      logical :: acted(contact%schur%order)
      integer :: k
      real(dp) :: own

      associate (map => mechanical%map, cyclic => in_cycle(mechanical%map, size(points%slave)))
         acted = .false.
         acted(contact%normal) = .true.
         acted(pack(contact%tangent, contact%tangent > 0)) = .true.
         contact%link = pack([(k, k=1, size(acted))], .not. acted)
         contact%links = size(map%link_force)
         allocate (contact%compliance(size(points%slave)), source=0.0_dp)
         contact%alone = contact%own(contact%normal)
         contact%nodal_stiffness = contact%alone
         do k = 1, size(points%slave)
            associate (nodes => points%nodes_of(k))
               own = node_stiffness(mechanical%matrix, nodes, 2)
               if (own > 0.0_dp) contact%nodal_stiffness(k) = own
               if (.not. cyclic(k)) then
                  ! Two contact points that carry a body on their own move it without any strain.
                  if (contact%alone(k) <= strainless*own) contact%alone(k) = own
                  cycle
               end if
               contact%compliance(k) = cycle_compliance/own
               contact%alone(k) = stiffness_alone(contact%alone(k), mechanical%matrix, nodes, 2)
            end associate
         end do
      end associate
   end subroutine set_cycles

   !> Where a matrix is singular, in words; empty where that is not known.
   pure function lost_place(model, node) result(words)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node          !! index, or 0
      character(:), allocatable :: words

      words = ''
      if (node == 0) return
      words = 'nothing resists it at node '//to_text(model%mesh%node_number(node))
      if (model%mesh%node_body(node) > 0) words = words//' of '//body_name(model, &
         model%mesh%node_body(node))
   end function lost_place

   !> The first body whose material explains a singular matrix, and what to do; empty where none
   !> does.
   pure function weakness_of_bodies(model) result(words)
      type(model_type), intent(in) :: model
      character(:), allocatable :: words   !! such as 'body 1 (...) is ...: check'
      real(dp) :: stiffness(model%mesh%body_count)
      integer :: body, e

      words = ''
      associate (mesh => model%mesh)
         stiffness = 0.0_dp
         do e = 1, size(mesh%element_body)
            associate (own => stiffness(mesh%element_body(e)))
               own = max(own, maxval(abs(model%materials(model%sections( &
                  mesh%element_section(e))%material)%elasticity)))
            end associate
         end do
         do body = 1, mesh%body_count
            if (stiffness(body) < maxval(stiffness)/hidden) then
               words = body_name(model, body)//' is '//to_text(maxval(stiffness)/stiffness(body)) &
                  //' times softer than '//body_name(model, maxloc(stiffness, dim=1))// &
                  ': check the values and units of *ELASTIC'
               return
            end if
         end do
      end associate
   end function weakness_of_bodies

end module equilibrium_reduction
