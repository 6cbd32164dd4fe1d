!> Groups `/history`, `/convergence`, `/contact/<name>` and `/errors` of the result file.
module result_tables
   use contact_pairs, only: contact_pairs_type
   use errors, only: error_type
   use growing_datasets, only: growing_dataset, growing_dataset_type
   use hdf5, only: hid_t
   use hdf5_attributes, only: write_attribute
   use hdf5_helpers, only: as_integer, as_real, create_group, write_array
   use kinds, only: dp
   use record_values, only: contact_edge_names, contact_heat_names, contact_pair_names, &
      contact_total_names, contact_values, history_body_names, history_body_values, history_names, &
      history_value, name_length
   use records, only: contact_record_type, estimated_names, estimated_quantities, &
      increment_record_type, interface_errors_type
   use solution_report, only: iteration_record_type
   use zone_edges, only: edges_kept
   implicit none
   private
   public :: history_results_type, convergence_results_type, contact_results_type
   public :: error_results_type

   !> Group `/history`: one row an increment.
   type :: history_results_type
      integer :: bodies = 0                                !! number of bodies
      character(name_length), allocatable :: names(:)      !! datasets that grow
      type(growing_dataset_type), allocatable :: sets(:)   !! one for each of names
   contains
      procedure :: start => start_history
      procedure :: append => append_history
      procedure, nopass :: write_static => write_history_static
   end type history_results_type

   character(*), parameter :: convergence_names(7) = [character(name_length) :: 'increment', &
      'iteration', 'residual', 'g_min', 'g_max', 'pairs_changed', 'cut_backs']

   !> Group `/convergence`: one row an iteration.
   type :: convergence_results_type
      type(growing_dataset_type), allocatable :: sets(:)   !! one for each of convergence_names
   contains
      procedure :: start => start_convergence
      procedure :: append => append_convergence
   end type convergence_results_type

   !> Group `/contact/<name>` of one interface: one row an increment.
   type :: contact_results_type
      character(name_length), allocatable :: names(:)      !! datasets that grow
      type(growing_dataset_type), allocatable :: sets(:)   !! one for each of names
   contains
      procedure :: start => start_contact
      procedure :: append => append_contact
      procedure, nopass :: write_static => write_contact_static
   end type contact_results_type

   integer, parameter :: error_columns = 4   !! value, errors of mesh, increments and iteration

   !> Group `/errors`, where errors are estimated: one row a step. `sets` holds the times, then for
   !> each interface one dataset for each of estimated_names.
   type :: error_results_type
      type(growing_dataset_type), allocatable :: sets(:)
   contains
      procedure :: start => start_errors
      procedure :: append => append_errors
      procedure :: create_groups => create_error_groups
   end type error_results_type

