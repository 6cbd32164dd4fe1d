!> Group `/run` of the result file: what the run was, as attributes.
module result_run
   use errors, only: error_type
   use hdf5, only: hid_t
   use hdf5_attributes, only: write_attribute
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
   !> Error: status_internal, when HDF5 refuses.
   subroutine write_run(file, run, model, seconds_write, error)
      integer(hid_t), intent(in) :: file                  !! the open file
      type(run_summary_type), intent(in) :: run           !! the run so far
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: seconds_write               !! writing not yet in run [s]
      type(error_type), allocatable, intent(out) :: error !! what went wrong

      call write_texts(file, run, model, error)
      if (allocated(error)) return
      call write_counts(file, run, error)
      if (allocated(error)) return
      call write_seconds(file, run, seconds_write, error)
   end subroutine write_run

   subroutine write_texts(file, run, model, error)
      integer(hid_t), intent(in) :: file
      type(run_summary_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      call write_attribute(file, group, 'format_version', format_version, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'version', or_blank(run%version), error)
      if (allocated(error)) return
      call write_attribute(file, group, 'heading', or_blank(model%heading), error)
      if (allocated(error)) return
      call write_attribute(file, group, 'solver', or_blank(run%solver), error)
      if (allocated(error)) return
      call write_attribute(file, group, 'modelled', or_blank(run%modelled), error)
      if (allocated(error)) return
      call write_attribute(file, group, 'unit_length', or_blank(model%units%length), error)
      if (allocated(error)) return
      call write_attribute(file, group, 'unit_stress', or_blank(model%units%stress), error)
      if (allocated(error)) return
      call write_attribute(file, group, 'unit_power', or_blank(model%units%power), error)
      if (allocated(error)) return
      call write_attribute(file, group, 'unit_temperature', or_blank(model%units%temperature), &
         error)
   end subroutine write_texts

   subroutine write_counts(file, run, error)
      integer(hid_t), intent(in) :: file
      type(run_summary_type), intent(in) :: run
      type(error_type), allocatable, intent(out) :: error

      call write_attribute(file, group, 'equations_thermal', run%equations_thermal, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'equations_mechanical', run%equations_mechanical, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'contact_unknowns', run%contact_unknowns, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'factor_bytes', run%factor_bytes, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'smallest_pivot', run%smallest_pivot, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'verify_passed', run%verify_passed, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'verify_failed', run%verify_failed, error)
   end subroutine write_counts

   subroutine write_seconds(file, run, seconds_write, error)
      integer(hid_t), intent(in) :: file
      type(run_summary_type), intent(in) :: run
      real(dp), intent(in) :: seconds_write
      type(error_type), allocatable, intent(out) :: error

      call write_attribute(file, group, 'seconds_read', run%seconds_read, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'seconds_assemble', run%seconds_assemble, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'seconds_reduce', run%seconds_reduce, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'seconds_iterate', run%seconds_iterate, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'seconds_recover', run%seconds_recover, error)
      if (allocated(error)) return
      call write_attribute(file, group, 'seconds_write', run%seconds_write + seconds_write, error)
   end subroutine write_seconds

end module result_run
