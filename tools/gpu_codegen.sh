#!/usr/bin/env bash
# Compiles every kernel for GPUs that need not be there, and tabulates what their compilers say:
#   tools/gpu_codegen.sh [--keep FOLDER] [CLANG OPTION...]
#   tools/gpu_codegen.sh -DHR_STRICT=1 -DHR_TRIANGLE_WATERTIGHT=0    other builds of the same kernels
# Targets: NVIDIA (PTX, then machine code by ptxas -arch=sm_90 where the CUDA toolkit is), AMD (gfx1030), SPIR-V.
# Registers are AMD's vector ones with its scalar ones behind the slash; a stack is what indexed private arrays take, a
# spill what did not fit the registers, both in bytes a work-item. Exit code 1 if a kernel does not compile or spills.
# Needs Debian's clang-15, libclc-15, libclc-15-dev and llvm-spirv-15. --keep leaves sources and code in FOLDER.
#   HEMIRAY_PTXAS=PATH   ptxas, if not on PATH and not in /usr/local/cuda/bin
set -euo pipefail

root=$(readlink -f -- "$(dirname -- "${BASH_SOURCE[0]}")/..")
fail() { printf 'gpu_codegen: %s\n' "$*" >&2; exit 1; }
if [[ ${1:-} == -h || ${1:-} == --help ]]; then sed -n '2,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0; fi

if [[ ${1:-} == --keep ]]; then
  (($# >= 2)) || fail "--keep needs a folder"
  mkdir -p -- "$2"
  work=$(readlink -f -- "$2")
  rm -f -- "$work"/*.{cl,ptx,s,bc,spv,log}
  shift 2
else
  work=$(mktemp -d)
  trap 'rm -rf -- "$work"' EXIT
fi

# --- tools ---
clc=/usr/lib/clc
for tool in clang-15 llvm-spirv-15 g++; do
  command -v "$tool" >/dev/null ||
    fail "$tool is missing: apt-get install --no-install-recommends clang-15 libclc-15 libclc-15-dev llvm-spirv-15 g++"
done
for library in nvptx64--nvidiacl amdgcn--amdhsa; do
  [[ -f $clc/$library.bc ]] || fail "$clc/$library.bc is missing: apt-get install libclc-15 libclc-15-dev"
done
ptxas=${HEMIRAY_PTXAS:-$(command -v ptxas || true)}
if [[ -z $ptxas && -x /usr/local/cuda/bin/ptxas ]]; then ptxas=/usr/local/cuda/bin/ptxas; fi

# --- flattened sources and the GPU profile's options, from hemiray's own code ---
g++ -std=c++20 -O0 -I"$root" -I"$root/kernels" -o "$work/gpu_programs" \
  "$root"/tools/gpu_programs.cpp "$root"/host/gpu/{source_store,device_profile}.cpp "$root"/host/bvh/accel_config.cpp \
  "$root"/host/base/{read_file,json_text,spelling}.cpp -lfmt -lOpenCL || fail "tools/gpu_programs.cpp does not compile"
read -ra profile < <(HEMIRAY_KERNEL_DIR=$root/kernels "$work/gpu_programs" "$work") && ((${#profile[@]})) ||
  fail "no options from tools/gpu_programs.cpp"
rm -f -- "$work/gpu_programs"
# As compile_options() of host/gpu/program.cpp, for a device of OpenCL 1.2; -O3 is what drivers do.
options=(-x cl -cl-std=CL1.2 -cl-kernel-arg-info -Xclang -finclude-default-header "${profile[@]}" "$@")
printf 'options: %s\n' "${profile[*]} $*"

failures=0 spills=0 kernels=0
row() { printf '%-24s %-14s %10s %8s %8s  %s\n' "$@"; }

failed() {  # FILE TARGET LOG
  row "$1" "$2" - - - FAIL >>"$work/rows.log"
  printf '%s for %s:\n' "$1" "$2"
  head -n 12 "$3" | sed 's/^/    /'
  failures=$((failures + 1))
}

tabulate() {  # TARGET, rows "kernel registers stack spill" on stdin
  local kernel registers stack spill verdict before=$kernels
  while read -r kernel registers stack spill; do
    verdict=OK
    if [[ $spill != 0 && $spill != - ]]; then
      verdict=SPILLS spills=$((spills + 1))
    fi
    row "$kernel" "$1" "$registers" "$stack" "$spill" "$verdict" >>"$work/rows.log"
    kernels=$((kernels + 1))
  done
  ((kernels > before)) || fail "$name for $1: its compiler's report could not be read"
}

# ptxas speaks of each kernel, and of each function in it that was not inlined: spills and stacks of all are added up.
read_ptxas() {
  awk 'function flush() { if (kernel != "") print kernel, registers, stack, spill }
       /Compiling entry function/ { flush(); split($0, part, "\047"); kernel = part[2]; registers = stack = spill = 0 }
       /bytes stack frame/ { for (i = 1; i <= NF; i++) if ($(i + 1) == "bytes") {
           if ($(i + 2) == "stack") stack += $i
           if ($(i + 2) == "spill") spill += $i } }
       /Used [0-9]+ registers/ { for (i = 1; i <= NF; i++) if ($i == "Used") registers = $(i + 1) }
       END { flush() }'
}

# The metadata at the end of AMD's assembly. A spilled vector register is a word a work-item; scalar ones count alike.
read_amd() {
  awk '$1 == "-" && $2 == ".args:" { vgpr = sgpr = stack = spill = 0 }
       $1 == ".private_segment_fixed_size:" { stack = $2 }
       $1 == ".sgpr_count:" { sgpr = $2 }
       $1 == ".vgpr_count:" { vgpr = $2 }
       $1 == ".sgpr_spill_count:" { scalar_spill = $2 }
       $1 == ".symbol:" { sub(/\.kd$/, "", $2); name = $2 }
       $1 == ".vgpr_spill_count:" { print name, vgpr "/" sgpr, stack, 4 * ($2 + scalar_spill) }'
}

nvidia() {  # FILE NAME
  clang-15 "${options[@]}" -O3 -S -target nvptx64-nvidia-nvcl -Xclang -target-cpu -Xclang sm_86 \
    -Xclang -target-feature -Xclang +ptx75 -Xclang -mlink-bitcode-file -Xclang "$clc/nvptx64--nvidiacl.bc" \
    "$1" -o "$work/$2.ptx" 2>"$work/$2.log" || { failed "$2" "NVIDIA PTX" "$work/$2.log"; return; }
  if ! grep -q '\.entry' "$work/$2.ptx"; then
    echo "$2: this profile has none of its kernels"
    return 3
  fi
  if [[ -z $ptxas ]]; then
    tabulate "NVIDIA PTX" < <(awk '$2 == ".entry" { sub(/\(.*/, "", $3); print $3, "-", "-", "-" }' "$work/$2.ptx")
    return
  fi
  "$ptxas" -arch=sm_90 -v "$work/$2.ptx" -o /dev/null >"$work/$2.log" 2>&1 ||
    { failed "$2" "NVIDIA sm_90" "$work/$2.log"; return; }
  tabulate "NVIDIA sm_90" < <(read_ptxas <"$work/$2.log")
}

