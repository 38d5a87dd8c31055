#!/usr/bin/env bash
# Try the Containerfile without an engine for containers: its steps, in bare Debians made by debootstrap.
#
#   sudo tools/container.sh
#
# FROM, RUN, COPY, ENV, WORKDIR and ENTRYPOINT are carried out as an engine would, each stage in a folder entered by chroot;
# another word is refused. The last stage then runs a new deck without a network. The bare Debians hold git, make, python3
# and certificates, which Debian's slim image does not: a step that relied on them would not be found out.
set -euo pipefail

source=$(cd "$(dirname "$0")/.." && pwd)
. "$source/tools/bare.sh"
file=$source/Containerfile
log=$place/logs/container
: >"$log"

declare -A rooms=()
stage='' room='' path=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin folder=/ entry=''
in_room() { enter "$stage" root env PATH="$path" DEBIAN_FRONTEND=noninteractive sh -c 'cd "$1" && shift && exec "$@"' sh "$folder" "$@"; }

# A step is one line of the file, or several that end in a backslash
while read -r word rest; do
  echo "$SECONDS s: $word $rest" | tee -a "$log"
  case "$word" in
    FROM)
      read -r image _ name <<<"$rest"
      case "$image" in
        debian:12*) release=bookworm ;;
        debian:13*) release=trixie ;;
        *) echo "$image: no bare machine is like it" >&2; exit 2 ;;
      esac
      name=${name:-last}
      fresh "$release" "container-$name"
      room=$place/$release-container-$name stage=$room folder=/
      path=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
      rooms[$name]=$room ;;
    RUN) in_room sh -c "$rest" >>"$log" 2>&1 || { tail -20 "$log"; echo "the step failed, see $log" >&2; exit 1; } ;;
    COPY)
      read -r from to last <<<"$rest"
      case "$from" in
        --from=*) mkdir -p "$(dirname "$room$last")" && cp -a "${rooms[${from#--from=}]}$to" "$room$last" ;;
        .) mkdir -p "$room$to" && git -C "$source" archive HEAD | tar -x -C "$room$to" ;;
        *) echo "COPY $from: not known here" >&2; exit 2 ;;
      esac ;;
    ENV) path=$(PATH=$path sh -c "$rest; echo \"\$PATH\"") ;;
    WORKDIR) folder=$rest && mkdir -p "$room$folder" ;;
    ENTRYPOINT) entry=$(echo "$rest" | tr -d '[]",') ;;
    CMD) ;;
    *) echo "$word: not known here" >&2; exit 2 ;;
  esac
done < <(sed -e ':a' -e '/\\$/{N;s/\\\n//;ba}' -e '/^#/d' -e '/^$/d' "$file")

for words in "version" "new arch" "run deck.toml" "cases"; do
  # shellcheck disable=SC2086
  net=no in_room $entry $words >"$log-run" 2>&1 || { tail -20 "$log-run"; echo "$entry $words failed, see $log-run" >&2; exit 1; }
  [ "$words" != "new arch" ] || cp "$log-run" "$room$folder/deck.toml"
  echo "$entry $words: $(grep -c . "$log-run") lines, the first: $(head -1 "$log-run")"
done
