"""Formulation 1, positions to reactions: dense equations in reference-point coordinates.

Newton on all constraint rows; velocities J v = q'; accelerations J a = q'' - J' v; the multipliers of the joints and of
the actuators from M a - f = J^T multipliers, each of which is the force or moment of the first body on the second.
"""

import numpy
from mpmath import mp, mpf

import joints
from jets import Jet, lift
from scene import evaluate

STEP = 0.05  # rad or m: the continuation's step from [assembly], which keeps the branch


def refine(matrix, residual, x):
    """x with residual(x) = 0 at full precision: `matrix`, its derivative in double precision, solves for each correction."""
    last = None
    for _ in range(60):
        r = residual(x)
        scale = max(abs(v) for v in r)
        if scale == 0:
            return x
        d = least(matrix, [float(v / scale) for v in r])
        x = [v - scale * mpf(float(s)) for v, s in zip(x, d)]
        step = mpf(float(max(abs(d)))) * scale
        done = step < max(abs(v) for v in x) * mpf(10) ** (3 - mp.dps)
        # Of rows that depend the last digits remain.
        if done or last is not None and last / 4 < step < mpf(10) ** (10 - mp.dps):
            return x
        last = step
    raise ValueError("the residual does not converge")


def least(matrix, right):
    """The smallest solution of equations of which some may depend, in double precision."""
    return numpy.linalg.lstsq(numpy.array(matrix, float), numpy.array(right, float), rcond=1e-11)[0]


