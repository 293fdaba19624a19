#!/usr/bin/env bash
# Usage: check_includes_test.sh CHECK_SCRIPT: plants one violation of each include rule in a small tree, and expects the
# script to name its file and line; the tree itself, and what the rules allow, must pass.
set -euo pipefail
check=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

put() { mkdir -p "$tree/$(dirname "$1")" && printf '// head\n#include %s\n' "$2" >"$tree/$1"; }

expect() {  # 0|1 FILE INCLUDE
  local want=$1 file=$2 rc=0 output
  put "$file" "$3"
  output=$(bash "$check" "$tree") || rc=$?
  if ((rc != want)) || { ((want == 1)) && [[ $output != "$file:2: "* ]]; }; then
    printf 'FAIL: %s with #include %s: exit code %d, wanted %d: %s\n' "$file" "$3" "$rc" "$want" "$output"
    failures=$((failures + 1))
  fi
  rm "$tree/$file"
}

put host/base/vec.hpp '<vector>'
allowed() { expect 0 "$@"; }
forbidden() { expect 1 "$@"; }

allowed host/gpu/a.cpp '<CL/opencl.hpp>'
allowed host/scene/a.cpp '"host/gpu/buffer.hpp"'
allowed host/path/a.cpp '"kernels/shared/params.h"'
allowed host/path/a.cpp '"shared/params.h"'
allowed tests/reference/a.cpp '"shared/params.h"'
allowed host/path/a.cpp '"host/bvh/bvh.hpp"'
allowed host/app/a.cpp '"host/study/curve.hpp"'
allowed host/bench/a.cpp '"host/bvh/accel.hpp"'
allowed host/app/a.cpp '"host/bench/run.hpp"'
allowed host/stability/a.cpp '"host/bench/run.hpp"'
allowed host/app/a.cpp '"bench/peers/embree_peer.hpp"'
allowed bench/peers/a.cpp '"host/bench/tracer.hpp"'
allowed kernels/path/a.cl '"lib/vec.h"'
allowed kernels/path/a.cl '"photon/gather.h"'
allowed kernels/path/a.cl '"path/context.h"'
allowed tests/reference/a.cpp '"host/scene/scene.hpp"'
allowed tests/path/a.cpp '"host/path/path.hpp"'

forbidden host/base/a.cpp '"host/gpu/buffer.hpp"'
forbidden host/gpu/a.cpp '"host/scene/scene.hpp"'
forbidden host/scene/a.cpp '"host/path/path.hpp"'
forbidden host/bvh/a.hpp '"host/path/path.hpp"'
forbidden host/photon/a.cpp '"host/path/path.hpp"'
forbidden host/path/a.cpp '"host/plan/plan.hpp"'
forbidden host/path/a.cpp '"host/stability/oracle.hpp"'
forbidden host/plan/a.cpp '"host/study/curve.hpp"'
forbidden host/plan/a.cpp '"host/app/commands.hpp"'
forbidden host/api/a.cpp '"host/app/commands.hpp"'
forbidden host/bench/a.cpp '"host/path/render.hpp"'
forbidden host/bvh/a.cpp '"host/bench/tracer.hpp"'
forbidden host/bench/a.cpp '"bench/peers/embree_peer.hpp"'
forbidden bench/peers/a.cpp '"host/bvh/accel.hpp"'
forbidden host/unknown/a.cpp '"host/base/vec.hpp"'
forbidden host/scene/a.cpp '<CL/cl.h>'
forbidden host/api/a.hpp '<CL/opencl.hpp>'
forbidden tests/gpu/a.cpp '"opencl.hpp"'
forbidden host/path/a.cpp '"kernels/lib/rng.h"'
forbidden host/path/a.cpp '"lib/rng.h"'
forbidden host/path/a.cpp '<lib/rng.h>'
forbidden host/base/a.cpp '"../gpu/buffer.hpp"'
forbidden host/base/a.cpp '"vec.hpp"'
forbidden kernels/shared/a.h '"lib/vec.h"'
forbidden kernels/lib/a.h '"path/context.h"'
forbidden kernels/path/a.cl '"bvh/morton.h"'
forbidden kernels/photon/a.cl '"path/context.h"'
forbidden kernels/raster/a.cl '"photon/gather.h"'
forbidden tests/reference/a.cpp '"host/gpu/context.hpp"'
forbidden tests/reference/a.cpp '"host/scene/load.hpp"'
forbidden tests/reference/a.cpp '"kernels/lib/rng.h"'

rc=0
bash "$check" "$tree/host/base" >/dev/null 2>&1 || rc=$?
if ((rc != 2)); then
  echo "FAIL: a tree without sources: exit code $rc, wanted 2"
  failures=$((failures + 1))
fi
echo "$failures failures"
((failures == 0))
