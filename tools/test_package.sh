#!/usr/bin/env bash
# test_package.sh PACKAGE.deb VIDEO CAD_FILE [DIR]: what a new user of the Debian package meets. Installs PACKAGE in a bare
# Debian 12 (debootstrap, minbase) with the dependencies that apt finds, makes a model of CAD_FILE, searches VIDEO for it,
# and prints the seconds of each step; no compiler, no display. A VIDEO.telemetry.csv or VIDEO.srt beside VIDEO goes along.
# Then it tries what else the package brings: the page of `serve`, the manual page, the completions, the other programs.
# Fails at the first thing that is missing, or if installing and finding take more than MAX_SECONDS (180).
# Needs root, debootstrap, curl and a Debian mirror (DEBIAN_MIRROR). DIR (/tmp/victorious_package) keeps the bare system
# as an archive for the next run; the system with the package in it is left there to look at.
set -euo pipefail

if [[ $# -lt 3 || $# -gt 4 ]]; then
  echo "test_package.sh: give package, video, CAD file: test_package.sh build/victorious_*.deb clip.mp4 assets/models/jeep.glb" >&2
  exit 2
fi
package=$(realpath -- "$1")
video=$(realpath -- "$2")
cad=$(realpath -- "$3")
dir=${4:-/tmp/victorious_package}
max_seconds=${MAX_SECONDS:-180}
mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}
root=$dir/root

fail() {
  echo "test_package.sh: $*" >&2
  exit 1
}
[[ "$(id -u)" == 0 ]] || fail "needs root, for debootstrap and chroot"
for tool in debootstrap curl; do
  command -v "$tool" >/dev/null || fail "needs $tool: apt-get install $tool"
done

unmount() { if mountpoint -q "$root/proc"; then umount "$root/proc"; fi; }
server=
finish() {
  if [[ -n "$server" ]]; then kill "$server" 2>/dev/null || true; wait "$server" 2>/dev/null || true; fi
  unmount
}
trap finish EXIT

mkdir -p "$dir"
unmount
rm -rf "$root"
if [[ ! -e $dir/bare.tar ]]; then
  echo "making a bare Debian 12 in $dir" >&2
  debootstrap --variant=minbase bookworm "$root" "$mirror" >"$dir/debootstrap.log"
  tar -C "$root" -cf "$dir/bare.tar.part" .
  mv "$dir/bare.tar.part" "$dir/bare.tar"
else
  mkdir "$root"
  tar -C "$root" -xf "$dir/bare.tar"
fi
cp /etc/resolv.conf "$root/etc/resolv.conf"
mount -t proc proc "$root/proc"
mkdir "$root/work"
cp "$package" "$root/work/victorious.deb"
cp "$video" "$cad" "$root/work/"
for beside in "$video.telemetry.csv" "${video%.*}.srt" "${video%.*}.SRT"; do
  if [[ -e $beside ]]; then cp "$beside" "$root/work/"; fi
done
clip=$(basename "$video")
file=$(basename "$cad")
name=${file%.*}

# Nothing of the caller's environment: no display, no locale, no compiler flags.
inside() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive chroot "$root" bash -c "cd /work && $1"; }
total=0
step() { # NAME COMMAND
  local begun ended
  begun=$(date +%s%N)
  inside "$2" >"$dir/$1.log" 2>&1 || { tail -20 "$dir/$1.log" >&2; fail "$1: failed: $2"; }
  ended=$(date +%s%N)
  printf '%-10s %6.1f s   %s\n' "$1" "$(((ended - begun) / 100000000))e-1" "$2"
  total=$((total + ended - begun))
}

step update "apt-get update -q"
step install "apt-get install -q -y ./victorious.deb"
inside "command -v g++ || command -v cc" >/dev/null && fail "the package brings a compiler"
step model "victorious model add $name $file --models models"
step index "victorious index $clip --models models --db index.db"
step search "victorious search --db index.db"
seconds=$((total / 1000000000))
cat "$dir/search.log"
found=$(inside "victorious search --db index.db --json" | wc -l)
[[ $found -gt 0 ]] || fail "nothing found in $clip"
times >"$dir/times"
processor=$(sed -n 2p "$dir/times" | tr 'ms' '  ' | awk '{ printf "%.0f", 60 * ($1 + $3) + $2 + $4 }')
printf '%-10s %6d s   from the .deb to the first object, of at most %d; %d s of processor time, load %s\n' total \
  "$seconds" "$max_seconds" "$processor" "$(cut -d' ' -f1 /proc/loadavg)"

# The rest of what is installed.
inside "victorious doctor" >"$dir/doctor.log" || fail "doctor failed"
inside "victorious bench --help && victorious self-test" >"$dir/programs.log" || fail "bench does not start, or self-test fails: $dir/programs.log"
inside "zcat /usr/share/man/man1/victorious.1.gz | grep -q '^.TH'" || fail "no manual page"
inside ". /usr/share/bash-completion/completions/victorious && complete -p victorious" >/dev/null || fail "no completion for bash"
inside "test -s /usr/share/doc/victorious/copyright" || fail "no copyright file"
rm -f "$dir/page.html" "$dir/page.js"
inside "exec victorious serve --db index.db --models models --listen 127.0.0.1:0" >"$dir/serve.log" 2>&1 &
server=$!
url=
for _ in $(seq 150); do
  url=$(grep -om1 'http://[0-9.:]*' "$dir/serve.log" || true)
  if [[ -n $url ]] && curl -sf "$url/" -o "$dir/page.html"; then break; fi
  sleep 0.2
done
script=$(grep -o '[a-zA-Z0-9_./-]*\.js' "$dir/page.html" 2>/dev/null | head -1)
[[ -n "$script" ]] || fail "serve sends no page"
curl -sf "$url/${script#./}" -o "$dir/page.js" || fail "serve does not send $script of its page"
curl -sf "$url/api/v1/objects" | grep -q "$name" || fail "serve does not list the object"
kill "$server"
wait "$server" || true
server=
inside "apt-get remove -q -y victorious" >"$dir/remove.log" 2>&1 || fail "cannot be removed"
inside "command -v victorious || test -e /usr/share/victorious" >/dev/null && fail "leaves files after its removal"
[[ $seconds -le $max_seconds ]] || fail "$seconds s to the first object, more than $max_seconds"
echo "installed, found, served and removed"
