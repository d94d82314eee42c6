#!/usr/bin/env bash
# Fetches Debian's source archive of Ceres into FOLDER, from the system's own package sources, and checks it.
#   fetch_sources.sh FOLDER
set -euo pipefail
tools=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1" && cd "$1"
! sha256sum -c "$tools/sources.sha256" >/dev/null 2>&1 || exit 0

# A list of our own with the system's package sources, changed to source packages.
lists=$(mktemp -d)
trap 'rm -rf "$lists"' EXIT
mkdir -p "$lists"/parts "$lists"/state/partial
for list in /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources}; do
  name=$(basename "$list")
  [ ! -f "$list" ] || sed -E 's/^deb /deb-src /; s/^Types:.*/Types: deb-src/' "$list" >"$lists/parts/${name/#sources.list/main.list}"
done
apt() {
  apt-get -qq -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$lists/parts" -o Dir::State::Lists="$lists/state" \
    -o Dir::Cache="$lists" -o APT::Sandbox::User="$(id -un)" "$@"
}
apt update
apt source --download-only ceres-solver=2.1.0+really2.1.0+dfsg-1
sha256sum --quiet -c "$tools/sources.sha256"
