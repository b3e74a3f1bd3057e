#!/bin/sh
# Runs the compiler, for cargo. Before, it corrects the list of exports that maturin 1.16 writes for Zig's
# linker on Windows: it has PyInit_ with the whole name of the module, of which Python wants the last part.
exports=$CARGO_TARGET_DIR/maturin/spectral_tv._native.def
[ ! -f "$exports" ] || sed -i 's/spectral_tv\._native/_native/' "$exports"
exec "$@"
