!> Group `/run` of the result file: what the run was, as attributes.
module result_run
   use hdf5_writer, only: hdf5_writer_type
   use kinds, only: dp
   use model, only: model_type
   use run_summaries, only: or_blank, run_summary_type
   implicit none
   private
   public :: write_run

   character(*), parameter :: group = '/run'
   integer, parameter :: format_version = 1   !! of the result file; grows where old readers fail

contains

   !> Writes the attributes of `/run`, over those of an earlier publishing.
   subroutine write_run(file, run, model, seconds_write)
      type(hdf5_writer_type), intent(inout) :: file       !! the open file
      type(run_summary_type), intent(in) :: run           !! the run so far
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: seconds_write               !! writing not yet in run [s]

      call file%set(group, 'format_version', format_version)
      call file%set(group, 'version', or_blank(run%version))
      call file%set(group, 'heading', or_blank(model%heading))
      call file%set(group, 'solver', or_blank(run%solver))
      call file%set(group, 'modelled', or_blank(run%modelled))
      call file%set(group, 'unit_length', or_blank(model%units%length))
      call file%set(group, 'unit_stress', or_blank(model%units%stress))
      call file%set(group, 'unit_power', or_blank(model%units%power))
      call file%set(group, 'unit_temperature', or_blank(model%units%temperature))
      call file%set(group, 'equations_thermal', run%equations_thermal)
      call file%set(group, 'equations_mechanical', run%equations_mechanical)
      call file%set(group, 'contact_unknowns', run%contact_unknowns)
      call file%set(group, 'factor_bytes', run%factor_bytes)
      call file%set(group, 'smallest_pivot', run%smallest_pivot)
      call file%set(group, 'verify_passed', run%verify_passed)
      call file%set(group, 'verify_failed', run%verify_failed)
      call file%set(group, 'seconds_read', run%seconds_read)
      call file%set(group, 'seconds_assemble', run%seconds_assemble)
      call file%set(group, 'seconds_reduce', run%seconds_reduce)
      call file%set(group, 'seconds_iterate', run%seconds_iterate)
      call file%set(group, 'seconds_recover', run%seconds_recover)
      call file%set(group, 'seconds_write', run%seconds_write + seconds_write)
   end subroutine write_run

end module result_run
