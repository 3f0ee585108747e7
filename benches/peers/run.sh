#!/bin/sh
# proboscis beside CasADi on the elephant trunk: builds both, runs them in turn, writes results/gallery/studies/peer and the table of
# benches/README.md. Options are those of compare.py: --intervals, --repeats, --interpreted-repeats, --library, and --proboscis PATH,
# which takes a program that is there instead of building one.
set -eu
cd "$(dirname "$0")/../.."
venv=target/peers
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
"$venv/bin/python" -m pip install --quiet -r benches/peers/requirements.txt
case " $* " in
    *" --proboscis"*) ;;
    *) cargo build --release --locked --bin proboscis; set -- --proboscis target/release/proboscis "$@" ;;
esac
exec "$venv/bin/python" benches/peers/compare.py \
    problems/scenes/elephant_trunk.json problems/elephant_trunk_effort.json results/gallery/studies/peer "$@"
