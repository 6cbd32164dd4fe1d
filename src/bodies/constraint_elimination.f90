!> Solves rows of linear constraints for the degrees of freedom, and numbers the unknowns.
!>
!> A constraint with a row to which those before leave no degree of freedom becomes a link
!> (linear_constraints); a tie becomes a condition on prescribed values then.
module constraint_elimination
   use constraint_rows, only: constraint_rows_type, elimination_type, largest, &
      least_coefficients, negligible, resolve, write_values
   use kinds, only: dp
   use linear_constraints, only: linear_constraints_type
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: eliminate

contains

   !> The constraints of these rows. Of the degrees of freedom that are left in a row it writes the
   !> row's choice, else the one that entered the rows last; of the values of one row the last
   !> enters first. Ties come before rows with introduced values.
   pure subroutine eliminate(rows, used, constraints)
      type(constraint_rows_type), intent(in) :: rows
      logical, intent(in) :: used(:)                !! (dofs) whether elements have them
      type(linear_constraints_type), intent(out) :: constraints
      type(elimination_type) :: found
      integer :: unknown(2*rows%dofs + size(rows%on_tail)), last

      last = rows%dofs + size(rows%on_tail)
      found%least = least_coefficients(rows)
      call write_values(rows, size(unknown), found)
      call number_unknowns(rows, found, used, constraints, unknown)
      constraints%components = rows%components
      constraints%introduced = unknown(rows%dofs + 1:last)
      call set_matrices(rows, found, unknown, constraints)
      call set_ties(rows, found, last, constraints)
   end subroutine eliminate

   !> Numbers the unknowns: degrees of freedom, introduced values off the tail, then the tail. On it
   !> the forces of the links are behind the values that stiffness holds and before those that
   !> only the links hold: factors without pivoting then have no zero pivot.
   pure subroutine number_unknowns(rows, found, used, constraints, unknown)
      type(constraint_rows_type), intent(in) :: rows
      type(elimination_type), intent(in) :: found
      logical, intent(in) :: used(:)
      type(linear_constraints_type), intent(inout) :: constraints
      integer, intent(out) :: unknown(:)
      logical :: by_link(size(unknown)), enters(size(rows%on_tail)), free(size(used))
      integer :: i, before_tail

      by_link = .false.
      do i = 1, rows%count
         if (found%linked(i)) by_link(rows%value(rows%start(i):rows%start(i + 1) - 1)) = .true.
      end do
      unknown = 0
      associate (n => constraints%equations, first => rows%dofs + 1, &
         held => by_link(rows%dofs + 1:rows%dofs + size(enters)))
         enters = found%entry(first:first + size(enters) - 1) > 0 .and. .not. held
         free = used .and. found%writer(:rows%dofs) == 0
         if (allocated(rows%dof_on_tail)) then
            call number_chosen(1, free .and. .not. rows%dof_on_tail, unknown, n)
         else
            call number_chosen(1, free, unknown, n)
         end if
         call number_chosen(first, enters .and. .not. rows%on_tail, unknown, n)
         before_tail = n
         if (allocated(rows%dof_on_tail)) call number_chosen(1, free .and. rows%dof_on_tail, &
            unknown, n)
         call number_chosen(first, enters .and. rows%on_tail, unknown, n)
         constraints%link_force = [(n + i, i=1, count(found%linked))]
         n = n + size(constraints%link_force)
         call number_chosen(first, held, unknown, n)
         constraints%tail = n - before_tail
      end associate
   end subroutine number_unknowns

   !> Numbers some of the values from one on, behind what is numbered already.
   pure subroutine number_chosen(first, chosen, unknown, n)
      integer, intent(in) :: first
      logical, intent(in) :: chosen(:)
      integer, intent(inout) :: unknown(:), n
      integer :: i

      do i = 1, size(chosen)
         if (.not. chosen(i)) cycle
         n = n + 1
         unknown(first + i - 1) = n
      end do
   end subroutine number_chosen

   !> The constraints as matrices.
   pure subroutine set_matrices(rows, found, unknown, constraints)
      type(constraint_rows_type), intent(in) :: rows
      type(elimination_type), intent(inout) :: found
      integer, intent(in) :: unknown(:)
      type(linear_constraints_type), intent(inout) :: constraints
      type(sum_list_type) :: written, links, plain
      integer, allocatable :: value(:)
      real(dp), allocatable :: coefficient(:)
      integer :: dof(size(unknown)), given(size(unknown)), i

      associate (dofs => rows%dofs)
         dof = [(merge(i, 0, i <= dofs), i=1, size(dof))]
         given = cshift(dof, dofs)
         call written%reserve(dofs, dofs + size(rows%value))
         call links%reserve(size(constraints%link_force), 8*size(constraints%link_force))
         plain = links
         do i = 1, dofs
            if (found%writer(i) == 0) then
               call written%add([i], [1.0_dp])
            else
               call resolve(found, found%sums, found%writer(i), value, coefficient)
               call written%add(value, coefficient)
            end if
         end do
         do i = 1, rows%count
            if (.not. found%linked(i)) cycle
            call resolve(found, rows, i, value, coefficient)
            where (abs(coefficient) <= negligible*largest(rows, i)) coefficient = 0.0_dp
            call links%add(value, coefficient)
            call plain%add(rows%value(rows%start(i):rows%start(i + 1) - 1), &
               rows%coefficient(rows%start(i):rows%start(i + 1) - 1))
         end do
         constraints%by_unknowns = written%renumbered(unknown)
         constraints%by_given = written%renumbered(given)
         constraints%link_unknowns = links%renumbered(unknown)
         constraints%link_given = links%renumbered(given)
         constraints%link_dofs = plain%renumbered(dof)
         allocate (constraints%link_stiffness(links%count), source=1.0_dp)
      end associate
   end subroutine set_matrices

   !> What ties write, and the conditions of those that write nothing. Prescribed values count as
   !> the degrees of freedom that have them.
   pure subroutine set_ties(rows, found, last, constraints)
      type(constraint_rows_type), intent(in) :: rows
      type(elimination_type), intent(inout) :: found
      integer, intent(in) :: last               ! value before the prescribed ones
      type(linear_constraints_type), intent(inout) :: constraints
      integer, allocatable :: value(:)
      real(dp), allocatable :: coefficient(:)
      integer :: dof_of(found%sums%count), i, k

      dof_of = 0
      do i = 1, rows%count
         if (found%written(i) > 0) dof_of(found%writer(found%written(i))) = found%written(i)
      end do
      constraints%tied = pack(dof_of, dof_of > 0)
      constraints%condition = pack(rows%origin(:rows%count), found%tie .and. found%written == 0)
      call constraints%tied_by%reserve(size(constraints%tied), 8*size(constraints%tied))
      call constraints%condition_given%reserve(size(constraints%condition), &
         8*size(constraints%condition))
      do k = 1, size(dof_of)
         if (dof_of(k) == 0) cycle
         value = found%sums%values_of(k)
         value = merge(value - last, value, value > last)
         call constraints%tied_by%add(value, found%sums%coefficients_of(k))
      end do
      do i = 1, rows%count
         if (.not. found%tie(i) .or. found%written(i) > 0) cycle
         call resolve(found, rows, i, value, coefficient)
         coefficient = pack(coefficient, value > last)
         value = pack(value, value > last) - last
         call constraints%condition_given%add(value, coefficient)
      end do
   end subroutine set_ties

end module constraint_elimination
