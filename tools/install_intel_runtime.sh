#!/usr/bin/env bash
# Installs Intel's OpenCL runtime for CPUs (it runs on AMD's too) into a folder, beside PoCL and away from the system:
#   tools/install_intel_runtime.sh [FOLDER]     FOLDER: build/intel-opencl of this checkout unless given
#   . FOLDER/environment.sh                     this shell then has both platforms, in one process
#   HEMIRAY_DEVICE=intel ./hemiray devices
# The wheels are pinned and hash-checked (intel_runtime.txt); about 270 MB to download, 400 MB on disk. They come with
# Intel's licence (FOLDER/licence). Needs python3 with pip (Debian: python3-pip). Does nothing where all is in place.
set -euo pipefail

here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
wheels_list=$here/intel_runtime.txt
fail() { printf 'install_intel_runtime: %s\n' "$*" >&2; exit 1; }

case ${1:-} in
  -h | --help) sed -n '2,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
  -*) fail "unknown option '$1'; see --help" ;;
esac
(($# <= 1)) || fail "one folder at most; see --help"
[[ $(uname -sm) == 'Linux x86_64' ]] || fail "Intel publishes this runtime for Linux on x86-64 only"
folder=$(readlink -m -- "${1:-$here/../build/intel-opencl}")
[[ ! -e $folder || -d $folder ]] || fail "$folder is not a folder"
[[ $folder != *:* ]] || fail "$folder: LD_LIBRARY_PATH cannot hold a ':' in a name"
[[ ! -d $folder || -f $folder/.installed || -z $(ls -A -- "$folder") ]] ||
  fail "$folder is neither empty nor of an earlier run: name another folder"
stamp="$folder $(sha256sum <"$wheels_list") $(sha256sum <"${BASH_SOURCE[0]}")"

# --- pip, which may live in an environment of its own: Debian's refuses to touch the system, and is not asked to ---
find_pip() {
  command -v python3 >/dev/null || fail "python3 is missing (apt-get install python3-pip)"
  pip=(python3 -m pip)
  "${pip[@]}" --version >/dev/null 2>&1 && return
  python3 -m venv "$scratch/venv" >/dev/null 2>&1 || fail "pip is missing (apt-get install python3-pip)"
  pip=("$scratch/venv/bin/python3" -m pip)
}

# The libraries, without the wheel's own libOpenCL.so* (the system's loader is used) and the linker's plug-in; a library
# that is there under several names is kept once.
unpack='
import os, pathlib, sys, zipfile
folder = pathlib.Path(sys.argv[1])
for wheel in sys.argv[2:]:
    with zipfile.ZipFile(wheel) as archive:
        written = {}
        for entry in archive.infolist():
            path = pathlib.PurePosixPath(entry.filename)
            name = path.name
            if path.parent.name == "lib" and not name.startswith(("libOpenCL.so", "icx-lto")):
                target = folder / "lib" / name
                same = (entry.file_size, entry.CRC)
                if same in written:
                    target.symlink_to(written[same])
                    continue
                written[same] = name
            elif path.parent.name.endswith(".dist-info") and name == "LICENSE.txt":
                target = folder / "licence" / path.parent.name.replace(".dist-info", ".txt")
            else:
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(archive.read(entry))
'

install_libraries() {
  scratch=$(mktemp -d)
  trap 'rm -rf -- "$scratch"' EXIT
  local pip=() new=$folder.new
  find_pip
  "${pip[@]}" download --quiet --disable-pip-version-check --no-deps --only-binary=:all: --require-hashes \
    --dest "$scratch/wheels" --requirement "$wheels_list" ||
    fail "pip could not fetch the wheels of tools/intel_runtime.txt (its message is above): is PyPI within reach?"
  rm -rf -- "$new"
  mkdir -p -- "$new"
  python3 -c "$unpack" "$new" "$scratch"/wheels/*.whl || fail "a wheel could not be unpacked into $new"
  ls "$new"/lib/libintelocl.so.* >/dev/null 2>&1 || fail "the wheel has no libintelocl.so.*: mend tools/intel_runtime.txt"
  rm -rf -- "$folder"
  mv -- "$new" "$folder"
}

# --- one .icd file a platform: the loader reads the libraries' paths from them ---
write_environment() {
  local intel pocl='' where
  intel=$(find "$folder/lib" -name 'libintelocl.so.*' -print -quit)
  mkdir -p -- "$folder/vendors"
  printf '%s\n' "$intel" >"$folder/vendors/intel.icd"
  for where in "${OCL_ICD_VENDORS:-/etc/OpenCL/vendors}/pocl.icd" /etc/OpenCL/vendors/pocl.icd; do
    if [[ -z $pocl && -f $where && ! $where -ef $folder/vendors/pocl.icd ]]; then pocl=$where; fi
  done
  if [[ -n $pocl ]]; then
    cp -- "$pocl" "$folder/vendors/pocl.icd"
  else
    echo "install_intel_runtime: no pocl.icd found (apt-get install pocl-opencl-icd): only Intel's platform is set up" >&2
  fi
  {
    echo "# Source this file: OpenCL programs of this shell then see Intel's runtime beside PoCL."
    printf 'export OCL_ICD_VENDORS=%q\n' "$folder/vendors"
    printf 'export LD_LIBRARY_PATH=%q${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}\n' "$folder/lib"
  } >"$folder/environment.sh"
}

if [[ $(cat -- "$folder/.installed" 2>/dev/null) != "$stamp" ]]; then
  install_libraries
fi
write_environment
printf '%s\n' "$stamp" >"$folder/.installed"
printf 'Intel'"'"'s runtime is in %s; to use it: . %q\n' "$folder" "$folder/environment.sh"
