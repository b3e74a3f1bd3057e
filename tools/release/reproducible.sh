#!/usr/bin/env bash
# Builds what build.sh builds for Linux on x86-64 twice, from clones of the last commit in two
# directories, each with all crates compiled anew, and fails unless the files are the same, byte for
# byte. Needs what build.sh needs, and uses its chroots.
set -euo pipefail
cd "$(dirname "$0")/../.."

place=$PWD/.build/reproducible
export TOOLCHAIN_CHROOT=$PWD/.build/release/toolchain
export BLENDER_CHROOT=${BLENDER_CHROOT:-$PWD/.build/blender-4.3}
export BUILD_CACHE=/var/cache/reproducible
rm -rf "$place"
for name in one another/below; do
  rm -rf "$TOOLCHAIN_CHROOT$BUILD_CACHE"
  git clone --quiet . "$place/$name"
  "$place/$name/tools/release/build.sh" linux-x64
done
rm -rf "$TOOLCHAIN_CHROOT$BUILD_CACHE"
diff --recursive "$place/one/dist/release" "$place/another/below/dist/release"
echo "the two builds are the same"
