#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: fas_test.sh BUILD CXX SANITIZE: installs the library into a folder that is then moved, builds the example
# against it with the CMake package and with pkg-config, and compares what the two print with what is expected.
set -euo pipefail
build=$1 cxx=$2 sanitize=$3
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
flags=${sanitize:+-fsanitize=$sanitize}

cmake --install "$build" --component fas --prefix "$folder/first" > "$folder/log" || { cat "$folder/log"; exit 1; }
mv "$folder/first" "$folder/prefix"
example=$folder/prefix/share/doc/fas/examples/spheres.cpp
header=$folder/prefix/include/fas/fas.h
[ -f "$header" ] && [ "$(ls "$folder/prefix/include/fas" | wc -l)" = 1 ] || { echo "not one public header"; exit 1; }
if grep -n '#include "' "$header"; then echo "the public header needs others"; exit 1; fi

cmake -S "$here/stranger" -B "$folder/stranger" -DCMAKE_PREFIX_PATH="$folder/prefix" -DEXAMPLE="$example" \
  -DCMAKE_CXX_COMPILER="$cxx" -DCMAKE_CXX_FLAGS="$flags" > "$folder/log" 2>&1 &&
  cmake --build "$folder/stranger" >> "$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
"$folder/stranger/spheres" > "$folder/by_cmake"

pc=$(find "$folder/prefix" -name fas.pc)
export PKG_CONFIG_PATH=$(dirname "$pc")
# The words are options.
# shellcheck disable=SC2046
"$cxx" -std=c++20 -Wall -Wextra -Wpedantic -Werror $flags "$example" -o "$folder/spheres" $(pkg-config --cflags --libs fas)
"$folder/spheres" > "$folder/by_pkg_config"

diff "$here/spheres.txt" "$folder/by_cmake"
diff "$here/spheres.txt" "$folder/by_pkg_config"
MANWIDTH=80 man -l --warnings "$folder"/prefix/share/man/man3/fas.3 2> "$folder/log" > /dev/null
if [ -s "$folder/log" ]; then cat "$folder/log"; exit 1; fi
