# %% [markdown]
# # A first mechanism in ten minutes
#
# A four-bar linkage in ten lines: its picture, its drive torque and its bearing forces. The cells are separated by `# %%`; Jupyter
# (with jupytext), VS Code and marimo open this file as a notebook, and Python runs it as a program.

# %%
import dwell
import numpy as np

m = dwell.Builder("Four-bar")
m.body("ground", A=(0, 0), D=(0.3, 0))
m.body("crank", A=(0, 0), B=(0.1, 0), mass=1.0, center=(0.05, 0), inertia=8e-4)
m.body("coupler", B=(0, 0), C=(0.25, 0), mass=1.5, center=(0.125, 0), inertia=8e-3)
m.body("rocker", D=(0, 0), C=(0.2, 0), mass=1.2, center=(0.1, 0), inertia=4e-3)
m.pin("A", "ground", "crank").pin("B", "crank", "coupler").pin("C", "coupler", "rocker").pin("D", "ground", "rocker")
m.actuator("phi", angle=("ground", "crank")).assembly(phi=1.0, rocker=1.8)
m.load("weight", gravity=(0, -9.81))
four_bar = m.assemble()
print(four_bar.scene.check())
four_bar  # in a notebook: its picture

# %% [markdown]
# The torque and the bearing forces at 60°, with the crank at a constant 20 rad/s:

# %%
forces = four_bar.at(np.radians(60), 20.0)
print(f"torque {forces.actuator_force('phi'):.4f} N m")
for pin in "ABCD":
    print(f"bearing {pin}: {forces.reaction(f'{pin}.magnitude'):.3f} N")

# %% [markdown]
# The torque and the forces over a whole revolution, from the reduced model: m(q) and ½m′(q) give the torque, and each reaction is
# R = a q̈ + b q̇² + Σ c F. Here q̈ = 0.

# %%
q = np.linspace(0, 2 * np.pi, 361)
reduced = four_bar.reduce(q, ["A", "B", "C", "D"])
speed, g = 20.0, 9.81
torque = reduced.half_dm * speed**2 - reduced.w["weight"] * g
force = {name: reduced.b[name] * speed**2 + reduced.c["weight"][name] * g for name in reduced.b}
largest = {pin: np.hypot(force[f"{pin}.x"], force[f"{pin}.y"]).max() for pin in "ABCD"}
print(f"largest torque {np.abs(torque).max():.4f} N m; bearings", {pin: round(float(f), 2) for pin, f in largest.items()}, "N")
assert abs(torque[60] - forces.actuator_force("phi")) < 1e-12

# %% [markdown]
# Released from rest at 60°, the mechanism swings under its weight:

# %%
m.motion(duration=2.0, initial_coordinate={"phi": 1.0})
motion = m.assemble().simulate(1e-9)
print(f"after 2 s: phi = {motion['phi'][-1]:.6f} rad, estimated error {motion.estimated_error:.1e} rad")
