#!/usr/bin/env bash
# Tests that ./hemiray tells the program when the build was done, and only where it built. Usage: wrapper_test.sh PATH
# In a checkout of nothing, with a cmake and a ninja that only pretend.
set -euo pipefail

work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
root=$work/checkout
mkdir -p "$root"/{cmake,host,kernels,bench} "$work/bin"
cp -- "$1" "$root/hemiray"
touch "$root"/{CMakeLists.txt,CMakePresets.json,cmake/packages.txt}
find "$root" -exec touch -d '1 hour ago' {} +

cat >"$work/bin/cmake" <<'STUB'
#!/usr/bin/env bash
touch build/release/build.ninja
STUB
cat >"$work/bin/ninja" <<'STUB'
#!/usr/bin/env bash
sleep 0.1
cut -d' ' -f1 /proc/uptime >"$2/compiled_at"
printf '#!/usr/bin/env bash\necho "${HEMIRAY_BUILT_AT:-nothing built}"\n' >"$2/hemiray"
chmod +x "$2/hemiray"
STUB
chmod +x "$work"/bin/*
export PATH=$work/bin:$PATH
unset HEMIRAY_BUILT_AT

first=$(cd "$root" && ./hemiray)
compiled=$(<"$root/build/release/compiled_at")
now=$(cut -d' ' -f1 /proc/uptime)
awk -v first="$first" -v compiled="$compiled" -v now="$now" \
  'BEGIN { exit !(first ~ /^[0-9.]+$/ && first >= compiled && first <= now) }' ||
  { echo "after a build: told '$first', compiled at $compiled, now $now"; exit 1; }
second=$(cd "$root" && ./hemiray)
[[ $second == "nothing built" ]] || { echo "without a build: told '$second'"; exit 1; }
