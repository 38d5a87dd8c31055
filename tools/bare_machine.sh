#!/usr/bin/env bash
# Try `make run` and `make test` on bare Debian machines: git, make, python3 and certificates, nothing else.
#
#   sudo tools/bare_machine.sh [--quick] [bookworm|trixie ...] [root|user|sudo ...]
#
# Each machine is a folder made by debootstrap, entered by chroot, with a clone of the present commit. By default both
# releases, and each as root, as an ordinary user for whom root installs the packages that set-up names, and as one
# who may use sudo. Each command runs twice, the second time without a network. --quick leaves `make test` out.
# Prints seconds and outcome of each; exit code 1 where one is not as it should be.
#
# Mirrors, proxies, certificates and pip's settings are those of the host. Debian's packages, the bare systems and
# pip's downloads stay in $BARE_MACHINES (default /var/tmp/bare-machines): the seconds of a later go hold no download
# by pip. Remove the folder for figures with it.
set -euo pipefail

source=$(cd "$(dirname "$0")/.." && pwd)
place=${BARE_MACHINES:-/var/tmp/bare-machines}
quick=no
releases=()
people=()
for word in "$@"; do
  case "$word" in
    --quick) quick=yes ;;
    bookworm|trixie) releases+=("$word") ;;
    root|user|sudo) people+=("$word") ;;
    *) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0" >&2; exit 2 ;;
  esac
