#!/usr/bin/env bash
# The shipped Compose files for real, with secret and certificates: workers 1, 3, 1; one killed, one paused, one cut off and back,
# the coordinator killed and restarted. Ends with 0 if every branch was stored once and the files are those of an undisturbed run.
#
#   deploy/trial_compose.sh [FOLDER WITH isola AND isola-worker]     default: target/release
#
# Needs Docker, Compose, Python and apt-get: the base image is made of Debian packages. Takes some minutes; leaves nothing behind.
set -euo pipefail
programs=$(realpath "${1:-$(dirname "$0")/../target/release}")
cd "$(dirname "$0")"
# shellcheck source=trial_common.sh
. ./trial_common.sh

work=$(mktemp -d)
name=isola-trial-$$
# An address of its own on the loopback interface.
address=127.88.$((RANDOM % 250 + 1)).1
if docker compose version >/dev/null 2>&1; then
    compose=(docker compose)
else
    compose=(docker-compose)
fi
export ISOLA_PUBLISH=$address ISOLA_PROTOCOL=tls ISOLA_CERTIFICATES=$work/certificates
export ISOLA_STUDY=models/nonlinear_damper/study.toml ISOLA_CHANGES="--amplitudes 0.004:0.012:0.00002"
export ISOLA_SERVING="--lease 5"
compose+=(-p "$name" -f compose.yaml -f compose.tls.yaml -f "$work/image.yaml")

ended() {
    local code=$?
    if [ "$code" -ne 0 ]; then
        "${compose[@]}" logs --no-color --tail 20 || true
    fi
    "${compose[@]}" down --volumes --timeout 5 >/dev/null 2>&1 || true
    docker rmi --force "$name" "$name-base" >/dev/null 2>&1 || true
    rm -rf "$work"
    exit "$code"
}
trap ended EXIT

# The base: a C library, and a shell with the small commands, of Debian packages.
(
    cd "$work"
    apt-get -o APT::Sandbox::User=root download -qq libc6 libgcc-s1 busybox-static ca-certificates >/dev/null
    mkdir root
    for package in *.deb; do dpkg-deb --extract "$package" root; done
    mkdir -p root/bin root/etc
    install -d -m 1777 root/tmp
    for command in $(root/bin/busybox --list 2>/dev/null || root/usr/bin/busybox --list); do
        [ -e "root/bin/$command" ] || ln -s busybox "root/bin/$command"
    done
    [ -e root/bin/busybox ] || cp root/usr/bin/busybox root/bin/busybox
    printf 'isola:x:10001:10001::/:/bin/sh\n' >root/etc/passwd
    tar -C root -c . | docker import - "$name-base" >/dev/null
)
mkdir -p "$work/image/bin" "$work/image/runs"
install -m 755 "$programs/isola" "$programs/isola-worker" "$work/image/bin/"
install -m 755 start.sh "$work/image/bin/isola-start"
cp -r ../models "$work/image/models"
docker build --quiet --build-arg "BASE=$name-base" --tag "$name" --file Dockerfile.release "$work/image" >/dev/null
# Slow workers: however quick the machine, the run must not be over before all of this has happened to it.
printf 'services:\n  coordinator:\n    image: %s\n  worker:\n    image: %s\n    cpus: "0.25"\n' "$name" "$name" >"$work/image.yaml"
said "image of Debian packages"

"$programs/isola" cert "$work/certificates" --name coordinator --name "$address" >/dev/null
chown -R 10001 "$work/certificates"

# shellcheck disable=SC2086 # words
"$programs/isola" sweep "../$ISOLA_STUDY" $ISOLA_CHANGES --out "$work/undisturbed" >"$work/undisturbed.log" 2>&1
said "undisturbed run"

containers() { # SERVICE, and more options
    docker ps --quiet --filter "label=com.docker.compose.project=$name" --filter "label=com.docker.compose.service=$1" "${@:2}"
}
coordinator() { containers coordinator --all; }
# A coordinator that ends otherwise is started again.
run_is_over() { [ "$(docker inspect --format '{{.State.Status}} {{.State.ExitCode}}' "$(coordinator)" 2>/dev/null)" = "exited 0" ]; }
workers() { containers worker; }
one_of() { workers | sed -n "$1p"; }
status_json() { docker exec "$(coordinator)" isola status /runs/run --json; }
goes_on() { # more is done than now
    local now
    now=$(status 's["tasks"]["done"]')
    until_holds "$1: goes on after $now tasks" has_done $((now + 5))
}
# As Prometheus asks for it, from outside: the authority of the certificates says who answers.
expired() {
    python3 - "https://$address:8080/metrics" "$work/certificates/ca.crt" \
        "$(docker exec "$(coordinator)" cat /runs/run/http-token 2>/dev/null)" <<'END'
import ssl, sys, urllib.request

url, authority, token = sys.argv[1:]
encrypted = urllib.request.HTTPSHandler(context=ssl.create_default_context(cafile=authority))
opener = urllib.request.build_opener(urllib.request.ProxyHandler({}), encrypted)
request = urllib.request.Request(url, headers={"Authorization": f"Bearer {token}"})
with opener.open(request, timeout=20) as answer:
    lines = answer.read().decode().splitlines()
counts = [line.split()[1] for line in lines if line.startswith("isola_leases_expired_total ")]
print(int(float(counts[0])))
END
}
has_expired() { [ "$(expired)" -ge "$1" ]; }
scale() { "${compose[@]}" up --detach --no-build --no-recreate --scale "worker=$1" >/dev/null 2>&1; }

scale 1
until_holds "one worker" has_workers 1
until_holds "tasks are done" has_done 20
scale 3
until_holds "three workers" has_workers 3
goes_on "three workers"

before=$(expired)
docker kill "$(one_of 1)" >/dev/null
goes_on "one killed"
until_holds "a lease of the killed one expired" has_expired $((before + 1))
scale 3
until_holds "three workers again" has_workers 3

before=$(expired) paused=$(one_of 1)
docker pause "$paused" >/dev/null
until_holds "a lease of the paused one expired" has_expired $((before + 1))
goes_on "one paused"
docker unpause "$paused" >/dev/null
until_holds "the paused one is back" has_workers 3

before=$(expired) cut=$(one_of 2)
docker network disconnect --force "${name}_default" "$cut"
until_holds "a lease of the one that was cut off expired" has_expired $((before + 1))
docker network connect "${name}_default" "$cut"
until_holds "the one that was cut off is back" has_workers 3
goes_on "reconnected"

docker kill "$(coordinator)" >/dev/null
docker start "$(coordinator)" >/dev/null
until_holds "three workers after the coordinator was killed" has_workers 3
docker restart "$(coordinator)" >/dev/null
until_holds "three workers after the coordinator was restarted" has_workers 3

scale 1
until_holds "one worker is left" has_workers 1

docker update --cpus "$(nproc)" "$(workers)" >/dev/null
until_holds "the run is over" run_is_over
docker cp "$(coordinator):/runs/run" "$work/run" >/dev/null

python3 same_results.py "$work/run" "$work/undisturbed"
