#!/usr/bin/env bash
# make_repository.sh PACKAGES FOLDER: an apt repository, FOLDER, of the Debian packages (*.deb) in the folder PACKAGES. On
# the machines that shall install them, as root, with FOLDER at that place or served by a web server:
#   echo "deb [signed-by=/etc/apt/keyrings/victorious.asc] file:FOLDER ./" >/etc/apt/sources.list.d/victorious.list
#   apt-get update && apt-get install victorious
# SIGN_KEY=ID signs it by that key of gpg, whose public part is then FOLDER/victorious.asc. An unsigned one needs [trusted=yes]
# instead of [signed-by=...]. The same packages give the same files, but for the date of Release and the signature.
set -euo pipefail

fail() {
  echo "make_repository.sh: $*" >&2
  exit 2
}
[[ $# -eq 2 ]] || fail "give the folder of the packages and that of the repository: make_repository.sh build build/repository"
packages=$(realpath -- "$1")
folder=$2
command -v dpkg-scanpackages >/dev/null || fail "needs dpkg-scanpackages: apt-get install dpkg-dev"
shopt -s nullglob
debs=("$packages"/*.deb)
[[ ${#debs[@]} -gt 0 ]] || fail "$packages: has no *.deb: make package builds them"

made=$folder.part
rm -rf "$made"
mkdir -p "$made/pool"
cp -- "${debs[@]}" "$made/pool/"
cd "$made"
dpkg-scanpackages --multiversion pool >Packages 2>/dev/null
gzip -9nk Packages

hashes() {
  local name
  for name in Packages Packages.gz; do
    printf ' %s %d %s\n' "$(sha256sum "$name" | cut -d ' ' -f 1)" "$(stat -c %s "$name")" "$name"
  done
}
{
  printf 'Origin: VICTORIOUS\nLabel: VICTORIOUS\nSuite: stable\nCodename: victorious\n'
  printf 'Architectures: %s\n' "$(sed -n 's/^Architecture: //p' Packages | sort -u | tr '\n' ' ' | sed 's/ $//')"
  printf 'Date: %s\nSHA256:\n' "$(date --utc --rfc-email --date="@${SOURCE_DATE_EPOCH:-$(date +%s)}" | sed 's/+0000/UTC/')"
  hashes
} >Release
if [[ -n "${SIGN_KEY:-}" ]]; then
  gpg --batch --yes --local-user "$SIGN_KEY" --clearsign --output InRelease Release
  gpg --batch --armor --export "$SIGN_KEY" >victorious.asc
fi
cd - >/dev/null
rm -rf "$folder"
mv "$made" "$folder"
printf '%s: %d packages\n' "$folder" "${#debs[@]}"
