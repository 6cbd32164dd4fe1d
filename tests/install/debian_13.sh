#!/usr/bin/env bash
# Makes a base system of Debian 13 in a folder, and in it runs `./setup.sh cylinder`, the unit tests of
# the solvers and the laws, and some decks, whose *VERIFY cards are the tests of the other kernels: what
# a new machine does. The folder is removed at the end.
#
# usage: debian_13.sh TREE FOLDER
#
# Exit status 77: it cannot run here, or the packages are out of reach.
# shellcheck disable=SC2016 # strings that apt-get and the inner shell expand
set -euo pipefail

tree=$1
base=$2
certificates=/etc/ssl/certs/ca-certificates.crt

skip() {
   printf 'skipped: %s\n' "$*"
   exit 77
}

# Mounts are those of this process alone: none is left behind, however it ends.
if [[ -z ${mounts_are_own-} ]]; then
   ((EUID == 0)) || skip 'needs root'
   command -v debootstrap >/dev/null || skip 'needs debootstrap'
   [[ -e /usr/share/debootstrap/scripts/trixie ]] || skip 'needs a debootstrap that knows Debian 13'
   unshare --mount mount -t proc proc /proc 2>/dev/null || skip 'file systems cannot be mounted here'
   exec env mounts_are_own=1 unshare --mount "$BASH" "$0" "$@"
fi

# Runs a command in the base system, in the copy of the source tree there.
inside() {
   env --unset TMPDIR HOME=/root LC_ALL=C.UTF-8 CMAKE_BUILD_PARALLEL_LEVEL=1 \
      ${trusted:+PIP_CERT="$trusted" REQUESTS_CA_BUNDLE="$trusted"} \
      PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
      chroot "$base" /bin/bash -c 'cd /thercon && exec "$@"' bash "$@"
}

# The mirror and the settings of the network are those of this machine. The system is in memory
# where there is enough of it, and without texts that nobody reads here.
make_base() {
   local mirror available
   mkdir -p "$base"
   available=$(awk '$1 == "MemAvailable:" {print int($2 / 1024)}' /proc/meminfo)
   ((available < 8000)) || mount -t tmpfs -o size=4G,mode=755 tmpfs "$base"
   mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Label: Debian' | head -n 1)
   debootstrap --variant=minbase trixie "$base" ${mirror:+"$mirror"} >"$base.log" 2>&1 ||
      skip "debootstrap: $(tail -n 1 "$base.log")"
   mount -t proc proc "$base/proc"
   {
      apt-config dump | grep '^Acquire::'
      printf 'Acquire::Languages "none";\n'
   } >"$base/etc/apt/apt.conf.d/host"
   {
      printf 'force-unsafe-io\n'
      printf 'path-exclude=/usr/share/%s/*\n' doc info locale man
   } >"$base/etc/dpkg/dpkg.cfg.d/host"
   [[ ! -e /etc/pip.conf ]] || cp /etc/pip.conf "$base/etc"
   if [[ -e $certificates ]]; then
      trusted=/etc/certificates.crt # its own name is that of a package's file
      cp "$certificates" "$base$trusted"
   fi
   mkdir "$base/thercon"
   tar --directory "$tree" --exclude ./build --exclude ./.git --create . |
      tar --directory "$base/thercon" --extract --no-same-owner
   # Without optimisation, which takes the compiler half of the time.
   local flags=("$base/thercon/"{cmake/DefaultFlags.cmake,CMakeLists.txt})
   sed --in-place 's/-Og -ffrontend-optimize -g1/-O0/; s/>:-O[13]>/>:-O0>/' "${flags[@]}"
   # The base, and what is frequent, a kernel, or seldom.
   [[ $(cat "${flags[@]}" | grep -c -e '"-O0 ' -e '>:-O0>') == 4 ]]
}

set_up() {
   local status=0
   inside ./setup.sh cylinder >"$base.log" 2>&1 || status=$?
   cat "$base.log"
   ((status != 0)) || return 0
   if grep -q 'could not install' "$base.log" &&
      grep -qE 'Failed to fetch|Retrying|Temporary failure' "$base.log"; then
      skip 'packages are out of reach'
   fi
   return "$status"
}

TIMEFORMAT='   %R s, of processors %U + %S s'
rm -rf --one-file-system "$base"
clean_up() {
   umount "$base/proc" "$base" 2>/dev/null || true
   rm -rf --one-file-system "$base" "$base.log"
}
trap clean_up EXIT
printf 'base system of Debian 13\n'
time make_base
printf './setup.sh cylinder\n'
time set_up
printf 'unit tests\n'
time inside cmake --build --preset release --target unit_laws unit_linalg -- --quiet
time inside ctest --preset release --tests-regex '^unit_(laws|linalg)$' --no-tests=error \
   --output-on-failure
printf 'decks\n'
time inside bash -c 'build/release/thercon run --quiet --out build/decks \
   input/examples/{auto*,b*pad,crack*,hot_*,press*,roller,t*,warm*}.inp input/rods/*.inp \
   input/hertz/*.inp tests/decks/checked/*.inp'
