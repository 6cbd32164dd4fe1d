#!/usr/bin/env bash
# Sets thercon up on Debian 12, Debian 13 or Ubuntu 24.04 and runs it; see usage below.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd -P)
build=$root/build
venv=$build/venv
program=$build/release/thercon

# The three systems use the same names. Debian 13 lacks calculix-ccx, and Ubuntu has Chromium as a
# snap alone: of test_packages, those that a system lacks are left out.
build_packages=(gcc libc6-dev gfortran cmake ninja-build libopenblas-serial-dev libmumps-seq-dev
   libmetis-dev libhdf5-dev python3 python3-venv)
test_packages=(valgrind calculix-ccx flang-19 chromium chromium-driver debootstrap file dpkg-dev)
bench_packages=(calculix-ccx)
sweep_requirements=("$root/input/sweep/requirements.txt")

usage() {
   cat <<USAGE
usage: ./setup.sh COMMAND

   cylinder    install what is missing, build, solve the published cylinder, draw its figures and page
   test        install what is missing, build, check the sources, run every test
   build       install what is missing, build build/release/thercon
   lint        check the sources: fortitude, findent, shellcheck; with --fix fix what can be fixed
   coverage    install what is missing, build with gcov, run every test, report the lines executed
   verify      run the verification manual again, write docs/verification.md, and with every
               value build/documents/verification.md
   bench       run thercon and CalculiX at equal error again, against the figures on record;
               bench performance [PART...]: measure docs/performance.md again, all of it or the
               parts skyline, tail, levels, rods, paper, stability

What is installed: Debian packages with apt-get, as root or with sudo; without either, the command
that is needed is printed. Python packages live in build/venv, those of Snakemake
(for tests only) in build/sweep.
USAGE
}

say() { printf '== %s\n' "$*"; }

fail() {
   printf 'setup.sh: error: %s\n' "$*" >&2
   exit 1
}

# Runs a command, with its output shown only when it fails.
quietly() {
   local log status=0
   log=$(mktemp)
   "$@" >"$log" 2>&1 || status=$?
   ((status == 0)) || cat "$log" >&2
   rm -f "$log"
   return "$status"
}

# Runs a command that asks the network, twice more where it fails.
patiently() {
   local pause
   for pause in 5 30; do
      quietly "$@" && return
      say "this failed: $*; once more in $pause s"
      sleep "$pause"
   done
   quietly "$@"
}

# Prints which of the Debian packages named are not installed.
missing_packages() {
   local installed
   installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null || true)
   local package
   for package in "$@"; do
      grep -qx "installed $package" <<<"$installed" || printf '%s\n' "$package"
   done
}

# Runs a command as root, without any question of apt-get or of its packages.
as_root() {
   if ((EUID == 0)); then
      env DEBIAN_FRONTEND=noninteractive "$@"
   else
      sudo env DEBIAN_FRONTEND=noninteractive "$@"
   fi
}

# Another apt-get, as of the system's timers, is waited for.
apt_install() {
   as_root apt-get update || true # the lists at hand may do
   as_root apt-get -o DPkg::Lock::Timeout=300 install --yes --no-install-recommends "$@"
}

can_be_root() { ((EUID == 0)) || { command -v sudo >/dev/null && sudo -v 2>/dev/null; }; }

