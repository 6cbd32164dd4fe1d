!> What is known of a run as a whole: for the listing's summary and the result file's `/run`.
module run_summaries
   use accuracy_rounds, only: accuracy_rounds_type
   use kinds, only: dp, long
   implicit none
   private
   public :: run_summary_type, or_blank

   !> One run. The caller of the output layer keeps it up to date.
   type :: run_summary_type
      character(:), allocatable :: version       !! version of the program
      character(:), allocatable :: deck_path     !! deck as the command line names it
      character(:), allocatable :: solver        !! SKYLINE or MUMPS
      character(:), allocatable :: modelled      !! heat, contact, friction, coupling: which are on
      character(:), allocatable :: reasons       !! why, in one sentence
      integer :: equations_thermal = 0           !! unknown temperatures
      integer :: equations_mechanical = 0        !! unknown displacements
      integer :: contact_unknowns = 0            !! unknowns of the reduced system
      integer(long) :: factor_bytes = 0          !! bytes of the factors
      real(dp) :: smallest_pivot = 1.0_dp        !! of the factors, over its diagonal entry [-]
      logical :: has_biot = .false.              !! whether contact_biot was computed
      real(dp) :: contact_biot(2) = 0.0_dp       !! omega L/K at the start, smallest and largest [-]
      real(dp) :: seconds_read = 0.0_dp          !! reading the deck [s]
      real(dp) :: seconds_assemble = 0.0_dp      !! element matrices [s]
      real(dp) :: seconds_reduce = 0.0_dp        !! factoring and reducing the bodies [s]
      real(dp) :: seconds_iterate = 0.0_dp       !! fixed point and contact [s]
      real(dp) :: seconds_recover = 0.0_dp       !! recovering the fields [s]
      real(dp) :: seconds_write = 0.0_dp         !! writing; the output layer adds to it [s]
      integer :: verify_passed = 0               !! *VERIFY checks that passed
      integer :: verify_failed = 0               !! *VERIFY checks that failed
      type(accuracy_rounds_type) :: accuracy     !! rounds of a requested accuracy
   end type run_summary_type

contains

   !> Text that may not have been given.
   pure function or_blank(text) result(string)
      character(:), allocatable, intent(in) :: text   !! the text, or unallocated
      character(:), allocatable :: string             !! the text, or nothing

      string = ''
      if (allocated(text)) string = text
   end function or_blank

end module run_summaries
