!> Solves rows of linear constraints for the degrees of freedom, and numbers the unknowns.
!>
!> A row says that a sum of values is zero. Values are numbered: the degrees of freedom u, then
!> those that rows introduce, such as relative displacements of contact points, then the prescribed
!> value of each degree of freedom. A support is the row u - g = 0. Row after row writes one degree
!> of freedom by other values. A constraint with a row to which those before leave no degree of
!> freedom becomes a link instead (linear_constraints). A row of degrees of freedom alone is a tie;
!> with none left it becomes a condition on prescribed values.
module constraint_elimination
   use kinds, only: dp
   use linear_constraints, only: linear_constraints_type
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: constraint_rows_type, eliminate

   !> Sum of coefficients that is rounding, as part of the row's largest coefficient.
   real(dp), parameter :: negligible = 1.0e-14_dp

   !> Coefficient below which a term is dropped, as part of the row's largest coefficient. Rows of
   !> faces that do not match couple each corner to the next ones, ever more weakly.
   real(dp), parameter :: dropped = 1.0e-17_dp

   !> The same for ties. On faces that do not match, ties that say nearly the same leave more than
   !> rounding; a body would be stiff along what is left of them.
   real(dp), parameter :: negligible_in_tie = 1.0e-9_dp

   !> Part of a row's largest coefficient that a degree of freedom needs to be written by the row.
   real(dp), parameter :: pivot_of_choice = 0.1_dp, least_pivot = 0.5_dp

   !> The rows.
   type, extends(sum_list_type) :: constraint_rows_type
      integer :: components = 1                 !! degrees of freedom of a node
      integer :: dofs = 0                       !! degrees of freedom
      logical, allocatable :: on_tail(:)        !! (introduced values) those that contact acts on
      !> (rows) the constraint that a row is part of; its rows follow each other
      integer, allocatable :: constraint(:)
      integer, allocatable :: choice(:)         !! (rows) degree of freedom to be written, if left
   end type constraint_rows_type

   !> Degrees of freedom as they are written by other values.
   type :: elimination_type
      type(sum_list_type) :: sums               !! what degrees of freedom are written by
      integer, allocatable :: writer(:)         !! (values) sum that writes a value, or 0
      integer, allocatable :: entry(:)          !! (values) when a value first entered the rows
      logical, allocatable :: linked(:)         !! (rows) those that become links
      logical, allocatable :: tie(:)            !! (rows) those of degrees of freedom alone
      integer, allocatable :: written(:)        !! (rows) what a tie writes, 0 for a condition
   end type elimination_type

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
      call write_values(rows, size(unknown), found)
      call number_unknowns(rows, found, used, constraints, unknown)
      constraints%components = rows%components
      constraints%introduced = unknown(rows%dofs + 1:last)
      call set_matrices(rows, found, unknown, constraints)
      call set_ties(rows, found, last, constraints)
   end subroutine eliminate

   !> Writes a degree of freedom by every row whose constraint does not become a link.
   pure subroutine write_values(rows, values, found)
      type(constraint_rows_type), intent(in) :: rows
      integer, intent(in) :: values
      type(elimination_type), intent(out) :: found
      integer :: i, k, first, last, n, written

      allocate (found%writer(values), found%entry(values), source=0)
      allocate (found%linked(rows%count), source=.false.)
      allocate (found%written(rows%count), source=0)
      found%tie = [(all(rows%value(rows%start(i):rows%start(i + 1) - 1) <= rows%dofs), &
         i=1, rows%count)]
      call found%sums%reserve(rows%count, size(rows%value))
      n = 0
      do i = 1, rows%count
         do k = rows%start(i + 1) - 1, rows%start(i), -1
            n = n + 1
            if (found%entry(rows%value(k)) == 0) found%entry(rows%value(k)) = n
         end do
      end do
      last = 0
      do while (last < rows%count)
         first = last + 1
         written = found%sums%count
         do last = first, rows%count
            call write_one(rows, last, found)
            if (last == rows%count) exit
            if (rows%constraint(last + 1) /= rows%constraint(first)) exit
         end do
         if (found%tie(first)) cycle
         if (found%sums%count - written == last - first + 1) cycle
         found%linked(first:last) = .true.
         where (found%writer > written) found%writer = 0
         found%sums%count = written
      end do
   end subroutine write_values

   !> Writes a degree of freedom by one row, if it has any left.
   pure subroutine write_one(rows, row, found)
      type(constraint_rows_type), intent(in) :: rows
      integer, intent(in) :: row
      type(elimination_type), intent(inout) :: found
      integer, allocatable :: value(:)
      real(dp), allocatable :: coefficient(:)
      logical, allocatable :: left(:)
      integer :: chosen
      real(dp) :: pivot

      call resolve(found, rows, row, value, coefficient)
      left = value <= rows%dofs .and. abs(coefficient) > merge(negligible_in_tie, negligible, &
         found%tie(row))*largest(rows, row)
      if (.not. any(left)) return
      pivot = maxval(abs(coefficient), mask=left)
      chosen = findloc(left .and. value == rows%choice(row) .and. &
         abs(coefficient) >= pivot_of_choice*pivot, .true., dim=1)
      if (chosen == 0) chosen = maxloc(found%entry(value), &
         mask=left .and. abs(coefficient) >= least_pivot*pivot, dim=1)
      found%writer(value(chosen)) = found%sums%count + 1
      if (found%tie(row)) found%written(row) = value(chosen)
      associate (factor => -1.0_dp/coefficient(chosen))
         coefficient(chosen) = 0.0_dp
         call found%sums%add(value, factor*coefficient)
      end associate
   end subroutine write_one

   !> Largest coefficient of a degree of freedom in a row.
   pure real(dp) function largest(rows, row)
      type(constraint_rows_type), intent(in) :: rows
      integer, intent(in) :: row

      associate (first => rows%start(row), last => rows%start(row + 1) - 1)
         largest = maxval(abs(rows%coefficient(first:last)), &
            mask=rows%value(first:last) <= rows%dofs)
      end associate
   end function largest

   !> A sum by the values that nothing writes, each once. What writes a value has no values that
   !> were written before, so those written first are replaced first, and each of them once.
   pure subroutine resolve(found, sums, i, value, coefficient)
      type(elimination_type), intent(in) :: found
      class(sum_list_type), intent(in) :: sums
      integer, intent(in) :: i
      integer, allocatable, intent(out) :: value(:)
      real(dp), allocatable, intent(out) :: coefficient(:)
      integer :: k, writer
      real(dp) :: factor, scale

      value = sums%value(sums%start(i):sums%start(i + 1) - 1)
      coefficient = sums%coefficient(sums%start(i):sums%start(i + 1) - 1)
      if (all(found%writer(value) == 0)) return
      scale = maxval(abs(coefficient))
      do
         k = minloc(found%writer(value), mask=found%writer(value) > 0, dim=1)
         if (k == 0) exit
         writer = found%writer(value(k))
         factor = coefficient(k)
         coefficient = [coefficient(:k - 1), coefficient(k + 1:)]
         value = [value(:k - 1), value(k + 1:)]
         if (abs(factor) <= dropped*scale) cycle
         associate (first => found%sums%start(writer), last => found%sums%start(writer + 1) - 1)
            call add_terms(found%sums%value(first:last), &
               factor*found%sums%coefficient(first:last), value, coefficient)
         end associate
      end do
   end subroutine resolve

   !> Adds terms to a sum, each value of it once.
   pure subroutine add_terms(more, factor, value, coefficient)
      integer, intent(in) :: more(:)
      real(dp), intent(in) :: factor(:)
      integer, allocatable, intent(inout) :: value(:)
      real(dp), allocatable, intent(inout) :: coefficient(:)
      integer :: i
      integer :: entry(size(more))

      entry = [(findloc(value, more(i), dim=1), i=1, size(more))]
      do i = 1, size(more)
         if (entry(i) > 0) coefficient(entry(i)) = coefficient(entry(i)) + factor(i)
      end do
      value = [value, pack(more, entry == 0)]
      coefficient = [coefficient, pack(factor, entry == 0)]
   end subroutine add_terms

   !> Numbers the unknowns: degrees of freedom, introduced values off the tail, then the tail. On it
   !> the forces of the links stand behind the values that stiffness holds and before those that
   !> only the links hold: factors without pivoting then have no zero pivot.
   pure subroutine number_unknowns(rows, found, used, constraints, unknown)
      type(constraint_rows_type), intent(in) :: rows
      type(elimination_type), intent(in) :: found
      logical, intent(in) :: used(:)
      type(linear_constraints_type), intent(inout) :: constraints
      integer, intent(out) :: unknown(:)
      logical :: by_link(size(unknown)), enters(size(rows%on_tail))
      integer :: i, before_tail

      by_link = .false.
      do i = 1, rows%count
         if (found%linked(i)) by_link(rows%value(rows%start(i):rows%start(i + 1) - 1)) = .true.
      end do
      unknown = 0
      associate (n => constraints%equations, first => rows%dofs + 1, &
         held => by_link(rows%dofs + 1:rows%dofs + size(enters)))
         enters = found%entry(first:first + size(enters) - 1) > 0 .and. .not. held
         call number_chosen(1, used .and. found%writer(:rows%dofs) == 0, unknown, n)
         call number_chosen(first, enters .and. .not. rows%on_tail, unknown, n)
         before_tail = n
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
      type(elimination_type), intent(in) :: found
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
      type(elimination_type), intent(in) :: found
      integer, intent(in) :: last               ! value before the prescribed ones
      type(linear_constraints_type), intent(inout) :: constraints
      integer, allocatable :: value(:)
      real(dp), allocatable :: coefficient(:)
      integer :: i

      constraints%tied = pack(found%written, found%written > 0)
      constraints%condition = pack(rows%constraint(:rows%count), found%tie .and. found%written == 0)
      call constraints%tied_by%reserve(size(constraints%tied), 8*size(constraints%tied))
      call constraints%condition_given%reserve(size(constraints%condition), &
         8*size(constraints%condition))
      do i = 1, rows%count
         if (.not. found%tie(i)) cycle
         if (found%written(i) > 0) then
            associate (k => found%writer(found%written(i)))
               value = found%sums%values_of(k)
               coefficient = found%sums%coefficients_of(k)
            end associate
            value = merge(value - last, value, value > last)
            call constraints%tied_by%add(value, coefficient)
         else
            call resolve(found, rows, i, value, coefficient)
            coefficient = pack(coefficient, value > last)
            value = pack(value, value > last) - last
            call constraints%condition_given%add(value, coefficient)
         end if
      end do
   end subroutine set_ties

end module constraint_elimination