done
[ ${#releases[@]} != 0 ] || releases=(bookworm trixie)
[ ${#people[@]} != 0 ] || people=(root user sudo)
[ "$(id -u)" = 0 ] || { echo "making a machine needs root" >&2; exit 2; }

commit=$(git -C "$source" rev-parse HEAD)
[ -z "$(git -C "$source" status --porcelain)" ] || echo "note: what is not committed is not tried"
mkdir -p "$place/debs" "$place/logs"

if ! command -v debootstrap >/dev/null || ! command -v ip >/dev/null; then
  apt-get update -qq
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends debootstrap iproute2 >/dev/null
fi
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Origin: Debian' 'Label: Debian' 2>/dev/null | sort -u | head -1)
mirror=${mirror:-http://deb.debian.org/debian}

# What the host says of proxies, certificates and indices
mapfile -t settings < <(env | grep -E '^(PIP_[A-Z_]+|SSL_CERT_(FILE|DIR)|REQUESTS_CA_BUNDLE|CURL_CA_BUNDLE|GIT_SSL_CAINFO|[A-Za-z]+_(proxy|PROXY))=' || true)

base() {  # RELEASE: the bare system, made once
  local release=$1 room=$place/$1
  if [ ! -e "$room.made" ]; then
    echo "making bare $release ..." >&2
    rm -rf "$room"
    debootstrap --variant=minbase --include=git,make,python3,ca-certificates --cache-dir="$place/debs" \
      "$release" "$room" "$mirror" >"$place/logs/$release-debootstrap" 2>&1
    echo "deb $mirror $release main" >"$room/etc/apt/sources.list"
    apt-config dump | grep -E '^Acquire::(http|https|ftp|Retries|Check-Valid-Until|Check-Date)\b' \
      >"$room/etc/apt/apt.conf.d/90host" || true
    cp /etc/resolv.conf /etc/hosts "$room/etc/"
    [ ! -f /etc/pip.conf ] || cp /etc/pip.conf "$room/etc/"
    cp -r /usr/local/share/ca-certificates/. "$room/usr/local/share/ca-certificates/"
    enter "$room" root update-ca-certificates >"$place/logs/$release-certificates" 2>&1
    enter "$room" root useradd --create-home --shell /bin/sh mason
    touch "$room.made"
  fi
}

enter() {  # ROOM USER COMMAND...: run it there; with net=no, only the loopback is up
  local room=$1 user=$2 home=/root
  shift 2
  [ "$user" = root ] || home=/home/$user
  mkdir -p "$place/pip/$user" "$room$home/.cache/pip"
  [ "$user" = root ] || chown -R 1000:1000 "$place/pip/$user" "$room$home/.cache"
  local nets=()
  [ "${net:-yes}" = yes ] || nets=(--net)
  # The mounts belong to these processes and go with them.
  unshare --mount --pid --fork --kill-child --propagation private "${nets[@]}" sh -c '
    set -e
    room=$1 home=$2 user=$3 kept=$4
    shift 4
    [ "${net:-yes}" = yes ] || ip link set lo up
    mount -t proc proc "$room/proc"
    mount --rbind /dev "$room/dev"
    mount --bind "$kept" "$room$home/.cache/pip"
    exec chroot --userspec="$user" "$room" "$@"
  ' sh "$room" "$home" "$user" "$place/pip/$user" \
    env -i "${settings[@]}" HOME="$home" USER="$user" LANG=C.UTF-8 \
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@" </dev/null
}

bad=0
rows=()
try() {  # RELEASE WHO COMMAND NETWORK WANTED(0: done, 1: refused): run it, note seconds and outcome
  local release=$1 who=$2 command=$3 network=$4 wanted=$5 user=mason begin code=0 outcome
  [ "$who" != root ] || user=root
  local log="$place/logs/$release-$who-${command// /-}-$network$([ "$wanted" = 0 ] || echo -refused)"
  begin=$(date +%s.%N)
  net=$([ "$network" = online ] && echo yes || echo no) \
    enter "$place/$release-$who" $user sh -c 'cd ~/extrados && exec "$@"' sh $command >"$log" 2>&1 || code=$?
  local seconds
  seconds=$(echo "$(date +%s.%N) $begin" | awk '{printf "%.1f", $1 - $2}')
  outcome=$(grep -aE '^[0-9]+ (passed|failed).* in ' "$log" | tail -1 || true)
  if [ "$wanted" = 0 ]; then
    if [ $code = 0 ]; then outcome="ok${outcome:+: $outcome}"; else outcome="FAILED ($code), see $log"; bad=1; fi
  elif [ $code != 0 ] && line "$log" >/dev/null; then
    outcome="as it should: lacks packages, names the line"
  else
    outcome="FAILED: should have named the packages that are missing, see $log"; bad=1
  fi
  rows+=("$(printf '%-9s %-5s %-9s %-8s %8s  %s' "$release" "$who" "$command" "$network" "$seconds" "$outcome")")
  echo "${rows[-1]}"
}

line() { grep -oE 'apt-get install .*' "$1"; }  # LOG: what set-up asks root to type

for release in "${releases[@]}"; do
  base "$release"
  for who in "${people[@]}"; do
    room=$place/$release-$who
    rm -rf "$room"
    cp -a --reflink=auto "$place/$release" "$room"
    home=$room/home/mason
    [ "$who" != root ] || home=$room/root
    git clone -q --no-hardlinks "$source" "$home/extrados"
    git -C "$home/extrados" checkout -q --detach "$commit"
    [ "$who" = root ] || chown -R 1000:1000 "$home/extrados"
    if [ "$who" != root ]; then
      try "$release" "$who" "make run" online 1
      enter "$room" root apt-get update -qq >"$place/logs/$release-$who-apt" 2>&1
      words=$([ "$who" = sudo ] && echo "apt-get install -y -qq sudo" ||
        line "$place/logs/$release-$who-make-run-online-refused" || true)
      # shellcheck disable=SC2086
      [ -z "$words" ] || enter "$room" root env DEBIAN_FRONTEND=noninteractive $words >>"$place/logs/$release-$who-apt" 2>&1
      [ "$who" != sudo ] || echo "mason ALL=(ALL) NOPASSWD: ALL" >"$room/etc/sudoers.d/mason"
    fi
    for network in online offline; do
      try "$release" "$who" "make run" $network 0
      [ $quick = yes ] || try "$release" "$who" "make test" $network 0
    done
  done
done

echo
printf '%-9s %-5s %-9s %-8s %8s  %s\n' release who command network seconds outcome
printf '%s\n' "${rows[@]}"
exit $bad
