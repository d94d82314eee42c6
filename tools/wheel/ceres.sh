#!/usr/bin/env bash
# Builds Ceres without GPL code: no SuiteSparse, no LAPACK, and Eigen's own sparse solvers.
#   ceres.sh ARCHIVE FOLDER PREFIX [CMAKE_ARGUMENT ...]     CXXFLAGS: more flags; JOBS: at most so many compilers at once
set -euo pipefail
archive=$(realpath "$1") prefix=$3
mkdir -p "$2" "$prefix" && cd "$2"
arguments=("${@:4}")
tar xf "$archive" --strip-components=1
# EIGEN_MPL2_ONLY: Eigen refuses to compile what is under another licence. -3: only what ends the program is printed.
export CXXFLAGS="${CXXFLAGS:-} -DEIGEN_MPL2_ONLY"
cmake -S . -B out -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_INSTALL_LIBDIR=lib \
  -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_CXX_VISIBILITY_PRESET=hidden -DCMAKE_VISIBILITY_INLINES_HIDDEN=ON \
  -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF -DBUILD_EXAMPLES=OFF -DBUILD_BENCHMARKS=OFF -DPROVIDE_UNINSTALL_TARGET=OFF \
  -DMINIGLOG=ON -DMINIGLOG_MAX_LOG_LEVEL=-3 -DGFLAGS=OFF -DEIGENSPARSE=ON -DSUITESPARSE=OFF -DCXSPARSE=OFF -DACCELERATESPARSE=OFF -DLAPACK=OFF -DCUDA=OFF \
  -DSCHUR_SPECIALIZATIONS=OFF -DCMAKE_EXPORT_NO_PACKAGE_REGISTRY=ON "${arguments[@]}" >/dev/null
cmake --build out ${JOBS:+-j "$JOBS"} --target install >/dev/null
