# %% [markdown]
# # The paper's study with its two runs
#
# Jordi, Zayas and Cardona (TMT 2008) take the parameters of the equation m q̈ + ½m′ q̇² = 0 from two kinetostatic runs of any mechanism
# program: (i) at unit speed, (ii) uniformly accelerated from rest, so that q̇² = 2q. Here both are made with `Mechanism.at`, combined, and
# compared with `reduce`. Then SciPy, if it is installed, integrates the motion.

# %%
import pathlib

import dwell
import numpy as np

here = pathlib.Path(__file__).resolve() if "__file__" in globals() else pathlib.Path.cwd() / "notebook"
scene = next(p for p in (top / "validation/single-dwell/scene.toml" for top in here.parents) if p.exists())
mechanism = dwell.read(str(scene))
q = np.linspace(0, 2 * np.pi, 361)

# %%
run_i = [mechanism.at(x, 1.0, 0.0) for x in q]
run_ii = [mechanism.at(x, np.sqrt(2 * x), 1.0) for x in q]
half_dm = np.array([s.actuator_force("phi") for s in run_i])
m = np.array([s.actuator_force("phi") for s in run_ii]) - half_dm * 2 * q
b = np.array([s.reaction("slide.normal") for s in run_i])
a = np.array([s.reaction("slide.normal") for s in run_ii]) - b * 2 * q
reduced = mechanism.reduce(q, ["slide.normal"])
for name, combined, exact in [("m", m, reduced.m), ("½m′", half_dm, reduced.half_dm), ("m_e1", a, reduced.a["slide.normal"]), ("m_e2", b, reduced.b["slide.normal"])]:
    difference = np.abs(combined - exact).max() / np.abs(exact).max()
    print(f"{name:>5}: combined runs and reduce differ by {difference:.1e} of the largest value")
    assert difference < 1e-12

# %%
print(f"period by quadrature: {mechanism.period().period:.12f} s")
try:
    from scipy.integrate import solve_ivp
except ImportError:
    print("SciPy is not installed: the motion is not integrated here")
else:
    f, jacobian, start = mechanism.rhs()

    def turn(t, y):
        return y[0] - 2 * np.pi

    turn.terminal = True
    found = solve_ivp(f, (0, 10), start, method="DOP853", rtol=1e-12, atol=1e-12, events=turn)
    print(f"period by SciPy:      {found.t_events[0][0]:.12f} s")
    assert abs(found.t_events[0][0] - mechanism.period().period) < 1e-9
