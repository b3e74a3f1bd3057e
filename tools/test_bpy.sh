#!/usr/bin/env bash
# Runs the extension's tests in pip's bpy of other versions than the one developed with.
# PYTHON and PYTHON_3_13 name the interpreters, or command lines; the latter may be missing.
set -euo pipefail
cd "$(dirname "$0")/.."

# Not to the interpreter's end: bpy 4.2 crashes there once an add-on has registered classes.
run_pytest='import os, sys, pytest
status = pytest.main(sys.argv[1:])
sys.stdout.flush()
os._exit(status)'

# test_in PYTHON ITS_VERSION BPY_VERSION REQUIREMENT…
test_in() {
  local packages=.build/bpy-$3
  local requirements="bpy==$3 pytest>=9 openexr>=3.3 pillow>=10.1 pypng tifffile ${*:4}"
  if [[ ! -f $packages/.installed || $(<"$packages/.installed") != "$requirements" ]]; then
    rm -rf "$packages"
    # shellcheck disable=SC2086  # a list of words
    .venv/bin/python -m pip install --quiet --no-warn-conflicts --target "$packages" \
      --python-version "$2" --only-binary :all: $requirements
    echo "$requirements" >"$packages/.installed"
  fi
  echo "bpy $3:"
  # The tools take packages of the development's environment.
  # shellcheck disable=SC2086  # a command line
  PYTHONPATH=$packages PYTEST_DISABLE_PLUGIN_AUTOLOAD=1 $1 -s -c "$run_pytest" \
    -m "not executable" --ignore tests/blender/test_bench_posing.py \
    --ignore tests/blender/test_limb_turns.py tests/blender
}

python=${PYTHON:-python3.11}
test_in "$python" 3.11 4.2.23 numpy==1.24.3 # the NumPy that Blender 4.2 comes with
test_in "$python" 3.11 4.5.15
if [[ -n ${PYTHON_3_13:-} ]] || python3.13 --version >/dev/null 2>&1; then
  test_in "${PYTHON_3_13:-python3.13}" 3.13 5.2.3
else
  echo "bpy 5.2 is skipped: there is no python3.13, and PYTHON_3_13 names none"
fi
