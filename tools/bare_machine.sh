#!/usr/bin/env bash
# Try `make run` and `make test` on bare Debian machines: git, make, python3 and certificates, nothing else.
#
#   sudo tools/bare_machine.sh [--quick] [bookworm|trixie ...] [root|user|sudo ...]
#
# Each machine is a folder made by debootstrap, entered by chroot, with a clone of the present commit. By default both
# releases, and each as root, as an ordinary user for whom root installs the packages that set-up names, and as one
# who may use sudo. Each command runs twice, the second time without a network. --quick leaves `make test` out.
# Prints seconds and outcome of each; exit code 1 if one is wrong.
#
# Downloads stay in the folder that tools/bare.sh names: the seconds of a later run include no download by pip.
# Remove the folder for figures with it.
set -euo pipefail

source=$(cd "$(dirname "$0")/.." && pwd)
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
commit=$(git -C "$source" rev-parse HEAD)
[ -z "$(git -C "$source" status --porcelain)" ] || echo "note: uncommitted changes are not tried"
. "$source/tools/bare.sh"

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

line() { grep -oE 'apt-get install .*' "$1"; }  # LOG: the command for root that set-up prints

for release in "${releases[@]}"; do
  for who in "${people[@]}"; do
    fresh "$release" "$who"
    room=$place/$release-$who
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
