#!/usr/bin/env bash
# Installs a release's wheel, and its sdist, in Debians that have nothing but a Python, as a user does,
# and runs there the first script of the README and the first plot, without a display. Needs root on
# Debian.
#
#   bare.sh WHEEL SDIST [SUITE…]   suites of Debian, bookworm and trixie if none is named
#
# What builds the sdist is Debian's rustc-web, as its rustc is older than the crates allow.
set -euo pipefail
cd "$(dirname "$0")/../.."

wheel=$(realpath "$1") sdist=$(realpath "$2")
suites=("${@:3}")
((${#suites[@]})) || suites=(bookworm trixie)
scripts=$PWD/.build/release/bare/scripts
python3 tools/release/first_scripts.py "$scripts"

# try_in SUITE FILE PACKAGE…
try_in() {
  local suite=$1 file=$2
  local chroot=$PWD/.build/release/bare/$suite-${file##*.}
  tools/chroot.sh setup "$chroot" "$suite" python3-venv ca-certificates "${@:3}"
  printf '\n== %s in a bare %s\n' "$(basename "$file")" "$suite"
  # Caches and settings of the machine's own user, and its screen, are not a bare system's.
  env -i HOME=/root TERM=dumb ${TMPDIR:+TMPDIR="$TMPDIR"} \
    tools/chroot.sh run "$chroot" sh -euc '
      rm -rf /opt/tried
      python3 -m venv /opt/tried
      /opt/tried/bin/pip install --quiet --no-cache-dir "$1"
      cd /opt/tried
      bin/python "$2/first_script.py"
      bin/pip install --quiet --no-cache-dir "spectral-tv[cli,plot]" # of what is installed now
      bin/python "$2/first_plot.py"
      bin/spectral-tv --help >help.txt
      head -c 4 spectrum.png | tail -c 3
      echo ": spectrum.png, by $(bin/python --version), spectral_tv $(bin/python -c "
import spectral_tv
print(spectral_tv.__version__)")"' sh "$file" "$scripts"
}

for suite in "${suites[@]}"; do
  try_in "$suite" "$wheel"
  try_in "$suite" "$sdist" rustc-web cargo-web gcc libc6-dev
done
