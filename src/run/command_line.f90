!> The command line: what is to be done with which decks.
module command_line
   use accuracy_targets, only: accuracy_target_type, read_request
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use model, only: uncertainty_named
   use spelling, only: nearest_known
   use text, only: append, read_integer, read_real, split_words, string_type, to_upper
   implicit none
   private
   public :: command_type, read_command, settings_in_words, usage, command_run, command_check, &
      command_trade, command_help, command_version, command_keywords

   integer, parameter :: command_run = 1       !! solve
   integer, parameter :: command_check = 2     !! read and check only
   integer, parameter :: command_help = 3      !! print the usage
   integer, parameter :: command_version = 4   !! print versions
   integer, parameter :: command_trade = 5     !! measure speed against accuracy
   integer, parameter :: command_keywords = 6  !! print the table of keywords

   ! For messages on misspelt words.
   character(*), parameter :: known_commands = 'run/check/trade/help'
   character(*), parameter :: known_options = '--out/--jobs/--width/--set/--limit/--accuracy/'// &
      '--errors/--restart/--resume/--table/--quiet/--json/--help/--version/'//'--keywords'

   character(4), parameter :: errors_words(0:2) = ['no  ', 'last', 'full']   !! of --errors

   !> Command, decks and options.
   type :: command_type
      integer :: action = command_help                !! one of the command_* constants
      type(string_type), allocatable :: decks(:)      !! paths as given
      type(string_type), allocatable :: settings(:)   !! NAME=VALUE of each --set
      character(:), allocatable :: folder             !! --out, the current folder unless given
      integer :: width = 0                            !! --width, 0 unless given
      character(:), allocatable :: keyword            !! --keywords, how those begin: * for all
      logical :: quiet = .false.                      !! --quiet or --json
      logical :: json = .false.                       !! --json
      integer :: jobs = 1                             !! --jobs, decks or rows at a time
      logical :: is_batch = .false.                   !! run: several decks, or --jobs
      !> --limit: CPU seconds of a row, seconds of the rounds of a run [s]; 0: none is given
      real(dp) :: limit = 0.0_dp
      type(accuracy_target_type), allocatable :: targets(:)   !! --accuracy; unallocated: none
      character(:), allocatable :: accuracy           !! the same as given; empty: none
      integer :: uncertainty = -1                     !! --errors, of uncertainty_named; -1: none
      character(:), allocatable :: restart            !! --restart, path of a result; empty: none
      real(dp), allocatable :: restart_time           !! its time, where one is given [time]
      logical :: resumes = .false.                    !! --resume
      character(:), allocatable :: table              !! --table, path of the values; empty: none
      integer :: row = 0                              !! the row of it that is run; 0: none
   end type command_type

   !> Lines of --help
   character(*), parameter :: usage(50) = [character(88) :: &
      'usage: thercon run DECK... [--out DIR] [--jobs N] [--width N] [--set NAME=VALUE]', &
      '                           [--quiet] [--json] [--accuracy P%] [--limit SECONDS]', &
      '                           [--errors last|full|no] [--restart RESULT[@TIME]] [--resume]', &
      '                           [--table VALUES.csv]', &
      '       thercon check DECK... [--width N] [--set NAME=VALUE] [--quiet] [--json]', &
      '                             [--accuracy P%] [--errors last|full|no] [--restart RESULT]', &
      '       thercon trade DECK [--out DIR] [--width N] [--set NAME=VALUE] [--quiet]', &
      '                          [--limit SECONDS] [--jobs N]', &
      '       thercon --help | --version | --keywords [KEYWORD]', '', &
      '  run      solve each deck a/b.inp; write to DIR b.vtkhdf, b.lst, b.sta, b.cvg and, with', &
      '           contact, b.contact.vtkhdf;', &
      '           several decks run as a batch, each in a process of its own, and are listed', &
      '           in DIR/thercon-batch.csv', &
      '  check    read each deck and report every mistake; solve nothing', &
      '  trade    solve a deck with other meshes, increments and methods; measure CPU seconds,', &
      '           memory and errors; recommend settings for 10, 1 and 0.1 %; DIR/b.trade.csv', '', &
      '  --out DIR          write results to this folder, created if missing (current folder)', &
      '  --width N          allow N columns in a card (256)', &
      '  --set NAME=VALUE   override the value of a *PARAMETER of the deck', &
      '  --quiet            print errors and warnings only', &
      '  --json             run, check: print one JSON document (docs/results.md); one deck', &
      '  --accuracy P%      run, check: refine the mesh and shorten increments until the', &
      '                     uncertainties of force, heat rate, peak pressure, edge of contact', &
      '                     are within P per cent; replaces *ACCURACY; with names only', &
      '                     those: force=1%,heat=2% (also pressure, edge, shear, stick)', &
      '  --errors last      run, check: numerical uncertainties at the ends of steps (last), of', &
      '                     all numbers at all times (full), or none (no); as ERRORS=', &
      '  --restart RESULT   go on from the last state that *RESTART, WRITE kept in this result,', &
      '                     or with RESULT@TIME from that at a time', &
      '  --resume           run: skip decks whose results are finished; go on with others from', &
      '                     the last state that their results keep, or from the start', &
      '  --table VALUES.csv run: solve one deck with each row of values, whose columns are', &
      '                     parameters; results of all rows are in DIR/b.table.csv', &
      '  --limit SECONDS    run: end the rounds of --accuracy in this time with the last whole', &
      '                     one, after the first in any case;', &
      '                     trade: skip rows that would take more CPU time (30)', &
      '  --keywords         print the keywords of decks, their data cards and parameters, or', &
      '                     of those that begin with KEYWORD', &
      '  --jobs N           solve N decks at a time, or measure N rows of a trade (1)', '', &
      'exit status: 0 ok, 1 deck error, 2 no convergence, 3 internal or I/O error,', &
      '             4 a *VERIFY check failed or a requested accuracy was not reached,', &
      '             5 ended by SIGINT or SIGTERM; of several decks the largest', '', &
      'pictures:    thercon-plot, thercon-report (one HTML page) and thercon-compare; in the', &
      '             source tree post/plot, post/report and post/compare', &
      'documents:   share/thercon/docs of the installation, docs of the source tree; deck.md', &
      '             describes every keyword, running.md every option and file']

