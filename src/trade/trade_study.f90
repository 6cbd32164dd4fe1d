!> A trade-off study: its rows, and the numbers by which they are compared.
module trade_study
   use kinds, only: dp
   use reported_quantities, only: traded
   use text, only: string_type
   use variations, only: variation_type
   implicit none
   private
   public :: trade_row_type, trade_type, targets, target_count
   public :: quantity_count, figure_count, closed_length, is_there, absent, item_quantities

   integer, parameter :: quantity_count = size(traded)       !! quantities that rows are judged by
   integer, parameter :: figure_count = quantity_count - 1   !! all but the last: the temperatures
   integer, parameter :: closed_length = 0                   !! no quantity: the scale of edges
   real(dp), parameter :: absent = -1.0e300_dp               !! marks a value that does not exist

   integer, parameter :: target_count = 3
   real(dp), parameter :: targets(target_count) = [0.1_dp, 0.01_dp, 0.001_dp] !! relative errors

   !> A variation of the deck, measured.
   type :: trade_row_type
      type(variation_type) :: variation                 !! with its order and levels
      character(:), allocatable :: varied               !! one thing; empty: mesh or increments
      logical :: is_default = .false.                   !! the deck as written
      integer :: status = 0                             !! exit status
      character(:), allocatable :: reason               !! why it failed; empty where it did not
      real(dp), allocatable :: cpu(:)                   !! CPU seconds, a run each [s]
      real(dp) :: cpu_seconds = 0.0_dp                  !! their median [s]
      real(dp) :: peak_bytes = 0.0_dp                   !! largest resident memory [byte]
      integer :: increments = 0                         !! accepted increments
      integer :: passes = 0                             !! passes of the fixed point in all of them
      real(dp), allocatable :: values(:, :)             !! (items, instants), or absent
      real(dp) :: errors(quantity_count) = absent       !! stated errors [-]
      real(dp) :: worst = absent                        !! largest of them
      logical :: is_optimal = .false.                   !! Pareto-optimal
      logical :: is_recommended(target_count) = .false.
   end type trade_row_type

   !> A trade-off study.
   type :: trade_type
      type(trade_row_type), allocatable :: rows(:)
      type(trade_row_type), allocatable :: left_out(:)  !! by --limit, with the reason
      character(:), allocatable :: ended_early          !! why rows are missing; else unallocated
      real(dp), allocatable :: instants(:)              !! total times of comparison [time]
      integer, allocatable :: items(:)                  !! as from item_quantities
      real(dp) :: uncertainty(quantity_count) = absent  !! of the reference; absent: not judged
      logical :: is_known(quantity_count) = .false.     !! whether there is a reference
      !> What a recommendation does not hold for, or why there is none; empty for neither
      type(string_type) :: remarks(target_count)
   end type trade_type

contains

   elemental logical function is_there(value)
      real(dp), intent(in) :: value   !! a value, or absent

      is_there = value > 0.5_dp*absent
   end function is_there

   !> Which quantity each of the compared values is of: for every interface its figures, then its
   !> closed length; then the temperatures of nodes. A deck without contact counts as one interface,
   !> whose heat is that which enters.
   pure function item_quantities(interfaces, nodes) result(quantities)
      integer, intent(in) :: interfaces, nodes       !! number of each
      integer, allocatable :: quantities(:)          !! indexes into traded, or closed_length
      integer :: q, i

      quantities = [([(q, q=1, figure_count), closed_length], i=1, max(interfaces, 1)), &
         (quantity_count, i=1, nodes)]
   end function item_quantities

end module trade_study
