#!/usr/bin/env bash
# Installs the build tree into a new folder and builds the examples against it alone, by find_package and pkg-config, and
# what uses brushsvg::fit if it was built; then the sources as a part of another project: run.sh BUILD_DIR SOURCE_DIR
# What docs/howto/cpp.md tells one to write and to type is taken from there.
set -euo pipefail
build=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --component cpp --prefix "$work/prefix" >/dev/null
if grep -rEl --include="*.hpp" --include="*.cmake" "boost|nlohmann|pybind" "$work/prefix"; then echo "the installed package needs more than Eigen" >&2; exit 1; fi
if grep -rEil --include="*.hpp" "ceres" "$work/prefix"; then echo "an installed header needs Ceres" >&2; exit 1; fi
documented() {  # BEGIN: the block of docs/howto/cpp.md that begins so
  awk -v begin="    $1" 'index($0, begin) == 1 { inside = 1 } inside && !/^    / { exit } inside { print substr($0, 5) }' "$source/docs/howto/cpp.md" | grep .
}
consume() {  # NAME FLAGS: configure, build
  cmake -S "$source/tests/consumer" -B "$work/$1" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" "${@:2}" >/dev/null
  cmake --build "$work/$1" >/dev/null
}
consume consumer -DEXAMPLE="$source/examples/12_embedding.cpp"
"$work/consumer/consumer"
version=$(sed -n 's/^project(brushsvg VERSION \([0-9.]*\).*/\1/p' "$source/CMakeLists.txt")
consume consumer -DEXAMPLE="$source/examples/01_first_word.cpp" -DVERSION="$version"
libraries=$(dirname "$(find "$work/prefix" -name libbrushsvg_core.a)")
brush=$source/python/brushsvg/data/brushes/round-6.json
"$work/consumer/consumer" "$brush" "$work/one.ngc"
grep -q "^M2$" "$work/one.ngc"
command=$source/.venv/bin/brushsvg  # the check that docs/howto/cpp.md asks for, where the command is installed
if [ -x "$command" ]; then "$command" check "$work/one.ngc" >"$work/said" || { cat "$work/said"; echo "brushsvg check refuses the example's program" >&2; exit 1; }; fi
if "$work/consumer/consumer" "$source/README.md" "$work/none.ngc" 2>"$work/said"; then echo "a README is read as a brush" >&2; exit 1; fi
[ "$(wc -l <"$work/said")" = 1 ] && ! [ -e "$work/none.ngc" ] && grep -q "^$source/README.md: " "$work/said"
if "$work/consumer/consumer" "$work/missing.json" "$work/none.ngc" 2>"$work/said"; then echo "a missing file is read as a brush" >&2; exit 1; fi
grep -q "^$work/missing.json: .*cannot be read$" "$work/said"
if "$work/consumer/consumer" "$brush" "$work/missing/none.ngc" 2>"$work/said"; then echo "a program is written nowhere" >&2; exit 1; fi
grep -q "^$work/missing/none.ngc: " "$work/said"
if cmake -S "$source/tests/consumer" -B "$work/newer" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" -DEXAMPLE="$work" -DVERSION=9.0 2>"$work/said" >/dev/null; then echo "any version will do" >&2; exit 1; fi
ln -s "$source" "$work/brushsvg"
(cd "$work" && eval "$(documented "cmake -S" | head -n 1)" >/dev/null)  # what follows would take minutes
mkdir "$work/documented" "$work/embedded"
cp "$source/examples/01_first_word.cpp" "$work/documented/program.cpp"
{ echo "cmake_minimum_required(VERSION 3.25)"; echo "project(program LANGUAGES CXX)"; echo "add_executable(program program.cpp)"; documented "find_package("; } >"$work/documented/CMakeLists.txt"
cmake -S "$work/documented" -B "$work/documented/build" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/documented/build" >/dev/null
"$work/documented/build/program" "$brush" "$work/two.ngc"
cmp "$work/one.ngc" "$work/two.ngc"
if command -v pkg-config >/dev/null; then
  export PKG_CONFIG_PATH
  PKG_CONFIG_PATH=$(dirname "$(find "$work/prefix" -name brushsvg.pc)")
  pkg-config --exact-version="$version" brushsvg
  (cd "$work/documented" && eval "$(documented "c++ ")")
  "$work/documented/program" "$brush" "$work/two.ngc"
  cmp "$work/one.ngc" "$work/two.ngc"
  # Debian installs libraries into lib/TRIPLET, one folder deeper than a prefix of its own
  cmake -S "$source" -B "$work/deb" -G Ninja -DCMAKE_INSTALL_PREFIX=/usr -DCMAKE_INSTALL_LIBDIR=lib/triplet >/dev/null
  mkdir -p "$work/root/usr/lib/triplet/pkgconfig"
  cp "$work/deb/brushsvg.pc" "$work/root/usr/lib/triplet/pkgconfig"
  for each in prefix: libdir:/lib/triplet includedir:/include; do
    found=$(PKG_CONFIG_PATH=$work/root/usr/lib/triplet/pkgconfig pkg-config --variable="${each%:*}" brushsvg)
    if [ "$(realpath -m "$found")" != "$work/root/usr${each#*:}" ]; then echo "brushsvg.pc: ${each%:*} is $found" >&2; exit 1; fi
  done
