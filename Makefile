# make trunk: the elephant trunk from nothing to pictures.  make test: the tests.  make help: the rest.

export PATH := $(PATH):$(or $(CARGO_HOME),$(HOME)/.cargo)/bin

CARGO := cargo
PROGRAM := target/release/proboscis
GALLERY := results/gallery
STUDIES := $(wildcard problems/studies/*.json)

BLOCKS := bending_actuator clamped_stack pull_in fe_bending_control creeping_block_at_once
MOTIONS := fe_trunk clamped_stack_step bending_actuator_step free_flight creeping_block

FUZZ_SECONDS := 600
ADVERSARY_SECONDS := 600
AGAINST := HEAD~1

.PHONY: help trunk blocks gallery build test test-python test-debian-13 test-browser wheel docs fuzz adversary compare-solvers check bindings check-bindings audit bench guard studies install-deps try-fresh clean

help:
	@echo 'make trunk         solve the elephant trunk, let it swing under constant voltages, and say where the pictures are'
	@echo 'make blocks        run the problems of finite elements, but the block of 16384'
	@echo 'make gallery       rewrite the results that the README shows, $(GALLERY)'
	@echo 'make test          run the tests'
	@echo 'make test-python   build and test the Python package, in an environment of its own (Python 3.10 or later with venv)'
	@echo 'make test-debian-13  what calls Ipopt or MUMPS, in a root of Debian 13 (debootstrap, as root; kept in ~/.cache)'
	@echo 'make test-browser  pages in a real Chromium; pictures of them in target/browser'
	@echo 'make wheel         build the wheel that needs no package of the system, in target/wheels'
	@echo 'make docs          pages of the Python package, in target/python/docs'
	@echo 'make fuzz          look for files that the reader does not survive, for FUZZ_SECONDS=$(FUZZ_SECONDS)'
	@echo 'make adversary     random robots in many forms, with fresh seeds, for ADVERSARY_SECONDS=$(ADVERSARY_SECONDS)'
	@echo 'make compare-solvers  200 random blocks and the kept problems of finite elements, by multigrid and by factors'
	@echo 'make check         formatting, lints, documentation'
	@echo 'make bindings      declarations of the C interface of Ipopt from its headers, by bindgen; make check-bindings compares them'
	@echo 'make audit         licences, sources and known vulnerabilities of all crates, by cargo-deny (installed where it is missing)'
	@echo 'make bench         measure; rewrite the tables of benches/README.md'
	@echo 'make guard         results and times of all kept problems beside those of another commit, AGAINST=$(AGAINST)'
	@echo 'make studies       what accuracy costs, hard cases, effects, random goals, warm starts, a peer: rewrite their pages in $(GALLERY)'
	@echo 'make try-fresh     run both commands of the README, and make the wheel, in bare roots of Debian (debootstrap, as root)'
	@echo 'make install-deps  install what is missing (make trunk and make test do so by themselves)'
	@echo 'make clean         remove what was built'

trunk: build
	@$(PROGRAM) solve problems/elephant_trunk.json
	@$(PROGRAM) simulate problems/elephant_trunk_constant.json
	@echo; echo 'Pictures:'; for problem in elephant_trunk elephant_trunk_constant; do ls results/$$problem/*.svg results/$$problem/report.html; done

blocks: build
	@for problem in $(BLOCKS); do $(PROGRAM) solve problems/$$problem.json || exit; done
	@for problem in $(MOTIONS); do $(PROGRAM) simulate problems/$$problem.json || exit; done

gallery: build
	@for problem in elephant_trunk elephant_trunk_effort elephant_trunk_figure_eight bending_actuator pull_in fe_bending_control fe_trunk_control; do $(PROGRAM) solve problems/$$problem.json -o $(GALLERY)/$$problem || exit; done
	@for problem in elephant_trunk_constant fe_trunk; do $(PROGRAM) simulate problems/$$problem.json -o $(GALLERY)/$$problem || exit; done
	@$(PROGRAM) solve problems/codesign_trunk.json --set 'control.free={}' --set 'control.limits=[]' -o target/design/given
	@$(PROGRAM) solve problems/codesign_trunk.json -o target/design/found
	@for design in given found; do cp target/design/$$design/right/snapshots.svg $(GALLERY)/codesign_trunk/$$design.svg || exit; done

build: install-deps
	@[ -x $(PROGRAM) ] || echo 'building (a few minutes the first time)'
	@$(CARGO) build --release --locked

test: install-deps
	@$(CARGO) test --locked $(TEST_PACKAGES)

test-python: install-deps
	@python/test

# The dependencies are those of other tests, built by this machine first: what Debian 13 builds may need its C library. Cargo before 1.91 does not know
# the first variable, and builds them too.
test-debian-13: SOLVER := $(CARGO) test --locked $(TEST_PACKAGES) -p proboscis-solver --test alone
test-debian-13: install-deps
	@$(SOLVER) --no-run
	@export CARGO_BUILD_BUILD_DIR=$${CARGO_TARGET_DIR:-target} && export CARGO_TARGET_DIR=$$CARGO_BUILD_BUILD_DIR/debian-13 && \
	  .ci/in-debian-13 env -u CLIPPY_ARGS $(SOLVER) -- ipopt ma57_adapter:: mpi:: one_mumps:: stopped::a_limit sparse::threads

test-browser:
	@.ci/install --browser
	@tests/browser/run

wheel:
	@.ci/install --wheel
	@python/wheel

docs: install-deps
	@python/install target/python
	@cd target/python && bin/python -m pdoc --output-directory docs proboscis && echo target/python/docs/index.html

# All properties at once, so that each has the whole time.
fuzz: install-deps
	@FUZZ_SECONDS=$(FUZZ_SECONDS) $(CARGO) test --release --locked --test files -- \
	  --test-threads 16 --nocapture are_read_or_refused are_refused are_taken_or_refused

adversary: install-deps
	@PROBOSCIS_SEED=$$(date +%s) PROBOSCIS_SECONDS=$(ADVERSARY_SECONDS) $(CARGO) test --release --locked --test adversary -- --nocapture

compare-solvers: install-deps
	@PROBOSCIS_BLOCKS=200 $(CARGO) test --release --locked --test solids -- --include-ignored --nocapture kept_problems random_blocks

check: install-deps
	@$(CARGO) fmt --check
	@$(CARGO) clippy --quiet --locked --lib --bins --examples --test '*' --bench '*' -- -D warnings
	@$(CARGO) clippy --quiet --locked --all-targets --no-deps --manifest-path python/Cargo.toml --target-dir "$${CARGO_TARGET_DIR:-target}" -- -D warnings
	@RUSTDOCFLAGS='-D warnings' $(CARGO) doc --quiet --locked --no-deps --lib --examples
	@RUSTDOCFLAGS='-D warnings --cfg internals' $(CARGO) doc --quiet --locked --no-deps --lib --examples

bindings:
	@.ci/bindings

check-bindings:
	@.ci/bindings --check

audit:
	@.ci/audit

guard: install-deps
	@benches/guard.py $(AGAINST)

bench: install-deps
	@$(CARGO) bench --locked --bench transcription --bench step
	@$(CARGO) bench --locked --bench solve -- --write
	@$(CARGO) bench --locked --bench kkt -- --write
	@$(CARGO) bench --locked --bench block -- 8 16 --write

studies: build
	@for study in $(STUDIES); do $(PROGRAM) study $$study -o $(GALLERY)/studies/$$(basename $$study .json) || exit; done
	@PROBOSCIS_WRITE_PAGES=1 $(CARGO) test --release --locked --test hard -- --include-ignored
	@$(CARGO) bench --locked --bench effects -- --write
	@$(CARGO) bench --locked --bench goals -- --write
	@$(CARGO) bench --locked --bench warm -- --write
	@$(CARGO) bench --locked --bench design -- --write
	@$(CARGO) bench --locked --bench feedback -- --write
	@$(CARGO) bench --locked --bench receding_horizon -- --write
	@benches/peers/run.sh

install-deps:
	@.ci/install

try-fresh:
	@.ci/try-fresh

clean:
	@$(CARGO) clean
