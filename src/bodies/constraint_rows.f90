!> Rows of linear constraints, what degrees of freedom they write, and what they say beside those
!> before them.
!>
!> A row says that a sum of values is zero. Values are numbered: the degrees of freedom u, then
!> those that rows introduce, such as relative displacements of contact points, then the prescribed
!> value of each degree of freedom, then marks that tell rows apart. A support is the row u - g = 0.
!> Row after row writes one degree of freedom by other values. A row of degrees of freedom alone is
!> a tie.
module constraint_rows
   use kinds, only: dp
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: row_origin_type, of_support, of_hanging, of_equation, of_tie, of_contact, &
      constraint_rows_type, elimination_type, write_values, resolve, largest, least_coefficients, &
      negligible, dependent_rows, origins_of

   !> Sum of coefficients that is rounding, as part of the row's largest coefficient.
   real(dp), parameter :: negligible = 1.0e-14_dp

   !> Coefficient below which a term is dropped, as part of the row's largest coefficient. Rows of
   !> faces that do not match couple each corner to the next ones, ever more weakly.
   real(dp), parameter :: dropped = 1.0e-17_dp

   !> The same for ties. On faces that do not match, ties that say nearly the same leave more than
   !> rounding; a body would be stiff along what is left of them.
   real(dp), parameter :: negligible_in_tie = 1.0e-9_dp

   !> The same for rows of contact points, as part of the largest coefficient that the degree of
   !> freedom has in any of them: rotations have those of their arms. A part p writes it by 1/p
   !> times their relative values, and the rounding of the matrix grows by 1/p^2. Contact points
   !> that form a cycle but for p, as where nodes of matching faces are not exactly opposite, end
   !> with a link, which keeps p as it is. With p below 0.004 rounding decides what sticks in a rod
   !> of twelve pellets.
   real(dp), parameter :: least_of_contact = 1.0e-2_dp

   !> Part of a row's largest coefficient that a degree of freedom needs to be written by the row.
   real(dp), parameter :: pivot_of_choice = 0.1_dp, least_pivot = 0.5_dp

   integer, parameter :: of_support = 1, of_hanging = 2, of_equation = 3, of_tie = 4
   integer, parameter :: of_contact = 5

   !> Origin of a row. Rows of one origin are one constraint.
   type :: row_origin_type
      integer :: kind = 0     !! of_support ... of_contact
      !> degree of freedom that is supported or hangs, equation, point of a tie, contact point
      integer :: number = 0
   contains
      procedure, private :: is_same
      generic :: operator(==) => is_same
   end type row_origin_type

   !> The rows.
   type, extends(sum_list_type) :: constraint_rows_type
      integer :: components = 1                 !! degrees of freedom of a node
      integer :: dofs = 0                       !! degrees of freedom
      logical, allocatable :: on_tail(:)        !! (introduced values) those that contact acts on
      !> (dofs) those that it acts on likewise; unallocated where there are none
      logical, allocatable :: dof_on_tail(:)
      !> degrees of freedom to be eliminated last, because many others are joined to them;
      !> unallocated for none
      integer, allocatable :: last_dofs(:)
      logical :: keeps_all = .false.            !! whether all unknowns are on the tail
      type(row_origin_type), allocatable :: origin(:)   !! (rows) those of one follow each other
      !> (rows) degree of freedom to be written, if left; 0 for any
      integer, allocatable :: choice(:)
   end type constraint_rows_type

   !> Degrees of freedom as they are written by other values.
   type :: elimination_type
      type(sum_list_type) :: sums               !! what degrees of freedom are written by
      integer, allocatable :: writer(:)         !! (values) sum that writes a value, or 0
      integer, allocatable :: entry(:)          !! (values) when a value first entered the rows
      logical, allocatable :: linked(:)         !! (rows) those that become links
      logical, allocatable :: tie(:)            !! (rows) those of degrees of freedom alone
      integer, allocatable :: written(:)        !! (rows) what a tie writes, 0 for a condition
      real(dp), allocatable :: least(:)         !! (rows) coefficient below which none is left
      !> (values) the same in rows of contact points
      real(dp), allocatable, private :: least_of_value(:)
      !> (values) term of each in the sum that is resolved; else 0
      integer, allocatable, private :: term(:)
      ! Room for the terms of that sum.
      integer, allocatable, private :: value(:)
      real(dp), allocatable, private :: coefficient(:)
   end type elimination_type

