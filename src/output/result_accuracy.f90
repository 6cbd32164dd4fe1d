!> Group `/accuracy` of the result file: all rounds of a requested accuracy.
module result_accuracy
   use accuracy_rounds, only: accuracy_rounds_type
   use contact_points, only: contact_points_type
   use contact_quantities, only: estimated
   use hdf5_writer, only: as_integer, hdf5_writer_type
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
   subroutine write_accuracy(file, accuracy, interfaces, labels)
      type(hdf5_writer_type), intent(inout) :: file          !! the open file
      type(accuracy_rounds_type), intent(in) :: accuracy
      type(contact_points_type), intent(in) :: interfaces(:) !! contact points of every interface
      type(unit_labels_type), intent(in) :: labels           !! units of the deck
      integer :: d, i

      if (.not. accuracy%is_on) return
      if (size(accuracy%rounds) == 0) return
      call file%create_group(group)
      associate (rounds => accuracy%rounds)
         call file%write(group//'/cpu_seconds', rounds%cpu_seconds, 'CPU seconds of the round', 's')
         call file%write(group//'/unknowns', rounds%unknowns, as_integer, &
            'unknown temperatures, displacements and contact unknowns')
         call file%write(group//'/elements', rounds%elements, as_integer, 'elements of the mesh')
         call file%write(group//'/increments', rounds%increments, as_integer, 'accepted increments')
      end associate
      call file%set(group, 'reached', merge(1, 0, accuracy%is_reached()))
      call file%set(group, 'later_round_begun', merge(1, 0, accuracy%goes_on))
      call file%create_group(group//'/bounds')
      do i = 1, size(interfaces)
         if (.not. any(accuracy%demands%interface == i)) cycle
         call file%create_group(group//'/bounds/'//interfaces(i)%name)
         do d = 1, size(accuracy%demands)
            if (accuracy%demands(d)%interface == i) call write_demand(file, accuracy, d, &
               group//'/bounds/'//interfaces(i)%name, labels)
         end do
      end do
   end subroutine write_accuracy

   !> A row for each round: step, value, bound and what the target allows, at the end of the step
   !> that is furthest from the target; zeros where no step has the quantity.
   subroutine write_demand(file, accuracy, d, path, labels)
      type(hdf5_writer_type), intent(inout) :: file
      type(accuracy_rounds_type), intent(in) :: accuracy
      integer, intent(in) :: d
      character(*), intent(in) :: path
      type(unit_labels_type), intent(in) :: labels
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
      call file%write(path//'/'//trim(quantity%name), rows, 'rounds of the requested accuracy: '// &
         trim(quantity%description), unit_in_words(quantity%unit, labels), &
         'step value bound target')
   end subroutine write_demand

end module result_accuracy
