!> What the rows of a trade are measured against: the grid extrapolated to no size of elements and
!> increments, with what that is uncertain by.
module trade_reference
   use extrapolation, only: extrapolate, limit_type
   use kinds, only: dp
   use reported_quantities, only: traded
   use trade_plan, only: factors, find_row
   use trade_quantities, only: figure_count, is_there, quantity_count
   use trade_rows, only: trade_type
   implicit none
   private
   public :: reference_type, find_reference

   !> Rows to extrapolate along: one sequence of meshes, one of increments.
   type :: sequences_type
      integer, allocatable :: meshes(:)       !! rows from the coarsest mesh to the finest
      integer, allocatable :: increments(:)   !! rows from the longest increments to the shortest
      integer :: base = 0        !! of the increments, the row whose increments the meshes have
      integer :: linear = 0      !! the last mesh with linear elements, 0 for none
      integer :: default = 0     !! the deck as written
      integer :: tight = 0       !! the same with the smallest tolerance, 0 for none
   end type sequences_type

   !> The reference.
   type :: reference_type
      logical :: is_known = .false.                    !! whether there is one
      real(dp), allocatable :: figures(:, :, :)    !! (figures, contact points, instants), or absent
      real(dp), allocatable :: temperatures(:, :)      !! (nodes, instants)
      real(dp), allocatable :: length(:, :)     !! (contact points, instants) closed length [length]
      !> (figures, contact points, instants), as figures
      real(dp), allocatable :: uncertainty(:, :, :)
      real(dp) :: temperature_uncertainty = 0.0_dp     !! largest of nodes and instants [temp.]
      logical :: is_contradictory(quantity_count) = .false.   !! some rows have it, others not
   end type reference_type

