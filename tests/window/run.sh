#!/usr/bin/env bash
# Installs the built zip into Blender and has a session in its window, on an X server without a
# screen. Needs xvfb-run, xdotool and ImageMagick. Pictures are in .build/screenshots.
set -euo pipefail
cd "$(dirname "$0")/../.."

blender=${BLENDER:-blender}
export PICTURES=$PWD/.build/screenshots
rm -rf "$PICTURES"
mkdir -p "$PICTURES"
BLENDER_USER_RESOURCES=$(mktemp -d)
export BLENDER_USER_RESOURCES
trap 'rm -rf "$BLENDER_USER_RESOURCES"' EXIT

$blender --command extension install-file -r user_default --enable dist/spectral_tv-*.zip
LIBGL_ALWAYS_SOFTWARE=1 xvfb-run --auto-servernum --server-args "-screen 0 1280x1400x24" \
  timeout 600 $blender --window-geometry 0 0 1280 1400 --python-exit-code 1 \
  --python tests/window/session.py
# Blender exits with 0 also when it is closed before the end.
[[ -f $PICTURES/passed ]]
