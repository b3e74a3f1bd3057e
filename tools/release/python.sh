#!/usr/bin/env bash
# CPythons that Debian 12 has no packages of, compiled from Debian's sources in a chroot. Needs root on
# Debian.
#
#   python.sh setup KIND   compile it unless it is there
#   python.sh run KIND …   run it with these arguments
#
# KIND is 3.14t (without a GIL) or musl (linked to musl in place of glibc; 3.13).
set -euo pipefail
cd "$(dirname "$0")/../.."

verb=$1 kind=$2
chroot=$PWD/.build/release/pythons
in_chroot() { tools/chroot.sh run "$chroot" "$@"; }

setup() {
  tools/chroot.sh setup "$chroot" trixie \
    gcc libc6-dev make musl-tools zlib1g-dev libffi-dev libssl-dev autoconf automake libtool libltdl-dev \
    dpkg-dev xz-utils ca-certificates
  [[ ! -x $chroot/opt/$kind/bin/python3 ]] || return 0
  echo "compiling a CPython of kind $kind into $chroot"
  in_chroot nice bash -euo pipefail -c "$(declare -f unpack compile_3.14t compile_musl)
    rm -rf /opt/build
    mkdir /opt/build
    cd /opt/build
    compile_$kind"
}

# unpack SUITE PACKAGE DIRECTORY: the authors' own sources, whose hashes the suite's signed index has
unpack() {
  echo "deb-src http://deb.debian.org/debian $1 main" >/etc/apt/sources.list.d/sources.list
  apt-get update --quiet
  mkdir "$3" "$3.download"
  (cd "$3.download" && apt-get source --quiet --download-only --tar-only "$2")
  tar --extract --file "$3.download"/*.orig.tar.?z --directory "$3" --strip-components 1
}

compile_3.14t() {
  unpack sid python3.14 python
  cd python
  ./configure --quiet --disable-gil --disable-test-modules --prefix=/opt/3.14t
  make --silent --jobs 2 install
}

# With what pip and NumPy need, and none of what else the machine has: that is linked to glibc.
compile_musl() {
  # It would name glibc's directories, which configure refuses.
  printf '#!/bin/sh\n[ "$1" = --print-multiarch ] || exec musl-gcc "$@"\n' >cc
  chmod +x cc
  export CC=$PWD/cc CFLAGS="-O2 -fPIC"
  unpack trixie zlib zlib
  (cd zlib && ./configure --static --prefix=/opt/musl-libraries && make --silent install)
  unpack trixie libffi libffi
  (cd libffi && ./autogen.sh && ./configure --quiet --disable-shared --disable-docs \
    --disable-multi-os-directory --disable-exec-static-tramp --prefix=/opt/musl-libraries &&
    make --silent install)
  unpack trixie python3.13 python
  cd python
  export PKG_CONFIG_LIBDIR=/opt/musl-libraries/lib/pkgconfig
  ./configure --quiet --disable-test-modules --prefix=/opt/musl \
    CPPFLAGS=-I/opt/musl-libraries/include LDFLAGS=-L/opt/musl-libraries/lib \
    LIBFFI_CFLAGS=-I/opt/musl-libraries/include LIBFFI_LIBS=-lffi
  make --silent --jobs 2 install
}

run() { in_chroot "/opt/$kind/bin/python3" "$@"; }

"$verb" "${@:3}"
