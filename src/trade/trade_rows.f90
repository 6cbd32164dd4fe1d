!> Rows of a trade: what each varies, what it took and what came of it.
module trade_rows
   use kinds, only: dp
   use text, only: string_type
   use trade_quantities, only: absent, quantity_count, row_values_type
   use variations, only: variation_type
   implicit none
   private
   public :: trade_row_type, trade_type, targets, target_count

   integer, parameter :: target_count = 3                                 !! target accuracies
   real(dp), parameter :: targets(target_count) = [0.1_dp, 0.01_dp, 0.001_dp] !! relative errors

   !> One row: a variation of the deck, measured.
   type :: trade_row_type
      type(variation_type) :: variation = variation_type()   !! what differs from the deck
      integer :: order = 2                              !! order of its elements, 1 or 2
      integer :: level = 0                              !! refinements of the deck's mesh
      integer :: contact_level = 0                      !! more of them at the contact faces
      logical :: is_grid = .true.                       !! of the grid; else one thing is varied
      logical :: is_default = .false.                   !! the deck as it is written
      character(:), allocatable :: varied               !! the one thing; empty in the grid
      integer :: status = 0                             !! exit status
      character(:), allocatable :: reason               !! why it failed; empty where it did not
      real(dp), allocatable :: cpu(:)                   !! (runs) CPU seconds [s]
      real(dp) :: cpu_seconds = 0.0_dp                  !! their median [s]
      real(dp) :: peak_bytes = 0.0_dp                   !! largest resident memory [byte]
      type(row_values_type) :: values = row_values_type()    !! what it found
      real(dp) :: errors(quantity_count) = absent       !! stated errors [-]
      real(dp) :: worst = absent                        !! largest of them
      logical :: is_optimal = .false.                   !! no row is both cheaper and better
      logical :: is_recommended(target_count) = .false. !! for a target
   end type trade_row_type

   !> A trade.
   type :: trade_type
      type(trade_row_type), allocatable :: rows(:)      !! room for all rows
      integer :: count = 0                              !! rows that there are
      type(string_type), allocatable :: left_out(:)     !! what was not run, and why
      character(:), allocatable :: ended_early          !! why rows are missing; else not allocated
      real(dp) :: uncertainty(quantity_count) = absent  !! of the reference; absent: not judged
      logical :: is_known(quantity_count) = .false.     !! whether there is a reference to judge by
      !> What a recommendation does not hold for, or why there is none; empty for neither
      type(string_type) :: remarks(target_count)
      real(dp), allocatable :: instants(:)              !! total times of comparison [time]
   end type trade_type

end module trade_rows
