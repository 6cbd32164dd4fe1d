!> The memory that a run will need, before its mesh is refined and anything is factored.
!>
!> The entries of matrices and factors follow from the mesh: the profile of the skyline is that of
!> the unrefined mesh in its profile order, and grows eightfold with each refinement; factors in
!> nested dissection have 31/4 n log2 n entries (A. George, Nested dissection of a regular finite
!> element mesh, 1973). How often entries are held at a time was measured, src/model/README.md.
module memory_needs
   use contact_definitions, only: makes_friction_heat
   use controls, only: default_solver, solver_by_size, solver_mumps
   use element_kinds, only: element_node_count, linear_kind
   use kinds, only: dp
   use materials, only: heat_capacity
   use model, only: has_sparse_tail, model_type, uncertainty_full, uncertainty_last
   use ordering, only: adjacency, first_rows, profile_order
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   use steps, only: planned_increments, solves_heat, solves_mechanics
   implicit none
   private
   public :: memory_needed

   real(dp), parameter :: real_bytes = 8.0_dp          !! of a number
   real(dp), parameter :: base = 40.0e6_dp             !! of the program and its libraries [byte]
   real(dp), parameter :: per_entry = 33.0_dp          !! of an entry of element matrices [byte]
   real(dp), parameter :: per_fine_entry = 26.0_dp     !! of one, for the finer mesh [byte]
   real(dp), parameter :: finer = 2.5_dp !! of entries and factors, where most elements are divided
   real(dp), parameter :: mumps_factor = 1.25_dp       !! MUMPS's memory in that of its factors
   real(dp), parameter :: waiting = 70.0e6_dp          !! most of results that wait [byte]
   real(dp), parameter :: field_values = 25.0_dp       !! of a node and written increment that wait
   real(dp), parameter :: dense_matrices = 12.0_dp     !! of the contact unknowns, held at a time
   real(dp), parameter :: bytes_per_point = 50.0e3_dp  !! of a contact point on a sparse tail
   !> Numbers of a node and contact point: of responses at the rates of *STABILITY, and to heat of
   !> friction.
   real(dp), parameter :: motion_responses = 13.0_dp, friction_responses = 3.0_dp
   real(dp), parameter :: motion_products = 250.0_dp   !! of a node, on a sparse tail

