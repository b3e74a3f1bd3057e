#!/usr/bin/env bash
# Builds the wheel of one platform in the chroot that build.sh makes, the checkout at /spectral_tv.
#
#   wheel.sh PLATFORM | versions
set -euo pipefail
cd /spectral_tv

tools=/opt/tools
if ! cmp --silent pyproject.toml $tools/installed.toml; then
  python3.11 -m venv --clear $tools
  $tools/bin/pip install --quiet --upgrade "pip>=25.1"
  $tools/bin/pip install --quiet --group release
  cp pyproject.toml $tools/installed.toml
fi
export PATH=$tools/bin:$PATH CARGO_HOME=/var/cache/cargo CARGO_TARGET_DIR=/var/cache/target
unset RUSTUP_TOOLCHAIN RUSTFLAGS

# Debian has no std for these targets: it is built from its sources.
build_std=(-Z "build-std=std,panic_unwind")
zig_linux=(--zig --compatibility manylinux_2_28)

build() {
  local target=$1
  maturin build --release --locked --interpreter python3.11 --target "$target" --out dist "${@:2}"
}

mac() {
  export MACOSX_DEPLOYMENT_TARGET=11.0 # as old as NumPy's wheels
  export SDKROOT=/var/empty            # zig brings what is linked with
  # Stripping afterwards would break the signature that the linker writes.
  export CARGO_PROFILE_RELEASE_STRIP=false MATURIN_STRIP=false
  RUSTC_BOOTSTRAP=1 build "$1" --zig "${build_std[@]}"
}

rm -rf dist
case $1 in
  linux-x64) build x86_64-unknown-linux-gnu "${zig_linux[@]}" ;;
  linux-arm64) build aarch64-unknown-linux-gnu "${zig_linux[@]}" ;;
  windows-x64) RUSTC_BOOTSTRAP=1 build x86_64-pc-windows-gnu "${build_std[@]}" ;;
  windows-arm64) RUSTC_BOOTSTRAP=1 build aarch64-pc-windows-gnullvm --zig "${build_std[@]}" ;;
  macos-arm64) mac aarch64-apple-darwin ;;
  macos-x64) mac x86_64-apple-darwin ;;
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
