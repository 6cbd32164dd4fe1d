!> Sums of coefficient*value, one after another, each of any length. Values are told by numbers.
module sum_lists
   use kinds, only: dp
   implicit none
   private
   public :: sum_list_type, add_terms, differences, single_values, sums_of_columns

   !> The sums.
   type :: sum_list_type
      integer :: count = 0                      !! number of sums
      integer, allocatable :: start(:)          !! (count + 1) first term of each
      integer, allocatable :: value(:)          !! (terms) values
      real(dp), allocatable :: coefficient(:)   !! (terms) their coefficients
   contains
      procedure :: reserve
      procedure :: add
      procedure :: add_value
      procedure :: add_sums
      procedure :: chosen
      procedure :: renumbered
      procedure :: transposed
      procedure :: as_columns
      procedure :: without_signs
      procedure :: add_totals
      procedure :: add_shares
      procedure :: is_sum_of
      procedure :: values_of
      procedure :: coefficients_of
   end type sum_list_type

contains

   !> The differences of two values, first less second.
   pure function differences(first, second) result(list)
      integer, intent(in) :: first(:), second(:)    !! (n)
      type(sum_list_type) :: list                   !! (n)
      integer :: i

      call list%reserve(size(first), 2*size(first))
      do i = 1, size(first)
         call list%add([first(i), second(i)], [1.0_dp, -1.0_dp])
      end do
   end function differences

   !> The values themselves, each a sum of its own.
   pure function single_values(values) result(list)
      integer, intent(in) :: values(:)              !! (n)
      type(sum_list_type) :: list                   !! (n)
      integer :: i

      call list%reserve(size(values), size(values))
      do i = 1, size(values)
         call list%add_value(values(i))
      end do
   end function single_values

   !> Sums with the coefficients of the columns of a matrix, those that are not 0.
   pure function sums_of_columns(columns) result(list)
      real(dp), intent(in) :: columns(:, :)         !! (values, n)
      type(sum_list_type) :: list                   !! (n)
      integer :: i, j

      call list%reserve(size(columns, 2), count(abs(columns) > 0.0_dp))
      do j = 1, size(columns, 2)
         call list%add([(i, i=1, size(columns, 1))], columns(:, j))
      end do
   end function sums_of_columns

   !> Makes room, for no more than an estimate; what the list held is dropped.
   pure subroutine reserve(self, sums, terms)
      class(sum_list_type), intent(inout) :: self
      integer, intent(in) :: sums      !! sums expected
      integer, intent(in) :: terms     !! terms expected in all of them

      self%count = 0
      if (allocated(self%start)) deallocate (self%start, self%value, self%coefficient)
      allocate (self%start(sums + 1), self%value(terms), self%coefficient(terms))
      self%start(1) = 1
   end subroutine reserve

   !> Adds a sum, without the terms whose coefficient is zero.
   pure subroutine add(self, values, coefficients)
      class(sum_list_type), intent(inout) :: self
      integer, intent(in) :: values(:)          !! (n) each once
      real(dp), intent(in) :: coefficients(:)   !! (n)
      integer :: i, term

      term = self%start(self%count + 1)
      if (self%count + 2 > size(self%start)) self%start = [self%start, self%start]
      if (term + size(values) > size(self%value) + 1) then
         self%value = [self%value, self%value, values]
         self%coefficient = [self%coefficient, self%coefficient, coefficients]
      end if
      do i = 1, size(values)
         if (abs(coefficients(i)) <= 0.0_dp) cycle
         self%value(term) = values(i)
         self%coefficient(term) = coefficients(i)
         term = term + 1
      end do
      self%count = self%count + 1
      self%start(self%count + 1) = term
   end subroutine add

   !> Adds a value as it is, without the arrays that `add` needs: faces that slide have many.
   pure subroutine add_value(self, value)
      class(sum_list_type), intent(inout) :: self
      integer, intent(in) :: value
      integer :: term

      term = self%start(self%count + 1)
      if (self%count + 2 > size(self%start) .or. term > size(self%value)) then
         call self%add([value], [1.0_dp])
         return
      end if
      self%value(term) = value
      self%coefficient(term) = 1.0_dp
      self%count = self%count + 1
      self%start(self%count + 1) = term + 1
   end subroutine add_value

   !> Adds the sums of another list.
   pure subroutine add_sums(self, sums)
      class(sum_list_type), intent(inout) :: self
      type(sum_list_type), intent(in) :: sums
      integer :: i

      do i = 1, sums%count
         call self%add(sums%values_of(i), sums%coefficients_of(i))
      end do
   end subroutine add_sums

   !> Some of the sums.
   pure function chosen(self, which) result(sums)
      class(sum_list_type), intent(in) :: self
      integer, intent(in) :: which(:)           !! (n) the sums
      type(sum_list_type) :: sums               !! (n)
      integer :: i

      call sums%reserve(size(which), size(self%value))
      do i = 1, size(which)
         call sums%add(self%values_of(which(i)), self%coefficients_of(which(i)))
      end do
   end function chosen

   !> The sums with values of other numbers, without the terms whose value has none.
   pure function renumbered(self, number) result(sums)
      class(sum_list_type), intent(in) :: self
      integer, intent(in) :: number(:)          !! (values) new number of each value, 0 for none
      type(sum_list_type) :: sums
      integer :: i, k, term

      associate (terms => self%start(self%count + 1) - 1)
         call sums%reserve(self%count, count(number(self%value(:terms)) > 0))
      end associate
      sums%count = self%count
      term = 1
      do i = 1, self%count
         do k = self%start(i), self%start(i + 1) - 1
            if (number(self%value(k)) == 0) cycle
            sums%value(term) = number(self%value(k))
            sums%coefficient(term) = self%coefficient(k)
            term = term + 1
         end do
         sums%start(i + 1) = term
      end do
   end function renumbered

   !> For each value the sums that it is in, with its coefficients.
   pure function transposed(self, values) result(sums)
      class(sum_list_type), intent(in) :: self
      integer, intent(in) :: values                      !! number of values
      type(sum_list_type) :: sums
      integer :: filled(values), i, k

      associate (terms => self%start(self%count + 1) - 1)
         call sums%reserve(values, terms)
         sums%count = values
         filled = 0
         do k = 1, terms
            filled(self%value(k)) = filled(self%value(k)) + 1
         end do
      end associate
      do i = 1, values
         sums%start(i + 1) = sums%start(i) + filled(i)
      end do
      filled = sums%start(:values)
      do i = 1, self%count
         do k = self%start(i), self%start(i + 1) - 1
            sums%value(filled(self%value(k))) = i
            sums%coefficient(filled(self%value(k))) = self%coefficient(k)
            filled(self%value(k)) = filled(self%value(k)) + 1
         end do
      end do
   end function transposed

   !> The same sums with the moduli of the coefficients.
   pure function without_signs(self) result(sums)
      class(sum_list_type), intent(in) :: self
      type(sum_list_type) :: sums

      sums = self
      sums%coefficient = abs(sums%coefficient)
   end function without_signs

   !> The coefficients of each sum in a column.
   pure function as_columns(self, values) result(columns)
      class(sum_list_type), intent(in) :: self
      integer, intent(in) :: values                      !! number of values
      real(dp) :: columns(values, self%count)
      integer :: i

      columns = 0.0_dp
      do i = 1, self%count
         columns(self%values_of(i), i) = self%coefficients_of(i)
      end do
   end function as_columns

   !> Adds the sums, term by term.
   pure subroutine add_totals(self, x, totals)
      class(sum_list_type), intent(in) :: self
      real(dp), intent(in) :: x(:)              !! (values)
      real(dp), intent(inout) :: totals(:)      !! (count)
      integer :: i, k

      do i = 1, self%count
         do k = self%start(i), self%start(i + 1) - 1
            totals(i) = totals(i) + self%coefficient(k)*x(self%value(k))
         end do
      end do
   end subroutine add_totals

   !> Adds to every value its share of each sum, coefficient*y: the transpose of add_totals.
   pure subroutine add_shares(self, y, shares)
      class(sum_list_type), intent(in) :: self
      real(dp), intent(in) :: y(:)              !! (count)
      real(dp), intent(inout) :: shares(:)      !! (values)
      integer :: i, k

      do i = 1, self%count
         do k = self%start(i), self%start(i + 1) - 1
            shares(self%value(k)) = shares(self%value(k)) + self%coefficient(k)*y(i)
         end do
      end do
   end subroutine add_shares

   !> Whether one sum is that of another list.
   pure logical function is_sum_of(self, i, other, j)
      class(sum_list_type), intent(in) :: self
      integer, intent(in) :: i                  !! the sum
      type(sum_list_type), intent(in) :: other
      integer, intent(in) :: j                  !! its sum

      associate (a => self%start(i), b => other%start(j), n => self%start(i + 1) - self%start(i))
         is_sum_of = other%start(j + 1) - b == n
         if (is_sum_of) is_sum_of = all(self%value(a:a + n - 1) == other%value(b:b + n - 1)) .and. &
            all(abs(self%coefficient(a:a + n - 1) - other%coefficient(b:b + n - 1)) <= 0.0_dp)
      end associate
   end function is_sum_of

   !> Values of one sum.
   pure function values_of(self, i) result(values)
      class(sum_list_type), intent(in) :: self
      integer, intent(in) :: i                  !! the sum
      integer, allocatable :: values(:)

      values = self%value(self%start(i):self%start(i + 1) - 1)
   end function values_of

   !> Coefficients of one sum.
   pure function coefficients_of(self, i) result(coefficients)
      class(sum_list_type), intent(in) :: self
      integer, intent(in) :: i                  !! the sum
      real(dp), allocatable :: coefficients(:)

      coefficients = self%coefficient(self%start(i):self%start(i + 1) - 1)
   end function coefficients_of

   !> Adds terms to one sum, in which each value stays once.
   pure subroutine add_terms(more, factor, value, coefficient)
      integer, intent(in) :: more(:)                            !! (n) values, each once
      real(dp), intent(in) :: factor(:)                         !! (n) their coefficients
      integer, allocatable, intent(inout) :: value(:)           !! values of the sum
      real(dp), allocatable, intent(inout) :: coefficient(:)    !! their coefficients
      integer :: entry(size(more)), i

      entry = [(findloc(value, more(i), dim=1), i=1, size(more))]
      do i = 1, size(more)
         if (entry(i) > 0) coefficient(entry(i)) = coefficient(entry(i)) + factor(i)
      end do
      if (all(entry > 0)) return
      value = [value, pack(more, entry == 0)]
      coefficient = [coefficient, pack(factor, entry == 0)]
   end subroutine add_terms

end module sum_lists
