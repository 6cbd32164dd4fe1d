!> Motions without strain that supports leave bodies free to make, on the tail: null vectors of S.
!> Each is one of one body, and has few entries; where bodies are many, so are the motions.
!>
!> Their basis Z is orthonormal on a full tail, where contact points alone tell the motions of a
!> body apart, and these may depend on each other. On a sparse tail, which has the face nodes of
!> all bodies, it is the motions themselves, each of length 1.
module tail_motions
   use dense, only: column_space, least_squares, lu_type, null_space
   use kinds, only: dp
   use sparse_null_space, only: null_space_of
   use sum_lists, only: sum_list_type, sums_of_columns
   implicit none
   private
   public :: tail_motions_type

   !> Force along a motion that is rounding, as part of the terms that it is the sum of.
   real(dp), parameter :: rounding = 1.0e-13_dp
   !> Part of the applied forces that cancel which coordinates and loads of a deck leave over.
   real(dp), parameter :: cancelled = 1.0e-10_dp

   !> All of them.
   type :: tail_motions_type
      logical :: is_orthonormal = .false.
      type(sum_list_type) :: rigid              !! (q, tail) motions
      type(sum_list_type) :: basis              !! (p, tail) Z^T
      logical, allocatable :: moves(:)          !! (tail) whether any of them moves it
      real(dp), allocatable, private :: products(:, :)   !! (q, p) rigid^T Z
      type(lu_type), private :: factors         !! of these on a sparse tail
   contains
      procedure :: set
      procedure :: along
      procedure :: combined
      procedure :: balanced
      procedure :: least_drive
      procedure :: unheld
      procedure :: is_driven
      procedure :: approach
   end type tail_motions_type

