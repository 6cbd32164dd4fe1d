!> The keywords of the dialect: which are understood, which are refused and why, where each may
!> are, and which parameters it takes.
module keywords
   use text, only: append, is_same_name, string_type
   implicit none
   private
   public :: known_keyword_type, known_keywords, find_keyword, keyword_names
   public :: built, not_needed, refused
   public :: in_model, in_step, in_both
   public :: known_parameter_type, find_parameter, parameter_names, refusal

   integer, parameter :: built = 1        !! understood
   integer, parameter :: not_needed = 2   !! read, and means nothing to this program
   integer, parameter :: refused = 3      !! will not be built; refusal gives the reason

   integer, parameter :: in_model = 1     !! is before the first *STEP
   integer, parameter :: in_step = 2      !! is between *STEP and *END STEP
   integer, parameter :: in_both = 3      !! is anywhere

   integer, parameter :: many = huge(1)

   !> One keyword. Its parameters are separated by slashes; `=` marks one that needs a value and `?`
   !> one that may have one; `~` is before one that is not needed, `!` before a refused one.
   type :: known_keyword_type
      character(32) :: name          !! without the star
      integer :: status              !! built, not_needed or refused
      integer :: section             !! in_model, in_step or in_both
      integer :: least_data          !! fewest data cards
      integer :: most_data           !! most data cards
      character(160) :: parameters   !! its parameters
   end type known_keyword_type

   !> One parameter of a keyword.
   type :: known_parameter_type
      character(:), allocatable :: name     !! its name
      integer :: status = built             !! built, not_needed or refused
      logical :: needs_value = .false.      !! whether a value must follow
      logical :: takes_value = .false.      !! whether a value may follow
   end type known_parameter_type

   !> Why a keyword, or a parameter of it, is refused.
   type :: refusal_type
      character(32) :: keyword     !! keyword; blank for all that have the parameter
      character(20) :: parameter   !! parameter, blank for the keyword itself
      character(72) :: reason      !! why
   end type refusal_type

   type(known_keyword_type), parameter :: model_keywords(30) = [ &
      known_keyword_type('HEADING', built, in_model, 0, many, ''), &
      known_keyword_type('OPTIONS', built, in_model, 0, 0, &
         'WIDTH=/UNITS=/LOAD=/PLANE=/ORDER=/ERRORS='), &
      known_keyword_type('PHYSICAL CONSTANTS', built, in_model, 0, 0, &
      'ABSOLUTE ZERO=/STEFAN BOLTZMANN=/~NEWTON GRAVITY=/~UNIVERSAL GAS CONSTANT='), &
      known_keyword_type('PARAMETER', built, in_model, 0, 0, ''), &
      known_keyword_type('NODE', built, in_model, 1, many, 'NSET=/FORMAT='), &
      known_keyword_type('ELEMENT', built, in_model, 1, many, 'TYPE=/ELSET=/FORMAT='), &
      known_keyword_type('NGEN', built, in_model, 1, many, 'NSET=/!LINE='), &
      known_keyword_type('ELGEN', built, in_model, 1, many, 'ELSET='), &
      known_keyword_type('NSET', built, in_model, 1, many, &
      'NSET=/GENERATE/ELSET=/SURFACE=/INSTANCE=/~INTERNAL/~UNSORTED'), &
      known_keyword_type('ELSET', built, in_model, 1, many, &
      'ELSET=/GENERATE/INSTANCE=/~INTERNAL/~UNSORTED'), &
      known_keyword_type('SURFACE', built, in_model, 1, many, 'NAME=/TYPE=/~INTERNAL'), &
      known_keyword_type('MATERIAL', built, in_model, 0, 0, 'NAME='), &
      known_keyword_type('ELASTIC', built, in_model, 1, many, 'TYPE='), &
      known_keyword_type('EXPANSION', built, in_model, 1, many, 'TYPE=/~ZERO='), &
      known_keyword_type('CONDUCTIVITY', built, in_model, 1, many, 'TYPE='), &
      known_keyword_type('DENSITY', built, in_model, 1, many, ''), &
      known_keyword_type('SPECIFIC HEAT', not_needed, in_model, 0, many, ''), &
      known_keyword_type('ORIENTATION', built, in_model, 1, 2, 'NAME=/SYSTEM='), &
      known_keyword_type('SOLID SECTION', built, in_model, 0, 1, &
      'ELSET=/MATERIAL=/ORIENTATION=/~OFFSET=/~CONTROLS='), &
      known_keyword_type('AMPLITUDE', built, in_model, 1, many, &
      'NAME=/TIME=/DEFINITION=/FIXED INTERVAL=/BEGIN=/VALUE=/~SMOOTH=/!USER/!SHIFTX=/!SHIFTY='), &
      known_keyword_type('INITIAL CONDITIONS', built, in_model, 1, many, 'TYPE='), &
      known_keyword_type('SURFACE INTERACTION', built, in_model, 0, 1, 'NAME='), &
      known_keyword_type('FRICTION', built, in_both, 1, 1, &
      'ROUGH/TAUMAX=/~SLIP TOLERANCE=/~ELASTIC SLIP='), &
      known_keyword_type('GAP CONDUCTANCE', built, in_model, 1, many, &
      'PRESSURE/CLEARANCE/!USER/!DEPENDENCIES='), &
      known_keyword_type('GAP LAW', built, in_model, 1, many, &
      'TYPE=/JUMP=/ROUGHNESS=/EMISSIVITY='), &
      known_keyword_type('SURFACE BEHAVIOR', not_needed, in_model, 0, many, &
      'PRESSURE-OVERCLOSURE=/~AUGMENTED LAGRANGE/~PENALTY?/~DIRECT/!NO SEPARATION'), &
      known_keyword_type('CONTACT PAIR', built, in_model, 1, 1, &
      'INTERACTION=/NAME=/PAIRING=/ADJUST=/~TYPE=/~SMALL SLIDING/!TIED'), &
      known_keyword_type('TIE', built, in_model, 1, many, 'NAME=/POSITION TOLERANCE=/ADJUST=/'// &
      '~TYPE=/~NO ROTATION/~NO THICKNESS/!CYCLIC SYMMETRY/!MULTISTAGE/!TIED NSET='), &
      known_keyword_type('CLEARANCE', built, in_model, 0, 0, 'MASTER=/SLAVE=/VALUE='), &
      known_keyword_type('TRANSFORM', built, in_model, 1, 1, 'NSET=/TYPE=')]

   type(known_keyword_type), parameter :: control_keywords(19) = [ &
      known_keyword_type('PART', built, in_model, 0, 0, 'NAME='), &
      known_keyword_type('END PART', built, in_model, 0, 0, ''), &
      known_keyword_type('ASSEMBLY', built, in_model, 0, 0, 'NAME='), &
      known_keyword_type('END ASSEMBLY', built, in_model, 0, 0, ''), &
      known_keyword_type('INSTANCE', built, in_model, 0, 2, 'NAME=/PART=/!LIBRARY='), &
      known_keyword_type('END INSTANCE', built, in_model, 0, 0, ''), &
      known_keyword_type('FIXED POINT', built, in_both, 0, 0, &
      'METHOD=/TOL=/MAXITER=/G=/CONSTANT='), &
      known_keyword_type('START', built, in_both, 0, many, 'FROM='), &
      known_keyword_type('THERMAL SCHEME', built, in_both, 0, 1, 'TYPE='), &
      known_keyword_type('SOLVER', built, in_model, 0, 0, 'TYPE='), &
      known_keyword_type('REFINE', built, in_model, 0, 0, 'LEVELS=/SURFACE=/ELSET=/DISTANCE='), &
      known_keyword_type('VERIFY', built, in_both, 1, many, 'KIND=/SOURCE='), &
      known_keyword_type('ACCURACY', built, in_model, 1, many, 'ROUNDS='), &
      known_keyword_type('CONTROLS', not_needed, in_both, 0, many, 'PARAMETERS=/FIELD=/RESET'), &
      known_keyword_type('EQUATION', built, in_model, 1, many, '!REMOVE/!INPUT='), &
      known_keyword_type('COUPLING', built, in_model, 0, 0, &
      'REF NODE=/SURFACE=/CONSTRAINT NAME=/!ORIENTATION=/!ALPHA='), &
      known_keyword_type('KINEMATIC', built, in_model, 0, many, ''), &
      known_keyword_type('MPC', refused, in_model, 0, many, ''), &
      known_keyword_type('RIGID BODY', refused, in_model, 0, many, '')]

   !> Parameters of the cards that write fields.
   character(*), parameter :: file_parameters = 'FREQUENCY=/~FREQUENCYF=/~NSET=/~GLOBAL=/'// &
      '~OUTPUT=/~LAST ITERATIONS/~CONTACT ELEMENTS/~SECTION FORCES/~DIRECTIONS=/'// &
      '~VARIABLE=/!TIME POINTS='

   !> Parameters of the damping by which Abaqus stabilizes a step.
   character(*), parameter :: stabilization = '~STABILIZE?/~FACTOR=/~ALLSDTOL=/~CONTINUE=/'

   type(known_keyword_type), parameter :: step_keywords(29) = [ &
      known_keyword_type('STEP', built, in_both, 0, 0, &
      'INC=/AMPLITUDE=/NLGEOM?/~NAME=/~UNSYMM=/~EXTRAPOLATION=/!PERTURBATION'), &
      known_keyword_type('STATIC', built, in_step, 0, 1, &
      stabilization//'DIRECT?/~SOLVER=/!EXPLICIT/!TIME RESET/!TOTAL TIME AT START='), &
      known_keyword_type('HEAT TRANSFER', built, in_step, 0, 1, &
      'STEADY STATE/DIRECT?/~SOLVER=/~DELTMX=/!TIME RESET/!TOTAL TIME AT START='), &
      known_keyword_type('COUPLED TEMPERATURE-DISPLACEMENT', built, in_step, 0, 1, &
      'CREEP=/'//stabilization// &
      'STEADY STATE/DIRECT?/~SOLVER=/~DELTMX=/!TIME RESET/!TOTAL TIME AT START='), &
      known_keyword_type('BOUNDARY', built, in_both, 1, many, &
      'OP=/AMPLITUDE=/TYPE=/!TIME DELAY=/!USER/!FIXED/!SUBMODEL/!MASS FLOW'), &
      known_keyword_type('CLOAD', built, in_step, 1, many, &
      'OP=/AMPLITUDE=/!TIME DELAY=/!USER'), &
      known_keyword_type('DLOAD', built, in_step, 1, many, &
      'OP=/AMPLITUDE=/!TIME DELAY=/!USER'), &
      known_keyword_type('DSLOAD', built, in_step, 1, many, 'OP=/AMPLITUDE='), &
      known_keyword_type('CFLUX', built, in_step, 1, many, &
      'OP=/AMPLITUDE=/!TIME DELAY=/!USER'), &
      known_keyword_type('DFLUX', built, in_step, 1, many, &
      'OP=/AMPLITUDE=/!TIME DELAY=/!USER'), &
      known_keyword_type('FILM', built, in_step, 1, many, &
      'OP=/AMPLITUDE=/FILM AMPLITUDE=/!TIME DELAY=/!FILM TIME DELAY='), &
      known_keyword_type('DSFLUX', built, in_step, 1, many, 'OP=/AMPLITUDE='), &
      known_keyword_type('SFILM', built, in_step, 1, many, 'OP=/AMPLITUDE=/FILM AMPLITUDE='), &
      known_keyword_type('TEMPERATURE', built, in_step, 1, many, &
      'OP=/AMPLITUDE=/!TIME DELAY=/!USER/!FILE=/!BSTEP='), &
      known_keyword_type('CHANGE FRICTION', built, in_step, 0, 0, 'INTERACTION='), &
      known_keyword_type('MODEL CHANGE', built, in_step, 1, many, &
      'TYPE=/ADD/REMOVE/!MECHSTRAINTORESIDUAL'), &
      known_keyword_type('CONTACT INTERFERENCE', built, in_step, 1, many, &
      'TYPE=/AMPLITUDE=/OP=/SHRINK'), &
      known_keyword_type('NODE FILE', built, in_step, 0, many, file_parameters), &
      known_keyword_type('EL FILE', built, in_step, 0, many, file_parameters), &
      known_keyword_type('CONTACT FILE', built, in_step, 0, many, file_parameters), &
      known_keyword_type('NODE OUTPUT', built, in_step, 0, many, file_parameters), &
      known_keyword_type('ELEMENT OUTPUT', built, in_step, 0, many, file_parameters), &
      known_keyword_type('CONTACT OUTPUT', built, in_step, 0, many, file_parameters), &
      known_keyword_type('RESTART', not_needed, in_both, 0, 0, &
      '!READ/STEP=/WRITE/FREQUENCY=/OVERLAY'), &
      known_keyword_type('NODE PRINT', built, in_step, 1, many, &
      'NSET=/FREQUENCY=/TOTALS=/GLOBAL=/~FREQUENCYF=/!TIME POINTS='), &
      known_keyword_type('EL PRINT', built, in_step, 1, many, &
      'ELSET=/FREQUENCY=/GLOBAL=/~TOTALS=/~FREQUENCYF=/!TIME POINTS='), &
      known_keyword_type('CONTACT PRINT', built, in_step, 0, many, &
      'FREQUENCY=/~SLAVE=/~MASTER=/~NSET=/~SET=/~GLOBAL=/~TOTALS=/!TIME POINTS='), &
      known_keyword_type('END STEP', built, in_step, 0, 0, ''), &
      known_keyword_type('INCLUDE', built, in_both, 0, 0, 'INPUT=')]

   !> Every keyword of the dialect.
   type(known_keyword_type), parameter :: known_keywords(78) = &
      [model_keywords, control_keywords, step_keywords]

   type(refusal_type), parameter :: refusals(32) = [ &
      refusal_type('EQUATION', 'REMOVE', 'equations hold in all steps'), &
      refusal_type('EQUATION', 'INPUT', 'take *INCLUDE behind the keyword'), &
      refusal_type('INSTANCE', 'LIBRARY', 'the mesh is in the deck; give its part'), &
      refusal_type('COUPLING', 'ORIENTATION', 'faces follow along x and y'), &
      refusal_type('COUPLING', 'ALPHA', 'small rotations need no penalty'), &
      refusal_type('MPC', '', 'give its relations by *EQUATION or *COUPLING'), &
      refusal_type('RIGID BODY', '', 'every body is elastic; give it a high modulus'), &
      refusal_type('NGEN', 'LINE', &
      'nodes are generated on straight lines; give those of a curve'), &
      refusal_type('GAP CONDUCTANCE', 'USER', 'no routine of the user is called; give the table'), &
      refusal_type('GAP CONDUCTANCE', 'DEPENDENCIES', 'conductance depends on one quantity only'), &
      refusal_type('MODEL CHANGE', 'MECHSTRAINTORESIDUAL', &
      'strains and stresses go on from step to step'), &
      refusal_type('SURFACE BEHAVIOR', 'NO SEPARATION', &
      'faces that do not come apart are those of *TIE'), &
      refusal_type('CONTACT PAIR', 'TIED', 'tied faces do not open; take *TIE'), &
      refusal_type('TIE', 'CYCLIC SYMMETRY', 'only faces that lie opposite each other are tied'), &
      refusal_type('TIE', 'MULTISTAGE', 'only faces that lie opposite each other are tied'), &
      refusal_type('TIE', 'TIED NSET', 'POSITION TOLERANCE= selects the nodes that are tied'), &
      refusal_type('', 'TIME POINTS', 'FREQUENCY= selects the increments that are printed'), &
      refusal_type('', 'TIME DELAY', 'shift the times of the *AMPLITUDE'), &
      refusal_type('', 'FILM TIME DELAY', 'shift the times of the *AMPLITUDE'), &
      refusal_type('', 'USER', 'no routine of the user is called; give the values'), &
      refusal_type('', 'TIME RESET', 'times of the steps add up'), &
      refusal_type('', 'TOTAL TIME AT START', 'times of the steps add up, from 0'), &
      refusal_type('BOUNDARY', 'FIXED', 'give the values'), &
      refusal_type('BOUNDARY', 'SUBMODEL', 'give the values'), &
      refusal_type('BOUNDARY', 'MASS FLOW', 'there are no fluids'), &
      refusal_type('TEMPERATURE', 'FILE', 'give the values, or solve *HEAT TRANSFER before'), &
      refusal_type('TEMPERATURE', 'BSTEP', 'give the values, or solve *HEAT TRANSFER before'), &
      refusal_type('STATIC', 'EXPLICIT', 'loads are slow'), &
      refusal_type('AMPLITUDE', 'SHIFTX', 'add the shift to the times'), &
      refusal_type('AMPLITUDE', 'SHIFTY', 'add the shift to the factors'), &
      refusal_type('RESTART', 'READ', 'a run begins with the first step'), &
      refusal_type('STEP', 'PERTURBATION', 'steps go on from the one before; leave it out')]

contains

   !> Index of a keyword, whatever its case and blanks; 0 for an unknown one.
   pure function find_keyword(name) result(known)
      character(*), intent(in) :: name   !! without the star
      integer :: known                   !! index into known_keywords

      do known = size(known_keywords), 1, -1
         if (is_same_name(known_keywords(known)%name, name)) return
      end do
   end function find_keyword

   !> The names of all keywords.
   pure function keyword_names() result(names)
      type(string_type) :: names(size(known_keywords))   !! in the order of known_keywords
      integer :: i

      do i = 1, size(known_keywords)
         names(i)%value = trim(known_keywords(i)%name)
      end do
   end function keyword_names

   !> Names of the parameters of a keyword.
   pure function parameter_names(known) result(names)
      integer, intent(in) :: known                     !! index into known_keywords
      type(string_type), allocatable :: names(:)       !! in the order of the table
      type(string_type), allocatable :: entries(:)
      type(known_parameter_type) :: parameter
      integer :: i

      entries = parameter_entries(known)
      allocate(names(size(entries)))
      do i = 1, size(entries)
         parameter = parsed_entry(entries(i)%value)
         names(i)%value = parameter%name
      end do
   end function parameter_names

   !> Finds a parameter of a keyword, whatever its case and blanks; its name is empty for an unknown
   !> one.
   pure function find_parameter(known, name) result(parameter)
      integer, intent(in) :: known              !! index into known_keywords
      character(*), intent(in) :: name          !! name as written
      type(known_parameter_type) :: parameter   !! what the table says of it
      type(string_type), allocatable :: entries(:)
      integer :: i

      entries = parameter_entries(known)
      do i = 1, size(entries)
         parameter = parsed_entry(entries(i)%value)
         if (is_same_name(parameter%name, name)) return
      end do
      parameter%name = ''
   end function find_parameter

   !> Why a keyword or a parameter of it is refused.
   pure function refusal(keyword, parameter) result(reason)
      character(*), intent(in) :: keyword     !! name of the keyword
      character(*), intent(in) :: parameter   !! name of the parameter, empty for the keyword itself
      character(:), allocatable :: reason     !! why
      integer :: i

      reason = ''
      do i = 1, size(refusals)
         if (refusals(i)%parameter /= parameter) cycle
         if (any(refusals(i)%keyword == [character(32) :: keyword, ''])) then
            reason = trim(refusals(i)%reason)
            if (refusals(i)%keyword == keyword) return
         end if
      end do
   end function refusal

   !> What is between the slashes of the table.
   pure function parameter_entries(known) result(entries)
      integer, intent(in) :: known
      type(string_type), allocatable :: entries(:)
      character(:), allocatable :: rest
      integer :: slash

      allocate(entries(0))
      rest = trim(known_keywords(known)%parameters)
      do while (len(rest) > 0)
         slash = index(rest, '/')
         if (slash == 0) slash = len(rest) + 1
         call append(entries, rest(:slash - 1))
         rest = rest(min(slash + 1, len(rest) + 1):)
      end do
   end function parameter_entries

   pure function parsed_entry(entry) result(parameter)
      character(*), intent(in) :: entry
      type(known_parameter_type) :: parameter
      integer :: first, last

      first = 2
      select case (entry(1:1))
      case ('~')
         parameter%status = not_needed
      case ('!')
         parameter%status = refused
      case default
         first = 1
      end select
      last = len(entry)
      parameter%needs_value = entry(last:last) == '='
      parameter%takes_value = parameter%needs_value .or. entry(last:last) == '?'
      if (parameter%takes_value) last = last - 1
      parameter%name = entry(first:last)
   end function parsed_entry

end module keywords
