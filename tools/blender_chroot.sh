#!/usr/bin/env bash
# Blender 4.3 and an X server without a screen, in a chroot of Debian 13. Needs root on Debian.
#
#   blender_chroot.sh setup          build the chroot unless it is there
#   blender_chroot.sh run COMMAND…   run a command in it
#
# What is seen inside, chroot.sh says. BLENDER_CHROOT names another directory than the default.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
directory=${BLENDER_CHROOT:-$(dirname "$here")/.build/blender-4.3}

case ${1:-} in
  setup)
    exec "$here/chroot.sh" setup "$directory" trixie \
      blender python3-numpy xvfb xauth xdotool imagemagick libgl1-mesa-dri libegl1 libgl1 libsm6
    ;;
  run)
    [[ -f $directory/.ready ]] || echo "there is no Blender yet; run: $0 setup" >&2
    exec "$here/chroot.sh" run "$directory" "${@:2}"
    ;;
  *)
    echo "blender_chroot.sh: setup or run?" >&2
    exit 2
    ;;
esac