contains

   !> Sets the basis.
   pure subroutine set(self, rigid, tail, is_full)
      class(tail_motions_type), intent(inout) :: self
      type(sum_list_type), intent(in) :: rigid     !! (q, tail) motions
      integer, intent(in) :: tail                  !! rows
      logical, intent(in) :: is_full               !! whether the tail is full
      integer :: q
      logical :: singular

      self%rigid = rigid
      self%is_orthonormal = is_full
      if (is_full) then
         self%basis = sums_of_columns(column_space(rigid%as_columns(tail)))
      else
         self%basis = rigid
         do q = 1, rigid%count
            associate (own => self%basis%coefficient(rigid%start(q):rigid%start(q + 1) - 1))
               if (size(own) > 0) own = own/norm2(own)
            end associate
         end do
      end if
      allocate (self%moves(tail), source=.false.)
      self%moves(self%basis%value(:self%basis%start(self%basis%count + 1) - 1)) = .true.
      self%products = products_of(rigid, self%basis, tail)
      if (.not. is_full) call self%factors%factor(self%products, singular)
   end subroutine set

   !> Products of the sums of two lists.
   pure function products_of(a, b, values) result(products)
      type(sum_list_type), intent(in) :: a, b
      integer, intent(in) :: values
      real(dp) :: products(a%count, b%count)
      type(sum_list_type) :: in_a
      integer :: j, k, t

      in_a = a%transposed(values)
      products = 0.0_dp
      do j = 1, b%count
         do k = b%start(j), b%start(j + 1) - 1
            do t = in_a%start(b%value(k)), in_a%start(b%value(k) + 1) - 1
               associate (i => in_a%value(t))
                  products(i, j) = products(i, j) + in_a%coefficient(t)*b%coefficient(k)
               end associate
            end do
         end do
      end do
   end function products_of

   !> Components along the basis, Z^T x.
   pure function along(self, x)
      class(tail_motions_type), intent(in) :: self
      real(dp), intent(in) :: x(:)              !! (tail)
      real(dp) :: along(self%basis%count)       !! (p)

      along = 0.0_dp
      call self%basis%add_totals(x, along)
   end function along

   !> The motion with these components, Z y.
   pure function combined(self, y) result(x)
      class(tail_motions_type), intent(in) :: self
      real(dp), intent(in) :: y(:)              !! (p)
      real(dp) :: x(size(self%moves))           !! (tail)

      x = 0.0_dp
      call self%basis%add_shares(y, x)
   end function combined

   !> A condensed load with the exact resultants along the motions. Temperatures and prescribed
   !> displacements have none; what the elimination makes of theirs is rounding.
   function balanced(self, load, resultant)
      class(tail_motions_type), intent(in) :: self
      real(dp), intent(in) :: load(:)        !! (tail) c [force]
      !> (q) of the applied forces along the rigid motions; absent for none [force]
      real(dp), intent(in), optional :: resultant(:)
      real(dp) :: balanced(size(load))       !! (tail) [force]
      real(dp) :: lacking(self%rigid%count, 1)

      balanced = load
      if (self%basis%count == 0) return
      lacking = 0.0_dp
      call self%rigid%add_totals(-load, lacking(:, 1))
      if (present(resultant)) lacking(:, 1) = lacking(:, 1) + resultant
      if (self%is_orthonormal) then
         balanced = load + self%combined(least_squares(self%products, lacking(:, 1)))
      else
         call self%factors%solve(lacking)
         balanced = load + self%combined(lacking(:, 1))
      end if
   end function balanced

   !> Forces along the motions that count as none.
   pure function least_drive(self, sums) result(least)
      class(tail_motions_type), intent(in) :: self
      real(dp), intent(in) :: sums(:)         !! (q) resultants of the forces without signs [force]
      real(dp) :: least(size(self%moves))     !! (tail) [force]
      real(dp) :: part
      integer :: k, q

      least = 0.0_dp
      do q = 1, self%rigid%count
         part = cancelled*sums(q)/max(sum(self%rigid%coefficients_of(q)**2), tiny(1.0_dp))
         do k = self%rigid%start(q), self%rigid%start(q + 1) - 1
            associate (to => least(self%rigid%value(k)))
               to = to + part*abs(self%rigid%coefficient(k))
            end associate
         end do
      end do
   end function least_drive

   !> The motions that no row of an active set holds, each of length 1 on the free rows; those of a
   !> full tail are orthonormal. Those that move no free row are left out.
   pure function unheld(self, is_free, is_held) result(motions)
      class(tail_motions_type), intent(in) :: self
      logical, intent(in) :: is_free(:)       !! (tail) rows that are sought
      logical, intent(in) :: is_held(:)       !! (tail) rows that hold a motion
      type(sum_list_type) :: motions          !! (l, tail)
      type(sum_list_type) :: rows
      real(dp), allocatable :: columns(:, :)
      integer :: i

      call motions%reserve(0, 0)
      if (self%basis%count == 0) return
      if (self%is_orthonormal) then
         columns = self%basis%as_columns(size(is_held))
         motions = normalised_sums(self%basis, null_space(columns(pack([(i, i=1, &
            size(is_held))], is_held), :)), is_free)
      else
         rows = self%basis%transposed(size(is_held))
         motions = normalised_sums(self%basis, null_space_of(rows, self%basis%count, is_held), &
            is_free)
      end if
   end function unheld

   !> Sums of motions in the free rows, each of length 1; those that move none are left out.
   pure function normalised_sums(motions, factors, is_free) result(sums)
      type(sum_list_type), intent(in) :: motions   !! (p, tail)
      real(dp), intent(in) :: factors(:, :)        !! (p, l), most of them 0
      logical, intent(in) :: is_free(:)            !! (tail)
      type(sum_list_type) :: sums                  !! (l, tail)
      real(dp) :: x(size(is_free))
      integer :: j, k, n, q, touched(size(is_free))
      logical :: is_touched(size(is_free))

      call sums%reserve(size(factors, 2), 2*size(motions%value))
      x = 0.0_dp
      is_touched = .false.
      do j = 1, size(factors, 2)
         n = 0
         do q = 1, size(factors, 1)
            if (abs(factors(q, j)) <= 0.0_dp) cycle
            do k = motions%start(q), motions%start(q + 1) - 1
               associate (row => motions%value(k))
                  if (.not. is_free(row)) cycle
                  if (.not. is_touched(row)) then
                     n = n + 1
                     touched(n) = row
                     is_touched(row) = .true.
                  end if
                  x(row) = x(row) + factors(q, j)*motions%coefficient(k)
               end associate
            end do
         end do
         associate (rows => touched(:n))
            if (norm2(x(rows)) > 0.0_dp) call sums%add(rows, x(rows)/norm2(x(rows)))
            x(rows) = 0.0_dp
            is_touched(rows) = .false.
         end associate
      end do
   end function normalised_sums

   !> Whether forces drive motions, by more than rounding. Each row is judged by the terms that its
   !> own motion collects: those of another body may be far larger.
   pure logical function is_driven(self, motions, unbalanced, terms, least)
      class(tail_motions_type), intent(in) :: self
      type(sum_list_type), intent(in) :: motions   !! (l, tail) as from unheld
      real(dp), intent(in) :: unbalanced(:)        !! (l) forces along the motions [force]
      real(dp), intent(in) :: terms(:)  !! (tail) sums without signs of the forces' terms [force]
      real(dp), intent(in) :: least(:)             !! (tail) drive that counts as none [force]
      real(dp), dimension(size(terms)) :: collected, drive
      real(dp) :: in_motion(motions%count)
      real(dp), allocatable :: columns(:, :)
      type(sum_list_type) :: sizes

      if (self%is_orthonormal) then
         columns = motions%as_columns(size(terms))
         collected = matmul(abs(matmul(columns, transpose(columns))), terms)
      else
         sizes = motions%without_signs()
         in_motion = 0.0_dp
         call sizes%add_totals(terms, in_motion)
         collected = 0.0_dp
         call sizes%add_shares(in_motion, collected)
      end if
      drive = 0.0_dp
      call motions%add_shares(unbalanced, drive)
      is_driven = any(abs(drive) > least + rounding*collected)
   end function is_driven

   !> Moves positions along motions so that what is left of some lengths is least.
   subroutine approach(self, motions, counts, way, d)
      class(tail_motions_type), intent(in) :: self
      type(sum_list_type), intent(in) :: motions   !! (l, tail) as from unheld
      logical, intent(in) :: counts(:)             !! (tail) whether a row's length counts
      real(dp), intent(in) :: way(:)               !! (tail) [length]
      real(dp), intent(inout) :: d(:)              !! (tail) [length]
      real(dp) :: factor(motions%count)
      type(sum_list_type) :: counted
      integer :: k

      counted = motions
      do k = 1, motions%start(motions%count + 1) - 1
         if (.not. counts(motions%value(k))) counted%coefficient(k) = 0.0_dp
      end do
      factor = 0.0_dp
      call counted%add_totals(way, factor)
      if (.not. self%is_orthonormal) factor = least_squares(products_of(counted, motions, &
         size(d)), factor)
      call motions%add_shares(-factor, d)
   end subroutine approach

end module tail_motions
