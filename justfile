# Recipes for working on Dwell. `just` alone lists them.

[private]
default:
    @just --list --unsorted

# All checks on all cases (or those named): pictures, tables and findings in reports/
[group('main')]
validate *cases: && size mutations trials
    cargo run --release -- validate {{ cases }}

# The same with the extremes that take minutes: 1e5 revolutions, 1000 pulses, 200 random machines
[group('main')]
validate-slow: && size (trials "--slow")
    cargo run --release -- validate --slow

# What a pose costs against the mechanism's size, and its errors: reports/size.png
[group('main')]
size:
    cargo run --release --example size

# Deliberate faults, and which independent checks detect them: reports/mutations.png, .md and .txt
[group('main')]
mutations:
    cargo run --release --example mutations

# A fault in every key of a scene, 60 pulses and 20 random machines (--slow: 1000 and 200; --seed N: others): reports/key-faults.txt, pulses.md, machines.md
[group('main')]
trials *options:
    cargo run --release --example trials -- {{ options }}

alias validate-long := validate-slow
alias faults := mutations

# All tests, every number of docs/theory.md, 2000 mutated scenes with random commands, 200 motions under nested laws, and 12 random jobs of optimise
[group('main')]
test: && fuzz laws jobs
    python3 tests/handout/theory_numbers.py
    cargo test --release --workspace

# Mutated scenes with random commands, each in a process of its own: no panic, no silence, no contradiction
[group('main')]
fuzz pairs="2000" seed="1":
    cargo build --release --workspace --bins
    python3 tests/fuzz/run.py {{ pairs }} {{ seed }}
    python3 tests/fuzz/motions.py 30 {{ seed }}

# Motions under nested laws (if, step, sign, floor, min, max, clamp, abs, tables, pulses), against an independent program
[group('main')]
laws count="200" seed="1":
    cargo build --release --workspace --bins
    python3 tests/laws/selftest.py 20 {{ seed }}
    python3 tests/laws/run.py {{ count }} {{ seed }}

# Random jobs of optimise (goals, conditions, mechanisms in the plane and in space), judged by sweeps of the scenes that it wrote
[group('main')]
jobs count="12" seed="1":
    cargo build --release --workspace --bins
    python3 tests/jobs/run.py {{ count }} {{ seed }}

# Format, lints with warnings denied, no circle of imports between folders, no long file or function without a reason, and a place for every named fault
[group('care')]
lint:
    cargo fmt --all --check
    cargo clippy --release --workspace --all-targets -- -D warnings
    python3 tests/house/circles.py
    python3 tests/house/sizes.py
    python3 tests/mutate/named.py
    python3 tests/mutate/selftest.py

# That the computing half compiles without pictures and files, here and for a browser (without that target: here only), without a warning. Cold it takes minutes, for it builds with other features
[group('care')]
computing:
    cargo clippy -p dwell-study --no-default-features -- -D warnings
    @if rustc --print target-libdir --target wasm32-unknown-unknown | xargs test -d; then \
        cargo clippy -p dwell-study -p dwell-live --no-default-features --target wasm32-unknown-unknown -- -D warnings; \
    else echo "wasm32 is not checked: rustup target add wasm32-unknown-unknown"; fi

# Changes of the source text, one at a time in a scratch copy, and which checks fail by each: reports/source-mutations.md and .txt. An hour; `--named` only the faults of tests/mutate/named.toml
[group('care')]
mutate *options="400 1":
    python3 tests/mutate/run.py {{ options }}

# Licences, sources, duplicates and advisories of the dependencies, by deny.toml. The tool: cargo install cargo-deny --locked
[group('care')]
deny:
    @command -v cargo-deny >/dev/null || { echo "cargo-deny is missing: cargo install cargo-deny --locked"; exit 1; }
    cargo deny --locked check

# Exact evaluation against hand-written closed forms, one by one and in batches, as ratios of one run
[group('care')]
bench:
    cargo bench -p dwell-kinetostatics --bench reduced --bench batches --bench table --bench kinds --bench variants
    cargo bench -p dwell-dynamics --bench motion
    cargo bench -p dwell-cli --bench wait
    cargo bench -p dwell-study --bench export

# Beside Exudyn, Pinocchio and MuJoCo: installs them into a scratch environment; reports/peers.md and .png. Then the Python package, the newest wheel in target/wheels, beside pylinkage, Exudyn and SymPy: tables in docs/performance.md
[group('care')]
peers:
    python3 validation/peers/run.py
    python3 validation/peers/python.py --write

# The paper's MATLAB part in GNU Octave, on exported runs of Dwell and of Exudyn, against `dwell reduce --from`. Installs Octave where it is missing
[group('care')]
octave:
    python3 validation/foreign/run.py

