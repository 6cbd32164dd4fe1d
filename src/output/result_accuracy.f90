!> Group `/accuracy` of the result file: all rounds of a requested accuracy.
module result_accuracy
   use accuracy_rounds, only: accuracy_rounds_type
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use errors, only: error_type
   use hdf5, only: hid_t
   use hdf5_attributes, only: describe, write_attribute
   use hdf5_helpers, only: as_integer, create_group, write_array
   use kinds, only: dp
   use model, only: unit_labels_type
   use quantity_types, only: quantity_type
   use unit_labels, only: unit_in_words
   implicit none
   private
   public :: write_accuracy

   character(*), parameter :: group = '/accuracy'
   integer, parameter :: columns = 4   !! step, value, bound, target

contains

   !> Writes the rounds, where an accuracy is requested and the first one came to its end.
   !> Error: status_internal, when HDF5 refuses.
   subroutine write_accuracy(file, accuracy, interfaces, labels, error)
      integer(hid_t), intent(in) :: file                     !! the open file
      type(accuracy_rounds_type), intent(in) :: accuracy
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(unit_labels_type), intent(in) :: labels           !! units of the deck
      type(error_type), allocatable, intent(out) :: error
      integer :: d, i

      if (.not. accuracy%is_on) return
      if (size(accuracy%rounds) == 0) return
      call create_group(file, group, error)
      if (allocated(error)) return
      associate (rounds => accuracy%rounds)
         call write_array(file, group//'/cpu_seconds', rounds%cpu_seconds, error)
         if (allocated(error)) return
         call describe(file, group//'/cpu_seconds', 'CPU seconds of the round', 's', error)
         if (allocated(error)) return
         call write_numbers(file, 'unknowns', rounds%unknowns, 'unknown temperatures, '// &
            'displacements and contact unknowns', error)
         if (allocated(error)) return
         call write_numbers(file, 'elements', rounds%elements, 'elements of the mesh', error)
         if (allocated(error)) return
         call write_numbers(file, 'increments', rounds%increments, 'accepted increments', error)
         if (allocated(error)) return
      end associate
      call write_attribute(file, group, 'reached', merge(1, 0, accuracy%is_reached()), error)
      if (allocated(error)) return
      call write_attribute(file, group, 'later_round_begun', merge(1, 0, accuracy%goes_on), error)
      if (allocated(error)) return
      call create_group(file, group//'/bounds', error)
      if (allocated(error)) return
      do i = 1, size(interfaces)
         if (.not. any(accuracy%demands%interface == i)) cycle
         call create_group(file, group//'/bounds/'//interfaces(i)%name, error)
         if (allocated(error)) return
         do d = 1, size(accuracy%demands)
            if (accuracy%demands(d)%interface /= i) cycle
            call write_demand(file, accuracy, d, group//'/bounds/'//interfaces(i)%name, labels, &
               error)
            if (allocated(error)) return
         end do
      end do
   end subroutine write_accuracy

   subroutine write_numbers(file, name, numbers, description, error)
      integer(hid_t), intent(in) :: file
      character(*), intent(in) :: name, description
      integer, intent(in) :: numbers(:)
      type(error_type), allocatable, intent(out) :: error

      call write_array(file, group//'/'//name, numbers, as_integer, error)
      if (allocated(error)) return
      call describe(file, group//'/'//name, description, '-', error)
   end subroutine write_numbers

   !> A row for each round: step, value, bound and what the target allows, at the end of the step
   !> that is furthest from the target; zeros where no step has the quantity.
   subroutine write_demand(file, accuracy, d, path, labels, error)
      integer(hid_t), intent(in) :: file
      type(accuracy_rounds_type), intent(in) :: accuracy
      integer, intent(in) :: d
      character(*), intent(in) :: path
      type(unit_labels_type), intent(in) :: labels
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: rows(columns, size(accuracy%rounds))
      integer :: i, step
      type(quantity_type) :: quantity

      rows = 0.0_dp
      do i = 1, size(accuracy%rounds)
         step = accuracy%rounds(i)%worst_step(d)
         if (step == 0) cycle
         associate (finding => accuracy%rounds(i)%findings(d, step))
            rows(:, i) = [real(step, dp), finding%value, finding%bound, finding%allowed]
         end associate
      end do
      quantity = estimated(accuracy%demands(d)%quantity)
      call write_array(file, path//'/'//trim(quantity%name), rows, error)
      if (allocated(error)) return
      call describe(file, path//'/'//trim(quantity%name), 'rounds of the requested accuracy: '// &
         trim(quantity%description), unit_in_words(quantity%unit, labels), error, &
         'step value bound target')
   end subroutine write_demand

end module result_accuracy
