#!/usr/bin/env bash
# Runs a small set of unit tests, or one command, on Oclgrind's simulated device, which watches every memory access:
#   tools/run_oclgrind.sh [BUILD]           the set below, by BUILD/tests/tests_unit (BUILD: build/release unless given)
#   tools/run_oclgrind.sh -- COMMAND...     one command; its exit code, or 1 where Oclgrind reports anything
# Reported are invalid memory accesses, data races, uses of uninitialised values and wrong uses of the API. Each case
# has HEMIRAY_OCLGRIND_SECONDS (120). Needs Debian's oclgrind and a C compiler. The profile in oclgrind_profile.json keeps
# launches small.
set -euo pipefail

here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
fail() { printf 'run_oclgrind: %s\n' "$*" >&2; exit 1; }

# Cases as Catch's patterns: all kernels on a few items, and what the host relies on in the language.
cases=(
  'tiny: *'
  'every shared struct lies in memory alike on host and device'
  'a pending branch takes as much memory on the device as the host sets aside'
  'arguments are bound by name*'
  'launches are rounded up to the local size*'
)

case ${1:-} in
  -h | --help) sed -n '2,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
command -v oclgrind >/dev/null || fail "oclgrind is missing (apt-get install oclgrind)"
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
# Oclgrind takes initialised values for uninitialised ones in memory that was released and given out again: here none is.
echo 'int clReleaseMemObject(void* memory) { return memory == 0 ? -38 : 0; }' >"$scratch/keep.c"
cc -shared -fPIC -o "$scratch/keep.so" "$scratch/keep.c" || fail "a C compiler is missing (apt-get install gcc)"

# Kernels are compiled without the optimiser: it would hide reads of uninitialised values, and leave instructions
# ("freeze") that this simulator does not know and takes for zero. hemiray's cache is off: of programs made from binaries
# initialised values are reported as uninitialised.
#
# Oclgrind opens its log anew, and empties it, with every context: a pipe keeps what earlier ones reported.
run_one() {  # LOG COMMAND...
  local log=$1 rc=0 pipe=$scratch/pipe reader
  shift
  [[ -p $pipe ]] || mkfifo -- "$pipe"
  cat -- "$pipe" >"$log" &
  reader=$!
  exec 3>"$pipe"  # held open between the contexts
  # shellcheck disable=SC2016
  env -u OCL_ICD_VENDORS -u OCL_ICD_FILENAMES -u HEMIRAY_DEVICE HEMIRAY_CACHE_DIR= \
    HEMIRAY_PROFILE="$here/oclgrind_profile.json" timeout -k 5 "${HEMIRAY_OCLGRIND_SECONDS:-120}" \
    oclgrind --build-options -cl-opt-disable --num-threads 1 --data-races --uninitialized --check-api \
    --max-errors 20 --log "$pipe" bash -c 'LD_PRELOAD=$0:$LD_PRELOAD exec "$@"' "$scratch/keep.so" "$@" 3>&- || rc=$?
  exec 3>&-
  wait "$reader"
  if ((rc == 124 || rc == 137)); then echo "run_oclgrind: no end within ${HEMIRAY_OCLGRIND_SECONDS:-120} s" >&2; fi
  if [[ -s $log ]]; then
    echo "run_oclgrind: Oclgrind reports:" >&2
    head -n 100 -- "$log" >&2
    if ((rc == 0)); then rc=1; fi
  fi
  return "$rc"
}

if [[ ${1:-} == -- ]]; then
  shift
  (($#)) || fail "a command must follow --"
  run_one "$scratch/log" "$@" || exit $?
  exit 0
fi

build=$(readlink -m -- "${1:-$here/../build/release}")
tests=$build/tests/tests_unit
[[ -x $tests ]] || fail "$tests is missing: build it first (./hemiray test -N builds all), or name the build folder"
passed=0 failed=0
for pattern in "${cases[@]}"; do
  mapfile -t names < <("$tests" --list-test-names-only "$pattern")
  ((${#names[@]})) || fail "no test case is called '$pattern': mend the list in tools/run_oclgrind.sh"
  for name in "${names[@]}"; do
    start=$SECONDS rc=0
    run_one "$scratch/log" "$tests" --warn NoTests "${name//,/\\,}" >"$scratch/output" 2>&1 || rc=$?
    if ((rc == 0)); then
      passed=$((passed + 1)) verdict=ok
    else
      failed=$((failed + 1)) verdict="FAILED (exit code $rc)"
      cat -- "$scratch/output"
    fi
    printf '%4d s  %s: %s\n' $((SECONDS - start)) "$name" "$verdict"
    rm -f -- "$scratch/log"
  done
done
# In the words of ctest, which .ci/run counts.
printf '%d%% tests passed, %d tests failed out of %d\n' $((100 * passed / (passed + failed))) "$failed" $((passed + failed))
((failed == 0))
