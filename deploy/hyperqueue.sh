#!/bin/sh
# Workers as tasks of HyperQueue (`hq`), which starts and ends allocations of Slurm or PBS as there is work:
#   hq server start &
#   hq alloc add slurm --time-limit 4h -- --partition=PARTITION
#   ISOLA_CONNECT=tcp/HOST:7447 ISOLA_SECRET_FILE=$PWD/runs/blade/secret deploy/hyperqueue.sh 32
# Each task is a worker; one that has had nothing to do for ten minutes leaves, and its allocation may end.
set -eu
: "${ISOLA_CONNECT:?where does the coordinator listen? ISOLA_CONNECT=tcp/HOST:7447 $0 WORKERS}"
slots=${ISOLA_SLOTS:-1}
exec hq submit --name isola-workers --array "1-${1:-8}" --cpus "$slots" --crash-limit 100 \
    --stdout none --stderr 'isola-worker-%{JOB_ID}-%{TASK_ID}.log' \
    ${ISOLA_SECRET_FILE:+--env "ISOLA_SECRET_FILE=$ISOLA_SECRET_FILE"} ${ISOLA_SECRET:+--env "ISOLA_SECRET=$ISOLA_SECRET"} -- \
    isola-worker --connect "$ISOLA_CONNECT" --slots "$slots" --wait 60 --idle-exit 600 --grace 60
