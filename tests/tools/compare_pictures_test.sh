#!/bin/sh
# SPDX-License-Identifier: MIT
# compare_pictures_test.sh PROGRAM: figures and exit statuses of compare_pictures on small pictures made by hand.
program=$1
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
cd "$dir" || exit 1
failed=0

# expect STATUS TEXT ARGUMENT...: the status, and a line of output that contains the text.
expect() {
  want=$1 text=$2
  shift 2
  "$program" "$@" >out 2>&1
  status=$?
  if [ "$status" -ne "$want" ] || ! grep -qF -- "$text" out; then
    echo "compare_pictures $*: status $status, wanted $want and \"$text\":"
    cat out
    failed=1
  fi
}

echo 'P2 4 3 255  10 10 10 10  10 10 10 10  10 10 10 10' >flat.pgm
# Two pixels that touch at a corner, and one alone.
echo 'P2 4 3 255  13 10 10 10  10 12 10 10  10 10 10 60' >spots.pgm
# The whole of it off by one.
echo 'P2 4 3 255  11 11 11 11  11 11 11 11  11 11 11 11' >lifted.pgm
echo 'P2 3 4 255  10 10 10 10  10 10 10 10  10 10 10 10' >turned.pgm
echo 'P3 1 1 255  1 2 3' >color.ppm

expect 0 'differing pixels: 0 of 12 (0.0000 %)' flat.pgm flat.pgm
expect 0 'PSNR: inf dB' flat.pgm flat.pgm
expect 1 'differing pixels: 3 of 12 (25.0000 %)' flat.pgm spots.pgm
expect 1 'largest difference: 50 / 255' spots.pgm flat.pgm
expect 1 'largest patch: 2 pixels' flat.pgm spots.pgm
expect 1 'largest patch: 1 pixels' flat.pgm spots.pgm --tolerance 2.5
expect 0 'differing pixels: 3 of 12' flat.pgm spots.pgm --max-share 25
expect 1 'differing pixels: 3 of 12' flat.pgm spots.pgm --max-share 24.9
expect 0 'differing pixels: 1 of 12' --tolerance 3 flat.pgm spots.pgm --max-share 9
expect 1 'largest patch: 2 pixels' flat.pgm spots.pgm --max-share 100 --max-patch 1
expect 0 'largest patch: 2 pixels' flat.pgm spots.pgm --max-share 100 --max-patch 2
expect 0 'PSNR: 48.13 dB' flat.pgm lifted.pgm --tolerance 1
expect 1 'differing pixels: 12 of 12' flat.pgm lifted.pgm --max-patch 12
expect 1 'sizes differ: 4 x 3, 3 x 4' flat.pgm turned.pgm
expect 2 'two pictures are needed' flat.pgm
expect 2 'needs a value' flat.pgm flat.pgm --tolerance
expect 2 'is not a number' flat.pgm flat.pgm --tolerance -1
expect 2 'unknown option' flat.pgm flat.pgm --fuzz 1
expect 2 'missing.pgm: No such file' flat.pgm missing.pgm
echo 'no picture' >text
expect 2 'text: not a picture' flat.pgm text

# The difference picture keeps the size and the place: black but for the upper left, the middle and the lower right.
expect 1 'differing' flat.pgm spots.pgm --diff diff.png
echo "P2 4 3 255  0 0 0 0  0 0 0 0  0 0 0 0" >black.pgm
expect 1 "differing pixels: 3 of 12" diff.png black.pgm
echo "P2 4 3 255  75 0 0 0  0 67 0 0  0 0 0 255" >expected.pgm
expect 0 "differing pixels: 0 of 12" diff.png expected.pgm
exit $failed
