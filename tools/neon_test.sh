#!/usr/bin/env bash
# neon_test.sh [FOLDER]: builds the tests of kernels/ for AArch64 and runs them under qemu: the same bits by NEON as by the
# reference. Needs g++-aarch64-linux-gnu, libc6-dev-arm64-cross, qemu-user, libgtest-dev and libhwy-dev (Debian 12), and
# Highway's run-time library for arm64, which it downloads into FOLDER (default build-neon) without installing it. Says
# SKIPPED, with what is missing, if a tool is absent.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
work=${1:-$root/build-neon}
for tool in aarch64-linux-gnu-g++ qemu-aarch64 apt-get dpkg-deb; do
  command -v "$tool" > /dev/null || { echo "SKIPPED: no $tool"; exit 0; }
done
[[ -d /usr/src/googletest/googletest ]] || { echo "SKIPPED: no /usr/src/googletest (libgtest-dev)"; exit 0; }

mkdir -p "$work/lists/partial" "$work/cache/archives/partial" "$work/objects"
cd "$work"
if ! compgen -G "hwy/usr/lib/aarch64-linux-gnu/libhwy.so.*" > /dev/null; then
  apt=(apt-get -q -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o "Dir::State::Lists=$work/lists"
       -o "Dir::Cache=$work/cache" -o "APT::Sandbox::User=$(id -un)")
  "${apt[@]}" update > apt.log 2>&1 && "${apt[@]}" download libhwy1 >> apt.log 2>&1 ||
    { echo "SKIPPED: no libhwy1 for arm64 (see $work/apt.log)"; exit 0; }
  dpkg-deb -x libhwy1_*_arm64.deb hwy
fi

# Headers of Highway and googletest by links, so that the host's other headers are not found.
mkdir -p include
ln -sfn /usr/include/hwy include/hwy
flags=(-std=c++20 -O2 -ffp-contract=off -I "$root/src" -isystem include -isystem /usr/src/googletest/googletest/include
       -I /usr/src/googletest/googletest)
sources=("$root"/src/victorious/kernels/*.cc /usr/src/googletest/googletest/src/gtest-all.cc
         /usr/src/googletest/googletest/src/gtest_main.cc)
printf '%s\n' "${sources[@]}" | xargs -P "$(nproc)" -I{} sh -c \
  'object=objects/$(basename "$1").o; [ "$object" -nt "$1" ] || { shift; aarch64-linux-gnu-g++ "$@" -c "$0" -o "$object"; }' \
  {} {} "${flags[@]}"
aarch64-linux-gnu-g++ -o kernels_tests objects/*.o hwy/usr/lib/aarch64-linux-gnu/libhwy.so.1 -pthread
qemu-aarch64 -L /usr/aarch64-linux-gnu -E "LD_LIBRARY_PATH=$work/hwy/usr/lib/aarch64-linux-gnu" ./kernels_tests --gtest_brief=1
