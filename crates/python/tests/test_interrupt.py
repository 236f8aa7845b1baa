"""Ctrl-C interrupts a computation of several seconds."""

import signal
import subprocess
import sys
import textwrap
import time

PROGRAM = """
    import dwell, signal
    # A shell lets background processes ignore SIGINT.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    m = dwell.Builder("Pendulum")
    m.body("ground", O=(0, 0))
    m.body("bob", O=(0, 0), P=(0.5, 0), mass=2.0, center="P", inertia=0.0)
    m.pin("O", "ground", "bob").actuator("phi", angle=("ground", "bob")).load("weight", gravity=(0, -9.81))
    m.load("drag", torque="bob", magnitude="-1e-9*phi.velocity")
    bob = m.motion(duration=7e3, initial_coordinate={"phi": 0.3}).assemble()
    try:
        print("begins", flush=True)
        bob.simulate(method="bdf", tolerance=1e-10)
    except KeyboardInterrupt:
        # The next simulation runs.
        m.motion(duration=0.1)
        print("interrupted,", m.assemble().simulate(1e-6).rows > 1)
"""


def test_a_long_motion_is_interrupted():
    with subprocess.Popen([sys.executable, "-c", textwrap.dedent(PROGRAM)], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "begins\n"
        # The signal arrives during the integration.
        time.sleep(0.5)
        child.send_signal(signal.SIGINT)
        assert child.stdout.read() == "interrupted, True\n"
        assert child.wait() == 0
