# %% [markdown]
# # A flywheel and a counterweight, chosen by a design study
#
# An engine-like slider-crank: which flywheel keeps its speed steady, and which counterweight takes the shaking force off the main bearing?

# %%
import dwell
import numpy as np

m = dwell.Builder("Slider-crank")
m.body("ground", A=(0, 0), G=(0, 0))
m.body("crank", A=(0, 0), B=(0.04, 0), mass=2.0, center=(0.0, 0), inertia=0.02)
m.body("rod", B=(0, 0), C=(0.14, 0), mass=0.5, center=(0.04, 0), inertia=1.2e-3)
m.body("piston", C=(0, 0), mass=0.4, center="C", inertia=2e-4)
m.pin("A", "ground", "crank").pin("B", "crank", "rod").pin("C", "rod", "piston")
m.joint("guide", prismatic=("ground.G", "piston.C"), axis=(1, 0))
m.actuator("phi", angle=("ground", "crank")).assembly(rod=0.0)
m.load("gas", force="piston.C", direction=(-1, 0), magnitude="600*(1 + cos(phi))*(1 - 0.3*sin(phi))")
m.drive("motor", motor="phi", stall_torque=40.0, no_load_speed=160.0)
machine = m.assemble()

# %% [markdown]
# The steady cycle, and the flywheel for a coefficient of fluctuation of 1 %:

# %%
cycle = machine.cycle(1e-10, fluctuation=0.01)
print(f"{cycle.mean_speed:.2f} rad/s, fluctuation {cycle.fluctuation:.4f}; a flywheel of {cycle.flywheel:.4f} kg m2 keeps it to 0.01")
print("work in a cycle (J):", {name: round(value, 3) for name, value in cycle.works.items()})
heavier = machine.scene.with_value("crank.inertia", 0.02 + cycle.flywheel).assemble().cycle(1e-10)
print(f"with it: {heavier.fluctuation:.6f}")
assert abs(heavier.fluctuation - 0.01) < 1e-5

# %% [markdown]
# The counterweight: the centre of the crank's mass on the other side of A. The inertia force in bearing A at constant speed is b q̇²; the
# best place makes its largest value over a revolution smallest.

# %%
q, speed = np.linspace(0, 2 * np.pi, 361), cycle.mean_speed
places = np.linspace(0.0, -0.03, 31)


def largest_force(place):
    b = machine.scene.with_value("crank.center[0]", place).reduce(q, ["A"]).b
    return speed**2 * np.hypot(b["A.x"], b["A.y"]).max()


forces = np.array([largest_force(place) for place in places])
best = int(np.argmin(forces))
print(f"best counterweight: centre at {places[best] * 1e3:.1f} mm, {forces[best]:.0f} N in bearing A; without, {forces[0]:.0f} N")
# Half of the reciprocating mass balanced is the textbook's compromise: it halves the force.
assert forces[best] < 0.7 * forces[0]

# %% [markdown]
# How much do the tolerances of the shop matter? A thousand random machines, lengths ±0.1 mm and masses ±2 %: the extremes of m.

# %%
varied = {"crank.points.B[0]": "±0.0001", "rod.points.C[0]": "±0.0001", "rod.mass": "±2%", "piston.mass": "±2%"}
swept = dwell.sweep(machine.scene, varied, ["m"], samples=1000, seed=1)
print(f"m.max: {swept['m.max'].mean():.6f} kg m2, standard deviation {swept['m.max'].std():.1e}")
