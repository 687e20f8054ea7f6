#!/bin/bash
# SPDX-License-Identifier: MIT
# usage: render.sh HOSTFILE [PAFAS-OPTION...] -O PICTURE SCENE
#
# Renders one picture on the machines that a host file names, one per line with the ranks that each may have:
#   node1 slots=8
#   node2 slots=4
# Only the machine that this is started on needs the scene. With --enable-recovery (Open MPI) the job outlives machines
# that die; mpirun then always says 0, so the outcome is taken from the statistics.
set -euo pipefail
hosts=${1:?usage: render.sh HOSTFILE [PAFAS-OPTION...] -O PICTURE SCENE}
shift
statistics=$(mktemp)
trap 'rm -f "$statistics"' EXIT
mpirun --hostfile "$hosts" --enable-recovery --bind-to none "${PAFAS:-pafas}" --stats "$statistics" "$@"
grep -q '"outcome": *"complete"' "$statistics"