contains

   !> Prepares the datasets.
   subroutine start_history(self, has_heat, has_mechanics, has_coupling, bodies, expected)
      class(history_results_type), intent(inout) :: self  !! the group
      logical, intent(in) :: has_heat                     !! whether a step solves heat
      logical, intent(in) :: has_mechanics                !! whether a step solves mechanics
      logical, intent(in) :: has_coupling                 !! whether a step couples both in contact
      integer, intent(in) :: bodies                       !! number of bodies
      integer, intent(in) :: expected                     !! increments that are expected
      integer :: i, storage, width

      self%names = pack(history_names, (has_heat .or. index(history_names, 'heat_') /= 1) .and. &
         (has_mechanics .or. history_names /= 'force_imbalance') .and. &
         (has_coupling .or. index(history_names, 'coupling_') /= 1))
      self%bodies = bodies
      self%names = [self%names, pack(history_body_names, [has_mechanics, has_heat])]
      allocate(self%sets(size(self%names)))
      do i = 1, size(self%names)
         storage = merge(as_integer, as_real, self%names(i) == 'iterations')
         width = merge(bodies, 0, any(self%names(i) == history_body_names))
         self%sets(i) = growing_dataset('/history/'//trim(self%names(i)), storage, width, 1, &
            expected)
      end do
   end subroutine start_history

   !> Adds an increment.
   subroutine append_history(self, record)
      class(history_results_type), intent(inout) :: self  !! the group
      type(increment_record_type), intent(in) :: record   !! the increment
      integer :: i

      do i = 1, size(self%sets)
         if (any(self%names(i) == history_body_names)) then
            call self%sets(i)%append(history_body_values(self%names(i), record, self%bodies))
         else
            call self%sets(i)%append([history_value(self%names(i), record)])
         end if
      end do
   end subroutine append_history

   !> Labels the load axis.
   !> Error: status_internal, when HDF5 refuses.
   subroutine write_history_static(file, load_label, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      character(*), intent(in) :: load_label              !! label of the load axis
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call write_attribute(file, '/history/load', 'label', load_label, error)
   end subroutine write_history_static

   !> Prepares the datasets.
   subroutine start_convergence(self, expected)
      class(convergence_results_type), intent(inout) :: self  !! the group
      integer, intent(in) :: expected                         !! iterations that are expected
      character(*), parameter :: real_names(3) = [character(name_length) :: 'residual', 'g_min', &
         'g_max']
      integer :: i, storage

      allocate(self%sets(size(convergence_names)))
      do i = 1, size(convergence_names)
         storage = merge(as_real, as_integer, any(convergence_names(i) == real_names))
         self%sets(i) = growing_dataset('/convergence/'//trim(convergence_names(i)), storage, 0, &
            1, expected)
      end do
   end subroutine start_convergence

   !> Adds iterations.
   subroutine append_convergence(self, iterations)
      class(convergence_results_type), intent(inout) :: self   !! the group
      type(iteration_record_type), intent(in) :: iterations(:) !! passes, in their order

      call self%sets(1)%append(real(iterations%increment, dp))
      call self%sets(2)%append(real(iterations%iteration, dp))
      call self%sets(3)%append((iterations%residual))
      call self%sets(4)%append((iterations%g_min))
      call self%sets(5)%append((iterations%g_max))
      call self%sets(6)%append(real(iterations%pairs_changed, dp))
      call self%sets(7)%append(real(iterations%cut_backs, dp))
   end subroutine append_convergence

   !> Prepares the datasets.
   subroutine start_contact(self, pairs, has_heat, expected)
      class(contact_results_type), intent(inout) :: self  !! the group
      type(contact_pairs_type), intent(in) :: pairs       !! pairs of the interface
      logical, intent(in) :: has_heat                     !! whether the deck has heat
      integer, intent(in) :: expected                     !! increments that are expected
      integer :: i, width, storage

      self%names = [contact_pair_names, contact_edge_names, contact_total_names]
      if (has_heat) then
         self%names = [contact_heat_names, self%names]
      else
         self%names = pack(self%names, self%names /= 'heat_rate')
      end if
      allocate(self%sets(size(self%names)))
      do i = 1, size(self%names)
         width = size(pairs%slave_node)
         if (any(self%names(i) == contact_total_names)) width = 0
         if (any(self%names(i) == contact_edge_names)) width = edges_kept
         storage = merge(as_integer, as_real, self%names(i) == 'status')
         self%sets(i) = growing_dataset('/contact/'//pairs%name//'/'//trim(self%names(i)), &
            storage, width, 1, expected)
      end do
   end subroutine start_contact

   !> Adds an increment.
   subroutine append_contact(self, pairs, contact)
      class(contact_results_type), intent(inout) :: self  !! the group
      type(contact_pairs_type), intent(in) :: pairs       !! pairs of the interface
      type(contact_record_type), intent(in) :: contact    !! their state
      integer :: i

      do i = 1, size(self%names)
         call self%sets(i)%append(contact_values(self%names(i), pairs, contact))
      end do
   end subroutine append_contact

   !> Creates the group, with the geometry of the pairs.
   !> Error: status_internal, when HDF5 refuses.
   subroutine write_contact_static(file, pairs, node_number, friction, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      type(contact_pairs_type), intent(in) :: pairs       !! pairs of the interface
      integer, intent(in) :: node_number(:)               !! (nodes) numbers in the deck
      real(dp), intent(in) :: friction                    !! coefficient of friction [-]
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      character(:), allocatable :: group

      group = '/contact/'//pairs%name
      call create_group(file, group, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'friction', friction, error)
      if (allocated(error)) return
      call write_array(file, group//'/slave_node', node_number(pairs%slave_node), as_integer, error)
      if (allocated(error)) return
      call write_array(file, group//'/master_node', node_number(pairs%master_node), as_integer, &
         error)
      if (allocated(error)) return
      call write_array(file, group//'/x', pairs%position(1, :), error)
      if (allocated(error)) return
      call write_array(file, group//'/y', pairs%position(2, :), error)
      if (allocated(error)) return
      call write_array(file, group//'/s', pairs%arc_length, error)
      if (allocated(error)) return
      call write_array(file, group//'/weight', pairs%weight, error)
   end subroutine write_contact_static

   !> Prepares the datasets; none without an interface or without estimates.
   subroutine start_errors(self, estimated, pairs, steps)
      class(error_results_type), intent(inout) :: self    !! the group
      logical, intent(in) :: estimated                    !! whether errors are estimated
      type(contact_pairs_type), intent(in) :: pairs(:)    !! pairs of every interface
      integer, intent(in) :: steps                        !! steps of the deck
      integer :: i, q

      if (size(pairs) == 0 .or. .not. estimated) then
         allocate(self%sets(0))
         return
      end if
      allocate(self%sets(1 + estimated_quantities*size(pairs)))
      self%sets(1) = growing_dataset('/errors/time', as_real, 0, 1, steps)
      do i = 1, size(pairs)
         do q = 1, estimated_quantities
            self%sets(1 + (i - 1)*estimated_quantities + q) = growing_dataset('/errors/'// &
               pairs(i)%name//'/'//trim(estimated_names(q)), as_real, error_columns, 1, steps)
         end do
      end do
   end subroutine start_errors

   !> Adds the end of a step.
   subroutine append_errors(self, time, errors)
      class(error_results_type), intent(inout) :: self        !! the group
      real(dp), intent(in) :: time                            !! total time [time]
      type(interface_errors_type), intent(in) :: errors(:)    !! (interfaces)
      integer :: i, q

      call self%sets(1)%append([time])
      do i = 1, size(errors)
         do q = 1, estimated_quantities
            call self%sets(1 + (i - 1)*estimated_quantities + q)%append([errors(i)%value(q), &
               errors(i)%mesh(q), errors(i)%increment(q), errors(i)%iteration(q)])
         end do
      end do
   end subroutine append_errors

   !> Creates the groups.
   !> Error: status_internal, when HDF5 refuses.
   subroutine create_error_groups(self, file, pairs, error)
      class(error_results_type), intent(in) :: self       !! the group, started
      integer(hid_t), intent(in) :: file                  !! the open file
      type(contact_pairs_type), intent(in) :: pairs(:)    !! pairs of every interface
      type(error_type), allocatable, intent(out) :: error !! what went wrong
      integer :: i

      if (size(self%sets) == 0) return
      call create_group(file, '/errors', error)
      if (allocated(error)) return
      do i = 1, size(pairs)
         call create_group(file, '/errors/'//pairs(i)%name, error)
         if (allocated(error)) return
      end do
   end subroutine create_error_groups

end module result_tables
