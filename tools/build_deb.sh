#!/usr/bin/env bash
# Builds libbrushsvg-dev as a Debian package in dist/, and checks it with lintian.
set -euo pipefail
tree=$(cd "$(dirname "$0")/.." && pwd)
work=$tree/build/deb
rm -rf "$work" && mkdir -p "$work/brushsvg" "$tree/dist"
cd "$tree"
git ls-files -z --cached --others --exclude-standard | tar --null -T - --ignore-failed-read -cf - | tar -C "$work/brushsvg" -xf -
cd "$work/brushsvg"
mv packaging/debian .
version=$(sed -n 's/^project(brushsvg VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
date=$(git -C "$tree" log -1 --format=%cD)
cat >debian/changelog <<END
brushsvg ($version) unstable; urgency=low

  * See CHANGELOG.md.

 -- The brushsvg authors <authors@brushsvg.invalid>  $date
END
dpkg-buildpackage --build=binary --no-sign ${JOBS:+"--jobs=$JOBS"}
cp "$work"/libbrushsvg-dev_*.deb "$tree/dist/"
lintian --fail-on error "$work"/libbrushsvg-dev_*.deb
