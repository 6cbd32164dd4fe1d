!> The limit of the grid, and the errors of the rows against it.
module trade_reference
   use kinds, only: dp
   use reported_quantities, only: traded
   use sequence_limits, only: extrapolate, halved, limit_type
   use trade_study, only: closed_length, is_there, quantity_count, trade_row_type, trade_type
   implicit none
   private
   public :: state_errors

   real(dp), parameter :: idle = 0.01_dp     !! part of the largest contact below which one is idle
   real(dp), parameter :: nothing = 1.0e-12_dp   !! part of the largest temperature: no range
   real(dp), parameter :: early = 0.25_dp    !! part of the largest value: least scale over time
   real(dp), parameter :: whole = 1.0_dp     !! error of a value that only one of two has

   !> Positions are known to a part of the size of elements, with scatter.
   logical, parameter :: has_scatter(0:quantity_count) = [.false., traded%resolution > 0.0_dp]

contains

   !> States the errors of all rows that were solved, and the uncertainty of the reference: the row
   !> of the finest mesh and its shortest increments, moved by what extrapolation adds over meshes
   !> and, on the finest mesh that has three sizes of them, over increments. An error is the
   !> distance from it plus its uncertainty, relative to the scale of the value.
   pure subroutine state_errors(initial_temperature, trade)
      real(dp), intent(in) :: initial_temperature(:)   !! of the nodes of the deck [temperature]
      type(trade_type), intent(inout) :: trade         !! receives the errors
      type(limit_type), allocatable :: limits(:, :)
      real(dp), allocatable :: scales(:, :)
      logical, allocatable :: is_of(:, :)
      integer, allocatable :: sequences(:)
      integer :: meshes, base, q, i, t, k

      call find_sequences(trade%rows, sequences, meshes, base)
      if (base == 0) return
      allocate (limits(size(trade%items), size(trade%instants)))
      do t = 1, size(limits, 2)
         do i = 1, size(limits, 1)
            limits(i, t) = limit_of([(trade%rows(sequences(k))%values(i, t), &
               k=1, size(sequences))], meshes, base, trade%items(i))
         end do
      end do
      scales = scales_of(trade%items, limits%value, initial_temperature)
      do q = 1, quantity_count
         is_of = spread(trade%items == q, 2, size(limits, 2)) .and. scales > 0.0_dp
         if (.not. any(is_of)) cycle
         trade%uncertainty(q) = merge(whole, maxval(pack(limits%uncertainty, is_of)/pack(scales, &
            is_of)), any(limits%differs .and. spread(trade%items == q, 2, size(limits, 2))))
         do i = 1, size(trade%rows)
            if (trade%rows(i)%status == 0) trade%rows(i)%errors(q) = trade%uncertainty(q) + &
               maxval(distance(pack(trade%rows(i)%values, is_of), pack(limits%value, is_of), &
               pack(scales, is_of)))
         end do
         trade%rows%worst = max(trade%rows%worst, trade%rows%errors(q))
      end do
   end subroutine state_errors

   !> Of a row from the reference; a value that only one of them has is wholly wrong.
   elemental real(dp) function distance(found, expected, scale)
      real(dp), intent(in) :: found, expected, scale

      distance = merge(0.0_dp, whole, is_there(expected) .eqv. is_there(found))
      if (is_there(expected) .and. is_there(found)) distance = abs(found - expected)/scale
   end function distance

   !> Reference of relative errors: the value at the instant, for edges the length of the contact, a
   !> quarter of the largest over time where that is more, and a hundredth of the largest of all
   !> interfaces; for temperatures the range of all, the initial ones included. 0 where there is
   !> nothing to measure.
   pure function scales_of(items, values, initial) result(scales)
      integer, intent(in) :: items(:)         !! as from item_quantities
      real(dp), intent(in) :: values(:, :)    !! (items, instants) of the reference
      real(dp), intent(in) :: initial(:)      !! temperatures
      real(dp), allocatable :: scales(:, :), ends(:)
      logical, allocatable :: is_of(:, :)
      integer :: q, i

      scales = merge(abs(values), 0.0_dp, is_there(values))
      do i = 1, size(items)
         if (has_scatter(items(i))) scales(i, :) = &
            values(i + findloc(items(i:), closed_length, dim=1) - 1, :)
         scales(i, :) = max(scales(i, :), early*maxval(scales(i, :)))
      end do
      do q = 1, quantity_count
         is_of = spread(items == q, 2, size(values, 2))
         where (is_of) scales = max(scales, idle*maxval(scales, mask=is_of))
         if (.not. any(is_of .and. is_there(values))) where (is_of) scales = 0.0_dp
      end do
      ends = pack(values, is_of .and. is_there(values))
      if (size(ends) == 0) return
      ends = [min(minval(ends), minval(initial)), max(maxval(ends), maxval(initial))]
      where (is_of) scales = merge(ends(2) - ends(1), 0.0_dp, &
         ends(2) - ends(1) > nothing*maxval(abs(ends)))
   end function scales_of

   !> Picks the finest mesh with its shortest increments and coarser ones with the same increments;
   !> the increments on the finest mesh that has three sizes of them.
   pure subroutine find_sequences(rows, sequences, mesh_count, base)
      type(trade_row_type), intent(in) :: rows(:)
      !> Rows from the coarsest mesh to the finest; from the longest increments to the shortest; the
      !> deck as written; the same with the smallest tolerance
      integer, allocatable, intent(out) :: sequences(:)
      integer, intent(out) :: mesh_count   !! how many of them are meshes
      integer, intent(out) :: base         !! which of the increments the meshes have; 0 for none
      integer, allocatable :: meshes(:), increments(:), found(:)
      logical :: is_grid(size(rows)), is_linear(size(rows))
      integer :: i, finest, level, list(size(rows)), default, tight

      mesh_count = 0
      base = 0
      list = [(i, i=1, size(rows))]
      is_grid = rows%status == 0 .and. rows%variation%contact_levels == 0 .and. &
         [(rows(i)%varied == '', i=1, size(rows))]
      is_linear = is_grid .and. rows%variation%order == 1
      is_grid = is_grid .and. rows%variation%order == maxval(rows%variation%order, mask=is_grid)
      finest = findloc(is_grid, .true., dim=1, back=.true.)
      if (finest == 0) return
      associate (factors => rows%variation%increments, levels => rows%variation%levels)
         meshes = halved(pack(list, is_grid .and. abs(factors - factors(finest)) <= 0.0_dp), &
            0.5_dp**levels)
         allocate (increments(0))
         do level = levels(finest), 0, -1
            found = halved(pack(list, is_grid .and. levels == level), factors)
            if (size(found) > size(increments)) increments = found
            if (size(increments) >= 3) exit
         end do
         ! Linear elements on the only mesh count as a coarser one.
         if (size(meshes) == 1) meshes = [pack(list, is_linear .and. .not. is_grid .and. levels == &
            levels(finest) .and. abs(factors - factors(finest)) <= 0.0_dp), meshes]
         if (size(meshes) > 1 .and. size(increments) > 1) base = findloc( &
            abs(factors(increments) - factors(finest)) <= 0.0_dp, .true., dim=1)
      end associate
      default = findloc(rows%is_default .and. rows%status == 0, .true., dim=1)
      tight = minloc(rows%variation%tolerance, dim=1, &
         mask=rows%variation%tolerance > 0.0_dp .and. rows%status == 0)
      mesh_count = size(meshes)
      sequences = [meshes, increments, &
         merge([default, tight], [finest, finest], min(default, tight) > 0)]
   end subroutine find_sequences

   !> The limit of one number.
   pure function limit_of(values, m, base, quantity) result(limit)
      real(dp), intent(in) :: values(:)     !! of the rows of find_sequences
      integer, intent(in) :: m, base        !! mesh_count and base of find_sequences
      integer, intent(in) :: quantity       !! of the item
      type(limit_type) :: limit, finer

      limit%value = values(m)
      limit%differs = any(is_there(values) .neqv. is_there(values(m)))
      if (limit%differs .or. quantity == closed_length .or. .not. is_there(values(m))) return
      limit = extrapolate(values(:m), has_scatter(quantity))
      associate (n => size(values))
         finer = extrapolate(values(m + 1:n - 2), has_scatter(quantity))
         limit%value = limit%value + (finer%value - values(m + base))
         limit%uncertainty = limit%uncertainty + finer%uncertainty + abs(values(n - 1) - values(n))
      end associate
   end function limit_of

end module trade_reference
