!> The document that `--json` prints of a deck.
module deck_documents
   use, intrinsic :: iso_fortran_env, only: output_unit
   use json, only: json_type
   use messages, only: message_type, print_line
   use version, only: program_version
   implicit none
   private
   public :: print_document

contains

   !> Prints a document on stdout.
   subroutine print_document(command, deck, status, messages, members)
      character(*), intent(in) :: command                 !! run or check
      character(*), intent(in) :: deck                    !! as given
      integer, intent(in) :: status                       !! exit status
      type(message_type), allocatable, intent(in) :: messages(:)   !! unallocated for none
      type(json_type), intent(in) :: members              !! what else it has
      type(json_type) :: document
      integer :: i

      call document%open('{')
      call document%put('thercon', 'program')
      call document%put(program_version, 'version')
      call document%put(command, 'command')
      call document%put(deck, 'deck')
      call document%put(status, 'status')
      call document%open('[', 'messages')
      if (allocated(messages)) then
         do i = 1, size(messages)
            associate (message => messages(i))
               call document%open('{')
               call document%put(message%severity, 'severity')
               call document%put(message%file, 'file')
               if (message%line > 0) then
                  call document%put(message%line, 'line')
                  call document%put(message%column, 'column')
               end if
               call document%put(message%words, 'message')
               call document%close('}')
            end associate
         end do
      end if
      call document%close(']')
      call document%put_members(members)
      call document%close('}')
      call print_line(output_unit, document%text)
   end subroutine print_document

end module deck_documents
