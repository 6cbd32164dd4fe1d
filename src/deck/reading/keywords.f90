!> The keywords with their limits and parameters, and what to write in place of others, as a table.
module keywords
   use spelling, only: full_word
   use text, only: append, is_same_name, split_words, string_type, to_text, to_upper, &
      without_blanks
   implicit none
   private
   public :: keyword_type, known_keywords, find_keyword, known_names, built, not_needed, refused, &
      in_model, in_step, in_both, known_parameter_type, find_parameter, find_abbreviated, &
      parameter_names, is_output, advice_type, find_advice, no_advice, passed_over, not_printed, &
      refused_with_data, keyword_lines

   integer, parameter :: built = 1        !! understood
   integer, parameter :: not_needed = 2   !! read, and means nothing to this program
   integer, parameter :: refused = 3      !! will not be built; the advice gives the reason

   integer, parameter :: in_model = 1     !! is before the first *STEP
   integer, parameter :: in_step = 2      !! is between *STEP and *END STEP
   integer, parameter :: in_both = 3      !! is anywhere

   ! Kinds of advice; that of a keyword may also be `refused`.
   integer, parameter :: no_advice = 0
   integer, parameter :: passed_over = 4         !! keyword that means nothing to this program
   integer, parameter :: not_printed = 5         !! keyword that asks for output that there is not
   integer, parameter :: refused_with_data = 6   !! keyword that means something with data only
   integer, parameter :: of_parameter = 7        !! parameter, which is refused

   integer, parameter :: many = huge(1)

   !> Why laws of other materials are refused.
   character(*), parameter :: laws = &
      'laws of materials are *ELASTIC, *PLASTIC and *CREEP; leave it out'

   !> One keyword. Its parameters are separated by slashes; `=` marks one that needs a value and `?`
   !> one that may have one; `~` is before one that is not needed.
   type :: keyword_type
      character(34) :: name          !! without the star
      integer :: section             !! in_model, in_step or in_both
      integer :: least_data          !! fewest data cards
      integer :: most_data           !! most data cards
      character(240) :: parameters   !! its parameters
   end type keyword_type

   !> One parameter of a keyword.
   type :: known_parameter_type
      character(:), allocatable :: name     !! its name
      integer :: status = built             !! built, not_needed or refused
      logical :: needs_value = .false.      !! whether a value must follow
      logical :: takes_value = .false.      !! whether a value may follow
   end type known_parameter_type

   !> Why keywords and parameters of other programs are not taken, or what to write in their place.
   type :: advice_type
      integer :: kind = no_advice       !! refused, passed_over ...
      character(19) :: keyword = ''     !! for which one stands, or that has a parameter
      character(256) :: names = ''      !! what it is about: names separated by slashes
      character(96) :: words = ''       !! why it is passed over or refused, what to write
   end type advice_type

   !> Parameters of the damping by which Abaqus stabilizes a step.
   character(*), parameter :: stabilization = '~STABILIZE?/~FACTOR=/~ALLSDTOL=/~CONTINUE=/'

   !> Parameters of the cards that write fields; others of an output card are noted.
   character(*), parameter :: file_parameters = 'FREQUENCY=/TIME POINTS=/~FREQUENCYF='

   !> How the keywords end that ask for output.
   character(*), parameter :: output_words(3) = [character(6) :: 'OUTPUT', 'FILE', 'PRINT']

   type(keyword_type), parameter :: known_keywords(97) = [ &
      keyword_type('HEADING', in_model, 0, many, ''), &
      keyword_type('OPTIONS', in_model, 0, 0, 'WIDTH=/UNITS=/LOAD=/PLANE=/ORDER=/ERRORS='), &
      keyword_type('PHYSICAL CONSTANTS', in_model, 0, 0, &
         'ABSOLUTE ZERO=/STEFAN BOLTZMANN=/~NEWTON GRAVITY=/~UNIVERSAL GAS CONSTANT='), &
      keyword_type('PARAMETER', in_model, 0, 0, ''), &
      keyword_type('NODE', in_model, 1, many, 'NSET=/FORMAT='), &
      keyword_type('ELEMENT', in_model, 1, many, 'TYPE=/ELSET=/FORMAT='), &
      keyword_type('NGEN', in_model, 1, many, 'NSET=/LINE='), &
      keyword_type('NFILL', in_model, 1, many, 'NSET=/BIAS='), &
      keyword_type('NCOPY', in_model, 1, 2, &
         'OLD SET=/CHANGE NUMBER=/NEW SET=/SHIFT/REFLECT=/MULTIPLE='), &
      keyword_type('ELGEN', in_model, 1, many, 'ELSET='), &
      keyword_type('ELCOPY', in_model, 0, 0, &
         'OLD SET=/ELEMENT SHIFT=/SHIFT NODES=/NEW SET=/REFLECT'), &
      keyword_type('NSET', in_both, 1, many, &
         'NSET=/GENERATE/ELSET=/SURFACE=/INSTANCE=/~INTERNAL/~UNSORTED'), &
      keyword_type('ELSET', in_both, 1, many, 'ELSET=/GENERATE/INSTANCE=/~INTERNAL/~UNSORTED'), &
      keyword_type('SURFACE', in_model, 1, many, 'NAME=/TYPE=/~INTERNAL/~TRIM=/~MAX RATIO='), &
      keyword_type('MATERIAL', in_model, 0, 0, 'NAME='), &
      keyword_type('ELASTIC', in_model, 1, many, 'TYPE='), &
      keyword_type('EXPANSION', in_model, 1, many, 'TYPE=/ZERO='), &
      keyword_type('CONDUCTIVITY', in_model, 1, many, 'TYPE='), &
      keyword_type('DENSITY', in_model, 1, many, ''), &
      keyword_type('SPECIFIC HEAT', in_model, 1, many, ''), &
      keyword_type('LATENT HEAT', in_model, 1, many, ''), &
      keyword_type('PLASTIC', in_model, 1, many, 'HARDENING=/DATA TYPE=/NUMBER BACKSTRESSES='), &
      keyword_type('CYCLIC HARDENING', in_model, 1, many, ''), &
      keyword_type('CREEP', in_model, 1, many, 'LAW='), &
      keyword_type('INELASTIC HEAT FRACTION', in_model, 0, 1, ''), &
      keyword_type('ANNEAL TEMPERATURE', in_model, 1, 1, ''), &
      keyword_type('ORIENTATION', in_model, 1, 2, 'NAME=/SYSTEM='), &
      keyword_type('SOLID SECTION', in_model, 0, 1, &
         'ELSET=/MATERIAL=/ORIENTATION=/REF NODE=/~OFFSET=/~CONTROLS='), &
      keyword_type('SPRING', in_model, 1, 2, 'ELSET='), &
      keyword_type('AMPLITUDE', in_both, 1, many, &
         'NAME=/TIME=/DEFINITION=/FIXED INTERVAL=/BEGIN=/VALUE=/~SMOOTH='), &
      keyword_type('INITIAL CONDITIONS', in_model, 1, many, 'TYPE=/~VARIABLE='), &
      keyword_type('SURFACE INTERACTION', in_model, 0, 1, 'NAME='), &
      keyword_type('FRICTION', in_both, 1, 1, &
         'ROUGH/TAUMAX=/~SLIP TOLERANCE=/~ELASTIC SLIP=/~LAGRANGE'), &
      keyword_type('GAP CONDUCTANCE', in_model, 1, many, 'PRESSURE/CLEARANCE'), &
      keyword_type('GAP LAW', in_model, 1, many, 'TYPE=/JUMP=/ROUGHNESS=/EMISSIVITY='), &
      keyword_type('GAP HEAT GENERATION', in_model, 0, 1, 'ANGULAR VELOCITY='), &
      keyword_type('GAP RADIATION', in_model, 1, many, ''), &
      keyword_type('WEAR', in_both, 0, many, 'CYCLES='), &
      keyword_type('SURFACE BEHAVIOR', in_model, 0, many, &
         'PRESSURE-OVERCLOSURE=/~AUGMENTED LAGRANGE/~PENALTY?/~DIRECT'), &
      keyword_type('CONTACT PAIR', in_model, 1, many, &
         'INTERACTION=/NAME=/PAIRING=/SLIDING=/SMALL SLIDING/ADJUST=/~TYPE=/~NO THICKNESS/'// &
         '~CPSET=/~GEOMETRIC CORRECTION=/~HCRIT=/~MECHANICAL CONSTRAINT=/~EXTENSION ZONE=/'// &
         '~SMOOTH=/~TRACKING=/~SUPPLEMENTARY CONSTRAINTS='), &
      keyword_type('TIE', in_model, 1, many, &
         'NAME=/POSITION TOLERANCE=/ADJUST=/~TYPE=/~NO ROTATION/~NO THICKNESS'), &
      keyword_type('CLEARANCE', in_model, 0, 0, 'MASTER=/SLAVE=/VALUE='), &
      keyword_type('TRANSFORM', in_model, 1, 1, 'NSET=/TYPE='), &
      keyword_type('PART', in_model, 0, 0, 'NAME='), &
      keyword_type('END PART', in_model, 0, 0, ''), &
      keyword_type('ASSEMBLY', in_model, 0, 0, 'NAME='), &
      keyword_type('END ASSEMBLY', in_model, 0, 0, ''), &
      keyword_type('INSTANCE', in_model, 0, 2, 'NAME=/PART=/MULTIPLE='), &
      keyword_type('END INSTANCE', in_model, 0, 0, ''), &
      keyword_type('FIXED POINT', in_both, 0, 0, 'METHOD=/TOL=/MAXITER=/G=/CONSTANT='), &
      keyword_type('START', in_both, 0, many, 'FROM='), &
      keyword_type('THERMAL SCHEME', in_both, 0, 1, 'TYPE='), &
      keyword_type('CONTINUATION', in_step, 0, 0, 'POINTS=/LOWEST=/HIGHEST=/ARC=/DIRECTION='), &
      keyword_type('SOLVER', in_model, 0, 0, 'TYPE=/TAIL='), &
      keyword_type('REFINE', in_model, 0, 0, 'LEVELS=/SURFACE=/ELSET=/DISTANCE='), &
      keyword_type('VERIFY', in_both, 1, many, 'KIND=/SOURCE='), &
      keyword_type('ACCURACY', in_model, 1, many, 'ROUNDS='), &
      keyword_type('EQUATION', in_model, 1, many, ''), &
      keyword_type('COUPLING', in_model, 0, 0, 'REF NODE=/SURFACE=/CONSTRAINT NAME='), &
      keyword_type('RIGID BODY', in_model, 0, 0, &
         'REF NODE=/ROT NODE=/ELSET=/NSET=/TIE NSET=/PIN NSET=/'// &
         'ANALYTICAL SURFACE=/ISOTHERMAL=/POSITION='), &
      keyword_type('KINEMATIC', in_model, 0, many, ''), &
      keyword_type('PRE-TENSION SECTION', in_model, 0, 1, 'NODE=/SURFACE='), &
      keyword_type('STEP', in_both, 0, 0, &
         'INC=/AMPLITUDE=/NLGEOM?/PERTURBATION/~NAME=/~UNSYMM?/~EXTRAPOLATION=/'// &
         '~CONVERT SDI=/~DSA?'), &
      keyword_type('CYCLE', in_both, 0, 0, 'STEPS=/REPEAT=/UNTIL=/TOLERANCE='), &
      keyword_type('STATIC', in_step, 0, 1, stabilization//'DIRECT?/~SOLVER=/STRAIN LIMIT='), &
      keyword_type('VISCO', in_step, 0, 1, stabilization//'DIRECT?/~SOLVER=/CETOL=/'// &
         'LOCAL ERROR=/STRAIN LIMIT='), &
      keyword_type('NO ANALYSIS', in_step, 0, 0, ''), &
      keyword_type('STABILITY', in_step, 0, 0, 'FREQUENCY=/MODES='), &
      keyword_type('TIME POINTS', in_both, 1, many, 'NAME=/TIME=/GENERATE'), &
      keyword_type('HEAT TRANSFER', in_step, 0, 1, &
         'STEADY STATE/DIRECT?/~SOLVER=/DELTMX=/LOCAL ERROR=/~END='), &
      keyword_type('COUPLED TEMPERATURE-DISPLACEMENT', in_step, 0, 1, 'CREEP=/'// &
         stabilization//'STEADY STATE/DIRECT?/~SOLVER=/DELTMX=/LOCAL ERROR=/DILATATION=/'// &
         'CETOL=/STRAIN LIMIT='), &
      keyword_type('UNCOUPLED TEMPERATURE-DISPLACEMENT', in_step, 0, 1, &
         'CREEP=/'//stabilization//'STEADY STATE/DIRECT?/~SOLVER=/DELTMX=/LOCAL ERROR=/'// &
         'CETOL=/STRAIN LIMIT='), &
      keyword_type('BOUNDARY', in_both, 1, many, 'OP=/AMPLITUDE=/TYPE=/FIXED'), &
      keyword_type('CLOAD', in_step, 1, many, 'OP=/AMPLITUDE=/~FOLLOWER?'), &
      keyword_type('DLOAD', in_step, 1, many, 'OP=/AMPLITUDE=/~FOLLOWER?/~CONSTANT RESULTANT='), &
      keyword_type('DSLOAD', in_step, 1, many, 'OP=/AMPLITUDE=/~FOLLOWER?/~CONSTANT RESULTANT='), &
      keyword_type('CFLUX', in_step, 1, many, 'OP=/AMPLITUDE='), &
      keyword_type('DFLUX', in_step, 1, many, 'OP=/AMPLITUDE='), &
      keyword_type('FILM', in_step, 1, many, 'OP=/AMPLITUDE=/FILM AMPLITUDE='), &
      keyword_type('DSFLUX', in_step, 1, many, 'OP=/AMPLITUDE='), &
      keyword_type('SFILM', in_step, 1, many, 'OP=/AMPLITUDE=/FILM AMPLITUDE='), &
      keyword_type('TEMPERATURE', in_step, 1, many, 'OP=/AMPLITUDE='), &
      keyword_type('CHANGE FRICTION', in_step, 0, 0, 'INTERACTION='), &
      keyword_type('MODEL CHANGE', in_step, 1, many, 'TYPE=/ADD/REMOVE'), &
      keyword_type('CONTACT INTERFERENCE', in_step, 1, many, 'TYPE=/AMPLITUDE=/OP=/SHRINK'), &
      keyword_type('NODE FILE', in_step, 0, many, file_parameters), &
      keyword_type('EL FILE', in_step, 0, many, file_parameters), &
      keyword_type('CONTACT FILE', in_step, 0, many, file_parameters), &
      keyword_type('NODE OUTPUT', in_step, 0, many, file_parameters), &
      keyword_type('ELEMENT OUTPUT', in_step, 0, many, file_parameters), &
      keyword_type('CONTACT OUTPUT', in_step, 0, many, file_parameters), &
      keyword_type('RESTART', in_both, 0, 0, &
         'READ/STEP=/INC=/WRITE/FREQUENCY=/OVERLAY/~NUMBER INTERVAL=/~TIME MARKS?'), &
      keyword_type('NODE PRINT', in_step, 0, many, &
         'NSET=/FREQUENCY=/TIME POINTS=/TOTALS=/GLOBAL=/~FREQUENCYF='), &
      keyword_type('EL PRINT', in_step, 0, many, &
         'ELSET=/FREQUENCY=/TIME POINTS=/GLOBAL=/~FREQUENCYF='), &
      keyword_type('CONTACT PRINT', in_step, 0, many, 'FREQUENCY=/TIME POINTS=/~FREQUENCYF='), &
      keyword_type('END STEP', in_step, 0, 0, ''), &
      keyword_type('INCLUDE', in_both, 0, 0, 'INPUT=')]

   !> Parameters of one keyword are before those of any.
   type(advice_type), parameter :: advice(73) = [ &
      advice_type(passed_over, '', 'CONTACT INCLUSIONS/CONTACT EXCLUSIONS/CONTACT PROPERTY '// &
         'ASSIGNMENT/CONTACT INITIALIZATION ASSIGNMENT/CONTACT FORMULATION', &
         'it belongs to *CONTACT'), &
      advice_type(passed_over, '', 'CONTROLS/SOLUTION TECHNIQUE', &
         'tolerance and iterations are parameters of *FIXED POINT'), &
      advice_type(passed_over, '', 'CONTACT CONTROLS', 'contact is exact'), &
      advice_type(passed_over, '', 'SECTION CONTROLS/HOURGLASS STIFFNESS', &
         'hourglass control is that of incompatible modes'), &
      advice_type(passed_over, '', 'OUTPUT/ENERGY OUTPUT/INCREMENTATION OUTPUT/INTEGRATED '// &
         'OUTPUT/INTEGRATED OUTPUT SECTION/MODAL OUTPUT/RADIATION OUTPUT/SURFACE OUTPUT/'// &
         'ENERGY FILE/MODAL FILE/RADIATION FILE/FILE FORMAT/FILE OUTPUT/VIEWFACTOR OUTPUT', &
         'fields are written at every increment'), &
      advice_type(passed_over, '', 'ENERGY PRINT/MODAL PRINT/RADIATION PRINT', &
         'the listing has no such table'), &
      advice_type(passed_over, '', 'FILTER', 'results are not filtered'), &
      advice_type(passed_over, '', 'DESIGN PARAMETER/DESIGN RESPONSE/DESIGN GRADIENT/NODE '// &
         'RESPONSE/ELEMENT RESPONSE/CONTACT RESPONSE', 'sensitivities are not computed'), &
      advice_type(passed_over, '', 'FAIL STRESS/FAIL STRAIN', 'materials do not fail'), &
      advice_type(passed_over, '', 'DAMPING/CONTACT DAMPING', 'loads are slow'), &
      advice_type(passed_over, '', 'NORMAL', 'the normal of the plane is z'), &
      advice_type(passed_over, '', 'DEPVAR', 'materials have no state'), &
      advice_type(passed_over, '', 'USER OUTPUT VARIABLES', 'no routine of the user is called'), &
      advice_type(passed_over, '', 'PREPRINT', 'the listing has the whole deck'), &
      advice_type(passed_over, '', 'PRINT', 'the listing has all that it has to say'), &
      advice_type(passed_over, '', 'MONITOR', 'the result has all nodes'), &
      advice_type(not_printed, '', 'SECTION PRINT/FACE PRINT', &
         'sums over a set of nodes: *NODE PRINT, TOTALS=ONLY; over a contact: /contact of the '// &
         'result'), &
      advice_type(refused_with_data, '', 'RADIATE', &
         'heat leaves sides by *FILM and *DFLUX; only contact gaps radiate'), &
      advice_type(refused, 'ELASTIC', 'HYPERELASTIC/ANISOTROPIC HYPERELASTIC/HYPERFOAM/'// &
         'HYPOELASTIC/POROUS ELASTIC/DEFORMATION PLASTICITY/USER MATERIAL', laws), &
      advice_type(refused, '', 'SWELLING/HARDENING/VISCOELASTIC/RATE '// &
         'DEPENDENT/POTENTIAL/UNIAXIAL TEST DATA/DRUCKER PRAGER/DRUCKER PRAGER HARDENING/'// &
         'DRUCKER PRAGER CREEP/MOHR COULOMB/MOHR COULOMB HARDENING/CAP PLASTICITY/'// &
         'CAP HARDENING', laws), &
      advice_type(refused, '', 'DAMAGE INITIATION/DAMAGE EVOLUTION/DAMAGE STABILIZATION/'// &
         'BRITTLE CRACKING/CONCRETE/CONCRETE DAMAGED PLASTICITY/CONCRETE COMPRESSION HARDENING/'// &
         'CONCRETE COMPRESSION DAMAGE/CONCRETE TENSION STIFFENING/CONCRETE TENSION DAMAGE', &
         laws), &
      advice_type(refused, '', 'USER DEFINED FIELD/FIELD', 'values depend on no field'), &
      advice_type(refused, '', 'PERMEABILITY/SORPTION/GEL/POROUS BULK MODULI/MOISTURE '// &
         'SWELLING/FLOW/DFLOW/DSFLOW/DIFFUSIVITY/SOLUBILITY', 'nothing flows through bodies'), &
      advice_type(refused, '', 'HEAT GENERATION', &
         'no routine of the user is called; give BF on *DFLUX'), &
      advice_type(refused, '', 'FILM PROPERTY', &
         'a film coefficient is a number on *FILM or *SFILM, over time by FILM AMPLITUDE='), &
      advice_type(refused, '', 'CAVITY DEFINITION/SURFACE PROPERTY/EMISSIVITY/RADIATION '// &
         'VIEWFACTOR/RADIATION SYMMETRY/VIEWFACTOR', 'only contact gaps radiate'), &
      advice_type(refused, 'SOLID SECTION', 'SHELL SECTION/BEAM SECTION/BEAM GENERAL SECTION/'// &
         'MEMBRANE SECTION', &
         'elements are plane: CPE, CPS or CAX, with *SOLID SECTION'), &
      advice_type(refused, '', 'USER ELEMENT/UEL PROPERTY', &
         'no routine of the user is called; elements are CPE, CPS or CAX, with *SOLID SECTION'), &
      advice_type(refused, 'SOLID SECTION', 'FLUID SECTION', 'there are no fluids'), &
      advice_type(refused, '', 'FLUID CONSTANTS/SPECIFIC GAS CONSTANT/MASS FLOW', &
         'there are no fluids'), &
      advice_type(refused, '', 'NODAL THICKNESS', 'give the thickness on *SOLID SECTION'), &
      advice_type(refused, '', 'DISTRIBUTION', &
         'give the axes of each element set on an *ORIENTATION of its own'), &
      advice_type(refused, 'CONTACT PAIR', 'CONTACT', &
         'there is no general contact; name the faces of each *CONTACT PAIR'), &
      advice_type(refused, '', 'KINEMATIC COUPLING/DISTRIBUTING/DISTRIBUTING COUPLING/CYCLIC '// &
         'SYMMETRY MODEL/SUBMODEL/DASHPOT', &
         'bodies are held by *BOUNDARY, contact, *TIE, *EQUATION and *COUPLING'), &
      advice_type(refused, '', 'MPC', 'give its relations by *EQUATION or *COUPLING'), &
      advice_type(refused, '', 'GAP', 'name the faces of a *CONTACT PAIR'), &
      advice_type(refused, '', 'MASS', 'weight is *DENSITY with GRAV on *DLOAD'), &
      advice_type(refused, '', 'CHANGE MATERIAL/CHANGE SOLID SECTION/CHANGE SURFACE BEHAVIOR', &
         'materials, elements and sections are the same in all steps'), &
      advice_type(refused, 'STATIC', 'FREQUENCY/COMPLEX FREQUENCY/BUCKLE/DYNAMIC/DYNAMIC '// &
         'TEMPERATURE-DISPLACEMENT/MODAL DYNAMIC/'// &
         'STEADY STATE DYNAMICS/SENSITIVITY/GREEN/ELECTROMAGNETICS/CFD/GEOSTATIC/SOILS/'// &
         'MASS DIFFUSION/COUPLED THERMAL-ELECTRICAL/DIRECT CYCLIC', &
         'steps are *STATIC, *VISCO, *HEAT TRANSFER or *COUPLED TEMPERATURE-DISPLACEMENT'), &
      advice_type(of_parameter, 'SPRING', 'NONLINEAR/ORIENTATION/DEPENDENCIES/COMPLEX STIFFNESS', &
         'springs have one constant'), &
      advice_type(of_parameter, 'EQUATION', 'REMOVE', 'equations hold in all steps'), &
      advice_type(of_parameter, 'EQUATION', 'INPUT', 'take *INCLUDE behind the keyword'), &
      advice_type(of_parameter, 'INSTANCE', 'LIBRARY', 'the mesh is in the deck; give its part'), &
      advice_type(of_parameter, 'SURFACE', 'PROPERTY', 'only contact gaps radiate'), &
      advice_type(of_parameter, 'INITIAL CONDITIONS', 'GEOSTATIC', &
         'give the stresses of each element set'), &
      advice_type(of_parameter, 'SURFACE', 'FILLET RADIUS', 'draw the fillets by CIRCL'), &
      advice_type(of_parameter, 'COUPLING', 'ORIENTATION', 'faces follow along x and y'), &
      advice_type(of_parameter, 'COUPLING', 'ALPHA', 'small rotations need no penalty'), &
      advice_type(of_parameter, 'GAP CONDUCTANCE', 'USER', &
         'no routine of the user is called; give the table'), &
      advice_type(of_parameter, 'MODEL CHANGE', 'MECHSTRAINTORESIDUAL', &
         'strains and stresses go on from step to step'), &
      advice_type(of_parameter, 'SURFACE BEHAVIOR', 'NO SEPARATION', &
         'faces that do not come apart are those of *TIE'), &
      advice_type(of_parameter, 'CONTACT PAIR', 'TIED', 'tied faces do not open; take *TIE'), &
      advice_type(of_parameter, 'TIE', 'CYCLIC SYMMETRY/MULTISTAGE', &
         'only faces that lie opposite each other are tied'), &
      advice_type(of_parameter, 'TIE', 'TIED NSET', &
         'POSITION TOLERANCE= selects the nodes that are tied'), &
      advice_type(of_parameter, 'BOUNDARY', 'SUBMODEL', 'give the values'), &
      advice_type(of_parameter, 'PRE-TENSION SECTION', 'ELEMENT', &
         'bolts are plane elements; name the sides of elements of a section, SURFACE='), &
      advice_type(of_parameter, 'BOUNDARY', 'MASS FLOW', 'there are no fluids'), &
      advice_type(of_parameter, 'TEMPERATURE', 'FILE/BSTEP', &
         'give the values, or solve *HEAT TRANSFER before'), &
      advice_type(of_parameter, 'STATIC', 'EXPLICIT', 'loads are slow'), &
      advice_type(of_parameter, 'AMPLITUDE', 'SHIFTX', 'add the shift to the times'), &
      advice_type(of_parameter, 'AMPLITUDE', 'SHIFTY', 'add the shift to the factors'), &
      advice_type(of_parameter, 'RESTART', 'END STEP', 'a step goes on to its end; leave it out'), &
      advice_type(of_parameter, '', 'TIME DELAY/FILM TIME DELAY', &
         'shift the times of the *AMPLITUDE'), &
      advice_type(of_parameter, '', 'USER', 'no routine of the user is called; give the values'), &
      advice_type(of_parameter, '', 'TIME RESET', 'times of the steps add up'), &
      advice_type(of_parameter, '', 'TOTAL TIME AT START', 'times of the steps add up, from 0'), &
      advice_type(of_parameter, '', 'RIKS', &
         'solutions past a turning point of the load are *CONTINUATION'), &
      advice_type(of_parameter, '', 'MXDEM', 'emissivities are constant; leave it out'), &
      advice_type(of_parameter, '', 'CREEP', 'materials creep in real time; leave it out'), &
      advice_type(of_parameter, '', 'DEPENDENCIES', &
         'values depend on no field; give the rows of one value of it, and 0'), &
      advice_type(of_parameter, '', 'TEMPERATURE', 'the temperature is that of the analysis'), &
      advice_type(of_parameter, '', 'INPUT', 'data in a file of their own are *INCLUDE, INPUT='), &
      advice_type(of_parameter, '', 'INSTANCE', 'write the name as INSTANCE.NAME')]

contains

   !> Index of a keyword, whatever its case and blanks; 0 for an unknown one.
   pure function find_keyword(name) result(known)
      character(*), intent(in) :: name   !! without the star
      integer :: known                   !! index into known_keywords

      do known = size(known_keywords), 1, -1
         if (is_same_name(known_keywords(known)%name, name)) return
      end do
   end function find_keyword

   !> The names of all keywords: first those of known_keywords, then those of other programs.
   pure function known_names() result(names)
      type(string_type), allocatable :: names(:), others(:)
      integer :: i, k

      allocate(names(0))
      do i = 1, size(known_keywords)
         call append(names, trim(known_keywords(i)%name))
      end do
      do i = 1, size(advice)
         if (advice(i)%kind == of_parameter) cycle
         others = split_words(trim(advice(i)%names))
         do k = 1, size(others)
            call append(names, others(k)%value)
         end do
      end do
   end function known_names

   !> The table of keywords as text, a line each behind that of the heads: name, where it may be,
   !> numbers of data cards, parameters; those that mean nothing are in parentheses.
   pure function keyword_lines() result(lines)
      type(string_type) :: lines(0:size(known_keywords))
      character(*), parameter :: sections(3) = [character(13) :: 'model', 'step', 'model or step']
      type(string_type), allocatable :: entries(:)
      type(keyword_type) :: known
      type(known_parameter_type) :: parameter
      character(:), allocatable :: cards, parameters
      integer :: i, k

      lines(0)%value = row('keyword', 'where', 'data cards', 'parameters')
      do i = 1, size(known_keywords)
         known = known_keywords(i)
         cards = to_text(known%least_data)
         if (known%most_data == many) then
            cards = cards//' or more'
         else if (known%most_data > known%least_data) then
            cards = cards//' to '//to_text(known%most_data)
         end if
         parameters = ''
         entries = split_words(trim(known%parameters))
         do k = 1, size(entries)
            parameter = parsed_entry(entries(k)%value)
            if (parameter%needs_value) then
               parameter%name = parameter%name//'='
            else if (parameter%takes_value) then
               parameter%name = parameter%name//'[=]'
            end if
            if (parameter%status == not_needed) parameter%name = '('//parameter%name//')'
            parameters = parameters//', '//parameter%name
         end do
         lines(i)%value = row('*'//known%name, sections(known%section), cards, parameters(3:))
      end do
   contains
      pure function row(name, section, cards, parameters) result(line)
         character(*), intent(in) :: name, section, cards, parameters
         character(:), allocatable :: line
         character(65) :: columns

         columns(:37) = name
         columns(38:52) = section
         columns(53:) = cards
         line = trim(columns//parameters)
      end function row
   end function keyword_lines

   !> Names of the parameters of a keyword.
   pure function parameter_names(known) result(names)
      integer, intent(in) :: known                     !! index into known_keywords
      type(string_type), allocatable :: names(:)       !! in the order of the table
      type(known_parameter_type) :: parameter
      integer :: i

      names = split_words(trim(known_keywords(known)%parameters))
      do i = 1, size(names)
         parameter = parsed_entry(names(i)%value)
         names(i)%value = parameter%name
      end do
   end function parameter_names

   !> Finds a parameter of a keyword, or one that is refused, whatever its case and blanks; its name
   !> is empty for an unknown one.
   pure function find_parameter(known, name) result(parameter)
      integer, intent(in) :: known              !! index into known_keywords
      character(*), intent(in) :: name          !! name as written
      type(known_parameter_type) :: parameter   !! what the table says of it
      type(string_type), allocatable :: entries(:)
      type(advice_type) :: found
      integer :: i

      entries = split_words(trim(known_keywords(known)%parameters))
      do i = 1, size(entries)
         parameter = parsed_entry(entries(i)%value)
         if (is_same_name(parameter%name, name)) return
      end do
      found = find_advice(name, trim(known_keywords(known)%name))
      parameter = known_parameter_type(status=refused)
      parameter%name = trim(found%names)
   end function find_parameter

   !> The parameter of a keyword that is abbreviated to its first letters, as in Abaqus; its name is
   !> empty where none begins so, or several do.
   pure function find_abbreviated(known, name) result(parameter)
      integer, intent(in) :: known              !! index into known_keywords
      character(*), intent(in) :: name          !! name as written
      type(known_parameter_type) :: parameter   !! what the table says of it
      type(string_type), allocatable :: names(:)
      character(:), allocatable :: found

      parameter%name = ''
      names = parameter_names(known)
      found = full_word(to_upper(name), names)
      if (len(found) > 0) parameter = find_parameter(known, found)
   end function find_abbreviated

   !> Whether a keyword asks for output, of which nothing stops a run.
   pure logical function is_output(name)
      character(*), intent(in) :: name         !! keyword without the star
      integer :: first, i

      is_output = .false.
      do i = 1, size(output_words)
         first = len_trim(name) - len_trim(output_words(i)) + 1
         if (first > 1) is_output = is_output .or. name(first:) == output_words(i)
      end do
   end function is_output

   pure function parsed_entry(entry) result(parameter)
      character(*), intent(in) :: entry
      type(known_parameter_type) :: parameter
      integer :: first, last

      first = 1
      if (entry(1:1) == '~') then
         parameter%status = not_needed
         first = 2
      end if
      last = len(entry)
      parameter%needs_value = entry(last:last) == '='
      parameter%takes_value = parameter%needs_value .or. entry(last:last) == '?'
      if (parameter%takes_value) last = last - 1
      parameter%name = entry(first:last)
   end function parsed_entry

   !> The advice on a keyword of another program, or on a parameter.
   pure function find_advice(name, keyword) result(found)
      character(*), intent(in) :: name                !! as written, without the star
      character(*), intent(in), optional :: keyword   !! the keyword that has the parameter
      type(advice_type) :: found                      !! with the one name; no_advice where none is
      integer :: first, i, last

      do i = 1, size(advice)
         if (present(keyword) .neqv. advice(i)%kind == of_parameter) cycle
         if (present(keyword)) then
            if (all(advice(i)%keyword /= [character(32) :: keyword, ''])) cycle
         end if
         last = -1
         do while (last + 1 < len_trim(advice(i)%names))
            first = last + 2
            last = first - 2 + index(advice(i)%names(first:)//'/', '/')
            if (.not. is_same_name(advice(i)%names(first:last), name)) cycle
            found = advice(i)
            found%names = advice(i)%names(first:last)
            return
         end do
      end do
   end function find_advice

end module keywords
