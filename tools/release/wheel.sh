#!/usr/bin/env bash
# Builds the wheel of one platform, or the sdist, in the chroot that build.sh makes, the checkout at
# /spectral_tv. Crates are compiled into BUILD_CACHE.
#
#   wheel.sh PLATFORM | sdist | versions
set -euo pipefail
cd /spectral_tv

tools=/opt/tools
if ! cmp --silent pyproject.toml $tools/installed.toml; then
  python3.11 -m venv --clear $tools
  $tools/bin/pip install --quiet --upgrade "pip>=25.1"
  $tools/bin/pip install --quiet --group release
  cp pyproject.toml $tools/installed.toml
fi
export PATH=$tools/bin:$PATH CARGO_HOME=/var/cache/cargo
unset RUSTUP_TOOLCHAIN RUSTFLAGS RUSTC_BOOTSTRAP

build() {
  # Directories apart: what runs while building is compiled anew wherever RUSTC_BOOTSTRAP changes.
  export CARGO_TARGET_DIR=${BUILD_CACHE:-/var/cache}/target${RUSTC_BOOTSTRAP:+-with-std}
  maturin build --release --locked --interpreter "${INTERPRETER:-python3.11}" --out dist --target "$@"
}

linux() { build "$1" --zig --compatibility manylinux_2_28; }

# Debian has no std for these targets: it is built from its sources.
build_with_std() {
  export RUSTC_BOOTSTRAP=1
  build "$@" -Z "build-std=std,panic_unwind"
}

musl() { build_with_std "$1" --zig --compatibility musllinux_1_2; }

mac() {
  export MACOSX_DEPLOYMENT_TARGET=11.0 # as old as NumPy's wheels
  export SDKROOT=/var/empty            # zig brings what is linked with
  # Stripping afterwards would break the signature that the linker writes.
  export CARGO_PROFILE_RELEASE_STRIP=false MATURIN_STRIP=false
  build_with_std "$1" --zig
}

rm -rf dist
case $1 in
  linux-x64) linux x86_64-unknown-linux-gnu ;;
  linux-arm64) linux aarch64-unknown-linux-gnu ;;
  # What a Python without a GIL loads has no stable ABI before 3.15; PyO3 then leaves abi3 off.
  linux-x64-3.14t) INTERPRETER=python3.14t linux x86_64-unknown-linux-gnu ;;
  linux-x64-musl) musl x86_64-unknown-linux-musl ;;
  linux-arm64-musl) musl aarch64-unknown-linux-musl ;;
  windows-x64) build_with_std x86_64-pc-windows-gnu ;;
  windows-arm64)
    export RUSTC_WRAPPER=$PWD/tools/release/exports.sh
    build_with_std aarch64-pc-windows-gnullvm --zig
    ;;
  macos-arm64) mac aarch64-apple-darwin ;;
  macos-x64) mac x86_64-apple-darwin ;;
  sdist) maturin sdist --out dist ;;
  versions)
    rustc --version
    maturin --version
    echo "zig $(python-zig version)"
    x86_64-w64-mingw32-gcc --version | head -n 1
    ;;
  *)
    echo "wheel.sh: no platform '$1'" >&2
    exit 2
    ;;
esac
