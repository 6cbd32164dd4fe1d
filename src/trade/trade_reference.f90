!> The limit of the grid, and the errors of the rows against it: the limit of values on meshes or
!> with increments that are halved again and again, and what it is uncertain by.
module trade_reference
   use kinds, only: dp
   use reported_quantities, only: traded
   use trade_study, only: closed_length, is_there, quantity_count, trade_row_type, trade_type
   implicit none
   private
   public :: state_errors, limit_type, extrapolate

   real(dp), parameter :: idle = 0.01_dp     !! part of the largest contact below which one is idle
   real(dp), parameter :: nothing = 1.0e-12_dp   !! part of the largest temperature: no range
   real(dp), parameter :: early = 0.25_dp    !! part of the largest value: least scale over time
   real(dp), parameter :: whole = 1.0_dp     !! error of a value that only one of two has

   !> Positions are known to a part of the size of elements, with scatter.
   logical, parameter :: has_scatter(0:quantity_count) = [.false., traded%resolution > 0.0_dp]

   real(dp), parameter :: rounding = 1.0e-11_dp   !! relative differences that are none
   real(dp), parameter :: slowest = 1.25_dp       !! ratio of differences; below it none is trusted
   real(dp), parameter :: fastest = 8.0_dp        !! ratio that is believed at most: third order
   real(dp), parameter :: doubtful = 5.0_dp       !! ratio of two differences alone: chance, perhaps
   real(dp), parameter :: faster = 1.1_dp         !! a ratio that grows more: terms that cancel
   real(dp), parameter :: slower = 2.0_dp         !! one that falls more: none is steady
   real(dp), parameter :: safety = 2.0_dp         !! on the differences of irregular sequences
   real(dp), parameter :: safety_of_three = 3.0_dp   !! the same on those of three values alone
   real(dp), parameter :: safety_of_two = 2.0_dp  !! on the difference of two values
   real(dp), parameter :: drift = 4.0_dp          !! 1/(slowest - 1), if differences fall slower

   !> The limit of a sequence.
   type :: limit_type
      real(dp) :: value = 0.0_dp
      real(dp) :: uncertainty = 0.0_dp
      logical :: differs = .false.   !! only some of them have a value
   end type limit_type

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

   !> The limit of values with steps h, h/2, h/4, ... Where the last differences fall by a steady
   !> ratio, Richardson's extrapolation with that ratio, uncertain by all that it adds and by half
   !> the last difference. Where they do not, the last value, uncertain by what the others say if
   !> errors fall at least as h does; a position that is known to a part of h, with scatter, is
   !> always judged so.
   pure function extrapolate(values, is_position) result(limit)
      real(dp), intent(in) :: values(:)     !! (n) from the coarsest to the finest, at least one
      logical, intent(in) :: is_position    !! whether their errors are parts of h
      type(limit_type) :: limit             !! their limit
      real(dp) :: differences(size(values) - 1), ratio, added
      integer :: k, n

      n = size(values)
      limit%value = values(n)
      if (n == 1) return
      differences = values(2:) - values(:n - 1)
      if (maxval(abs(differences)) <= rounding*maxval(abs(values))) then
         limit%uncertainty = maxval(abs(differences))
         return
      else if (n == 2) then
         limit%uncertainty = safety_of_two*abs(differences(1))
         return
      end if
      ratio = 0.0_dp
      if (.not. is_position) ratio = steady_ratio(differences)
      if (ratio > 0.0_dp) then
         added = differences(n - 1)/(min(ratio, fastest) - 1.0_dp)
         limit%value = values(n) + added
         limit%uncertainty = max(abs(added), 0.5_dp*abs(differences(n - 1)))
         if (n == 3) limit%uncertainty = max(abs(added), abs(differences(2)))
      else
         ! If errors fall at least as the steps do, that of the last value is at most
         ! |v_k - v_n|/(2^(n-k) - 1) for any k; one of these may vanish by chance, not the largest.
         limit%uncertainty = merge(safety_of_three, safety, n == 3)* &
            maxval([(abs(values(k) - values(n))/(2.0_dp**(n - k) - 1.0_dp), k=1, n - 1)])
         associate (before => differences(n - 2), last => differences(n - 1))
            if (.not. is_position .and. (before > 0.0_dp .eqv. last > 0.0_dp) .and. abs(before) < &
               slowest*abs(last)) limit%uncertainty = max(limit%uncertainty, drift*abs(last))
         end associate
      end if
   end function extrapolate

   !> The last of some entries, as far as each has half the size of the one before.
   pure function halved(list, sizes) result(last)
      integer, intent(in) :: list(:)       !! entries, the smallest size last
      real(dp), intent(in) :: sizes(:)     !! of all entries
      integer, allocatable :: last(:)
      integer :: first

      do first = size(list), 2, -1
         if (abs(sizes(list(first - 1)) - 2.0_dp*sizes(list(first))) > 0.0_dp) exit
      end do
      last = list(max(first, 1):)
   end function halved

   !> By which ratio the last differences fall; 0 where that is not steady.
   pure real(dp) function steady_ratio(differences) result(ratio)
      real(dp), intent(in) :: differences(:)   !! at least two
      real(dp) :: last(min(size(differences), 3)), ratios(2)
      integer :: n

      ratio = 0.0_dp
      n = size(last)
      last = differences(size(differences) - n + 1:)
      if (any(abs(last) <= tiny(ratio)) .or. any((last > 0.0_dp) .neqv. (last(1) > 0.0_dp))) return
      ratios = [last(1)/last(2), last(n - 1)/last(n)]
      if (minval(ratios) < slowest .or. n == 2 .and. ratios(2) > doubtful) return
      if (ratios(2) > faster*ratios(1) .or. ratios(1) > slower*ratios(2)) return
      ratio = minval(ratios)
   end function steady_ratio

end module trade_reference
