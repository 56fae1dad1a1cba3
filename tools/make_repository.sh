#!/usr/bin/env bash
# make_repository.sh PACKAGES FOLDER: an apt repository, FOLDER, of the Debian packages (*.deb) in the folder PACKAGES, signed by
# the key SIGN_KEY of gpg if that is set. FOLDER is replaced only if it is such a repository. On the machines that shall install
# from it, as root, with FOLDER's absolute path, readable by everybody, or its URL where a web server has it:
#   install -m 644 FOLDER/victorious.asc /etc/apt/keyrings/
#   echo "deb [signed-by=/etc/apt/keyrings/victorious.asc] file:FOLDER ./" >/etc/apt/sources.list.d/victorious.list
#   apt-get update && apt-get install victorious
# Of an unsigned one: [trusted=yes] instead of [signed-by=...], and no key. The same packages give the same files, but for the
# date in Release (SOURCE_DATE_EPOCH sets it) and the signature.
set -euo pipefail

fail() {
  echo "make_repository.sh: $*" >&2
  exit 2
}
[[ $# -eq 2 ]] || fail "give the folder of the packages and that of the repository: make_repository.sh build build/repository"
packages=$(realpath -- "$1")
folder=$(realpath -m -- "$2")
[[ "$packages/" != "$folder"/* ]] || fail "$folder: holds the packages: give another folder"
if [[ -e $folder ]] && ! grep -qs '^Origin: VICTORIOUS$' "$folder/Release"; then
  fail "$folder: exists and is no repository of this script: give another folder"
fi
command -v dpkg-scanpackages >/dev/null || fail "needs dpkg-scanpackages: apt-get install dpkg-dev"
shopt -s nullglob
debs=("$packages"/*.deb)
[[ ${#debs[@]} -gt 0 ]] || fail "$packages: has no *.deb: make package builds them"

made=$folder.part
before=$folder.before
rm -rf -- "$made" "$before"
mkdir -p -- "$made/pool"
cp -- "${debs[@]}" "$made/pool/"
cd "$made"
dpkg-scanpackages --multiversion pool >Packages 2>scan.log || fail "$(tail -n 1 scan.log)"
rm scan.log
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
if [[ -e $folder ]]; then mv -- "$folder" "$before"; fi
mv -- "$made" "$folder"
rm -rf -- "$before"
printf '%s: %d packages\n' "$folder" "${#debs[@]}"
