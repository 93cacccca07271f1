#!/usr/bin/env bash
# A sweep across network namespaces: coordinator and two workers on networks of their own, a router between that loses packets at
# random, and a cable that is pulled for 20 s. Secret and certificates are on. Ends with 0 if every branch was stored once and the
# files are those of an undisturbed run. Packets are not delayed: that takes netem, which not every kernel has.
#
#   deploy/trial_network.sh [FOLDER WITH isola AND isola-worker]     default: target/release
#
# Needs root, ip, nft and Python; takes some minutes and leaves nothing behind.
set -euo pipefail
programs=$(realpath "${1:-$(dirname "$0")/../target/release}")
cd "$(dirname "$0")"
# shellcheck source=trial_common.sh
. ./trial_common.sh

work=$(mktemp -d)
name=isola-$$
# Of a hundred packets so many are lost.
loss=3
# Of sides that are not used otherwise: 0 the coordinator, 1 and 2 the workers.
net=10.231
study=../models/nonlinear_damper/study.toml
# Long enough: on a quick machine one worker alone must not be done with it while the cable is out.
changes=(--amplitudes 0.004:0.012:0.00002)
started=()

ended() {
    local code=$? side
    if [ "$code" -ne 0 ]; then
        tail -n 5 "$work"/*.log || true
    fi
    [ ${#started[@]} -eq 0 ] || kill -KILL "${started[@]}" 2>/dev/null || true
    for side in router 0 1 2; do
        ip netns delete "$name-$side" 2>/dev/null || true
    done
    rm -rf "$work"
    exit "$code"
}
trap ended EXIT

within() { ip netns exec "$name-$1" "${@:2}"; }

ip netns add "$name-router"
within router ip link set lo up
within router sysctl -q -w net.ipv4.ip_forward=1
for side in 0 1 2; do
    ip netns add "$name-$side"
    within router ip link add "to$side" type veth peer name eth0 netns "$name-$side"
    within router ip addr add "$net.$side.254/24" dev "to$side"
    within router ip link set "to$side" up
    within "$side" ip addr add "$net.$side.1/24" dev eth0
    within "$side" ip link set lo up
    within "$side" ip link set eth0 up
    within "$side" ip route add default via "$net.$side.254"
done
within router nft -f - <<NFT
table inet trial {
    counter lost { }
    chain forward {
        type filter hook forward priority 0; policy accept;
        numgen random mod 100 < $loss counter name lost drop
    }
}
NFT

"$programs/isola" sweep "$study" "${changes[@]}" --out "$work/undisturbed" >"$work/undisturbed.log" 2>&1
said "undisturbed run"

"$programs/isola" cert "$work/certificates" --name "$net.0.1" >/dev/null
ip netns exec "$name-0" "$programs/isola" sweep "$study" "${changes[@]}" --out "$work/run" --listen "tls/$net.0.1:7447" \
    --tls "$work/certificates/coordinator" --workers 0 --lease 5 >"$work/coordinator.log" 2>&1 &
coordinator=$!
started+=("$coordinator")
run_is_over() { ! kill -0 "$coordinator" 2>/dev/null; }
has_address() { [ -s "$work/run/address" ]; }
until_holds "the coordinator listens" has_address
for side in 1 2; do
    ip netns exec "$name-$side" "$programs/isola-worker" --connect "tls/$net.0.1:7447" --secret-file "$work/run/secret" \
        --tls "$work/certificates/worker" --slots 1 --wait 60 >"$work/worker-$side.log" 2>&1 &
    started+=("$!")
done

status_json() { within 0 "$programs/isola" status "$work/run" --json; }

until_holds "two workers" has_workers 2
until_holds "tasks are done" has_done 20
within router ip link set to1 down
pulled=$SECONDS
until_holds "one worker is left" has_workers 1
before=$(status 's["tasks"]["done"]')
until_holds "it goes on without the other" has_done $((before + 5))
[ $((SECONDS - pulled)) -ge 20 ] || sleep $((20 - SECONDS + pulled))
within router ip link set to1 up
until_holds "both workers after $((SECONDS - pulled)) s" has_workers 2
code=0
wait "$coordinator" || code=$?
[ "$code" -eq 0 ] || { echo "the coordinator ended with $code" >&2 && exit 1; }
said "the run is over; $(within router nft list counter inet trial lost | grep -o 'packets [0-9]*') lost"
python3 same_results.py "$work/run" "$work/undisturbed"