fi
cp "$source/tests/consumer/embedded/CMakeLists.txt" "$work/embedded"
ln -s "$source" "$work/embedded/brushsvg"
documented "include(FetchContent)" >"$work/embedded/FetchContent.cmake"
{ echo 'add_subdirectory(brushsvg)'; documented "find_package(" | grep -v find_package; } >"$work/embedded/add_subdirectory.cmake"
for how in add_subdirectory FetchContent; do
  cmake -S "$work/embedded" -B "$work/$how" -G Ninja -DHOW=$how.cmake >/dev/null
  cmake --build "$work/$how" --target program >/dev/null
  for folder in include io posts; do
    if ! grep -rq -- "-isystem [^ ]*brushsvg/cpp/$folder" "$work/$how/build.ninja"; then echo "headers of cpp/$folder are not SYSTEM includes of a project that embeds brushsvg" >&2; exit 1; fi
  done
  # the library itself is built once, elsewhere
  c++ "$(find "$work/$how" -path '*program.dir*' -name '*.o')" -L"$libraries" -lbrushsvg_io -lbrushsvg_posts -lbrushsvg_core -pthread -o "$work/by_$how"
  "$work/by_$how" "$brush" "$work/three.ngc"
  cmp "$work/one.ngc" "$work/three.ngc"
done
if grep -q "^BRUSHSVG_SHARED:BOOL=ON" "$build/CMakeCache.txt"; then
  consume shared -DSHARED=ON -DEXAMPLE="$source/examples/01_first_word.cpp"
  "$work/shared/consumer" "$brush" "$work/four.ngc"
  cmp "$work/one.ngc" "$work/four.ngc"
  offered=$(nm -DC --defined-only "$libraries/libbrushsvg.so" | grep -v " A BRUSHSVG_${version%.*}$")
  if grep -v " [A-Zu] \(typeinfo for \|typeinfo name for \|vtable for \|\)brushsvg::.*@@BRUSHSVG_${version%.*}$" <<<"$offered"; then echo "libbrushsvg.so offers more than names of brushsvg" >&2; exit 1; fi
  grep -q " brushsvg::compensate(" <<<"$offered"
  if grep "select_ends\|squared_end\|nlohmann\|boost" <<<"$offered"; then echo "libbrushsvg.so offers what is private" >&2; exit 1; fi
  readelf -d "$libraries/libbrushsvg.so" | grep -q "SONAME.*libbrushsvg.so.${version%.*}\]"
  if ldd "$libraries/libbrushsvg.so" | grep -i ceres; then echo "libbrushsvg.so needs Ceres" >&2; exit 1; fi
fi
if grep -q "^BRUSHSVG_FIT:BOOL=ON" "$build/CMakeCache.txt"; then
  consume fit -DFIT=ON
  "$work/fit/fit"
else
  if cmake -S "$source/tests/consumer" -B "$work/none" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" -DFIT=ON 2>"$work/said"; then echo "fits are found where none were built" >&2; exit 1; fi
  grep -q "built without fits" "$work/said"
fi
