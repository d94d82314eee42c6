#!/usr/bin/env bash
# Installs the build tree into a new folder and builds the example against it alone: run.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
build=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --component cpp --prefix "$work/prefix" >/dev/null
if grep -rEl --include="*.hpp" --include="*.cmake" "boost|nlohmann|pybind" "$work/prefix"; then echo "the installed package needs more than Eigen" >&2; exit 1; fi
cmake -S "$source/tests/consumer" -B "$work/build" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" \
  -DEXAMPLE="$source/examples/01_word_to_program.cpp" >/dev/null
cmake --build "$work/build" >/dev/null
"$work/build/consumer"
