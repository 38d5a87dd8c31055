# Bare Debian machines, for scripts that source this: folders made by debootstrap, entered by chroot. Needs root.
#
# Mirrors, proxies, certificates and pip's settings are those of the host. Debian's packages, the bare systems and
# pip's downloads stay in $BARE_MACHINES (default /var/tmp/bare-machines).
place=${BARE_MACHINES:-/var/tmp/bare-machines}
[ "$(id -u)" = 0 ] || { echo "making a machine needs root" >&2; exit 2; }
mkdir -p "$place/debs" "$place/logs"

if ! command -v debootstrap >/dev/null || ! command -v ip >/dev/null; then
  apt-get update -qq
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends debootstrap iproute2 >/dev/null
fi
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Origin: Debian' 'Label: Debian' 2>/dev/null | sort -u | head -1)
mirror=${mirror:-http://deb.debian.org/debian}

# Proxies, certificates and indices of the host
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

enter() {  # PLACE USER COMMAND...: run it there; with net=no, only the loopback is up
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

fresh() {  # RELEASE NAME: a machine of that name, a copy of the bare one
  base "$1"
  rm -rf "${place:?}/$1-$2"
  cp -a --reflink=auto "$place/$1" "$place/$1-$2"
}
