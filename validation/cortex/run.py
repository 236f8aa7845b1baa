"""Exported code on a processor of controllers: `just cortex`.

The single-dwell mechanism in C and in Rust, in single precision, compiled for a Cortex-M4F and run by an emulator of a board that has
one: both self-tests, the instructions of a call, and a million steps, whose energy must not change by more than 1e-6. In double precision,
which that processor has no unit for, the self-test and the instructions. The emulator counts instructions, not cycles.

Installs gcc-arm-none-eabi and qemu-system-arm from the distribution where they are missing, and Rust's target by rustup.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
HOME = HERE.parents[1]
TARGET = "thumbv7em-none-eabihf"
PROCESSOR = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]
WARNINGS = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-Wconversion"]
# Of each instruction of the emulated processor one nanosecond, so that its counter counts instructions.
BOARD = "qemu-system-arm -M mps2-an386 -nographic -monitor none -serial none -icount shift=0"
HOST = ["-semihosting-config", "enable=on,target=native", "-kernel"]

RUST = """#![no_std]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
#[no_mangle]
pub extern "C" fn rust_self_test() -> i32 {
    match single_dwell::self_test() {
        Ok(()) => 0,
        Err(check) => check as i32,
    }
}
"""


def command(*words, **options):
    return subprocess.run([str(word) for word in words], check=True, text=True, **options)


def install():
    """The compiler, the emulator and Rust's target."""
    packages = {"arm-none-eabi-gcc": "gcc-arm-none-eabi", "qemu-system-arm": "qemu-system-arm"}
    missing = [package for program, package in packages.items() if shutil.which(program) is None]
    if missing:
        command("apt-get", "install", "-y", "--no-install-recommends", *missing, "libnewlib-arm-none-eabi", stdout=subprocess.DEVNULL)
    command("rustup", "target", "add", TARGET, stderr=subprocess.DEVNULL)


def scene(folder):
    """The single-dwell mechanism without the positions of its paths."""
    text = (HOME / "validation/single-dwell/scene.toml").read_text(encoding="utf-8")
    path = folder / "single-dwell.toml"
    path.write_text(re.sub(r"(?m)^paths = .*$", "", text), encoding="utf-8")
    return path


def rust_library(folder, export):
    """The exported crate and a wrapper that C can call, as a static library."""
    library = folder / "libsingle_dwell.rlib"
    options = ["--target", TARGET, "-O", "-C", "panic=abort", "--edition", "2021", "--crate-name"]
    source = export / "single_dwell" / "src" / "lib.rs"
    command("rustc", *options, "single_dwell", "--crate-type", "rlib", "--cfg", 'feature="self-test"', source, "-o", library)
    wrapper = folder / "wrapper.rs"
    wrapper.write_text(RUST, encoding="utf-8")
    out = folder / "libwrapper.a"
    command("rustc", *options, "wrapper", "--crate-type", "staticlib", "--extern", f"single_dwell={library}", wrapper, "-o", out)
    return out


def run(folder, name, options, rust=False):
    """Compiles and runs an export; what it printed, by words."""
    dwell = HOME / "target/release/dwell"
    where = folder / name
    made = [dwell, "export", scene(folder), *options]
    command(*made, "--to", "c", "--out", where, capture_output=True)
    libraries, define = [], []
    if rust:
        command(*made, "--to", "rust", "--out", where, capture_output=True)
        libraries, define = [rust_library(folder, where)], ["-DWITH_RUST"]
    # Functions of the library stay single, too.
    single = "--float" in options
    double = ["-Wdouble-promotion"] if single else []
    names = ["-DMACHINE=single_dwell", "-DSINGLE_DWELL_SELF_TEST", f"-DSTEPS={1000000 if single else 1000}"]
    program = folder / f"{name}.elf"
    command("arm-none-eabi-gcc", *PROCESSOR, *WARNINGS, *double, "-O2", *names, *define, f"-I{where}", f"-I{HERE}",
            HERE / "board.c", HERE / "machine.c", where / "single_dwell.c", *libraries, "-nostdlib", "-nostartfiles",
            f"-T{HERE / 'board.ld'}", "-Wl,--no-warn-execstack", "-lm", "-lc", "-lgcc", "-o", program)
    # It prints on the standard error.
    done = command(*BOARD.split(), *HOST, program, capture_output=True, timeout=600)
    found = {}
    for line in done.stderr.splitlines():
        words, _, number = line.rpartition(" ")
        found[words] = int(number)
        print(f"{name}: {words}: {number}")
    return found


def main():
    install()
    with tempfile.TemporaryDirectory() as folder:
        single = run(Path(folder), "float", ["--accuracy", "1e-6", "--float"], rust=True)
        exact = run(Path(folder), "exact", ["--exact", "--float"])
        double = run(Path(folder), "double", ["--accuracy", "1e-9"])
    assert single["self-test"] == single["self-test of Rust"] == double["self-test"] == exact["self-test"] == 0
    for found in [single, exact]:
        assert found["periods"] > 100, found
        change = found["change of energy, 1e-9"]
        assert abs(change) < 1000, f"a million steps change the energy by {change / 1e9:.1e}"
    print("the code runs on a Cortex-M4F")


if __name__ == "__main__":
    sys.exit(main())
