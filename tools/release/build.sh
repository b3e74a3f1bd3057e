#!/usr/bin/env bash
# Builds the last commit's sdist, and its wheels and extension zips for every platform or for those
# named, into dist/release/. Needs root on Debian 12, with Python and debootstrap: the compilers are in
# a chroot of their own, .build/release/toolchain or TOOLCHAIN_CHROOT, and so is Blender, which builds
# the zips.
#
#   build.sh [PLATFORM…]   of linux-x64 linux-arm64 windows-x64 windows-arm64 macos-arm64 macos-x64,
#                          which Blender has, and linux-x64-3.14t linux-x64-musl linux-arm64-musl
#
# The same commit and compilers give the same files; BUILT-WITH.txt names them.
set -euo pipefail
cd "$(dirname "$0")/../.."

platforms=("$@")
(($#)) || platforms=(linux-x64 linux-arm64 windows-x64 windows-arm64 macos-arm64 macos-x64
  linux-x64-3.14t linux-x64-musl linux-arm64-musl)
chroot=${TOOLCHAIN_CHROOT:-$PWD/.build/release/toolchain}
source=$PWD/.build/release/source
output=$PWD/dist/release

# rustc-web is as new as Debian's browser needs it, and comes with the sources of std.
tools/chroot.sh setup "$chroot" bookworm \
  rustc-web cargo-web rust-web-src libstd-rust-web-dev libstd-rust-web-dev:arm64 gcc libc6-dev \
  gcc-mingw-w64-x86-64-posix mingw-w64-tools python3.11 python3.11-venv ca-certificates

tools/blender_chroot.sh setup # for the zips

# A clone has no uncommitted change, and keeps the times of unchanged files for Cargo.
[[ -z $(git status --porcelain) ]] || echo "build.sh: uncommitted changes are left out" >&2
commit=$(git rev-parse HEAD)
[[ -d $source ]] || git clone --quiet --no-checkout . "$source"
git -C "$source" fetch --quiet "$PWD" "$commit"
git -C "$source" checkout --quiet --force --detach "$commit"

rm -rf "$output"
mkdir -p "$output"
SOURCE_DATE_EPOCH=$(git -C "$source" show --no-patch --format=%ct)
export SOURCE_DATE_EPOCH
# Where it is built stands in panic messages: always in the same place.
in_chroot() { MOUNT=$source:/spectral_tv tools/chroot.sh run "$chroot" "$@"; }
{
  echo "commit $commit"
  in_chroot /spectral_tv/tools/release/wheel.sh versions
} | tee "$output/BUILT-WITH.txt"
for made in sdist "${platforms[@]}"; do
  in_chroot /spectral_tv/tools/release/wheel.sh "$made"
  mv "$source"/dist/* "$output"
done
shopt -s nullglob
zipped=("$output"/*-abi3-{manylinux,win,macosx}*.whl)
((!${#zipped[@]})) || python3 "$source/tools/extension.py" --split --blender "$PWD/tools/blender" \
  --output "$output" "${zipped[@]}"
cd "$output"
sha256sum -- *.tar.gz *.whl *.zip | tee SHA256SUMS
