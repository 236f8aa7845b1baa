# %% [markdown]
# # The torque that a press needs, and its motor
#
# A crank press runs at 60 strokes a minute and presses with 3 kN over the last 8 mm. Which torque does the crank need for that motion
# (the feed-forward of its controller), and how fast does a motor run it?

# %%
import dwell
import numpy as np


def press():
    m = dwell.Builder("Crank press")
    m.body("ground", A=(0, 0), G=(0, 0))
    m.body("crank", A=(0, 0), B=(0.06, 0), mass=12.0, center="A", inertia=0.9)
    m.body("rod", B=(0, 0), C=(0.3, 0), mass=4.0, center=(0.1, 0), inertia=0.04)
    m.body("ram", C=(0, 0), mass=25.0, center="C", inertia=0.1)
    m.pin("A", "ground", "crank").pin("B", "crank", "rod").pin("C", "rod", "ram")
    m.joint("guide", prismatic=("ground.G", "ram.C"), axis=(1, 0))
    m.actuator("phi", angle=("ground", "crank")).assembly(phi=0.0, rod=0.0)
    return m


# %% [markdown]
# The reduced model knows the mechanism; the load is a generalised force w F of the ram's force F. Its velocity ratio is w.

# %%
m = press()
m.load("work", force="ram.C", direction=(-1, 0), magnitude=1.0)
mechanism = m.assemble()
q = np.linspace(0, 2 * np.pi, 721)
speed = 2 * np.pi
reduced = mechanism.reduce(q, ["A", "guide.normal"])
ram = np.array([mechanism.at(x).position("ram.C")[0] for x in q])
pressing = (reduced.w["work"] < 0) & (ram > ram.max() - 0.008)
force = np.where(pressing, 3000.0, 0.0)
torque = reduced.half_dm * speed**2 - reduced.w["work"] * force
work = np.trapezoid(torque, q) if hasattr(np, "trapezoid") else np.trapz(torque, q)
print(f"feed-forward torque: largest {torque.max():.1f} N m, work of a stroke {work:.2f} J")
print(f"largest side force on the guide: {np.abs(reduced.b['guide.normal'] * speed**2 + reduced.c['work']['guide.normal'] * force).max():.0f} N")
# The work of the pressing force is force times distance; rows of half a degree resolve it to 3 %.
assert abs(work - 3000 * 0.008) < 0.03 * 24

# %% [markdown]
# A motor with a straight line from stall to no load drives it, and the speed falls as it presses. The force is a function of the ram's
# travel here; a Python function could stand in its place.

# %%
m = press()
m.toml('[coordinates]\nrise = { travel = "guide" }')
m.load("work", force="ram.C", direction=(-1, 0), magnitude="if(rise > 0.352, if(rise.velocity > 0, 3000, 0), 0)")
m.drive("motor", motor="phi", stall_torque=60.0, no_load_speed=7.0)
m.motion(duration=5.0, initial_velocity={"phi": 2 * np.pi})
motion = m.assemble().simulate(method="dop853", tolerance=1e-9)
late = motion["t"] > 3
speeds = motion["phi.velocity"][late]
print(f"with the motor: {speeds.min():.3f} to {speeds.max():.3f} rad/s")
assert motion.early_stop is None
