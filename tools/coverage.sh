#!/usr/bin/env bash
# Measures how much of the library, the bindings and the extension the tests reach: make coverage.
#
# Needs cargo-llvm-cov, and llvm-profdata and llvm-cov of the compiler's LLVM (rustc -vV): those of
# rustup's llvm-tools, of Debian's llvm-22, or what LLVM_PROFDATA and LLVM_COV name.
set -euo pipefail
cd "$(dirname "$0")/.."
python=$PWD/.venv/bin/python
version=$(rustc -vV | sed -n 's/^LLVM version: \([0-9]*\).*/\1/p')
for tool in profdata cov; do
  variable=LLVM_${tool^^}
  if [[ -z ${!variable:-} ]] && command -v "llvm-$tool-$version" >/dev/null; then
    export "$variable=$(command -v "llvm-$tool-$version")"
  fi
done

environment=$(cargo llvm-cov show-env --sh)
eval "$environment"
export CARGO_TARGET_DIR=$PWD/target/coverage CARGO_LLVM_COV_TARGET_DIR=$PWD/target/coverage
export LLVM_PROFILE_FILE=$CARGO_TARGET_DIR/spectral_tv-%p-%4m.profraw
export CARGO_PROFILE_RELEASE_STRIP=none CARGO_PROFILE_RELEASE_LTO=off
cargo llvm-cov clean --workspace
cargo test --workspace --release --quiet

# The package with instrumented bindings, ahead of the installed one.
PYO3_BUILD_EXTENSION_MODULE=1 cargo build --package spectral-tv-python --release --quiet
package=$CARGO_TARGET_DIR/package
mkdir -p "$package/spectral_tv"
cp python/spectral_tv/*.py* "$package/spectral_tv"
cp "$CARGO_TARGET_DIR/release/lib_native.so" "$package/spectral_tv/_native.abi3.so"
export PYTHONPATH=$package COVERAGE_FILE=$CARGO_TARGET_DIR/data
"$python" -m coverage run --parallel-mode -m pytest tests "$@"

cargo llvm-cov report --release --ignore-filename-regex '/(tests|registry)/' --summary-only |
  tee "$CARGO_TARGET_DIR/rust.txt"
"$python" -m coverage combine --quiet
"$python" -m coverage report | tee "$CARGO_TARGET_DIR/extension.txt"
