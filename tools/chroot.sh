#!/usr/bin/env bash
# A chroot of Debian for what the machine itself shall not have. Needs root on Debian.
#
#   chroot.sh setup DIRECTORY SUITE PACKAGE…   build it, unless it is there with these packages;
#                                              PACKAGE:ARCHITECTURE adds the architecture
#   chroot.sh run DIRECTORY COMMAND…           run a command in it
#
# Inside, the checkout and the temporary directory have the paths that they have outside, and the
# environment is the caller's. A variable MOUNT=OUTSIDE:INSIDE shows one more directory.
set -euo pipefail

checkout=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
temporary=${TMPDIR:-/tmp}

fail() {
  echo "chroot.sh: $*" >&2
  exit 1
}

((EUID == 0)) || fail "needs root"
(($# >= 3)) || fail "setup DIRECTORY SUITE PACKAGE… or run DIRECTORY COMMAND…?"
verb=$1 directory=$2

# Mounts are in a namespace of the command's own: none outlives it, and none is there for an rm.
inside() { unshare --mount "${BASH_SOURCE[0]}" mount-and-run "$directory" "$@"; }

case $verb in
  setup)
    suite=$3 packages=("${@:4}")
    [[ -f $directory/.ready && $(<"$directory/.ready") == "${packages[*]}" ]] && exit
    command -v debootstrap >/dev/null || fail "needs debootstrap; run: apt-get install debootstrap"
    rm -rf --one-file-system "$directory"
    mkdir -p "$directory"
    debootstrap --variant=minbase "$suite" "$directory"
    sed -n 's|/debian/\{0,1\} \([a-z]*\) main|/debian-security \1-security main|p' \
      "$directory/etc/apt/sources.list" >"$directory/etc/apt/sources.list.d/security.list"
    echo force-unsafe-io >"$directory/etc/dpkg/dpkg.cfg.d/unsafe-io" # it can be built anew
    for package in "${packages[@]}"; do
      [[ $package != *:* ]] || inside dpkg --add-architecture "${package#*:}"
    done
    inside apt-get update
    DEBIAN_FRONTEND=noninteractive inside \
      apt-get install --quiet --yes --no-install-recommends "${packages[@]}"
    inside apt-get clean
    certificates=/etc/ssl/certs/ca-certificates.crt # with those of the machine's own network
    [[ ! -f $directory$certificates ]] || cp --dereference "$certificates" "$directory$certificates"
    ln -sf /proc/self/mounts "$directory/etc/mtab" # Blender reads it
    echo "${packages[*]}" >"$directory/.ready"
    ;;
  run)
    [[ -f $directory/.ready ]] || fail "there is no chroot in $directory"
    inside "${@:3}"
    ;;
  mount-and-run)
    mount -t proc proc "$directory/proc"
    mount --rbind /dev "$directory/dev"
    for shared in "$checkout" "$temporary" "${MOUNT:-}"; do
      [[ -n $shared ]] || continue
      target=$directory${shared#*:}
      mkdir -p "$target"
      mount --bind "${shared%%:*}" "$target"
    done
    [[ -d $directory$PWD ]] || cd /
    exec chroot "$directory" /usr/bin/env --chdir="$PWD" \
      PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin LC_ALL=C.UTF-8 "${@:3}"
    ;;
  *) fail "setup or run?" ;;
esac
