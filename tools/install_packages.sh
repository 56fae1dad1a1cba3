#!/usr/bin/env bash
# install_packages.sh [--test | --tidy | --cluster]: installs the Debian 12 packages that the build and the demo need. Does
# nothing if all are installed. --test adds what only tests need: clang-format-19, a browser, PostgreSQL with PostGIS, gpg.
# --tidy adds the tools of the lint and fuzz presets, --cluster what `make demo-cluster` starts: PostgreSQL and Slurm.
set -euo pipefail

packages=(
  g++ cmake ninja-build pkg-config ccache mold python3
  libopencv-dev libeigen3-dev libhwy-dev libtbb-dev libxxhash-dev libgeographiclib-dev libgdal-dev libceres-dev
  libavformat-dev libavcodec-dev libavutil-dev libswscale-dev
  libassimp-dev libopengl-dev libegl-dev libgl-dev libegl1 libegl-mesa0 libgl1-mesa-dri
  libsqlite3-dev libpq-dev libexif-dev zlib1g-dev libfmt-dev libspdlog-dev nlohmann-json3-dev libcli11-dev
  libboost-dev libsodium-dev libssl-dev
  pybind11-dev python3-dev python3-numpy
  libgtest-dev libgmock-dev libbenchmark-dev
  libfaiss-dev libhnswlib-dev libvlfeat-dev
)
case "${1:-}" in
  "") ;;
  --test) packages+=(clang-format-19 chromium dpkg-dev gnupg openssl postgresql-15 postgresql-15-postgis-3) ;;
  --tidy) packages+=(clang-19 clang-format-19 clang-tidy-19 libclang-rt-19-dev libomp-19-dev) ;;
  --cluster) packages+=(postgresql-15 postgresql-15-postgis-3 slurm-wlm munge) ;;
  *)
    echo "install_packages.sh: unknown: $1; give --test, --tidy, --cluster or nothing" >&2
    exit 2
    ;;
esac

# The page is built by npm. A Node.js from elsewhere brings its own, beside which Debian's cannot be installed.
if ! command -v npm >/dev/null; then
  packages+=(nodejs npm)
fi

missing=()
for package in "${packages[@]}"; do
  if [[ "$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null)" != "installed" ]]; then
    missing+=("$package")
  fi
done
if [[ ${#missing[@]} -eq 0 ]]; then
  exit 0
fi

as_root=()
if [[ "$(id -u)" != "0" ]]; then
  as_root=(sudo)
fi
echo "Installing: ${missing[*]}" >&2
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q >&2
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}" >&2