contains

   !> Finds the reference: the row of the finest mesh and its shortest increments, moved by what
   !> extrapolation adds over meshes and, on the finest mesh that has three sizes of them, over
   !> increments.
   pure subroutine find_reference(trade, reference)
      type(trade_type), intent(in) :: trade              !! the trade, run
      type(reference_type), intent(out) :: reference
      type(sequences_type) :: rows
      type(limit_type) :: limit
      logical :: differs
      integer :: q, i, t

      call find_sequences(trade, rows)
      reference%is_known = size(rows%increments) > 1 .and. rows%base > 0 .and. &
         (size(rows%meshes) > 1 .or. rows%linear > 0)
      if (.not. reference%is_known) return
      associate (finest => trade%rows(rows%meshes(size(rows%meshes)))%values)
         reference%figures = finest%figures
         reference%temperatures = finest%temperatures
         reference%length = finest%length
      end associate
      allocate (reference%uncertainty, mold=reference%figures)
      do t = 1, size(reference%figures, 3)
         do i = 1, size(reference%figures, 2)
            do q = 1, figure_count
               call find_limit(figures_of(trade, rows, q, i, t), &
                  traded(q)%resolution > 0.0_dp, limit, differs)
               reference%figures(q, i, t) = limit%value
               reference%uncertainty(q, i, t) = limit%uncertainty
               reference%is_contradictory(q) = reference%is_contradictory(q) .or. differs
            end do
         end do
         do i = 1, size(reference%temperatures, 1)
            call find_limit(temperatures_of(trade, rows, i, t), .false., limit, differs)
            reference%temperatures(i, t) = limit%value
            reference%temperature_uncertainty = max(reference%temperature_uncertainty, &
               limit%uncertainty)
         end do
      end do
   contains
      !> The limit of one number: rows of the sequences, then the three single ones.
      pure subroutine find_limit(values, is_position, limit, differs)
         real(dp), intent(in) :: values(:)
         logical, intent(in) :: is_position
         type(limit_type), intent(out) :: limit
         logical, intent(out) :: differs
         type(limit_type) :: finer
         integer :: m, n

         m = size(rows%meshes)
         n = size(rows%increments)
         limit%value = values(m)
         differs = any(is_there(values) .neqv. is_there(values(m)))
         if (differs .or. .not. is_there(values(m))) return
         limit = extrapolate(values(:m), is_position)
         if (m == 1) limit%uncertainty = 2.0_dp*abs(values(1) - values(m + n + 1))
         finer = extrapolate(values(m + 1:m + n), is_position)
         limit%value = limit%value + (finer%value - values(m + rows%base))
         limit%uncertainty = limit%uncertainty + finer%uncertainty + &
            abs(values(m + n + 2) - values(m + n + 3))
      end subroutine find_limit
   end subroutine find_reference

   pure function figures_of(trade, rows, q, i, t) result(values)
      type(trade_type), intent(in) :: trade
      type(sequences_type), intent(in) :: rows
      integer, intent(in) :: q, i, t
      real(dp), allocatable :: values(:)
      integer, allocatable :: list(:)
      integer :: k

      list = all_rows(rows)
      values = [(trade%rows(list(k))%values%figures(q, i, t), k=1, size(list))]
   end function figures_of

   pure function temperatures_of(trade, rows, node, t) result(values)
      type(trade_type), intent(in) :: trade
      type(sequences_type), intent(in) :: rows
      integer, intent(in) :: node, t
      real(dp), allocatable :: values(:)
      integer, allocatable :: list(:)
      integer :: k

      list = all_rows(rows)
      values = [(trade%rows(list(k))%values%temperatures(node, t), k=1, size(list))]
   end function temperatures_of

   !> Rows whose values make a limit; in place of one that is missing is one that adds nothing.
   pure function all_rows(rows) result(list)
      type(sequences_type), intent(in) :: rows
      integer, allocatable :: list(:)
      integer :: last

      last = rows%meshes(size(rows%meshes))
      list = [rows%meshes, rows%increments, merge(rows%linear, last, rows%linear > 0), &
         merge([rows%default, rows%tight], [last, last], min(rows%default, rows%tight) > 0)]
   end function all_rows

   !> Picks the rows: the finest mesh with its shortest increments, coarser ones with the same
   !> increments; and the increments on the finest mesh that has three sizes of them.
   pure subroutine find_sequences(trade, rows)
      type(trade_type), intent(in) :: trade
      type(sequences_type), intent(out) :: rows
      integer, allocatable :: found(:)
      integer :: order, finest, f, level, i

      allocate (rows%meshes(0), rows%increments(0))
      order = 0
      finest = -1
      do i = 1, trade%count
         if (trade%rows(i)%is_default .and. trade%rows(i)%status == 0) rows%default = i
         if (.not. is_grid_row(trade, i)) cycle
         order = max(order, trade%rows(i)%order)
      end do
      do i = 1, trade%count
         if (is_grid_row(trade, i) .and. trade%rows(i)%order == order) then
            finest = max(finest, trade%rows(i)%level)
         end if
      end do
      if (finest < 0) return
      do f = size(factors), 1, -1
         if (is_grid_row(trade, find_row(trade, order, finest, 0, factors(f)))) exit
      end do
      do level = finest, 0, -1
         i = find_row(trade, order, level, 0, factors(f))
         if (.not. is_grid_row(trade, i)) exit
         rows%meshes = [i, rows%meshes]
      end do
      do level = finest, 0, -1
         found = increments_on(trade, order, level)
         if (size(found) > size(rows%increments)) rows%increments = found
         if (size(rows%increments) >= 3) exit
      end do
      do i = 1, size(rows%increments)
         if (abs(trade%rows(rows%increments(i))%variation%increments - factors(f)) <= 0.0_dp) then
            rows%base = i
         end if
      end do
      if (order > 1) rows%linear = find_row(trade, 1, finest, 0, factors(f))
      if (.not. is_grid_row(trade, rows%linear)) rows%linear = 0
      do i = 1, trade%count
         if (trade%rows(i)%variation%tolerance <= 0.0_dp .or. trade%rows(i)%status /= 0) cycle
         if (rows%tight > 0) then
            if (trade%rows(rows%tight)%variation%tolerance < &
               trade%rows(i)%variation%tolerance) cycle
         end if
         rows%tight = i
      end do
   end subroutine find_sequences

   !> The rows of a level by ever shorter increments, up to the shortest that was solved.
   pure function increments_on(trade, order, level) result(found)
      type(trade_type), intent(in) :: trade
      integer, intent(in) :: order, level
      integer, allocatable :: found(:)
      integer :: f, i

      allocate (found(0))
      do f = size(factors), 1, -1
         i = find_row(trade, order, level, 0, factors(f))
         if (is_grid_row(trade, i)) then
            found = [i, found]
         else if (size(found) > 0) then
            exit
         end if
      end do
   end function increments_on

   pure logical function is_grid_row(trade, i)
      type(trade_type), intent(in) :: trade
      integer, intent(in) :: i

      is_grid_row = .false.
      if (i > 0) is_grid_row = trade%rows(i)%is_grid .and. trade%rows(i)%status == 0
   end function is_grid_row

end module trade_reference
