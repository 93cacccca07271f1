#!/usr/bin/env bash
# Makes what is released, from the state of this folder: a wheel for Python that carries the program, the same program as an
# archive, a container image of it, a wheel without it for other systems, a bill of materials and checksums. The program runs
# on x86_64 Linux with glibc 2.28 (2018) or later. It needs cargo, Python, a few hundred MB from PyPI, and Docker for the image.
#
#   deploy/release.sh [FOLDER]        FOLDER: dist
#
# ISOLA_BASE names another base image than Debian's; ISOLA_RELEASE_TOOLS a virtual environment to keep.
set -euo pipefail
cd "$(dirname "$0")/.."

out=$(realpath --canonicalize-missing "${1:-dist}")
target=x86_64-unknown-linux-gnu
glibc=2_28
largest=30000000 # bytes of the wheel
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tools=${ISOLA_RELEASE_TOOLS:-$work/tools}
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
grep -q "^version = \"$version\"" python/pyproject.toml || { echo "python/pyproject.toml has another version" >&2 && exit 1; }
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH
say() { echo "== $*"; }
archive() { # FILE FOLDER ENTRY...: the same bytes whoever packs it
    local file=$1 folder=$2
    shift 2
    tar --create --directory "$folder" --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner "$@" |
        gzip --no-name --best > "$file"
}

rm -rf "$out"
mkdir -p "$out"
[ -x "$tools/bin/python" ] || python3 -m venv "$tools"
"$tools/bin/python" -m pip install --quiet --disable-pip-version-check maturin==1.16.0 ziglang==0.17.1 hatchling build
export PATH="$tools/bin:$PATH"

say "wheel with the program, for glibc ${glibc/_/.}"
(cd python && maturin build --quiet --profile dist --locked --zig --target "$target" --compatibility "manylinux_$glibc" --out "$out")
wheel=$(ls "$out"/*.whl)
size=$(stat --format %s "$wheel")
[ "$size" -lt "$largest" ] || { echo "$wheel: $size bytes, more than $largest" >&2 && exit 1; }

say "wheel without the program, for other systems"
python -m build --wheel --outdir "$out" python > "$work/build.log" || { cat "$work/build.log" && exit 1; }

say "archive"
folder=isola-$version-$target
mkdir -p "$work/$folder" "$work/image/bin" "$work/image/runs"
python -m zipfile --extract "$wheel" "$work/wheel"
install -m 755 "$work/wheel"/*.data/scripts/isola "$work/$folder/isola"
# The same as `isola worker`, for units and scripts that name it.
# shellcheck disable=SC2016
printf '#!/bin/sh\nexec "$(dirname "$0")/isola" worker "$@"\n' > "$work/$folder/isola-worker"
chmod 755 "$work/$folder/isola-worker"
cp README.md REFERENCE.md CHANGELOG.md CITATION.cff LICENSE-APACHE LICENSE-MIT "$work/$folder"
archive "$out/$folder.tar.gz" "$work" "$folder"

say "bill of materials"
python deploy/sbom.py "$target" > "$out/isola-$version.cdx.json"

if docker info > "$work/docker.log" 2>&1; then
    say "container image"
    cp "$work/$folder"/isola "$work/$folder"/isola-worker "$work/image/bin"
    install -m 755 deploy/start.sh "$work/image/bin/isola-start"
    git archive HEAD models | tar --extract --directory "$work/image"
    docker build --quiet ${ISOLA_BASE:+--build-arg "BASE=$ISOLA_BASE"} --file deploy/Dockerfile.release \
        --tag "isola:$version" "$work/image" > "$work/docker.log"
    docker run --rm "isola:$version" isola --version
    docker save "isola:$version" | gzip --no-name > "$out/isola-$version-image.tar.gz"
else
    say "no container image: Docker does not answer"
fi

say "trial"
LIMIT=60 tests/wheel/first_steps.sh "$wheel"

say "checksums"
(cd "$out" && sha256sum -- * > "$work/sums" && mv "$work/sums" SHA256SUMS && cat SHA256SUMS)