install_packages() {
   local missing
   command -v dpkg-query >/dev/null ||
      fail "this is no Debian; needed are, under whatever names: $*"
   mapfile -t missing < <(missing_packages "$@")
   ((${#missing[@]})) || return 0
   if ! can_be_root; then
      printf 'Some Debian packages are missing. As root:\n\n   apt-get install %s\n' \
         "${missing[*]}" >&2
      exit 1
   fi
   say "installing Debian packages: ${missing[*]}"
   patiently apt_install "${missing[@]}" ||
      fail "apt-get could not install: ${missing[*]}"
}

# Whether a package is in the lists of apt; none is where there are no lists.
is_listed() { [[ -n $(apt-cache madison "$1" 2>/dev/null) ]]; }

# Packages that some tests need; these tests are skipped where the system has no such package.
install_test_packages() {
   local missing package listed=()
   mapfile -t missing < <(missing_packages "${test_packages[@]}")
   ((${#missing[@]})) || return 0
   ! can_be_root || quietly as_root apt-get update || true
   if is_listed ninja-build; then
      for package in "${missing[@]}"; do
         if is_listed "$package"; then
            listed+=("$package")
         else
            say "this system has no package $package: the tests that need it are skipped"
         fi
      done
      missing=("${listed[@]}")
   fi
   install_packages "${missing[@]}"
}

# What an environment was made for. It does not survive a move to another path.
venv_identity() {
   printf '%s\n' "$1"
   /usr/bin/python3 --version
}

# Makes an environment, anew where it has packages of a file that has changed since, and installs into
# it the packages of those files that it does not have. Python compiles what is imported when it is.
make_venv() {
   local folder=$1 file installed arguments=()
   shift
   unset PYTHONHOME PYTHONPATH
   venv_identity "$folder" | cmp -s - "$folder/identity" || rm -rf "$folder"
   for file in "$@"; do
      installed=$folder/installed${file#"$root"}
      [[ ! -f $installed ]] || cmp -s "$file" "$installed" || rm -rf "$folder"
   done
   for file in "$@"; do
      [[ -f $folder/installed${file#"$root"} ]] || arguments+=(--requirement "$file")
   done
   ((${#arguments[@]})) || return 0
   say "installing Python packages into ${folder#"$root"/}"
   if [[ ! -d $folder ]]; then
      quietly /usr/bin/python3 -m venv "$folder" || fail "no Python environment could be made"
      venv_identity "$folder" >"$folder/identity"
   fi
   patiently "$folder/bin/python" -m pip install --disable-pip-version-check --no-input --no-compile \
      "${arguments[@]}" || fail "pip could not install the Python packages"
   for file in "$@"; do
      mkdir -p "$folder/installed$(dirname "${file#"$root"}")"
      cp "$file" "$folder/installed${file#"$root"}"
   done
}

# Those of the tests too, which take longer than those that draw.
install_python_packages() {
   make_venv "$venv" "$root/post/requirements.txt" "$root/tests/requirements.txt"
}

# Configures (once) and builds the preset named, all of it or the target named.
build_preset() {
   local folder=$build/$1
   cd "$root"
   # A build folder does not survive a move to another path either.
   if ! grep -qsFx "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$folder/CMakeCache.txt" ||
      [[ ! -f $folder/build.ninja ]]; then
      say "configuring build/$1"
      rm -rf "$folder"
      quietly cmake --preset "$1" || fail "build/$1 could not be configured"
   fi
   say "building build/$1"
   local progress=()
   [[ -t 1 ]] || progress=(-- --quiet)
   cmake --build --preset "$1" --target "${2:-all}" "${progress[@]}"
}

run_build() {
   install_packages "${build_packages[@]}"
   make_venv "$venv" "$root/post/requirements.txt"
   build_preset release thercon
}

# Whether the file named first is newer than all files in what is named after it.
is_newer() {
   local file=$1
   shift
   [[ -f $file && -z $(find "$@" -type f -newer "$file" -print -quit) ]]
}

solve_cylinder() {
   local deck=$root/input/cylinder/cylinder.inp
   is_newer "$1/cylinder.vtkhdf" "$program" "$deck" && return
   say "solving input/cylinder/cylinder.inp"
   "$program" run "$deck" --out "$1"
}

draw() { "$venv/bin/python" "$root/post/plot" "$@" >/dev/null; }

draw_cylinder() {
   local result=$1/cylinder.vtkhdf picture
   is_newer "$1/.drawn" "$result" "$root/post" "$root/python" && return
   say "drawing the figures"
   for picture in mesh zones fields convergence; do
      draw "$picture" "$result" --out "$1"
   done
   draw profiles "$result" --load 540 --out "$1"
   "$venv/bin/python" "$root/post/report" "$result" --out "$1" >/dev/null
   touch "$1/.drawn"
}

run_cylinder() {
   local folder=$build/cylinder
   run_build
   mkdir -p "$folder"
   solve_cylinder "$folder"
   draw_cylinder "$folder"
   say "the published cylinder is in build/cylinder:"
   find "$folder" -maxdepth 1 -type f ! -name .drawn -printf '   %f\n' | sort
}

fortran_sources() {
   find "$root/src" "$root/tests" -name '*.f90' -o -name '*.pf' | sort
}

# findent says nothing about a file: its output is compared, or, with --fix, taken.
check_indentation() {
   local source status=0 indented
   indented=$(mktemp)
   while IFS= read -r source; do
      "$venv/bin/findent" -i3 -c3 -k- -Rr <"$source" >"$indented"
      cmp -s "$source" "$indented" && continue
      if [[ ${1-} == --fix ]]; then
         cat "$indented" >"$source"
         printf 'indented: %s\n' "${source#"$root"/}"
      else
         printf 'findent would change: %s\n' "${source#"$root"/}"
         status=1
      fi
   done < <(fortran_sources)
   rm -f "$indented"
   return "$status"
}

run_lint() {
   local status=0
   install_packages "${build_packages[@]}"
   install_python_packages
   say "checking the sources"
   cd "$root"
   "$venv/bin/fortitude" check --progress-bar off "$@" src tests || status=1
   check_indentation "$@" || status=1
   "$venv/bin/shellcheck" setup.sh .ci/run input/*/*.sh tests/*/*.sh || status=1
   ((status == 0)) || printf 'The sources do not pass; ./setup.sh lint --fix fixes some of it.\n'
   return "$status"
}

# Runs tests of a preset, with one more at a time than there are processors, since some wait. Result
# files replace each other at every increment, for which a disk lets the program wait: temporary
# files are in memory where there is enough of it.
run_ctest() {
   local memory=/dev/shm free=0
   [[ ! -w $memory ]] || free=$(df --output=avail --block-size=1M "$memory" | tail -n 1)
   ((free < 2000)) || local -x TMPDIR=$memory
   ctest --preset "$1" --parallel "$(($(nproc) + 1))" "${@:2}"
}

# The tests on the program as users have it come last, so that their summary closes the output; before
# that the sources, and the unit tests and all decks with run-time checks. Unit tests run with these
# checks only: to compile them once more would take as long as most of the tests below. Both programs
# are built side by side; the packages, most of whose time is that of the network, are installed and the
# sources checked meanwhile: none of these keeps all processors busy.
run_test() {
   local status=0 job jobs=() lint
   install_packages "${build_packages[@]}"
   trap wait EXIT
   install_test_packages &
   jobs+=($!)
   run_lint &
   lint=$!
   make_venv "$build/sweep" "${sweep_requirements[@]}" & # Snakemake, for the test of input/sweep
   jobs+=($!)
   build_preset release thercon &
   jobs+=($!)
   build_preset checks
   for job in "${jobs[@]}"; do
      wait "$job"
   done
   wait "$lint" || status=1
   say "tests with run-time checks"
   run_ctest checks --label-regex 'unit|standin|memory' || status=1
   ((status == 0)) || say "something above has failed"
   say "tests on the program"
   run_ctest release --label-exclude 'unit|standin' || status=1
   return "$status"
}

# Lines count here, not verdicts: without optimisation the program rounds otherwise and is slow, and a
# test that sees this fails.
run_coverage() {
   install_packages "${build_packages[@]}"
   install_test_packages
   install_python_packages
   make_venv "$build/sweep" "${sweep_requirements[@]}"
   build_preset coverage
   find "$build/coverage" -name '*.gcda' -delete
   say "all tests, with lines counted"
   run_ctest coverage --exclude-regex 'memory|debian_13' || say "some tests have failed"
   # More than 2^32 executions of a line are nothing odd here.
   "$venv/bin/gcovr" --gcov-suspicious-hits-threshold 0 --root "$root" --filter "$root/src/" \
      --txt-summary --txt "$build/coverage/lines.txt" "$build/coverage"
   say "lines that no test executes are listed in build/coverage/lines.txt"
}

# Writes docs/performance.md anew, or the sections named. Nothing waits for a disk where temporary
# files are in memory.
run_performance() {
   [[ ! -w /dev/shm ]] || local -x TMPDIR=/dev/shm
   install_packages valgrind
   say "measuring, which takes some ten minutes for all parts"
   THERCON=$program "$venv/bin/python" "$root/tests/bench/report.py" "$@"
   say "docs/performance.md is written"
}

# Without an argument half an hour, most of it CalculiX.
run_bench() {
   run_build
   install_python_packages
   if [[ ${1-} == performance ]]; then
      run_performance "${@:2}"
      return
   fi
   install_packages "${bench_packages[@]}"
   say "runs on record, again"
   mkdir -p "$build/bench"
   THERCON=$program "$venv/bin/python" "$root/tests/bench/bench.py" "$build/bench"
   say "what came out is in build/bench/runs.csv, what was on record in tests/bench/runs.csv"
}

# A few minutes. It fails where a row of the manual does.
run_verify() {
   run_build
   install_python_packages
   say "running the verification manual"
   THERCON=$program "$venv/bin/python" "$root/tests/verification/manual.py"
   say "the manual is docs/verification.md, every value in build/documents/verification.md"
}

command=${1-}
(($# == 0)) || shift
case $command in
   bench) [[ $# == 0 || $1 == performance ]] || fail "$command takes performance or nothing: $*" ;;
   cylinder | test | build | coverage | verify) (($# == 0)) || fail "$command takes no argument: $1" ;;
   lint) [[ $# == 0 || $* == --fix ]] || fail "lint takes --fix or nothing: $*" ;;
esac
case $command in
   cylinder) run_cylinder ;;
   test) run_test ;;
   build)
      run_build
      say "the program is build/release/thercon"
      ;;
   lint) run_lint "$@" ;;
   coverage) run_coverage ;;
   verify) run_verify ;;
   bench) run_bench "$@" ;;
   help | --help | -h) usage ;;
   *)
      usage >&2
      exit 1
      ;;
esac
