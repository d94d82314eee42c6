#!/usr/bin/env bash
# Installs a wheel in a bare system, without a compiler or Eigen, and tests the installed package: once without extras,
# and once with each. Needs root, mmdebstrap and chroot.
#   bare_root.sh WHEEL [EXTRA ...]     FOLDER: where the system and the wheels of other packages are kept
set -euo pipefail
tree=$(cd "$(dirname "$0")/../.." && pwd)
wheel=$(realpath "$1") && shift
extras=("$@")
[ ${#extras[@]} -gt 0 ] || extras=(text plot arm cluster parquet)
python=$(sed -E 's/.*-cp3([0-9]+)-.*/3.\1/' <<<"$(basename "$wheel")")
own=$(. /etc/os-release && echo "$VERSION_CODENAME")
case $python in 3.11) suite=bookworm ;; 3.13) suite=trixie ;; *) suite=$own ;; esac  # Debian's release with that Python
mkdir -p "${FOLDER:-$tree/build/wheel/$suite}" && cd "${FOLDER:-$tree/build/wheel/$suite}"

# Other packages are downloaded here, because the bare system has no network.
if [ ! -e wheelhouse/complete ]; then
  mkdir -p wheelhouse
  "${PYTHON:-python3}" -m pip download -q --only-binary :all: --python-version "$python" -d wheelhouse "$wheel[$(IFS=,; echo "${extras[*]}")]" pytest hypothesis svgelements
  rm -f wheelhouse/brushsvg-*.whl
  touch wheelhouse/complete
fi
if [ ! -e bare/usr/bin/python3 ]; then
  rm -rf bare
  lists=$(mktemp -d)
  for list in /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources}; do
    ! grep -qs "/debian" "$list" || sed "s/\b$own\b/$suite/g" "$list" >"$lists/$(basename "$list")"
  done
  mmdebstrap --quiet --variant=minbase --include=python3,python3-venv,fonts-dejavu-core "$suite" bare "$lists"/*
  rm -r "$lists"
fi
if chroot bare sh -c 'command -v cc || command -v g++ || ls -d /usr/include/eigen3' 2>/dev/null; then
  echo "the bare system has a compiler or Eigen" >&2
  exit 1
fi

# The tests read the tree. The package is not copied, so that only the installed package can be imported.
rm -rf bare/wheels bare/source bare/tmp/run && mkdir -p bare/wheels bare/source bare/tmp/run
cp wheelhouse/*.whl "$wheel" bare/wheels/
git -C "$tree" ls-files -z --cached --others --exclude-standard -- ':!python' | (cd "$tree" && xargs -0 ls -d 2>/dev/null || true) |
  tar -C "$tree" -cf - -T - | tar -C bare/source -xf -
mkdir -p bare/proc bare/dev
[ -e bare/dev/null ] || mknod -m 666 bare/dev/null c 1 3

run() { unshare --pid --fork --mount-proc="$PWD/bare/proc" chroot bare env -i PATH=/usr/bin:/bin HOME=/tmp/run LC_ALL=C.UTF-8 PYTHONDONTWRITEBYTECODE=1 "$@"; }
install() { # ENVIRONMENT EXTRAS: a new environment with the wheel, from the folder of wheels alone
  rm -rf "bare/$1"
  run python3 -m venv "/$1"
  run "/$1/bin/pip" install -q --disable-pip-version-check --no-index --find-links /wheels "brushsvg$2"
}
tests() { # ENVIRONMENT TESTS: the tests against the package that is installed there
  run "/$1/bin/pip" install -q --disable-pip-version-check --no-index --find-links /wheels pytest hypothesis svgelements
  run sh -c "cd /source && exec /$1/bin/python -c \"import brushsvg; assert brushsvg.__file__.startswith('/$1/'), brushsvg.__file__\""
  run sh -c "cd /source && exec /$1/bin/python -m pytest -q -p no:cacheprovider -m 'not slow and not long and not thorough' $2"
}

size() { # ENVIRONMENT: the size of all installed packages, and of brushsvg alone
  for what in "bare/$1" bare/"$1"/lib/python3*/site-packages/brushsvg; do du -sm "$what"; done |
    awk '{ print $1 " MB " (NR == 1 ? "installed" : "of them brushsvg") }'
}

start=$EPOCHREALTIME
install plain ""
run sh -c 'cd /tmp/run && /plain/bin/brushsvg demo --force'
echo "from a folder of wheels to the picture of the demo: $(awk "BEGIN {print $EPOCHREALTIME - $start}") s"
size plain
run sh -c 'cd /tmp/run && echo "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"60mm\" height=\"20mm\" viewBox=\"0 0 60 20\"><path d=\"M5 10c10-8 30 8 50 0\" fill=\"none\" stroke=\"#000\" stroke-width=\"3\"/></svg>" >line.svg
  for k in 1 2 3 4 5; do date +%s.%N; /plain/bin/brushsvg convert line.svg -o line.ngc --force >/dev/null; done; date +%s.%N' |
  awk 'NR > 1 { t = $1 - last; if (!best || t < best) best = t } { last = $1 } END { printf "convert of a line takes %.2f s, the best of 5\n", best }'
run /plain/bin/brushsvg doctor
echo "== without extras"
tests plain "$(printf 'tests/python/test_%s.py ' extras demo convert gcode svg svg_paint strokes brushes plan fit refining calibrate)"
for extra in "${extras[@]}"; do
  echo "== with $extra"
  install "with-$extra" "[$extra]"
  size "with-$extra"
  tests "with-$extra" tests/python/test_extras.py
  rm -rf "bare/with-$extra"
done