contains

   !> Whether two rows belong to one constraint.
   elemental logical function is_same(self, other)
      class(row_origin_type), intent(in) :: self
      type(row_origin_type), intent(in) :: other

      is_same = self%kind == other%kind .and. self%number == other%number
   end function is_same

   !> Coefficients below which rows have no degree of freedom left.
   pure function least_coefficients(rows) result(least)
      type(constraint_rows_type), intent(in) :: rows
      real(dp) :: least(rows%count)
      integer :: i

      least = [(largest(rows, i)*merge(negligible_in_tie, negligible, is_tie(rows, i)), &
         i=1, rows%count)]
   end function least_coefficients

   !> Whether a row is one of degrees of freedom alone, beside the mark that may tell it.
   pure logical function is_tie(rows, row)
      type(constraint_rows_type), intent(in) :: rows
      integer, intent(in) :: row

      associate (value => rows%value(rows%start(row):rows%start(row + 1) - 1))
         is_tie = all(value <= rows%dofs .or. value > 2*rows%dofs + size(rows%on_tail))
      end associate
   end function is_tie

   !> Writes a degree of freedom by every row whose constraint does not become a link.
   pure subroutine write_values(rows, values, found)
      type(constraint_rows_type), intent(in) :: rows
      integer, intent(in) :: values
      type(elimination_type), intent(inout) :: found    ! its least coefficients are set
      integer :: i, k, n

      allocate (found%writer(values), found%entry(values), found%term(values), source=0)
      allocate (found%value(0), found%coefficient(0))
      allocate (found%linked(rows%count), source=.false.)
      allocate (found%written(rows%count), source=0)
      found%tie = [(is_tie(rows, i), i=1, rows%count)]
      call found%sums%reserve(rows%count, size(rows%value))
      allocate (found%least_of_value(values), source=0.0_dp)
      n = 0
      do i = 1, rows%count
         do k = rows%start(i + 1) - 1, rows%start(i), -1
            n = n + 1
            associate (value => rows%value(k))
               if (found%entry(value) == 0) found%entry(value) = n
               if (rows%origin(i)%kind == of_contact) found%least_of_value(value) = max( &
                  found%least_of_value(value), least_of_contact*abs(rows%coefficient(k)))
            end associate
         end do
      end do
      associate (last_tie => findloc(found%tie, .true., dim=1, back=.true.))
         call write_section(rows, 1, last_tie, found)
         call write_section(rows, last_tie + 1, rows%count, found)
      end associate
   end subroutine write_values

   !> Writes values by the rows of some whole constraints. Those whose choice is written already
   !> come last: what they say beside the others is then all that they have left. In turn, each
   !> would write its neighbour's choice, and along a face whose end is held the coefficients would
   !> grow by a factor of four from corner to corner.
   pure subroutine write_section(rows, from, to, found)
      type(constraint_rows_type), intent(in) :: rows
      integer, intent(in) :: from, to
      type(elimination_type), intent(inout) :: found
      logical :: done(from:to)
      integer :: first, i, last, pass, written

      done = .false.
      do pass = 1, 2
         last = from - 1
         do while (last < to)
            first = last + 1
            last = last_of(rows, first)
            if (done(first)) cycle
            associate (choice => rows%choice(first:last))
               done(first) = pass == 2 .or. all(found%writer(pack(choice, choice > 0)) == 0)
            end associate
            if (.not. done(first)) cycle
            written = found%sums%count
            do i = first, last
               call write_one(rows, i, found)
            end do
            if (found%tie(first) .or. found%sums%count - written == last - first + 1) cycle
            ! Unless every row writes a degree of freedom, all of them are links.
            found%linked(first:last) = .true.
            where (found%writer > written) found%writer = 0
            found%sums%count = written
         end do
      end do
   end subroutine write_section

   !> Last row of the constraint with a first row.
   pure integer function last_of(rows, first) result(last)
      type(constraint_rows_type), intent(in) :: rows
      integer, intent(in) :: first

      do last = first, rows%count - 1
         if (.not. rows%origin(last + 1) == rows%origin(first)) return
      end do
   end function last_of

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
      left = value <= rows%dofs .and. abs(coefficient) > found%least(row)
      if (rows%origin(row)%kind == of_contact) left = left .and. abs(coefficient) > &
         found%least_of_value(value)
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
      type(elimination_type), intent(inout) :: found
      class(sum_list_type), intent(in) :: sums
      integer, intent(in) :: i
      integer, allocatable, intent(out) :: value(:)
      real(dp), allocatable, intent(out) :: coefficient(:)
      integer :: k, l, n, writer
      real(dp) :: factor, scale

      value = sums%value(sums%start(i):sums%start(i + 1) - 1)
      coefficient = sums%coefficient(sums%start(i):sums%start(i + 1) - 1)
      if (all(found%writer(value) == 0)) return
      scale = maxval(abs(coefficient))
      n = size(value)
      call make_room(found, n)
      found%value(:n) = value
      found%coefficient(:n) = coefficient
      found%term(value) = [(k, k=1, n)]
      do
         k = first_written(found, n)
         if (k == 0) exit
         writer = found%writer(found%value(k))
         factor = found%coefficient(k)
         found%term(found%value(n)) = k
         found%term(found%value(k)) = 0
         found%value(k) = found%value(n)
         found%coefficient(k) = found%coefficient(n)
         n = n - 1
         if (abs(factor) <= dropped*scale) cycle
         associate (first => found%sums%start(writer), last => found%sums%start(writer + 1) - 1)
            call make_room(found, n + last - first + 1)
            do l = first, last
               associate (term => found%term(found%sums%value(l)))
                  if (term == 0) then
                     n = n + 1
                     term = n
                     found%value(n) = found%sums%value(l)
                     found%coefficient(n) = 0.0_dp
                  end if
                  found%coefficient(term) = found%coefficient(term) + &
                     factor*found%sums%coefficient(l)
               end associate
            end do
         end associate
      end do
      found%term(found%value(:n)) = 0
      associate (kept => abs(found%coefficient(:n)) > dropped*scale)
         value = pack(found%value(:n), kept)
         coefficient = pack(found%coefficient(:n), kept)
      end associate
   end subroutine resolve

   !> Place of the value that was written first, 0 where none is: without the arrays of minloc.
   pure integer function first_written(found, terms) result(first)
      type(elimination_type), intent(in) :: found
      integer, intent(in) :: terms
      integer :: k, least

      first = 0
      least = huge(least)
      do k = 1, terms
         associate (writer => found%writer(found%value(k)))
            if (writer == 0 .or. writer >= least) cycle
            first = k
            least = writer
         end associate
      end do
   end function first_written

   !> Makes room for terms of the sum that is resolved.
   pure subroutine make_room(found, terms)
      type(elimination_type), intent(inout) :: found
      integer, intent(in) :: terms

      if (terms <= size(found%value)) return
      found%value = [found%value, spread(0, 1, terms)]
      found%coefficient = [found%coefficient, spread(0.0_dp, 1, terms)]
   end subroutine make_room

   !> Rows of degrees of freedom alone to which those before leave less of any than a part of their
   !> largest coefficient. Each writes its choice, else one of the largest.
   pure function dependent_rows(rows, least) result(dependent)
      type(constraint_rows_type), intent(in) :: rows
      real(dp), intent(in) :: least             !! the part
      logical :: dependent(rows%count)
      type(elimination_type) :: found
      integer :: i

      found%least = [(least*largest(rows, i), i=1, rows%count)]
      call write_values(rows, 2*rows%dofs, found)
      dependent = found%written == 0
   end function dependent_rows

   !> The constraints before from which the rows of a constraint follow. Every row is marked by a
   !> value of its own, whose coefficient is its share in what is left of the row.
   pure function origins_of(rows, constraint) result(origins)
      type(constraint_rows_type), intent(in) :: rows
      type(row_origin_type), intent(in) :: constraint   !! one that is left no degree of freedom
      type(row_origin_type), allocatable :: origins(:)  !! constraints, in their order
      type(constraint_rows_type) :: marked
      type(elimination_type) :: found
      integer, allocatable :: value(:)
      real(dp), allocatable :: coefficient(:)
      logical :: is_origin(rows%count), of_part(rows%count), is_left
      integer :: i, k, last

      last = 2*rows%dofs + size(rows%on_tail)
      marked = rows
      call marked%reserve(rows%count, size(rows%value) + rows%count)
      do i = 1, rows%count
         call marked%add([rows%values_of(i), last + i], [rows%coefficients_of(i), 1.0_dp])
      end do
      found%least = least_coefficients(marked)
      call write_values(marked, last + rows%count, found)
      is_origin = .false.
      of_part = .false.
      do i = 1, rows%count
         if (.not. rows%origin(i) == constraint) cycle
         call resolve(found, marked, i, value, coefficient)
         coefficient = merge(coefficient, 0.0_dp, abs(coefficient) > &
            negligible_in_tie*largest(rows, i))
         is_left = any(value <= rows%dofs .and. abs(coefficient) > 0.0_dp)
         do k = 1, size(value)
            if (value(k) <= last .or. abs(coefficient(k)) <= 0.0_dp) cycle
            if (is_left) of_part(value(k) - last) = .true.
            if (.not. is_left) is_origin(value(k) - last) = .true.
         end do
      end do
      ! Where no row alone follows from others, the rows together do.
      if (.not. any(is_origin)) is_origin = of_part
      is_origin = is_origin .and. .not. rows%origin(:rows%count) == constraint
      origins = pack(rows%origin(:rows%count), is_origin)
   end function origins_of

end module constraint_rows
