!> Groups `/history`, `/convergence`, `/contact/<name>` and `/uncertainty` of the result file, whose
!> datasets grow row by row; and `/rigid_surfaces`, the drawings of rigid bodies for pictures.
module result_tables
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, geometry_values
   use growing_datasets, only: growing_dataset, growing_dataset_type, quantity_dataset, write_once
   use hdf5_writer, only: as_real, hdf5_writer_type
   use increment_quantities, only: part_values, history_value, pass_value
   use kinds, only: dp
   use mesh, only: mesh_type
   use quantity_types, only: of_bodies, of_contact_points, of_history, of_interface, of_motions, &
      of_passes, of_references, of_sections, quantity_type
   use records, only: increment_record_type, uncertainty_type
   use reported_quantities, only: geometry
   implicit none
   private
   public :: result_table_type, with_uncertainty, write_geometry, write_rigid_surfaces

   character(*), parameter :: rigid_group = '/rigid_surfaces'

   !> A group with one dataset for each quantity: `/history` and `/contact/<name>` with one row an
   !> increment, `/convergence` with one row a pass, `/uncertainty` and `/uncertainty/<name>` with
   !> one row a step.
   type :: result_table_type
      character(:), allocatable :: group                           !! its path
      type(quantity_type), allocatable, private :: quantities(:)   !! those that grow
      type(growing_dataset_type), allocatable :: sets(:)           !! one for each of them
   contains
      procedure :: start => start_table
      procedure :: rows
      generic :: append => append_increment, append_uncertainties
      procedure, private :: append_increment, append_uncertainties
   end type result_table_type

contains

   !> Prepares the datasets of a group.
   subroutine start_table(self, group, reported, places, expected)
      class(result_table_type), intent(inout) :: self
      character(*), intent(in) :: group                   !! its path
      type(quantity_type), intent(in) :: reported(:)
      integer, intent(in) :: places                       !! bodies or contact points
      integer, intent(in) :: expected                     !! rows that are expected
      integer :: i

      self%group = group
      self%quantities = reported
      allocate(self%sets(size(reported)))
      do i = 1, size(reported)
         self%sets(i) = quantity_dataset(group//'/', reported(i), 1, expected, places)
      end do
   end subroutine start_table

   !> Rows so far.
   pure integer function rows(self)
      class(result_table_type), intent(in) :: self

      rows = 0
      if (size(self%sets) > 0) rows = self%sets(1)%rows()
   end function rows

   !> Adds what an increment has: the passes of the fixed point in `/convergence`.
   subroutine append_increment(self, record, i)
      class(result_table_type), intent(inout) :: self
      type(increment_record_type), intent(in) :: record
      integer, intent(in), optional :: i                  !! interface of `/contact/<name>`
      real(dp), allocatable :: values(:)
      integer :: k

      do k = 1, size(self%sets)
         associate (quantity => self%quantities(k))
            select case (quantity%kind)
            case (of_passes)
               values = pass_value(quantity%name, record%iterations)
            case (of_contact_points, of_interface)
               values = contact_values(quantity%name, record%contacts(i))
            case (of_bodies, of_sections, of_references, of_motions)
               values = part_values(quantity, record)
            case default
               values = [history_value(quantity%name, record)]
            end select
         end associate
         call self%sets(k)%append(values)
      end do
   end subroutine append_increment

   !> Adds the uncertainties of an interface, a body or the increment.
   subroutine append_uncertainties(self, errors)
      class(result_table_type), intent(inout) :: self     !! `/uncertainty/<name>`
      type(uncertainty_type), intent(in) :: errors(:)
      integer :: i

      ! Strains come last, and are left out without laws.
      do i = 1, size(self%sets) - 1
         call self%sets(i)%append([errors(i)%value, errors(i)%total, errors(i)%change, &
            errors(i)%scatter, errors(i)%iteration])
      end do
      call self%sets(size(self%sets))%append(real(errors(:size(self%sets) - 1)%no_estimate, dp))
   end subroutine append_uncertainties

   !> Quantities with uncertainties, as they are in `/uncertainty/<name>`, and why there are none.
   pure function with_uncertainty(estimated) result(quantities)
      type(quantity_type), intent(in) :: estimated(:)
      type(quantity_type) :: quantities(size(estimated) + 1), reason
      integer :: i

      reason = quantity_type('no_estimate', of_history, '-', is_integer=.true., &
         description='reason for which a quantity has none, a row of /uncertainty/reasons from 0')
      reason%components = ''
      do i = 1, size(estimated)
         quantities(i) = estimated(i)
         quantities(i)%values = 5
         quantities(i)%components = 'value uncertainty change scatter iteration'
         quantities(i)%description = 'value and its numerical uncertainty (95 %), with its '// &
            'parts: '//trim(estimated(i)%description)
         reason%components = trim(reason%components)//' '//estimated(i)%name
      end do
      reason%components = adjustl(reason%components)
      reason%values = size(estimated)
      quantities(size(quantities)) = reason
      quantities%kind = of_history   ! every table has one row at a time, whatever it is of
   end function with_uncertainty

   !> Writes the geometry of contact points, those of some interfaces one behind the other.
   subroutine write_geometry(file, group, interfaces, node_number)
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      character(*), intent(in) :: group                   !! its path, with a slash at the end
      type(contact_points_type), intent(in) :: interfaces(:)
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
      real(dp), allocatable :: values(:)
      integer :: i, k

      do k = 1, size(geometry)
         values = [real(dp) ::]
         do i = 1, size(interfaces)
            values = [values, geometry_values(geometry(k)%name, interfaces(i), node_number)]
         end do
         call write_once(file, quantity_dataset(group, geometry(k), 1, 1), values)
      end do
   end subroutine write_geometry

   !> Writes each rigid surface, which has no elements, before deformation as points of a line, arcs
   !> divided finely, with the nodes that it follows. Without such surfaces there is no group.
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

end module result_tables
