#!/usr/bin/env bash
# Checks who may include whom (the rules are the tables below). Usage: check_includes.sh [REPOSITORY_ROOT]
# Prints file:line: reason for every violation; exit code 1 if there is one, 2 if there was nothing to check.
set -euo pipefail

cd -- "${1:-$(dirname -- "${BASH_SOURCE[0]}")/..}"
mapfile -d '' -t files < <(find host kernels tests bench fuzz -type f \
  \( -name '*.cpp' -o -name '*.hpp' -o -name '*.h' -o -name '*.cl' -o -name '*.def' \) -print0 2>/dev/null | sort -z)
((${#files[@]})) || { echo "check_includes.sh: no sources in $PWD" >&2; exit 2; }

awk '
BEGIN {
  # Host folders, and the folders each may include besides itself: base <- gpu <- scene <- bvh <- path, bench <- api, app,
  # with room for more effects beside path, and for what plans and studies them above.
  below["base"] = ""
  below["gpu"] = "base"
  below["scene"] = "base gpu"
  effects = "bvh film path raster radiosity photon"
  count = split(effects, effect, " ")
  for (i = 1; i <= count; ++i) below[effect[i]] = "base gpu scene"
  for (i = 1; i <= count; ++i) if (effect[i] != "bvh") below[effect[i]] = below[effect[i]] " bvh"  # rays need its trees
  below["bench"] = "base gpu scene bvh"
  below["plan"] = below["study"] = "base gpu scene " effects
  below["api"] = "base gpu scene " effects " plan study"
  below["app"] = below["api"] " api bench"
  # Kernels: shared <- lib <- module; modules never include each other.
  exception["path", "photon/gather.h"] = 1
  bad = 0
}

function complain(reason) {
  printf "%s:%d: %s\n", FILENAME, FNR, reason
  bad = 1
}

function holds(list, word) { return index(" " list " ", " " word " ") > 0 }

function check_host(folder, target, part) {
  split(target, part, "/")
  if (!(folder in below)) {
    complain("host/" folder " has no include rule; add one to cmake/check_includes.sh")
  } else if (part[1] == "kernels") {
    if (part[2] != "shared") complain("host includes only kernels/shared, not " target)
  } else if (part[1] == "bench") {
    if (folder != "app" || part[2] != "peers") complain("only host/app includes bench/peers, not host/" folder)
  } else if (part[1] == "host") {
    if (part[2] != folder && !holds(below[folder], part[2])) complain("host/" folder " may not include " target)
  } else {
    complain("write \"" target "\" from the repository root, or in angle brackets if it is not ours")
  }
}

function check_kernel(folder, target, part) {
  split(target, part, "/")
  if (part[1] == folder || part[1] == "shared") return
  if (part[1] == "lib" && folder != "shared") return
  if ((folder, target) in exception) return
  complain("kernels/" folder " may not include " target " (shared <- lib <- module)")
}

# Peers stand behind the interface of host/bench and know nothing of our own tracers.
function check_peers(target) {
  if (target ~ /^(bench\/peers|host\/base|host\/bench|host\/scene|kernels\/shared)\//) return
  complain("bench/peers sees only host/base, host/bench, host/scene and kernels/shared, not " target)
}

function check_reference(target) {
  if (target ~ /^(tests\/reference|host\/base|kernels\/shared)\// || target == "host/scene/scene.hpp") return
  complain("tests/reference sees only host/base, host/scene/scene.hpp and kernels/shared, not " target)
}

/^[ \t]*#[ \t]*include[ \t]*["<]/ {
  quoted = $0 ~ /include[ \t]*"/
  target = $0
  sub(/^[^"<]*["<]/, "", target)
  sub(/[">].*$/, "", target)
  split(FILENAME, place, "/")
  opencl = target ~ /^(CL|OpenCL)\// || target ~ /(^|\/)opencl\.hpp$/
  if (target ~ /(^|\/)\.\.?\//) {
    complain("no relative paths in includes: " target)
    next
  }
  if (opencl) {
    if (place[1] "/" place[2] != "host/gpu") complain("only host/gpu includes OpenCL headers, not here: " target)
    next
  }
  if (!quoted && target !~ /^(host|kernels|tests|shared|lib)\//) next  # a system header
  if (place[1] != "kernels") sub(/^(shared|lib)\//, "kernels/&", target)  # kernels/ is an include folder of the host
  if (place[1] == "host") {
    check_host(place[2], target)
  } else if (place[1] == "kernels") {
    check_kernel(place[2], target)
  } else if (place[1] == "bench" && place[2] == "peers") {
    check_peers(target)
  } else if (place[1] == "tests" && place[2] == "reference") {
    check_reference(target)
  }
}

END { exit bad }
' "${files[@]}"
