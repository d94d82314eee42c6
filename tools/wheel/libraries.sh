#!/usr/bin/env bash
# Builds the library inside the wheels: Ceres, from Debian's source package.
# The results are in FOLDER/prefix, licence files in FOLDER/licences. A second run does nothing.
#   libraries.sh FOLDER     ZIG: the compiler's program; JOBS: at most so many compilers at once
set -euo pipefail
tools=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1" && cd "$1"
stamp=prefix/made-by-$(cat "$tools"/{libraries.sh,ceres.sh,sources.sha256,zig-c++,zig-cc} | sha256sum | cut -c1-16)
[ ! -e "$stamp" ] || exit 0
export ZIG ZIG_GLOBAL_CACHE_DIR=$PWD/zig-cache
if command -v ccache >/dev/null; then  # a compilation that was stopped goes on where it was
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_COMPILERTYPE=clang CCACHE_BASEDIR=
  CCACHE_COMPILERCHECK="string:zig $("$ZIG" version) $(sha256sum <"$tools/zig-c++")"
  export CCACHE_COMPILERCHECK
fi
rm -rf prefix licences ceres
"$tools/fetch_sources.sh" sources

# Headers of Debian's packages alone, without those of Debian's C library next to them.
mkdir -p prefix/include prefix/lib/cmake licences
ln -s /usr/include/boost /usr/include/nlohmann /usr/include/eigen3 prefix/include/
cp -r /usr/share/cmake/nlohmann_json prefix/lib/cmake/

export CXXFLAGS="-ffile-prefix-map=$PWD=."
compiler=(-DCMAKE_C_COMPILER="$tools/zig-cc" -DCMAKE_CXX_COMPILER="$tools/zig-c++" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
"$tools/ceres.sh" sources/ceres-solver_*.orig.tar.xz ceres "$PWD/prefix" "${compiler[@]}" -DEigen3_DIR=/usr/share/eigen3/cmake

cp ceres/LICENSE licences/ceres-solver.txt
touch "$stamp"
