!> Versions of the program, its compiler and its libraries.
module version_report
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use, intrinsic :: iso_fortran_env, only: compiler_version, output_unit
   use blas_lapack, only: ilaver
   use hdf5, only: h5close_f, h5get_libversion_f, h5open_f
   use messages, only: print_line
   use mumps_solver, only: mumps_version
   use text, only: to_text
   use version, only: metis_version, program_version
   implicit none
   private
   public :: print_versions

   interface
      subroutine c_processor(name, length) bind(c, name='blas_processor')
         import :: c_char, c_int
         integer(c_int), value :: length
         character(kind=c_char), intent(out) :: name(length)
      end subroutine c_processor
   end interface

contains

   !> Prints one line each.
   subroutine print_versions()
      integer, parameter :: most = 64
      character(most, kind=c_char) :: buffer
      character(:), allocatable :: mumps, processor
      integer :: lapack(3), hdf5(3), status

      mumps = mumps_version()
      call ilaver(lapack(1), lapack(2), lapack(3))
      call h5open_f(status)
      call h5get_libversion_f(hdf5(1), hdf5(2), hdf5(3), status)
      call h5close_f(status)
      call print_line(output_unit, 'thercon '//program_version)
      call print_line(output_unit, 'compiler '//compiler_version())
      call print_line(output_unit, 'MUMPS '//mumps)
      call print_line(output_unit, 'METIS '//metis_version)
      call print_line(output_unit, 'HDF5 '//dotted(hdf5))
      ! The processor for which OpenBLAS computes, in its own words; empty with another BLAS.
      call c_processor(buffer, int(most, c_int))
      processor = buffer(:index(buffer, c_null_char) - 1)
      if (len(processor) > 0) processor = ', OpenBLAS for '//processor
      call print_line(output_unit, 'LAPACK '//dotted(lapack)//processor)
   end subroutine print_versions

   pure function dotted(numbers) result(string)
      integer, intent(in) :: numbers(3)
      character(:), allocatable :: string

      string = to_text(numbers(1))//'.'//to_text(numbers(2))//'.'//to_text(numbers(3))
   end function dotted

end module version_report
