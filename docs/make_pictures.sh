#!/usr/bin/env bash
# Makes the pictures of the documentation again, in docs/images/. Takes a few minutes.
# Usage: docs/make_pictures.sh [FOLDER]     HEMIRAY: the program to use instead of ./hemiray
set -euo pipefail

cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
hemiray=${HEMIRAY:-./hemiray}
folder=${1:-docs/images}
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
mkdir -p "$folder"

picture() {  # SCENE SIZE EXPOSURE
  local name=${1%.*}
  "$hemiray" render "scenes/$1" -o "$work/$name.exr" --png "$folder/$name.png" \
    --size "$2" --exposure "$3" --spp 16 --quiet
  echo "$folder/$name.png"
}
picture cornell_box.json 300x300 1
"$hemiray" render scenes/cornell_box.json -o "$work/radiosity.exr" --png "$folder/cornell_radiosity.png" \
  --method radiosity --size 300x300 --exposure 1 --spp 16 --quiet
echo "$folder/cornell_radiosity.png"
picture whitted_spheres.json 400x300 0
picture glass_and_mirror.json 400x300 0
picture light_arrays.json 450x300 0
picture gltf_sample.gltf 450x300 0.5
picture obj_scene.json 480x300 0
picture analytic_shapes.json 450x300 0
picture implicit_surfaces.json 450x300 0
picture implicit_barth.json 450x300 0

# A layer as a picture: its difference from the same layer of an empty scene, which is 0 everywhere.
cat >"$work/empty.json" <<'JSON'
{ "hemiray": 1, "camera": { "position": [0, 0, 1], "look_at": [0, 0, 0] }, "objects": [], "lights": [] }
JSON
"$hemiray" render "$work/empty.json" -o "$work/empty.exr" --size 400x300 --spp 1 --quiet
for layer in albedo normal depth reflection; do
  file=$folder/layer_$layer.png
  "$hemiray" compare "$work/glass_and_mirror.exr" "$work/empty.exr" --layer "$layer" --difference "$file" >/dev/null
  echo "$file"
done
