# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced by the scripts beside it: where things are, what they run on, and tables in docs/.
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
databases=(balls gears mount rings teapot tetra tree)

# fail MESSAGE
fail() {
  echo "$(basename "$0"): $1" >&2
  exit 2
}

# cached BUILD NAME: a variable of the build's CMake cache.
cached() { sed -n "s/^$2:[^=]*=//p" "$1/CMakeCache.txt"; }

# environment BUILD: processor, cores, compiler and our version, as a list.
environment() {
  local compiler
  compiler=$(cached "$1" CMAKE_CXX_COMPILER)
  echo "- processor: $(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -1), $(nproc) cores"
  echo "- compiler: $("$compiler" --version | head -1), $(cached "$1" CMAKE_BUILD_TYPE)"
  echo "- $("$1/bin/rayshade" --version | head -1)"
}

# write_section NAME [PAGE]: puts standard input between the markers of that name in docs/PAGE (performance.md).
write_section() {
  local page=$source/docs/${2:-performance.md} begin="<!-- $1: begin -->" end="<!-- $1: end -->" text
  grep -qxF "$begin" "$page" && grep -qxF "$end" "$page" || fail "no markers '$1' in $page"
  text=$(mktemp) && cat > "$text"
  awk -v begin="$begin" -v end="$end" -v text="$text" '
    $0 == end { inside = 0 }
    !inside { print }
    $0 == begin { inside = 1; while ((getline line < text) > 0) print line }' "$page" > "$text.page"
  cat "$text.page" > "$page"
  rm -f "$text" "$text.page"
}
