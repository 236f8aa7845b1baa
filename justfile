# Recipes for working on Dwell. `just` alone lists them.

[private]
default:
    @just --list --unsorted

# All checks on all cases (or those named): pictures, tables and findings in reports/
[group('main')]
validate *cases: && size faults
    cargo run --release -- validate {{ cases }}

# The same with the extremes that take minutes: 1e5 revolutions
[group('main')]
validate-long: && size
    cargo run --release -- validate --long

# What a pose costs against the mechanism's size, and its errors: reports/size.png
[group('main')]
size:
    cargo run --release --example size

# Deliberate faults, and which independent truths catch them: reports/faults.png, .md and .txt
[group('main')]
faults:
    cargo run --release --example faults

# All tests
[group('main')]
test:
    cargo test --release --workspace

# Format and lints, warnings denied
[group('care')]
lint:
    cargo fmt --all --check
    cargo clippy --release --workspace --all-targets -- -D warnings

# Exact evaluation against hand-written closed forms, one by one and in batches, as ratios of one run
[group('care')]
bench:
    cargo bench -p dwell-kinetostatics --bench reduced --bench batches --bench table --bench kinds
    cargo bench -p dwell-dynamics --bench motion

# Beside Exudyn, Pinocchio and MuJoCo: installs them into a scratch environment; reports/peers.md and .png
[group('care')]
peers:
    python3 validation/peers/run.py

# What the build server runs
[group('care')]
ci: lint test validate