# The live page, in target/web: the analyses as WebAssembly with an editor, as one HTML file and as a folder for a server. Adds the target wasm32-unknown-unknown to Rust where it is missing
[group('care')]
web:
    @rustc --print target-libdir --target wasm32-unknown-unknown | xargs test -d || rustup target add wasm32-unknown-unknown || \
        { echo "the live page needs Rust's target wasm32-unknown-unknown: rustup target add wasm32-unknown-unknown"; exit 1; }
    cargo build -p dwell-live --lib --target wasm32-unknown-unknown --profile web
    cargo run --release --example web

# Tests of the live page in Chromium, after `just page`, which installs what they need
[group('care')]
live: web
    cargo build --release --workspace --bins
    cd tests/page && node live.mjs ../../target/web ../../target/page

# The Python package: built into target/python, its tests, notebooks and types, and what its calls cost. Needs Python 3.10 or later
[group('care')]
python:
    cargo build --release --workspace --bins
    crates/python/run.sh

# The HTML pages of every command and all reports in Chromium, from the file system; pictures in target/page/pictures. Installs Chromium and its driver; needs the reports of `just validate`
[group('care')]
page:
    cargo build --release --workspace --bins
    tests/page/run.sh

# A million designs spread by Ray and by Dask over four processes, two of which are killed on the way. After `just python`; installs Ray
[group('care')]
engines: python
    target/python/bin/pip install --quiet ray polars
    cd crates/python && DWELL_POINTS=1000000 ../../target/python/bin/python -m pytest -s tests/test_engines.py

# Exported FMUs by FMPy and the standard's schemas, in a scratch environment: validated, simulated by both kinds, saved and restored
[group('care')]
export:
    cargo build --release --workspace --bins
    python3 validation/fmu/run.py

# FMUs of two cases in a second importer, fmi-rs, against `dwell simulate`. Builds it in a scratch folder, which takes minutes and needs libclang
[group('care')]
fmi-rs:
    cargo build --release --workspace --bins
    python3 validation/fmu/second_importer.py

# Exported C and Rust on an emulated Cortex-M4F: self-tests, instructions of a call, a million steps. Installs compiler and emulator
[group('care')]
cortex:
    cargo build --release --workspace --bins
    python3 validation/cortex/run.py

# Ten million designs by a run that is killed twice, read back by Polars, DuckDB and pandas as docs/sweep.md shows. Installs these into a scratch environment
[group('care')]
designs points="10000000":
    cargo build --release --workspace --bins
    python3 validation/designs/run.py {{ points }}

# Remakes all reference values (or those of the named cases) by the independent program and compares them digit by digit; reports/reference.md. Installs mpmath into a scratch environment; takes minutes
[group('care')]
reference *cases:
    python3 validation/reference/run.py {{ cases }}

# Faults planted in files and scenes, one at a time, and whether the independent reader (validation/audit) finds them. Needs Python 3.11 with NumPy
[group('care')]
audit *scenes:
    cargo build --release --workspace --bins
    python3 validation/audit/selftest.py target/release/dwell {{ scenes }}

# What takes too long for each change, as a whole in a night: its parts are the seven recipes below
[group('care')]
nightly: nightly-validation nightly-tests nightly-imports && nightly-laws nightly-jobs nightly-others
    seed=$(date +%j); for part in 0 1 2 3 4; do just nightly-fuzz $part $seed || exit 1; done

# Of `nightly`: 1e5 revolutions, 1000 pulses, 200 random machines, all deliberate faults, also those in files, and the computing half by itself
[group('care')]
nightly-validation: validate-slow mutations audit computing

# Of `nightly`: 2000 new random draws in every property, of the second's seed or another
[group('care')]
nightly-tests seed=`date +%s`:
    PROPTEST_RNG_SEED={{ seed }} PROPTEST_CASES=2000 cargo test --release --workspace

# Of `nightly`: 20 000 mutated models of other programs, of the second's seed or another
[group('care')]
nightly-imports seed=`date +%s`:
    PROPTEST_RNG_SEED={{ seed }} PROPTEST_CASES=20000 cargo test --release -p dwell-door --test named

# Of `nightly`: one of five parts (0 to 4) of 100 000 mutated scenes, of the day's seed or another
[group('care')]
nightly-fuzz part="0" seed=`date +%j`:
    cargo build --release --workspace --bins
    python3 tests/fuzz/run.py 20000 {{ seed }} --first $(({{ part }} * 20000))
    python3 tests/fuzz/motions.py 300 {{ seed }} --first $(({{ part }} * 300))

# Of `nightly`: 20 000 motions under nested laws, of the day's seed or another
[group('care')]
nightly-laws seed=`date +%j`: (laws "20000" seed)

# Of `nightly`: 300 random jobs of optimise, of the day's seed or another
[group('care')]
nightly-jobs seed=`date +%j`: (jobs "300" seed)

# Of `nightly`: ten million designs, other programs, the reference values, the dependencies' advisories. Installs what these need
[group('care')]
nightly-others: peers deny octave designs reference export fmi-rs cortex engines

# Lint, test and validate: a part of what the build server runs (.ci/run), which also tests the pages, the exports and Python
[group('care')]
ci: lint test validate
