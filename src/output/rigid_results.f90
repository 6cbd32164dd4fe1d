!> Group `/rigid_surfaces` of the result file: the drawings and lines of rigid bodies, which have no
!> elements, for pictures.
module rigid_results
   use growing_datasets, only: growing_dataset, write_once
   use hdf5_writer, only: as_real, hdf5_writer_type
   use kinds, only: dp
   use mesh, only: mesh_type
   implicit none
   private
   public :: write_rigid_surfaces

   character(*), parameter :: rigid_group = '/rigid_surfaces'

contains

   !> Writes each rigid surface before deformation as points of a line, arcs divided finely, with
   !> the nodes that it follows. Without such surfaces there is no group.
   subroutine write_rigid_surfaces(file, mesh)
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      type(mesh_type), intent(in) :: mesh
      real(dp), allocatable :: points(:, :)
      real(dp) :: none(2, 0)
      integer :: i

      do i = 1, size(mesh%surfaces)
         if (.not. allocated(mesh%surfaces(i)%drawing)) cycle
         associate (line => mesh%surfaces(i)%drawing, group => rigid_group//'/'// &
            mesh%surfaces(i)%name)
            if (line%reference == 0) cycle
            if (.not. file%has(rigid_group)) call file%create_group(rigid_group)
            call file%create_group(group)
            points = line%samples(none)
            if (line%closed) points = reshape([points, points(:, 1)], shape(points) + [0, 1])
            call write_once(file, growing_dataset(group//'/points', as_real, 2, size(points, 2), &
               1, 'coordinates before deformation, from the first end to the last', 'length'), &
               reshape(points, [size(points)]))
            call file%set(group, 'reference_node', mesh%node_number(line%reference))
            call file%set(group, 'rotation_node', mesh%node_number(line%rotation))
         end associate
      end do
   end subroutine write_rigid_surfaces

end module rigid_results
