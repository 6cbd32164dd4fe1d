!> Groups `/history`, `/convergence`, `/contact/<name>` and `/errors` of the result file.
module result_tables
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_values, estimated, geometry_values
   use growing_datasets, only: growing_dataset, growing_dataset_type, quantity_dataset
   use hdf5_writer, only: as_integer, as_real, hdf5_writer_type
   use increment_quantities, only: body_values, history_value, pass_value
   use kinds, only: dp
   use model, only: model_type, unit_labels_type
   use quantity_types, only: of_bodies, of_contact_points, quantity_type
   use records, only: contact_record_type, increment_record_type, interface_errors_type
   use reported_quantities, only: geometry
   use solution_report, only: iteration_record_type
   use unit_labels, only: unit_in_words
   implicit none
   private
   public :: result_table_type, error_results_type, storage_of, write_geometry

   !> A group with one dataset for each quantity: `/history` and `/contact/<name>` with one row an
   !> increment, `/convergence` with one row a pass.
   type :: result_table_type
      private
      type(quantity_type), allocatable :: quantities(:)            !! those that grow
      type(growing_dataset_type), allocatable, public :: sets(:)   !! one for each of them
   contains
      procedure :: start => start_table
      generic :: append => append_increment, append_passes, append_contact
      procedure, private :: append_increment, append_passes, append_contact
   end type result_table_type

   integer, parameter :: error_columns = 5   !! value, bound, its parts

   !> Group `/errors`, where errors are estimated: one row a step. `sets` holds the times, then for
   !> each interface one dataset for each quantity with an estimate.
   type :: error_results_type
      type(growing_dataset_type), allocatable :: sets(:)
   contains
      procedure :: start => start_errors
      procedure :: append => append_errors
      procedure :: create_groups => create_error_groups
   end type error_results_type

