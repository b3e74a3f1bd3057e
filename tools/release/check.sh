#!/usr/bin/env bash
# Checks what build.sh left in dist/release: the sdist, the wheels, each as far as it can be run here,
# and the zip for Linux in Blender. Stops at the first thing that is wrong. Needs root on Debian 12.
#
#   check.sh [PART…]   of wheels results packages bare docs reproducible flaws tests blender, or all
#
# flaws needs GitHub, and what PyPI tells of flaws.
set -euo pipefail
cd "$(dirname "$0")/../.."

release=$PWD/dist/release
results=$PWD/.build/release/results
python=$PWD/.venv/bin/python
place=tools/release/place.sh

say() { printf '\n== %s\n' "$*"; }

fail() {
  echo "check.sh: that is wrong: $*" >&2
  exit 1
}

# Where each wheel is run; macOS, and Windows and musl on arm64, have no such place.
places() {
  case $1 in
    *abi3-manylinux*x86_64.whl) echo linux-x64 ;;
    *cp314t-manylinux*x86_64.whl) echo linux-x64-3.14t ;;
    *musllinux*x86_64.whl) echo linux-x64-musl ;;
    *manylinux*aarch64.whl) echo linux-arm64 ;;
    *win_amd64.whl) echo windows-x64 windows-x64-3.13 ;;
  esac
}

# Checks without running.
wheels() {
  "$python" -m pip install --quiet --group release-check
  for wheel in "$release"/*.whl; do
    say "$(basename "$wheel")"
    [[ $wheel != *-abi3-* ]] || "$python" -m abi3audit --strict --summary "$wheel"
    case $wheel in
      *manylinux*) # it needs no newer glibc than its name says
        shown=$("$python" -m auditwheel show "$wheel")
        tag=$(basename "$wheel" .whl | cut -d - -f 5)
        [[ ${shown//[[:space:]]/ } == *"platform tag: \"$tag\""* ]] || fail "$shown"
        ;;
      *musllinux*) # it needs no library but musl; auditwheel would take glibc's libc.so for that
        rm -rf .build/release/unpacked
        "$python" -m zipfile --extract "$wheel" .build/release/unpacked
        shown=$(readelf --dynamic .build/release/unpacked/spectral_tv/_native.abi3.so | grep NEEDED)
        [[ $shown == *"[libc.so]" && $(wc -l <<<"$shown") == 1 ]] || fail "$shown"
        ;;
      *win_*) # it needs no library but Windows' and Python's
        shown=$("$python" -m delvewheel show "$wheel")
        [[ $shown == *"will be copied into the wheel."[[:space:]]*"None"* ]] || fail "$shown"
        ;;
      *macosx*) shown=$("$python" -m tools.release.mach_o "$wheel") ;;
    esac
    echo "$shown"
  done
  say zips
  (cd "$release" && sha256sum --check SHA256SUMS)
  tools/blender_chroot.sh setup
  for zip in "$release"/*.zip; do
    tools/blender --command extension validate "$zip"
  done
}

# What goes to PyPI and crates.io, and whose licences go along.
packages() {
  say "the page of the package"
  "$python" -m pip install --quiet --group release-check
  "$python" -m twine check --strict "$release"/*.whl "$release"/*.tar.gz
  say "the licences of what is built in"
  make deny DENY="licenses bans sources"
  make notices NOTICES=.build/release/notices.txt
  cmp .build/release/notices.txt THIRD_PARTY_LICENSES.txt || fail "they are not those of what is built in"
  say "the recipe for conda-forge"
  "$python" -m tools.release.conda "$release"/*.tar.gz .build/release/conda
  say "the crates"
  cargo publish --dry-run --locked --package spectral-tv-system --package spectral-tv
}

# The package where there is nothing but a Python.
bare() {
  tools/release/bare.sh "$release"/*abi3-manylinux*x86_64.whl "$release"/*.tar.gz
}

docs() {
  make docs
}

reproducible() {
  tools/release/reproducible.sh
}

# Known ones, of the crates that are built in and of the packages that ours needs.
flaws() {
  make deny DENY=advisories
  "$python" -m pip install --quiet --group release-check
  "$python" -m pip_audit --strict "$PWD"
}

# The package's tests on every platform that is here or can be emulated. What a place has no library for is
# skipped, and told. On arm64 of the mathematics only what compares with the reference is run, as qemu is slow,
# and nothing that judges by the clock or by memory. In Windows' Python 3.13 none of it is, as it has no SciPy.
tests() {
  for wheel in "$release"/*.whl; do
    for name in $(places "$wheel"); do
      say "tests on $name"
      tested=(-p tools.release.lacking -rs tests/package tests/mathematics)
      case $name in
        linux-x64) tested=(tests/package tests/mathematics) ;;
        *-3.13) tested=(-p tools.release.lacking -rs tests/package) ;;
        *-arm64) tested=(-p tools.release.lacking -rs -m "not bare" tests/package tests/mathematics/*agreement.py) ;;
      esac
      $place setup "$name" "$wheel"
      $place run "$name" -m pytest -p no:cacheprovider "${tested[@]}"
    done
  done
}

# The same numbers everywhere as on Linux on x86-64.
results() {
  mkdir -p "$results"
  $place setup linux-x64 "$release"/*abi3-manylinux*x86_64.whl
  $place run linux-x64 tools/release/results.py meshes "$results/meshes.npz"
  others=()
  for wheel in "$release"/*.whl; do
    for name in $(places "$wheel"); do
      say "results on $name"
      $place setup "$name" "$wheel"
      $place run "$name" tools/release/results.py compute "$results/meshes.npz" "$results/$name.npz"
      [[ $name == linux-x64 ]] || others+=("$results/$name.npz")
    done
  done
  "$python" tools/release/results.py compare "$results/linux-x64.npz" "${others[@]}"
}

# The zip for Linux in the real program, and in bpy of several versions.
blender() {
  tools/blender_chroot.sh setup
  export SPECTRAL_TV_ZIP EVERY_CASE=1
  SPECTRAL_TV_ZIP=$(echo "$release"/*-linux_x64.zip)
  # All that lies beside bpy but the checkout's own package, which would be found before the zip's.
  local packages=$PWD/.build/release/bpy
  rm -rf "$packages"
  mkdir -p "$packages"
  for package in .venv/lib/python3*/site-packages/*; do
    [[ $package == */spectral_tv* ]] || ln -s "$PWD/$package" "$packages"
  done
  PYTHONPATH=$packages BLENDER=$PWD/tools/blender "$python" -s -S -m pytest tests/blender
  PYTHON_3_13="$PWD/tools/blender_chroot.sh run python3.13" tools/test_bpy.sh
}

(($#)) || set -- wheels results packages bare docs reproducible flaws tests blender
for part in "$@"; do
  "$part"
done
say "all of it is right"
