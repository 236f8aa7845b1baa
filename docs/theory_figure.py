"""Draws docs/theory-constraint-actuator.svg: the mechanism at phi = 1 with a constraint actuator in its slide, and its free
bodies with the reactions of section 4. Positions by equations (2) and (3); nothing is copied from the program.

    python3 docs/theory_figure.py
"""

from math import atan2, cos, hypot, pi, sin, sqrt
from pathlib import Path

R, L1 = 0.1, 0.25
O, Q = (0.2, 0.0), (-0.2, 0.4)
PIXELS = 620  # to a metre
COLORS = {"crank": "#0072b2", "coupler": "#d55e00", "rocker": "#009e73", "guide": "#cc79a7", "slider": "#e69f00"}
FORCE = "#222222"


def positions(phi):
    """B, C and P."""
    b = (R * cos(phi), R * sin(phi))
    d = (O[0] - b[0], O[1] - b[1])
    square = d[0] ** 2 + d[1] ** 2
    h = sqrt(L1**2 / square - 0.25)
    c = (b[0] + 0.5 * d[0] - h * d[1], b[1] + 0.5 * d[1] + h * d[0])
    return b, c, (2 * c[0] - b[0], 2 * c[1] - b[1])


class Drawing:
    """Shapes in metres, moved by an offset in pixels."""

    def __init__(self):
        self.shapes = []
        self.offset = (0.0, 0.0)

    def at(self, point):
        return self.offset[0] + PIXELS * point[0], self.offset[1] - PIXELS * point[1]

    def line(self, a, b, color, width=5.0, more=""):
        (x, y), (u, v) = self.at(a), self.at(b)
        self.shapes.append(
            f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{u:.1f}" y2="{v:.1f}" stroke="{color}" stroke-width="{width}" '
            f'stroke-linecap="round" {more}/>'
        )

    def pin(self, point, radius=5.0):
        x, y = self.at(point)
        self.shapes.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="white" stroke="{FORCE}" stroke-width="2"/>')

    def words(self, point, words, shift=(8, -8), size=17, color=FORCE):
        x, y = self.at(point)
        self.shapes.append(f'<text x="{x + shift[0]:.1f}" y="{y + shift[1]:.1f}" font-size="{size}" fill="{color}">{words}</text>')

    def arrow(self, tail, angle, words, length=0.09, shift=(6, -6)):
        """A force that acts at its tail."""
        head = (tail[0] + length * cos(angle), tail[1] + length * sin(angle))
        self.line(tail, head, FORCE, 2.5)
        for side in (2.7, -2.7):
            barb = (head[0] + 0.02 * cos(angle + side), head[1] + 0.02 * sin(angle + side))
            self.line(head, barb, FORCE, 2.5)
        self.words(head, words, shift)

    def block(self, center, angle, color):
        x, y = self.at(center)
        self.shapes.append(
            f'<rect x="{x - 22:.1f}" y="{y - 11:.1f}" width="44" height="22" fill="{color}" fill-opacity="0.35" stroke="{color}" '
            f'stroke-width="2.5" transform="rotate({-angle * 180 / pi:.2f} {x:.1f} {y:.1f})"/>'
        )

    def ground(self, point):
        x, y = self.at(point)
        self.shapes.append(f'<path d="M{x:.0f} {y:.0f} l-12 18 h24 z" fill="white" stroke="#666" stroke-width="2"/>')
        self.pin(point)


