#!/usr/bin/env bash
# What maturin takes for cargo when tests make a wheel: it builds the whole workspace with its tests, as `cargo test --workspace`
# has done before, so that nothing is compiled again for other features, and tells of no test. Whatever else is asked goes to cargo.
set -o pipefail
case $1 in
    rustc | build)
        cargo build --workspace --bins --tests --locked --message-format json-render-diagnostics | grep -v '"overflow_checks":[a-z]*,"test":true'
        ;;
    *) exec cargo "$@" ;;
esac