contains

   !> The largest memory that a run holds at a time, estimated on the mesh before it is refined:
   !> with ERRORS=FULL that of two runs.
   function memory_needed(model, levels, order) result(bytes)
      type(model_type), intent(in) :: model   !! the model, unrefined and with all nodes
      integer, intent(in) :: levels           !! refinements that are to come
      integer, intent(in) :: order            !! 1 where midside nodes are to be dropped, else 2
      real(dp) :: bytes                       !! [byte]

      bytes = memory_of_run(model, levels, order)
      if (model%uncertainty == uncertainty_full) bytes = bytes + memory_of_run(model, levels + 1, &
         order) - base
   end function memory_needed

   !> The largest memory of one run, with the ends of steps on a finer mesh.
   function memory_of_run(model, levels, order) result(bytes)
      type(model_type), intent(in) :: model   !! the model, unrefined and with all nodes
      integer, intent(in) :: levels           !! refinements that are to come
      integer, intent(in) :: order            !! 1 where midside nodes are to be dropped, else 2
      real(dp) :: bytes                       !! [byte]
      real(dp) :: entries, factors, nodes, points, written
      type(sparse_matrix_type) :: lower
      integer, allocatable :: kinds(:)
      integer :: i, solver
      logical :: has_finer_mesh, heat, mechanics

      heat = any(solves_heat(model%steps%analysis))
      mechanics = any(solves_mechanics(model%steps%analysis))
      kinds = model%mesh%element_kind
      if (order == 1) kinds = linear_kind(kinds)
      nodes = size(model%mesh%node_number)*4.0_dp**levels
      points = sum([(2*size(model%mesh%surfaces(model%contacts(i)%slave)%faces, 2) + 1, &
         i=1, size(model%contacts))])*2.0_dp**levels
      entries = entries_of(kinds, heat, mechanics)*4.0_dp**levels
      ! Every n-th increment of a step and its last are written, of n = 0 the last alone.
      written = sum(1 + merge(min(planned_increments(model%steps), &
         real(model%steps%max_increments, dp))/max(model%steps%field_frequency, 1), 0.0_dp, &
         model%steps%field_frequency > 0))
      bytes = base + per_entry*entries + min(waiting, real_bytes*field_values*nodes*written) + &
         merge(bytes_per_point*points, dense_matrices*real_bytes*(3*points)**2, &
         has_sparse_tail(model, points))
      if (any(model%steps%stability_frequency > 0) .and. any(heat_capacity(model%materials) > &
         0.0_dp)) bytes = bytes + real_bytes*nodes*merge(motion_products, &
         motion_responses*points, has_sparse_tail(model, points))
      if (makes_friction_heat(model%interactions, model%contacts) .and. .not. &
         has_sparse_tail(model, points)) bytes = bytes + real_bytes*friction_responses*nodes*points
      ! The finer mesh has room for both fields.
      has_finer_mesh = model%uncertainty == uncertainty_last
      if (has_finer_mesh) bytes = bytes + finer*per_fine_entry*entries_of(kinds, .true., .true.)* &
         4.0_dp**levels
      solver = model%solver
      if (solver == solver_by_size) solver = default_solver(nodes, mechanics)
      if (solver == solver_mumps) then
         factors = mumps_factor*(dissected(2*nodes, mechanics) + dissected(nodes, heat))
      else
         ! Entries of the skyline of one unknown a node, with the columns of the contact points.
         lower = node_graph(model, kinds)
         associate (position => profile_order(adjacency(lower, [(i, i=1, lower%row_count)])))
            factors = sum([(i, i=1, size(position))] - first_rows(lower, position) + 1.0_dp)* &
               8.0_dp**levels
            factors = (merge(4, 0, mechanics) + merge(1, 0, heat))*(factors + &
               points*size(position)*4.0_dp**levels)
         end associate
      end if
      bytes = bytes + real_bytes*factors
      if (has_finer_mesh) bytes = bytes + finer*real_bytes*factors
   end function memory_of_run

   !> Entries of the matrices of all elements.
   pure real(dp) function entries_of(kinds, heat, mechanics)
      integer, intent(in) :: kinds(:)
      logical, intent(in) :: heat, mechanics
      integer :: of_two_nodes

      of_two_nodes = merge(1, 0, heat) + merge(4, 0, mechanics) + merge(2, 0, heat .and. mechanics)
      entries_of = of_two_nodes*sum(real(element_node_count(kinds), dp)**2)
   end function entries_of

   !> Entries of factors in nested dissection; 0 where a field is not solved.
   pure real(dp) function dissected(unknowns, is_solved)
      real(dp), intent(in) :: unknowns
      logical, intent(in) :: is_solved

      dissected = 0.0_dp
      if (is_solved) dissected = 7.75_dp*unknowns*log(max(unknowns, 2.0_dp))/log(2.0_dp)
   end function dissected

   !> Nodes that are joined by an element, lower triangle with its diagonal.
   function node_graph(model, kinds) result(lower)
      type(model_type), intent(in) :: model
      integer, intent(in) :: kinds(:)
      type(sparse_matrix_type) :: lower
      type(triplet_list_type) :: list
      integer :: e, i, j, n

      n = size(model%mesh%node_number)
      call list%reserve(n + sum(element_node_count(kinds)**2))
      do i = 1, n
         call list%add(i, i, 1.0_dp)
      end do
      do e = 1, size(kinds)
         associate (nodes => model%mesh%element_nodes(:element_node_count(kinds(e)), e))
            do i = 1, size(nodes)
               do j = 1, size(nodes)
                  if (nodes(j) < nodes(i)) call list%add(nodes(i), nodes(j), 1.0_dp)
               end do
            end do
         end associate
      end do
      lower = list%compress(n, n)
   end function node_graph

end module memory_needs