def mechanism(drawing, phi, b, c, p, opening):
    """The whole mechanism; the actuator holds the guide's axis at the distance `opening` from P."""
    drawing.line((0, 0), b, COLORS["crank"])
    drawing.line(b, p, COLORS["coupler"])
    drawing.line(O, c, COLORS["rocker"])
    distance = hypot(p[0] - Q[0], p[1] - Q[1])
    direction = atan2(p[1] - Q[1], p[0] - Q[0])
    theta = direction - opening / distance
    along, normal = (cos(theta), sin(theta)), (-sin(theta), cos(theta))
    drawing.line(Q, (Q[0] + 0.7 * along[0], Q[1] + 0.7 * along[1]), COLORS["guide"])
    foot = (p[0] - opening * normal[0], p[1] - opening * normal[1])
    drawing.block(foot if opening else p, theta, COLORS["slider"])
    if opening:
        drawing.line(foot, p, FORCE, 9.0)
        drawing.line(foot, p, "white", 5.0)
        drawing.line(foot, ((foot[0] + p[0]) / 2, (foot[1] + p[1]) / 2), FORCE, 3.0)
        drawing.words(((foot[0] + p[0]) / 2, (foot[1] + p[1]) / 2), "q₂, R", (14, 4))
    for place in ((0, 0), O, Q):
        drawing.ground(place)
    for place, name, shift in ((b, "B", (10, 2)), (c, "C", (10, 12)), (p, "P", (4, -12))):
        drawing.pin(place)
        drawing.words(place, name, shift)
    for place, name, shift in (((0, 0), "A", (-24, 4)), (O, "O", (12, 6)), (Q, "Q", (-8, -12))):
        drawing.words(place, name, shift)
    drawing.words((0.0, 0.0), "φ = q₁, τ", (8, 40))


def free_bodies(drawing, phi, b, c, p):
    """Each body with the reactions that act on it, moved apart."""
    theta = atan2(p[1] - Q[1], p[0] - Q[0])
    base = drawing.offset

    def moved(x, y):
        drawing.offset = (base[0] + x, base[1] + y)

    moved(-20, 60)
    drawing.line((0, 0), b, COLORS["crank"])
    drawing.arrow((0, 0), 3.4, "R_A", shift=(-38, 4))
    drawing.arrow(b, 1.05, "−R_B", shift=(-52, 4))
    drawing.words((0, 0), "τ ↺", (-10, 28))
    moved(75, -20)
    drawing.line(b, p, COLORS["coupler"])
    drawing.arrow(b, 4.19, "R_B", shift=(8, 6))
    drawing.arrow(c, 2.6, "−R_C", shift=(-52, 0))
    drawing.arrow(p, 5.0, "−R_P", shift=(8, 4))
    moved(150, 60)
    drawing.line(O, c, COLORS["rocker"])
    drawing.arrow(c, 0.3, "R_C")
    drawing.arrow(O, 0.9, "R_O")
    moved(110, -60)
    drawing.block(p, theta, COLORS["slider"])
    drawing.arrow(p, pi / 2, "N n", length=0.07)
    drawing.arrow(p, 0.1, "R_P", length=0.1)
    moved(-30, -90)
    drawing.line(Q, (Q[0] + 0.7 * cos(theta), Q[1] + 0.7 * sin(theta)), COLORS["guide"])
    drawing.arrow(p, -pi / 2, "−N n", length=0.07, shift=(-52, 4))
    drawing.arrow(Q, 2.2, "R_Q")
    drawing.offset = base


def main():
    phi = 1.0
    b, c, p = positions(phi)
    drawing = Drawing()
    for x, title, opening in ((200, "one degree of freedom", 0.0), (720, "the constraint is an actuator: q₂ ≠ 0", 0.07)):
        drawing.offset = (x, 440)
        mechanism(drawing, phi, b, c, p, opening)
        drawing.words((-0.2, 0.0), title, (0, 70))
    drawing.offset = (1270, 440)
    free_bodies(drawing, phi, b, c, p)
    drawing.words((-0.2, 0.0), "free bodies (inertia terms left out)", (0, 110))
    shapes = "\n".join(drawing.shapes)
    text = (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1800 580" font-family="DejaVu Sans, sans-serif">\n'
        f'<rect width="1800" height="580" fill="white"/>\n{shapes}\n</svg>\n'
    )
    Path(__file__).with_name("theory-constraint-actuator.svg").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
