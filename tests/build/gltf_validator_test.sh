#!/usr/bin/env bash
# The file of `hemiray solve` by Khronos' validator. Usage: gltf_validator_test.sh HEMIRAY VALIDATOR SCENE
set -euo pipefail

scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
"$1" solve "$3" -o "$scratch/solution.glb" --patches 200 --quiet
"$2" -o "$scratch/solution.glb" >"$scratch/report" || { cat -- "$scratch/report" >&2; exit 1; }
