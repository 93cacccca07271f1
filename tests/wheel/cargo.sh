#!/bin/sh
# What maturin takes for cargo when tests make a wheel: it builds the whole workspace, as `cargo test --workspace` has done
# before, so that nothing is compiled again for other features. Whatever else is asked goes to cargo.
case $1 in
    rustc | build) exec cargo build --workspace --locked --message-format json-render-diagnostics ;;
    *) exec cargo "$@" ;;
esac