class Machine:
    def __init__(self, scene):
        self.scene, self.rows, self.names = scene, joints.rows(scene), list(scene.bodies)
        self.first = {b: 3 * k for k, b in enumerate(self.names)}
        self.x = None  # the coordinates in double precision at self.q of the actuators

    def bodies(self, x):
        return {**{b: x[k:k + 3] for b, k in self.first.items()}, "ground": (0 * x[0],) * 3}

    def jacobian(self, x, rows):
        """Residuals and their derivatives, one column at a time."""
        values, J = [], []
        for row in rows:
            line = [0 * x[0]] * len(x)
            for k in (self.first[b] + k for b in row.bodies for k in range(3)):
                value = lift(row.residual(self.bodies([Jet(v, 1) if i == k else v for i, v in enumerate(x)])))
                line[k] = value.d
            values.append(value.v)
            J.append(line)
        return values, J

    def newton(self, x, q, free, rows):
        """In double precision: coordinates `free` that close the rows at q, as well as they can."""
        drive = [0.0] * (len(rows) - len(q)) + q
        for _ in range(30):
            values, J = self.jacobian(x, rows)
            d = least([[line[k] for k in free] for line in J], [float(v) - f for v, f in zip(values, drive)])
            for k, step in zip(free, d):
                x[k] -= float(step)
            if max(abs(d)) < 1e-7:  # it converges quadratically
                return x
        if len(free) < len(x):
            return x
        raise ValueError("Newton's method does not converge")

    def assemble(self):
        """The branch of [assembly]: rough angles, positions that fit them, then all rows."""
        s, angle = self.scene, {b: self.scene.guess(b) for b in self.names if b in self.scene.assembly}
        for c in s.actuators:
            if "angle" in s.coordinates[c]:
                first, second = s.coordinates[c]["angle"]
                angle.setdefault(second, s.guess(c) + angle.get(first, 0))
        x = [float(v) for k, b in enumerate(self.names) for v in (0.1 + 0.03 * k, 0.1, angle[b])]
        positions = [k for k in range(len(x)) if k % 3 < 2]
        x = self.newton(x, [], positions, self.rows[:-len(s.actuators)])
        self.q = [float(s.guess(c)) for c in s.actuators]
        self.x = self.newton(x, self.q, range(len(x)), self.rows)

    def move(self, q):
        """Exact coordinates at q: small steps in double precision, then all digits."""
        if self.x is None:
            self.assemble()
        start, goal = self.q, [float(v) for v in q]
        count = int(max(abs(g - a) for g, a in zip(goal, start)) / STEP) + 1
        for k in range(1, count + 1):
            self.q = [a + (g - a) * k / count for a, g in zip(start, goal)]
            self.x = self.newton(self.x, self.q, range(len(self.x)), self.rows)
        self.J = numpy.array(self.jacobian(self.x, self.rows)[1], float)
        drive = self.drive(q)
        return refine(self.J, lambda x: [r.residual(self.bodies(x)) - d for r, d in zip(self.rows, drive)],
                      [mpf(v) for v in self.x])

    def drive(self, q):
        """The right side of all rows: zero for the joints' rows, then the actuators'."""
        return [mpf(0)] * (len(self.rows) - len(q)) + list(q)

    def along(self, x, v):
        """All rows along a motion with velocities v and no accelerations."""
        X = self.bodies([Jet(a, b) for a, b in zip(x, v)])
        return [lift(r.residual(X)) for r in self.rows]

    def rates(self, x, drive):
        """v with J v = drive."""
        return refine(self.J, lambda v: [r.d - d for r, d in zip(self.along(x, v), drive)], [mpf(0)] * len(x))

    def velocities(self, x, qd):
        return self.rates(x, self.drive(qd))

    def weights(self):
        return [w for m, i in self.scene.bodies.values() for w in (m, m, i)]

    def state(self, q, qd, qdd):
        """All coordinates with both derivatives, and the multipliers by name."""
        x = self.move(q)
        v = self.velocities(x, qd)
        a = self.rates(x, [d - r.s for d, r in zip(self.drive(qdd), self.along(x, v))])
        net = [w * s - f for w, s, f in zip(self.weights(), a, self.forces(x, v))]
        columns = list(zip(*self.jacobian(x, self.rows)[1]))
        residual = lambda m: [sum(j * f for j, f in zip(column, m)) - n for column, n in zip(columns, net)]
        multipliers = refine(self.J.T, residual, [mpf(0)] * len(self.rows))
        return State(self, x, v, a, {r.name: m for r, m in zip(self.rows, multipliers)})

    def forces(self, x, v):
        """The loads as generalized forces, by virtual work."""
        s, f, X = self.scene, [mpf(0)] * len(x), self.bodies([Jet(a, b) for a, b in zip(x, v)])
        names = {}
        for c in s.coordinates:
            value = joints.coordinate(s, X, c)
            names[c], names[c + ".velocity"] = value.v, value.d

        def add(force, bodies, work):
            """`work` is the displacement on which the force does work."""
            for k, d in enumerate(self.jacobian(x, [joints.Row("", bodies, work)])[1][0]):
                f[k] += force * d

        for load in s.loads.values():
            number = lambda key: evaluate(load[key], names)
            if "gravity" in load:
                for k, w in enumerate(self.weights()):
                    f[k] += w * mpf((load["gravity"] + [0])[k % 3])
            elif "torque" in load:
                f[self.first[load["torque"]] + 2] += number("magnitude")
            elif "force" in load:
                body, d = s.points[load["force"]][0], joints.unit(load["direction"])
                d = joints.turned(self.bodies(x), body, d) if load.get("frame") == "body" else d
                add(number("magnitude"), [body],
                    lambda Y: sum(p * e for p, e in zip(joints.place(s, Y, load["force"]), d)))
            elif "spring" in load or "damper" in load:
                ends = load.get("spring") or load["damper"]
                length = joints.distance(s, X, ends)
                pull = (number("stiffness") * (length.v - mpf(load["free-length"]) * s.length) if "spring" in load
                        else number("damping") * length.d)
                add(-pull, [s.points[e][0] for e in ends], lambda Y: joints.distance(s, Y, ends))
            else:
                a, b = load.get("torsion-spring") or load["rotational-damper"]
                turn = X[b][2] - X[a][2]
                torque = (number("stiffness") * (turn.v - mpf(load["free-angle"]) * s.angle) if "torsion-spring" in load
                          else number("damping") * turn.d)
                add(-torque, [a, b], lambda Y: Y[b][2] - Y[a][2])
        return f


class State:
    def __init__(self, machine, x, v, a, multipliers):
        self.machine, self.v, self.a, self.multipliers = machine, v, a, multipliers
        self.X = machine.bodies([Jet(*jet) for jet in zip(x, v, a)])

    def value(self, name):
        """A quantity by its name in the case's file."""
        s, (head, _, last) = self.machine.scene, name.rpartition(".")
        if name in self.multipliers:
            return self.multipliers[name]
        order = {"angle": "v", "angular_velocity": "d", "angular_acceleration": "s"}.get(last)
        if order:
            return getattr(self.X[head][2], order)
        if head in s.points:
            return getattr(joints.place(s, self.X, head)["xy".index(last[-1])], {"v": "d", "a": "s"}.get(last[:-1], "v"))
        if last == "travel" and head in s.joints:
            return joints.travel(s, self.X, head).v
        order = {"velocity": "d", "acceleration": "s"}.get(last)
        return getattr(joints.coordinate(s, self.X, head if order else name), order or "v")

    def unit_runs(self):
        """m and half of its derivative from the kinetic energy at unit speed: sum w v^2, and sum w v a at q'' = 0."""
        w = self.machine.weights()
        return sum(k * s * s for k, s in zip(w, self.v)), sum(k * s * r for k, s, r in zip(w, self.v, self.a))
