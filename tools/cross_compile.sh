#!/usr/bin/env bash
# Compiles the C++ library and its examples for other systems with zig's clang, to check that this works. The
# parts are the core, the readers of our files and the posts. An example also runs if qemu-user
# has the processor.
#   cross_compile.sh [TARGET ...]
# FOLDER: for the results; PYTHON: an interpreter with venv; JOBS: at most so many compilers at once
set -euo pipefail
tree=$(cd "$(dirname "$0")/.." && pwd)
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(aarch64-linux-gnu x86_64-windows-gnu)
mkdir -p "${FOLDER:-$tree/build/cross}" && cd "${FOLDER:-$tree/build/cross}"
if [ ! -x venv/bin/python ]; then
  "${PYTHON:-python3}" -m venv venv
  venv/bin/pip install -q "$(grep '^ziglang==' "$tree/tools/wheel/requirements.txt")"
fi
zig=$(venv/bin/python -c 'import ziglang; print(ziglang.__path__[0] + "/zig")')
export ZIG_GLOBAL_CACHE_DIR=$PWD/zig-cache
# Only these headers are visible, not the headers of this system's C library next to them.
mkdir -p include
ln -sfn /usr/include/boost include/boost
ln -sfn /usr/include/nlohmann include/nlohmann
for target in "${targets[@]}"; do
  mkdir -p "$target"
  printf '#!/bin/sh\nexec %q c++ -target %s -O1 -g0 "$@"\n' "$zig" "$target" >"$target/c++"
  printf '#!/bin/sh\nexec %q ar "$@"\n' "$zig" >"$target/ar"
  printf '#!/bin/sh\nexec %q ranlib "$@"\n' "$zig" >"$target/ranlib"
  chmod +x "$target"/{c++,ar,ranlib}
  case $target in *windows*) system=Windows suffix=.exe ;; *macos*) system=Darwin suffix= ;; *) system=Linux suffix= ;; esac
  cmake -S "$tree" -B "$target/build" -G Ninja -DCMAKE_SYSTEM_NAME=$system -DCMAKE_SYSTEM_PROCESSOR="${target%%-*}" \
    -DCMAKE_CXX_COMPILER="$PWD/$target/c++" -DCMAKE_AR="$PWD/$target/ar" -DCMAKE_RANLIB="$PWD/$target/ranlib" \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE= -DBRUSHSVG_WERROR=ON \
    -DCMAKE_CXX_FLAGS="-pedantic-errors -isystem $PWD/include -D_LIBCPP_ENABLE_CXX17_REMOVED_UNARY_BINARY_FUNCTION -Wno-enum-constexpr-conversion" \
    -DEigen3_DIR=/usr/share/eigen3/cmake -DBoost_INCLUDE_DIR="$PWD/include" -DBoost_NO_BOOST_CMAKE=ON \
    -Dnlohmann_json_DIR=/usr/share/cmake/nlohmann_json -DBRUSHSVG_INSTALL=OFF >/dev/null
  cmake --build "$target/build" ${JOBS:+-j "$JOBS"} --target brushsvg_core brushsvg_io brushsvg_posts >/dev/null
  for example in 12_embedding 01_first_word; do
    "$target/c++" -std=c++17 -I"$tree/cpp/include" -I"$target/build/headers" -isystem /usr/include/eigen3 "$tree/examples/$example.cpp" \
      "$target"/build/{libbrushsvg_io.a,libbrushsvg_posts.a,libbrushsvg_core.a} -o "$target/$example$suffix"
  done
  echo "$target: compiled, with its examples"
  case $target in aarch64-linux*)
    if command -v qemu-aarch64 >/dev/null && [ -e /usr/aarch64-linux-gnu/lib/libc.so.6 ]; then
      qemu-aarch64 -L /usr/aarch64-linux-gnu "$target/01_first_word" "$tree/python/brushsvg/data/brushes/round-6.json" "$target/out.ngc"
      echo "$target: run, $(wc -l <"$target/out.ngc") lines of G-code"
    fi ;;
  esac
done
