!> Two blocks on each other, on which procedures of several folders are tested.
module sample_blocks
   use mesh_bodies, only: find_bodies
   use conductance_laws, only: law_power
   use elasticity, only: isotropic_elasticity
   use element_kinds, only: plane_strain, quad8
   use errors, only: error_type
   use increments, only: advance
   use kinds, only: dp
   use mesh, only: mesh_type
   use model, only: model_type
   use records, only: increment_record_type
   use simulation, only: simulation_type
   use steps, only: analysis_static, boundary_type, load_pressure, load_type
   implicit none
   private
   public :: two_blocks, add_block, hold, press, solve, width, gap, top

   real(dp), parameter :: width = 2.0_dp, gap = 0.01_dp
   real(dp), parameter :: top = 2.5_dp + gap   !! the lower block is 1 high, the upper one 1.5

contains

   !> Lower block (nodes 1-21, elements 1-4, section 1) and upper block, the slave (nodes 22-42,
   !> elements 5-8, section 2), each of 2 x 2 elements with moved inner nodes. One static step.
   function two_blocks(friction, conductance) result(model)
      real(dp), intent(in) :: friction, conductance
      type(model_type), pointer :: model
      integer :: i

      allocate (model)
      allocate (model%mesh%coordinates(2, 42), model%mesh%element_nodes(8, 8))
      allocate (model%mesh%element_kind(8), source=quad8)
      allocate (model%mesh%element_plane(8), source=plane_strain)
      call add_block(0.0_dp, 1.0_dp, 0, model%mesh)
      call add_block(1.0_dp + gap, 1.5_dp, 1, model%mesh)
      model%mesh%node_number = [(i, i=1, 42)]
      model%mesh%element_number = [(i, i=1, 8)]
      model%mesh%element_section = [1, 1, 1, 1, 2, 2, 2, 2]
      model%mesh%element_kind = spread(quad8, 1, 8)
      model%mesh%element_plane = spread(plane_strain, 1, 8)
      call find_bodies(model%mesh)
      allocate (model%mesh%surfaces(2), model%materials(2), model%sections(2))
      model%mesh%surfaces(1)%name = 'UPPER'
      model%mesh%surfaces(1)%faces = reshape([5, 1, 6, 1], [2, 2])
      model%mesh%surfaces(2)%name = 'LOWER'
      model%mesh%surfaces(2)%faces = reshape([3, 3, 4, 3], [2, 2])
      model%sections%material = [1, 2]
      model%sections%thickness = 0.5_dp
      model%materials(1)%elasticity = isotropic_elasticity(1000.0_dp, 0.3_dp)
      model%materials(2)%elasticity = isotropic_elasticity(3000.0_dp, 0.2_dp)
      model%materials(1)%conductivity = 2.0_dp
      model%materials(2)%conductivity = 5.0_dp
      allocate (model%interactions(1), model%contacts(1), model%ties(0), model%equations(0), &
         model%bars(0), model%couplings(0), model%amplitudes(0), model%steps(1))
      allocate (model%verifications(0), model%orientations(0))
      model%interactions(1)%friction%coefficient = friction
      model%interactions(1)%law%closed_kind = law_power
      model%interactions(1)%law%power_c0 = conductance
      model%contacts(1)%name = 'FACE'
      model%contacts(1)%slave = 1
      model%contacts(1)%master = 2
      model%contacts(1)%interaction = 1
      model%initial_temperature = [(0.0_dp, i=1, 42)]
      model%steps(1)%analysis = analysis_static
      allocate (model%steps(1)%boundaries(0), model%steps(1)%loads(0))
   end function two_blocks

   subroutine add_block(bottom, height, block, mesh)
      real(dp), intent(in) :: bottom, height
      integer, intent(in) :: block   !! 0 or 1
      type(mesh_type), intent(inout) :: mesh
      integer, parameter :: corner(2, 8) = reshape( &
         [0, 0, 2, 0, 2, 2, 0, 2, 1, 0, 2, 1, 1, 2, 0, 1], [2, 8])
      real(dp), parameter :: column(0:4) = [0.0_dp, 0.4_dp, 0.8_dp, 1.4_dp, 2.0_dp]
      integer :: number(0:4, 0:4), i, j, n, q

      n = 21*block
      do j = 0, 4
         do i = 0, 4
            if (mod(i, 2) == 1 .and. mod(j, 2) == 1) cycle
            n = n + 1
            number(i, j) = n
            mesh%coordinates(:, n) = [column(i), bottom + 0.25_dp*j*height]
            if (i == 0 .or. i == 4 .or. j == 0 .or. j == 4) cycle
            mesh%coordinates(:, n) = mesh%coordinates(:, n) + 0.05_dp*[sin(2.0_dp*n), cos(3.0_dp*n)]
         end do
      end do
      do j = 0, 1
         do i = 0, 1
            do q = 1, 8
               mesh%element_nodes(q, 4*block + 1 + i + 2*j) = &
                  number(2*i + corner(1, q), 2*j + corner(2, q))
            end do
         end do
      end do
   end subroutine add_block

   !> Prescribes a degree of freedom of all nodes with this coordinate.
   subroutine hold(model, axis, at, dof, value)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: axis, dof
      real(dp), intent(in) :: at, value
      integer :: node

      associate (step => model%steps(1))
         do node = 1, size(model%mesh%node_number)
            if (abs(model%mesh%coordinates(axis, node) - at) > 1.0e-9_dp) cycle
            step%boundaries = [step%boundaries, boundary_type(node=node, dof=dof, value=value, &
               card=1 + maxval([0, step%boundaries%card]))]
         end do
      end associate
   end subroutine hold

   !> Pressure on the top of the upper block.
   subroutine press(model, pressure)
      type(model_type), intent(inout) :: model
      real(dp), intent(in) :: pressure

      model%steps(1)%loads = [load_type(load_pressure, item=7, component=3, value=pressure), &
         load_type(load_pressure, item=8, component=3, value=pressure)]
   end subroutine press

   !> The last increment of a run, and what went wrong in it, empty where nothing did.
   subroutine solve(model, record, failure)
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(out) :: record
      character(:), allocatable, intent(out) :: failure
      type(simulation_type), allocatable :: simulation
      type(error_type), allocatable :: error

      failure = ''
      allocate (simulation)
      call simulation%start(model, error)
      do while (.not. allocated(error))
         if (simulation%finished(model)) exit
         call advance(simulation, model, record, error)
      end do
      if (allocated(error)) failure = error%message
      call simulation%release()
   end subroutine solve

end module sample_blocks