amd() {  # FILE NAME
  clang-15 "${options[@]}" -O3 -S -target amdgcn-amd-amdhsa -mcpu=gfx1030 -nogpulib \
    -Xclang -mlink-bitcode-file -Xclang "$clc/amdgcn--amdhsa.bc" "$1" -o "$work/$2.s" 2>"$work/$2.log" ||
    { failed "$2" "AMD gfx1030" "$work/$2.log"; return; }
  tabulate "AMD gfx1030" < <(read_amd <"$work/$2.s")
}

# Unoptimised: SPIR-V is portable source in another form, and llvm-spirv-15 has no word for what optimisers leave
# ("freeze").
spirv() {  # FILE NAME
  if ! clang-15 "${options[@]}" -O0 -emit-llvm -c -target spir64-unknown-unknown "$1" -o "$work/$2.bc" \
    2>"$work/$2.log" || ! llvm-spirv-15 "$work/$2.bc" -o "$work/$2.spv" 2>"$work/$2.log"; then
    failed "$2" SPIR-V "$work/$2.log"
    return
  fi
  tabulate SPIR-V < <(llvm-spirv-15 --to-text "$work/$2.spv" -o - |
    awk '$2 == "EntryPoint" { gsub(/"/, "", $5); print $5, "-", "-", "-" }')
}

for file in "$work"/*.cl; do
  name=$(basename "$file" .cl)
  nvidia "$file" "$name" || continue
  amd "$file" "$name"
  spirv "$file" "$name"
done
row kernel target registers stack spill verdict
sort "$work/rows.log"
[[ -n $ptxas ]] || echo "no CUDA toolkit here: NVIDIA registers and spills are not known (HEMIRAY_PTXAS=PATH names a ptxas)"
printf '%d compiled, %d failed, %d spill\n' "$kernels" "$failures" "$spills"
((kernels > 0 && failures == 0 && spills == 0))