contains

   !> Type of a quantity in the file.
   pure integer function storage_of(quantity)
      type(quantity_type), intent(in) :: quantity

      storage_of = merge(as_integer, as_real, quantity%is_integer)
   end function storage_of

   !> Prepares the datasets of a group.
   subroutine start_table(self, group, reported, places, expected, labels)
      class(result_table_type), intent(inout) :: self
      character(*), intent(in) :: group                   !! its path, with a slash at the end
      type(quantity_type), intent(in) :: reported(:)
      integer, intent(in) :: places                       !! bodies or contact points
      integer, intent(in) :: expected                     !! rows that are expected
      type(unit_labels_type), intent(in) :: labels        !! units of the deck
      integer :: i, width

      self%quantities = reported
      allocate(self%sets(size(reported)))
      do i = 1, size(reported)
         width = merge(reported(i)%values, 0, reported(i)%values > 1)
         if (any(reported(i)%kind == [of_bodies, of_contact_points])) width = places
         self%sets(i) = quantity_dataset(group, reported(i), labels, storage_of(reported(i)), &
            width, 1, expected)
      end do
   end subroutine start_table

   !> Adds an increment of a model with as many bodies.
   subroutine append_increment(self, record, bodies)
      class(result_table_type), intent(inout) :: self     !! `/history`
      type(increment_record_type), intent(in) :: record
      integer, intent(in) :: bodies
      real(dp), allocatable :: values(:)
      integer :: i

      do i = 1, size(self%sets)
         if (self%quantities(i)%kind == of_bodies) then
            values = body_values(self%quantities(i)%name, record)
            if (size(values) == 0) values = spread(ieee_value(1.0_dp, ieee_quiet_nan), 1, bodies)
         else
            values = [history_value(self%quantities(i)%name, record)]
         end if
         call self%sets(i)%append(values)
      end do
   end subroutine append_increment

   !> Adds passes of the fixed point.
   subroutine append_passes(self, iterations)
      class(result_table_type), intent(inout) :: self          !! `/convergence`
      type(iteration_record_type), intent(in) :: iterations(:) !! passes, in their order
      integer :: i

      do i = 1, size(self%sets)
         call self%sets(i)%append(pass_value(self%quantities(i)%name, iterations))
      end do
   end subroutine append_passes

   !> Adds the contact points of an increment.
   subroutine append_contact(self, points, contact)
      class(result_table_type), intent(inout) :: self     !! `/contact/<name>`
      type(contact_points_type), intent(in) :: points     !! contact points of the interface
      type(contact_record_type), intent(in) :: contact    !! their state
      integer :: i

      do i = 1, size(self%sets)
         call self%sets(i)%append(contact_values(self%quantities(i)%name, points, contact))
      end do
   end subroutine append_contact

   !> Writes the geometry of contact points, those of some interfaces one behind the other.
   subroutine write_geometry(file, group, interfaces, node_number, labels)
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      character(*), intent(in) :: group                   !! its path, with a slash at the end
      type(contact_points_type), intent(in) :: interfaces(:)
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
      type(unit_labels_type), intent(in) :: labels        !! units of the deck
      type(quantity_type) :: quantity
      real(dp), allocatable :: values(:)
      integer :: i, k

      do k = 1, size(geometry)
         quantity = geometry(k)
         values = [real(dp) ::]
         do i = 1, size(interfaces)
            values = [values, geometry_values(quantity%name, interfaces(i), node_number)]
         end do
         if (quantity%is_integer) then
            call file%write(group//trim(quantity%name), nint(values), as_integer, &
               quantity%description)
         else
            call file%write(group//trim(quantity%name), values, quantity%description, &
               unit_in_words(quantity%unit, labels))
         end if
      end do
   end subroutine write_geometry

   !> Prepares the datasets; none without an interface or without estimates.
   subroutine start_errors(self, has_estimates, interfaces, steps, labels)
      class(error_results_type), intent(inout) :: self    !! the group
      logical, intent(in) :: has_estimates                !! whether errors are estimated
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer, intent(in) :: steps                        !! steps of the deck
      type(unit_labels_type), intent(in) :: labels        !! units of the deck
      integer :: i, q

      if (size(interfaces) == 0 .or. .not. has_estimates) then
         allocate(self%sets(0))
         return
      end if
      allocate(self%sets(1 + size(estimated)*size(interfaces)))
      self%sets(1) = growing_dataset('/errors/time', as_real, 0, 1, steps)
      call self%sets(1)%describe_as('total time at the end of the step', 'time', '')
      do i = 1, size(interfaces)
         do q = 1, size(estimated)
            associate (set => self%sets(1 + (i - 1)*size(estimated) + q))
               set = growing_dataset('/errors/'//interfaces(i)%name//'/'// &
                  trim(estimated(q)%name), as_real, error_columns, 1, steps)
               call set%describe_as('value and the bound of its error, with its parts: '// &
                  trim(estimated(q)%description), unit_in_words(estimated(q)%unit, labels), &
                  'value bound mesh increments iteration')
            end associate
         end do
      end do
   end subroutine start_errors

   !> Adds the end of a step.
   subroutine append_errors(self, time, errors)
      class(error_results_type), intent(inout) :: self        !! the group
      real(dp), intent(in) :: time                            !! total time [time]
      type(interface_errors_type), intent(in) :: errors(:)
      integer :: i, q

      call self%sets(1)%append([time])
      do i = 1, size(errors)
         do q = 1, size(estimated)
            call self%sets(1 + (i - 1)*size(estimated) + q)%append([errors(i)%value(q), &
               errors(i)%bound(q), errors(i)%mesh(q), errors(i)%increment(q), &
               errors(i)%iteration(q)])
         end do
      end do
   end subroutine append_errors

   !> Creates the groups.
   subroutine create_error_groups(self, file, interfaces)
      class(error_results_type), intent(in) :: self       !! the group, started
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      integer :: i

      if (size(self%sets) == 0) return
      call file%create_group('/errors')
      do i = 1, size(interfaces)
         call file%create_group('/errors/'//interfaces(i)%name)
      end do
   end subroutine create_error_groups

end module result_tables
