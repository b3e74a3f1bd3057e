#!/usr/bin/env bash
# Blender 4.3 and an X server without a screen, in a chroot of Debian 13. Needs root on Debian.
#
#   blender_chroot.sh setup          build the chroot unless it is there
#   blender_chroot.sh run COMMAND…   run a command in it
#
# Inside, the checkout and the temporary directory have the paths that they have outside, and the
# environment is the caller's. BLENDER_CHROOT names another directory for it than the default.
set -euo pipefail

checkout=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
directory=${BLENDER_CHROOT:-$checkout/.build/blender-4.3}
temporary=${TMPDIR:-/tmp}
packages=(blender python3-numpy xvfb xauth xdotool imagemagick libgl1-mesa-dri libegl1 libgl1 libsm6)

fail() {
  echo "blender_chroot.sh: $*" >&2
  exit 1
}

is_ready() { [[ -f $directory/.ready && $(<"$directory/.ready") == "${packages[*]}" ]]; }

# Mounts are in a namespace of the command's own: none outlives it, and none is there for an rm.
inside() { unshare --mount "${BASH_SOURCE[0]}" mount-and-run "$@"; }

((EUID == 0)) || fail "needs root"

case ${1:-} in
  setup)
    is_ready && exit
    command -v debootstrap >/dev/null || fail "needs debootstrap; run: apt-get install debootstrap"
    rm -rf --one-file-system "$directory"
    mkdir -p "$directory"
    debootstrap --variant=minbase trixie "$directory"
    DEBIAN_FRONTEND=noninteractive inside \
      apt-get install --quiet --yes --no-install-recommends "${packages[@]}"
    inside apt-get clean
    ln -sf /proc/self/mounts "$directory/etc/mtab" # Blender reads it
    echo "${packages[*]}" >"$directory/.ready"
    ;;
  run)
    is_ready || fail "there is no Blender in $directory; run: $0 setup"
    inside "${@:2}"
    ;;
  mount-and-run)
    mount -t proc proc "$directory/proc"
    mount --rbind /dev "$directory/dev"
    for shared in "$checkout" "$temporary"; do
      mkdir -p "$directory$shared"
      mount --bind "$shared" "$directory$shared"
    done
    [[ -d $directory$PWD ]] || cd /
    exec chroot "$directory" /usr/bin/env --chdir="$PWD" \
      PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin LC_ALL=C.UTF-8 "${@:2}"
    ;;
  *) fail "setup or run?" ;;
esac
