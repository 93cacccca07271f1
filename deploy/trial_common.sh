# shellcheck shell=bash
# What the trials share. Whoever reads this in defines `run_is_over`, a command that holds once the run has ended, and
# `status_json`, which prints the run's status.

said() { echo "$(date +%T)  $*"; }

# Waits, at most ten minutes, until something holds; not beyond the end of the run.
until_holds() { # WHAT COMMAND...
    local what=$1 deadline=$((SECONDS + 600)) last=
    shift
    until "$@"; do
        if [ -n "$last" ]; then
            echo "the run was over before: $what; the study is too short" >&2
            return 1
        fi
        if [ "$SECONDS" -gt "$deadline" ]; then
            echo "not in ten minutes: $what" >&2
            return 1
        fi
        # It may have come to hold and the run have ended since it was asked: it is asked once more.
        if run_is_over; then last=asked; else sleep 0.5; fi
    done
    said "$what"
}

# A number of the status; -1 if there is none.
status() { # EXPRESSION OF s
    status_json 2>/dev/null |
        python3 -c "import json, sys; s = json.load(sys.stdin); print(int($1))" 2>/dev/null || echo -1
}
has_workers() { [ "$(status 's["conducted"] and len(s["workers"])')" -eq "$1" ]; }
has_done() { [ "$(status 's["conducted"] and s["tasks"]["done"]')" -ge "$1" ]; }
