#!/usr/bin/env bash
# Builds the libraries inside the wheels: Ceres and Highway, from Debian's source packages.
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
rm -rf prefix licences ceres highway
"$tools/fetch_sources.sh" sources

# Headers of Debian's packages alone, without those of Debian's C library next to them.
mkdir -p prefix/include prefix/lib/cmake licences highway
ln -s /usr/include/boost /usr/include/nlohmann /usr/include/eigen3 prefix/include/
cp -r /usr/share/cmake/nlohmann_json prefix/lib/cmake/

export CXXFLAGS="-ffile-prefix-map=$PWD=."
compiler=(-DCMAKE_C_COMPILER="$tools/zig-cc" -DCMAKE_CXX_COMPILER="$tools/zig-c++" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
tar xf sources/highway_*.orig.tar.gz -C highway --strip-components=1
cmake -S highway -B highway/out -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$PWD/prefix" -DCMAKE_INSTALL_LIBDIR=lib \
  -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_CXX_VISIBILITY_PRESET=hidden -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF \
  -DHWY_ENABLE_TESTS=OFF -DHWY_ENABLE_EXAMPLES=OFF -DHWY_ENABLE_CONTRIB=OFF "${compiler[@]}" >/dev/null
cmake --build highway/out ${JOBS:+-j "$JOBS"} --target install >/dev/null
mkdir -p prefix/include/hwy/contrib/math
cp highway/hwy/contrib/math/math-inl.h prefix/include/hwy/contrib/math/  # the rest of contrib takes minutes to compile
# this release installs no configuration for find_package; Debian adds one to its own package
mkdir prefix/lib/cmake/hwy
cat >prefix/lib/cmake/hwy/hwy-config.cmake <<'CONFIG'
if(TARGET hwy::hwy)
  return()
endif()
add_library(hwy::hwy STATIC IMPORTED)
get_filename_component(prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set_target_properties(hwy::hwy PROPERTIES IMPORTED_LOCATION "${prefix}/lib/libhwy.a"
  INTERFACE_INCLUDE_DIRECTORIES "${prefix}/include" INTERFACE_COMPILE_DEFINITIONS HWY_STATIC_DEFINE)
CONFIG
cat >prefix/lib/cmake/hwy/hwy-config-version.cmake <<CONFIG
set(PACKAGE_VERSION $(sed -n 's/^Version: //p' prefix/lib/pkgconfig/libhwy.pc))
if(NOT PACKAGE_VERSION VERSION_LESS PACKAGE_FIND_VERSION)
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
endif()
CONFIG
"$tools/ceres.sh" sources/ceres-solver_*.orig.tar.xz ceres "$PWD/prefix" "${compiler[@]}" -DEigen3_DIR=/usr/share/eigen3/cmake

cp ceres/LICENSE licences/ceres-solver.txt
cp highway/LICENSE licences/highway.txt
touch "$stamp"
