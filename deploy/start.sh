#!/bin/sh
# Sweep or resume: begins a run, or goes on with it if it is there.
#
#   start.sh RUN STUDY [what `isola sweep` changes: --set K=V, --amplitudes LIST] -- [how it is served: --listen, ...]
set -eu

if [ $# -lt 2 ]; then
    echo "usage: $0 RUN STUDY [CHANGES] -- [SERVING]" >&2
    exit 2
fi
run=$1
study=$2
shift 2
if [ -f "$run/run.sqlite" ]; then
    # Changes are kept in the run.
    while [ $# -gt 0 ] && [ "$1" != -- ]; do shift; done
    [ $# -eq 0 ] || shift
    set -- resume "$run" "$@"
else
    # Leaves out the separator.
    count=$#
    while [ "$count" -gt 0 ]; do
        [ "$1" = -- ] || set -- "$@" "$1"
        shift
        count=$((count - 1))
    done
    set -- sweep "$study" --out "$run" "$@"
fi
[ $$ -eq 1 ] || exec isola "$@"

# First process of a container. Docker can restart at every exit code but 0 only. 3 says that the run ended, by `isola cancel`
# or with tasks given up, and starting it again would undo the one and not help the other; 4 that it is complete, with doubts
# that come again, as wrong usage (2) does.
isola "$@" &
isola=$!
trap 'kill -TERM "$isola"' TERM INT
code=0
wait "$isola" || code=$?
while kill -0 "$isola" 2>/dev/null; do
    # A signal ended the wait, not the program.
    code=0
    wait "$isola" || code=$?
done
case $code in
2 | 3 | 4) code=0 ;;
esac
exit "$code"
