#!/usr/bin/env bash
# Every deck of refused/ must be refused by `thercon check`: exit status 1, nothing on stdout, and on stderr exactly
# the text of NAME.expected beside it. NAME.args, if it exists, has further arguments.
#
#    run_refused.sh [PROGRAM]     PROGRAM defaults to $THERCON
set -u

program=$(realpath "${1:-${THERCON:?give the program}}")
cd "$(dirname "${BASH_SOURCE[0]}")/refused" || exit 2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

decks=0
failed=0
for deck in *.inp; do
   decks=$((decks + 1))
   wrong=""
   arguments=()
   [[ ! -f "${deck%.inp}.args" ]] || read -ra arguments <"${deck%.inp}.args"
   "$program" check "$deck" "${arguments[@]}" >"$folder/out" 2>"$folder/err"
   status=$?
   ((status == 1)) || wrong="exit status $status instead of 1"
   [[ ! -s "$folder/out" ]] || wrong="$wrong; something on stdout"
   diff -u "${deck%.inp}.expected" "$folder/err" >"$folder/diff" || wrong="$wrong; other messages"
   [[ -n "$wrong" ]] || continue
   failed=$((failed + 1))
   printf '%s: %s\n' "$deck" "${wrong#; }"
   cat "$folder/diff"
done
if [[ $("$program" check nowhere.inp 2>&1) != "nowhere.inp: error: the deck cannot be read: there is no such file" ]]; then
   failed=$((failed + 1))
   printf 'nowhere.inp: a deck that does not exist is not reported by its path\n'
fi
printf '%d decks, %d of them not refused as expected\n' "$decks" "$failed"
((decks > 0 && failed == 0))
