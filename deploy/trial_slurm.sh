#!/usr/bin/env bash
# The shipped job array in a Slurm of its own: three workers, one of whose tasks is requeued and comes back. Ends with 0 if every
# branch was stored once and the files are those of an undisturbed run.
#
#   deploy/trial_slurm.sh [FOLDER WITH isola AND isola-worker]     default: target/release
#
# Needs root, Python and, of Debian, slurmctld, slurmd, slurm-client and munge; takes some minutes and leaves nothing behind.
set -euo pipefail
programs=$(realpath "${1:-$(dirname "$0")/../target/release}")
cd "$(dirname "$0")"
# shellcheck source=trial_common.sh
. ./trial_common.sh

work=$(mktemp -d)
node=$(hostname -s)
port=$((20000 + RANDOM % 10000))
study=../models/nonlinear_damper/study.toml
# Long enough: a requeued task comes back after half a minute.
changes=(--amplitudes 0.004:0.012:0.00001)
started=()

ended() {
    local code=$?
    if [ "$code" -ne 0 ]; then
        tail -n 5 "$work"/*.log || true
    fi
    scancel --user root --quiet >/dev/null 2>&1 || true
    [ ${#started[@]} -eq 0 ] || kill -TERM "${started[@]}" 2>/dev/null || true
    wait
    rm -rf "$work"
    exit "$code"
}
trap ended EXIT

export SLURM_CONF=$work/slurm.conf
mkdir "$work/state" "$work/spool"
# A job that is requeued begins again when its credential has expired.
cat >"$SLURM_CONF" <<SLURM
ClusterName=trial
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge,cred_expire=5
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
MpiDefault=none
ReturnToService=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=8
PartitionName=trial Nodes=$node Default=YES MaxTime=INFINITE
SLURM
head -c 1024 /dev/urandom >"$work/munge.key"
chmod 600 "$work/munge.key"
run_is_over() { false; }
begin() { # NAME COMMAND...
    "${@:2}" >"$work/$1.log" 2>&1 &
    started+=("$!")
}
begin munged munged --foreground --force --socket "$work/munge" --key-file "$work/munge.key" --pid-file "$work/munge.pid" \
    --seed-file "$work/munge.seed"
until_holds "Munge answers" test -S "$work/munge"
begin controller slurmctld -D
begin node slurmd -D -N "$node"
has_node() { sinfo --noheader --format %T 2>/dev/null | grep -q idle; }
until_holds "Slurm has a node" has_node

"$programs/isola" sweep "$study" "${changes[@]}" --out "$work/undisturbed" >"$work/undisturbed.log" 2>&1
said "undisturbed run"

"$programs/isola" sweep "$study" "${changes[@]}" --out "$work/run" --listen tcp/127.0.0.1:0 --workers 0 --lease 5 \
    >"$work/coordinator.log" 2>&1 &
coordinator=$!
started+=("$coordinator")
run_is_over() { ! kill -0 "$coordinator" 2>/dev/null; }
has_address() { [ -s "$work/run/address" ]; }
until_holds "the coordinator listens" has_address
export ISOLA_CONNECT
ISOLA_CONNECT=$(cat "$work/run/address")
job=$(PATH=$programs:$PATH sbatch --parsable --export=ALL,ISOLA_SECRET_FILE="$work/run/secret" --array=1-3 --cpus-per-task=1 \
    --output "$work/worker-%a.log" slurm/isola.sbatch)

status_json() { "$programs/isola" status "$work/run" --json; }
restarts() { [ "$(squeue --noheader --array --jobs "${job}_2" --Format RestartCnt | tr -d ' ')" = 1 ]; }

until_holds "three workers" has_workers 3
until_holds "tasks are done" has_done 20
scontrol requeue "${job}_2"
until_holds "one is requeued" restarts
until_holds "two workers are left" has_workers 2
until_holds "three workers again" has_workers 3
code=0
wait "$coordinator" || code=$?
[ "$code" -eq 0 ] || { echo "the coordinator ended with $code" >&2 && exit 1; }
said "the run is over"
python3 same_results.py "$work/run" "$work/undisturbed"
