#!/usr/bin/env bash
# Installs the build tree into a new folder and builds the example against it alone, then what uses brushsvg::fit if it
# was built: run.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
build=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --component cpp --prefix "$work/prefix" >/dev/null
if grep -rEl --include="*.hpp" --include="*.cmake" "boost|nlohmann|pybind" "$work/prefix"; then echo "the installed package needs more than Eigen" >&2; exit 1; fi
if grep -rEil --include="*.hpp" "ceres" "$work/prefix"; then echo "an installed header needs Ceres" >&2; exit 1; fi
consume() {  # NAME FLAGS: configure, build, run
  cmake -S "$source/tests/consumer" -B "$work/$1" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" "${@:2}" >/dev/null
  cmake --build "$work/$1" >/dev/null
  "$work/$1/$1"
}
consume consumer -DEXAMPLE="$source/examples/01_word_to_program.cpp"
if grep -q "^BRUSHSVG_FIT:BOOL=ON" "$build/CMakeCache.txt"; then
  consume fit -DFIT=ON
else
  if cmake -S "$source/tests/consumer" -B "$work/none" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" -DFIT=ON 2>"$work/said"; then echo "fits are found where none were built" >&2; exit 1; fi
  grep -q "built without fits" "$work/said"
fi