contains

   !> Reads the arguments of the program.
   !> Error: status_deck, with what is wrong.
   subroutine read_command(command, error)
      type(command_type), intent(out) :: command          !! what is asked for
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: word
      integer :: i

      allocate (command%decks(0), command%settings(0))
      command%folder = '.'
      command%restart = ''
      command%accuracy = ''
      command%table = ''
      if (command_argument_count() == 0) return
      word = argument(1)
      select case (word)
      case ('run')
         command%action = command_run
      case ('check')
         command%action = command_check
      case ('--help', '-h', 'help')
         return
      case ('--version')
         command%action = command_version
         return
      case ('--keywords')
         command%action = command_keywords
         command%keyword = ''
         do i = 2, command_argument_count()
            command%keyword = trim(command%keyword//' '//to_upper(argument(i)))
         end do
         command%keyword = '*'//command%keyword(verify(command%keyword//'.', ' *'):)
         return
      case ('trade')
         command%action = command_trade
      case default
         call set_error(error, status_deck, unknown_command(word))
         return
      end select
      i = 2
      do while (i <= command_argument_count())
         call read_argument(command, i, error)
         if (allocated(error) .or. command%action == command_help) return
      end do
      if (size(command%decks) == 0) then
         call set_error(error, status_deck, 'no deck is named')
      else if (size(command%decks) > 1 .and. command%action == command_trade) then
         call set_error(error, status_deck, 'trade takes one deck')
      else if (size(command%decks) > 1 .and. command%restart /= '') then
         call set_error(error, status_deck, '--restart takes one deck; --resume takes several, '// &
            'each with its own result')
      else if (command%json .and. (size(command%decks) > 1 .or. command%is_batch)) then
         call set_error(error, status_deck, '--json takes one deck, without --jobs and --table')
      else if (command%table /= '' .and. size(command%decks) > 1) then
         call set_error(error, status_deck, '--table takes one deck')
      else if (command%table /= '' .and. command%restart /= '') then
         call set_error(error, status_deck, '--restart does not go with --table; --resume goes '// &
            'on with each row')
      else if (command%resumes .and. command%restart /= '') then
         call set_error(error, status_deck, '--resume goes on from the deck''s own result, and '// &
            '--restart from another: leave one out')
      end if
      if (size(command%decks) > 1) command%is_batch = .true.
   end subroutine read_command

   !> Message on a first argument that is no command.
   function unknown_command(word) result(message)
      character(*), intent(in) :: word
      character(:), allocatable :: message
      logical :: is_file

      inquire (file=deck_file(word), exist=is_file)
      if (is_file .or. index(word, '.inp') > 0) then
         message = word//' is no command; write thercon run '//word//', or thercon check '//word
      else
         message = 'unknown command '//word//nearest_known(word, split_words(known_commands))// &
            '; see thercon --help'
      end if
   end function unknown_command

   !> Reads the argument at a position, with its value where it has one.
   subroutine read_argument(command, i, error)
      type(command_type), intent(inout) :: command
      integer, intent(inout) :: i
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: word, value

      word = argument(i)
      i = i + 1
      select case (word)
      case ('--quiet')
         command%quiet = .true.
         return
      case ('--json')
         command%json = .true.
         command%quiet = .true.
         if (command%action == command_trade) call set_error(error, status_deck, &
            'option --json does not go with trade')
         return
      case ('--resume')
         command%resumes = .true.
         if (command%action /= command_run) call set_error(error, status_deck, &
            'option --resume does not go with '//argument(1))
         return
      case ('--help', '-h')
         command%action = command_help
         return
      case ('--out', '--width', '--set', '--jobs', '--limit', '--accuracy', '--errors', &
         '--restart', '--table')
         value = ''
         if (i <= command_argument_count()) value = argument(i)
         if (len_trim(value) == 0) then
            call set_error(error, status_deck, 'option '//word//' needs a value')
            return
         end if
         i = i + 1
      case default
         if (index(word, '--') == 1 .and. index(word, '=') > 0) then
            call set_error(error, status_deck, 'unknown option '//word//': an option and its '// &
               'value are separate words; see thercon --help')
         else if (index(word, '-') == 1) then
            call set_error(error, status_deck, 'unknown option '//word// &
               nearest_known(word, split_words(known_options))//'; see thercon --help')
         else
            call append(command%decks, deck_file(word))
         end if
         return
      end select
      if (command%action == command_check .and. any(word == [character(7) :: '--out', '--jobs', &
         '--limit', '--table']) .or. command%action == command_trade .and. any(word == &
         [character(10) :: '--accuracy', '--errors', '--table', '--restart'])) then
         call set_error(error, status_deck, 'option '//word//' does not go with '//argument(1))
         return
      end if
      call take_value(command, word, value, error)
   end subroutine read_argument

   !> The file of a deck that is named with or without its ending, as with CalculiX.
   function deck_file(name) result(path)
      character(*), intent(in) :: name
      character(:), allocatable :: path   !! name, or name.inp where only that is a file
      logical :: exists, is_folder

      path = name
      inquire (file=name, exist=exists)
      inquire (file=name//'/.', exist=is_folder)
      if (exists .and. .not. is_folder) return
      inquire (file=name//'.inp', exist=exists)
      if (exists) path = name//'.inp'
   end function deck_file

   subroutine take_value(command, word, value, error)
      type(command_type), intent(inout) :: command
      character(*), intent(in) :: word, value
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: hint
      integer :: status
      logical :: valid

      select case (word)
      case ('--jobs')
         command%is_batch = .true.
         call read_integer(value, command%jobs, valid)
         if (.not. valid .or. command%jobs < 1) call set_error(error, status_deck, &
            'option --jobs needs a whole number of at least 1, not '//value)
      case ('--accuracy')
         command%accuracy = value
         call read_request(value, command%targets, hint)
         if (.not. allocated(command%targets)) call set_error(error, status_deck, &
            'option --accuracy needs a percentage above 0% and below 100%, such as 1%, or '// &
            'those of quantities, each once, such as force=1%,heat=2% (force, heat, pressure, '// &
            'edge, shear, stick), not '//value//hint)
      case ('--errors')
         command%uncertainty = uncertainty_named(value)
         if (command%uncertainty < 0) call set_error(error, status_deck, &
            'option --errors needs last, full or no, not '//value)
      case ('--limit')
         call read_real(value(:len(value) - merge(1, 0, index(value, 's') == len(value))), &
            command%limit, valid)
         if (.not. valid .or. command%limit <= 0.0_dp) call set_error(error, status_deck, &
            'option --limit needs a number of seconds above 0, such as 60s, not '//value)
      case ('--out')
         command%folder = value
         if (len(value) > 1 .and. index(value, '/', back=.true.) == len(value)) command%folder = &
            value(:len(value) - 1)
      case ('--set')
         call append(command%settings, value)
      case ('--table')
         command%is_batch = .true.
         command%table = value
      case ('--restart')
         call take_restart(command, value, error)
      case default
         status = verify(value, '0123456789')
         if (status == 0 .and. len(value) > 0) read (value, *, iostat=status) command%width
         if (status /= 0 .or. command%width < 80) call set_error(error, status_deck, &
            'option --width needs a whole number of at least 80, not '//value)
      end select
   end subroutine take_value

   !> Takes RESULT or RESULT@TIME; the file may be named without its ending.
   subroutine take_restart(command, value, error)
      type(command_type), intent(inout) :: command
      character(*), intent(in) :: value
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: ending = '.vtkhdf'
      integer :: at
      logical :: exists, valid
      real(dp) :: time

      command%restart = value
      at = index(value, '@', back=.true.)
      inquire (file=value, exist=exists)
      if (at > 1 .and. .not. exists) then
         call read_real(value(at + 1:), time, valid)
         if (.not. valid) call set_error(error, status_deck, 'option --restart needs RESULT or '// &
            'RESULT@TIME, not '//value)
         command%restart = value(:at - 1)
         command%restart_time = time
      end if
      at = max(0, len(command%restart) - len(ending))
      if (command%restart(at + 1:) /= ending) command%restart = command%restart//ending
   end subroutine take_restart

   !> The options that change what a deck asks for; empty for none.
   pure function settings_in_words(command) result(words)
      type(command_type), intent(in) :: command
      character(:), allocatable :: words
      integer :: i

      words = ''
      do i = 1, size(command%settings)
         words = words//' --set '//command%settings(i)%value
      end do
      if (command%accuracy /= '') words = words//' --accuracy '//command%accuracy
      if (command%uncertainty >= 0) words = words//' --errors '// &
         trim(errors_words(command%uncertainty))
      words = trim(adjustl(words))
   end function settings_in_words

   !> An argument without trailing blanks of its buffer.
   function argument(i) result(word)
      integer, intent(in) :: i
      character(:), allocatable :: word
      integer :: length

      call get_command_argument(i, length=length)
      allocate (character(length) :: word)
      if (length > 0) call get_command_argument(i, word)
   end function argument

end module command_line
