#!/usr/bin/env bash
# Runs the extension's tests in pip's bpy of other versions than the one developed with: the first case of
# each, or all if EVERY_CASE is set.
# PYTHON and PYTHON_3_13 name the interpreters, or command lines; the latter may be missing.
set -euo pipefail
cd "$(dirname "$0")/.."

# Not to the interpreter's end: bpy 4.2 crashes there once an add-on has registered classes.
run_pytest='import os, sys, pytest
status = pytest.main(sys.argv[1:])
sys.stdout.flush()
os._exit(status)'

# install ITS_VERSION BPY_VERSION REQUIREMENT…
install() {
  local packages=.build/bpy-$2
  local requirements="bpy==$2 pytest>=9 openexr>=3.3 pillow>=10.1 pypng tifffile ${*:3}"
  if [[ ! -f $packages/.installed || $(<"$packages/.installed") != "$requirements" ]]; then
    rm -rf "$packages"
    # shellcheck disable=SC2086  # a list of words
    .venv/bin/python -m pip install --quiet --no-warn-conflicts --target "$packages" \
      --python-version "$1" --only-binary :all: $requirements
    echo "$requirements" >"$packages/.installed"
  fi
}

one_case=(--one-case)
[[ -z ${EVERY_CASE:-} ]] || one_case=()

# test_in PYTHON BPY_VERSION: what it prints goes to a file.
test_in() {
  # The tools take packages of the development's environment.
  # shellcheck disable=SC2086  # a command line
  PYTHONPATH=.build/bpy-$2 PYTEST_DISABLE_PLUGIN_AUTOLOAD=1 $1 -s -c "$run_pytest" \
    -m "not executable and not once" --ignore tests/blender/test_bench_posing.py \
    --ignore tests/blender/test_limb_turns.py "${one_case[@]}" tests/blender >".build/bpy-$2.txt" 2>&1
}

python=${PYTHON:-python3.11}
newer=${PYTHON_3_13:-python3.13}
install 3.11 4.2.23 numpy==1.24.3 # the NumPy that Blender 4.2 comes with
install 3.11 4.5.15
# With no job left, kill fails, and that would be this script's exit code.
trap 'kill $(jobs -p) 2>/dev/null || true' EXIT
declare -A runs
test_in "$python" 4.2.23 &
runs[4.2.23]=$!
test_in "$python" 4.5.15 &
runs[4.5.15]=$!
# shellcheck disable=SC2086  # a command line
if $newer --version >/dev/null 2>&1; then
  install 3.13 5.2.3
  test_in "$newer" 5.2.3 &
  runs[5.2.3]=$!
else
  echo "bpy 5.2 is skipped: there is no python3.13, and PYTHON_3_13 names none"
fi
# Those that failed come last, where the end of a log is all that one sees.
failed=()
for version in "${!runs[@]}"; do
  if wait "${runs[$version]}"; then
    echo "bpy $version: $(tail -n 1 ".build/bpy-$version.txt")"
  else
    failed+=("$version: exit code $?")
  fi
done
for failure in "${failed[@]}"; do
  cat ".build/bpy-${failure%%:*}.txt"
  # Once more where Python was when Blender crashed: the middle of a long log may be left out.
  grep --after-context 12 "Fatal Python error" ".build/bpy-${failure%%:*}.txt" || true
  echo "bpy $failure"
done
exit $((${#failed[@]} > 0))
