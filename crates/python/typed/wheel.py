"""Code that a type checker must accept. The tests check it without running it."""

import dwell
import numpy as np

m = dwell.Builder("Wheel")
m.body("ground", O=(0.0, 0.0))
m.body("wheel", O=(0.0, 0.0), mass=1.0, center="O", inertia=0.1)
m.pin("O", "ground", "wheel").actuator("phi", angle=("ground", "wheel")).motion(duration=1.0, initial_velocity={"phi": 1.0})
wheel: dwell.Mechanism = m.assemble()
coefficients = wheel.reduce(np.linspace(0.0, 1.0, 11), ["O"])
largest: float = float(coefficients.m.max()) + float(coefficients.b["O.x"][0])
torque: float = wheel.at(0.5, 1.0).actuator_force("phi")
motion: dwell.Motion = wheel.simulate(1e-9)
angle = motion(0.5)["phi"]
