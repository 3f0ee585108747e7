#!/bin/sh
# proboscis beside CasADi on the elephant trunk: builds both, runs them in turn, writes results/gallery/studies/peer.
# Options are those of compare.py: --intervals, --repeats, --compiled-repeats.
set -eu
cd "$(dirname "$0")/../.."
venv=target/peers
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
"$venv/bin/python" -m pip install --quiet -r benches/peers/requirements.txt
cargo build --release --locked --bin proboscis
exec "$venv/bin/python" benches/peers/compare.py target/release/proboscis \
    problems/scenes/elephant_trunk.json problems/elephant_trunk_effort.json results/gallery/studies/peer "$@"
