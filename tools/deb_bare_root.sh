#!/usr/bin/env bash
# Installs the Debian package in a system without brushsvg, and compiles and runs programs against it there.
# Needs root, mmdebstrap and chroot.
#   deb_bare_root.sh PACKAGE.deb     FOLDER: where the system is kept
set -euo pipefail
tree=$(cd "$(dirname "$0")/.." && pwd)
package=$(realpath "$1")
mkdir -p "${FOLDER:-$tree/build/deb-root}" && cd "${FOLDER:-$tree/build/deb-root}"
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
if [ ! -e root/usr/bin/cmake ]; then
  rm -rf root
  sources=()
  for list in /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources}; do [ ! -f "$list" ] || sources+=("$list"); done
  mmdebstrap --quiet --variant=minbase --include=g++,cmake,ninja-build,pkg-config,libeigen3-dev,libceres-dev \
    "$suite" root "${sources[@]}"
fi
rm -rf root/work && mkdir -p root/work
cp "$package" root/work/libbrushsvg-dev.deb
cp -r "$tree/tests/consumer" "$tree/examples" "$tree/python/brushsvg/data/brushes/round-6.json" root/work/

cat >root/work/run.sh <<'RUN'
set -eu
cd /work
dpkg --purge libbrushsvg-dev >/dev/null 2>&1 || true
dpkg --install libbrushsvg-dev.deb
build() { # NAME FLAGS
  name=$1
  shift
  cmake -S consumer -B "$name" -G Ninja "$@" >/dev/null
  cmake --build "$name" >/dev/null
}
build word -DEXAMPLE=/work/examples/12_embedding.cpp
word/consumer
build brush -DEXAMPLE=/work/examples/01_first_word.cpp
brush/consumer round-6.json cmake.ngc
build fit -DFIT=ON
fit/fit
c++ -std=c++17 examples/01_first_word.cpp $(pkg-config --cflags --libs brushsvg) -o by_pkg_config
./by_pkg_config round-6.json pkg_config.ngc
cmp cmake.ngc pkg_config.ngc
dpkg --purge libbrushsvg-dev >/dev/null
[ -z "$(find / -xdev -path /work -prune -o -path /proc -prune -o -name '*brushsvg*' -print)" ]
echo "installed, used by CMake and pkg-config, removed without a trace"
RUN
exec chroot root env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 sh /work/run.sh
