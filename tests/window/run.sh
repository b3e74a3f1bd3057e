#!/usr/bin/env bash
# Installs the built zip into Blender and has two sessions in its window, on an X server without a
# screen: one of a user, one of an impatient user. Needs xvfb-run, xdotool and ImageMagick.
# Pictures are in .build/screenshots.
set -euo pipefail
cd "$(dirname "$0")/../.."

blender=${BLENDER:-blender}
export PICTURES=$PWD/.build/screenshots
rm -rf "$PICTURES"
mkdir -p "$PICTURES"
BLENDER_USER_RESOURCES=$(mktemp -d)
export BLENDER_USER_RESOURCES
trap 'rm -rf "$BLENDER_USER_RESOURCES"' EXIT

# SCRIPT WIDTH HEIGHT: the window fills the screen, as events have the screen's coordinates.
have_session() {
  LIBGL_ALWAYS_SOFTWARE=1 xvfb-run --auto-servernum --server-args "-screen 0 $2x$3x24" \
    timeout 2100 $blender --window-geometry 0 0 "$2" "$3" --python-exit-code 1 \
    --python "tests/window/$1.py"
  # Blender exits with 0 also when it is closed before the end.
  [[ -f $PICTURES/$1.passed ]]
}

$blender --command extension install-file -r user_default --enable dist/spectral_tv-*.zip
have_session session 1280 2060
have_session stress 800 700
