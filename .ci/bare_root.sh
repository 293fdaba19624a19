#!/usr/bin/env bash
# A bare Debian 12 root in which a fresh machine is played: only what ./hemiray installs by itself is there.
#   bare_root.sh make ROOT   fills ROOT by debootstrap from the mirror this machine's apt uses, and copies the work tree;
#                            exit code 1 where that cannot be done (the reason is printed)
#   bare_root.sh run ROOT    runs the README's two commands in it. /proc, /sys and /dev are mounted in a namespace of
#                            this process only, so they are gone with it however it ends.
# HR_CI_CACHES: a folder whose caches (of the compiler and of kernels) the root fills, for the steps of .ci/run after it.
set -euo pipefail
repository=$(readlink -f -- "$(dirname -- "${BASH_SOURCE[0]}")/..")
suite=bookworm
home=work/hemiray  # the checkout inside the root; ../shared lies beside it, as outside

refuse() { echo "bare root: $*"; exit 1; }

apt_sources() {  # FORMAT
  apt-get indextargets --format "$1" 'Created-By: Packages' 'Origin: Debian' | sort -u
}

make_root() {
  local root=$1 mirror proxy='' log=$1.log
  ((EUID == 0)) || refuse "not root"
  command -v debootstrap >/dev/null || refuse "no debootstrap"
  mkdir -p "$root"
  unshare --mount --pid --fork bash -c 'mount -t proc proc "$1" && umount "$1"' _ "$root" 2>/dev/null ||
    refuse "mounting is refused"
  mirror=$(apt_sources '$(CODENAME) $(REPO_URI)' | sed -n "s/^$suite //p" | head -n 1)
  [[ -n $mirror ]] || refuse "this machine's apt knows no mirror of $suite"
  eval "$(apt-config shell proxy Acquire::http::Proxy)"
  if [[ -n $proxy && $proxy != DIRECT ]]; then export http_proxy=${http_proxy:-$proxy}; fi

  local start=$SECONDS
  debootstrap --variant=minbase --include=ccache "$suite" "$root" "$mirror" >"$log" 2>&1 ||
    { tail -n 20 "$log"; refuse "debootstrap failed"; }
  echo "bare root: debootstrap took $((SECONDS - start)) s"

  # Let apt and the network work inside as they do outside.
  apt_sources 'deb $(REPO_URI) $(RELEASE) $(COMPONENT)' >"$root/etc/apt/sources.list"
  apt-config dump Acquire | grep -iE 'proxy|verify|cainfo|check-valid|check-date|retries' \
    >"$root/etc/apt/apt.conf.d/90outside" || true
  local file
  for file in /etc/resolv.conf /etc/hosts /etc/ssl/certs/ca-certificates.crt; do
    if [[ -e $file ]]; then mkdir -p "$root$(dirname "$file")" && cp -L "$file" "$root$file"; fi
  done

  # The work tree as git sees it, and of git itself only what tells the commit.
  mkdir -p "$root/$home"
  {
    git -C "$repository" ls-files -z --cached --others --exclude-standard
    (cd "$repository" && find .git/HEAD .git/refs .git/packed-refs .git/logs/HEAD -print0 2>/dev/null || true)
  } | tar -C "$repository" --null --no-recursion --ignore-failed-read -T - -cf - 2>/dev/null | tar -C "$root/$home" --no-same-owner -xf -
}

inside_namespace() {  # ROOT: runs as the first process of its own mount and process namespaces
  local root=$1 folder
  mount -t proc proc "$root/proc"
  for folder in sys dev dev/pts; do
    mount --bind "/$folder" "$root/$folder"
  done
  if [[ -d $repository/../shared ]]; then
    mkdir -p "$root/$home/../shared"
    mount --bind "$repository/../shared" "$root/$home/../shared"
    mount -o remount,bind,ro "$root/$home/../shared"
  fi
  if [[ -n ${HR_CI_CACHES:-} ]]; then
    mkdir -p "$root$HR_CI_CACHES"
    mount --bind "$HR_CI_CACHES" "$root$HR_CI_CACHES"
  fi
  local environment=(PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8) name
  export CCACHE_BASEDIR=/$home
  for name in http_proxy https_proxy no_proxy HEMIRAY_CMAKE_ARGS CI CCACHE_{DIR,BASEDIR,NOHASHDIR}; do
    if [[ -n ${!name:-} ]]; then environment+=("$name=${!name}"); fi
  done
  # shellcheck disable=SC2016  # expanded inside
  chroot "$root" env -i "${environment[@]}" bash -euc '
    cd "/$0"
    ./hemiray render scenes/cornell_box.json -o cornell.exr
    test -s cornell.exr
    echo "bare root: packages, build and the first picture took $SECONDS s"
    SECONDS=0
    ./hemiray test --repeat until-pass:2
    echo "bare root: building and running the tests took $SECONDS s"
  ' "$home"
}

case ${1:-} in
  make) make_root "$2" ;;
  run) exec unshare --mount --pid --fork --kill-child bash "${BASH_SOURCE[0]}" inside_namespace "$2" ;;
  inside_namespace) inside_namespace "$2" ;;
  *) sed -n '2,7s/^# //p' "${BASH_SOURCE[0]}"; exit 2 ;;
esac
