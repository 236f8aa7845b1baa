"""The checks: the compared quantities, the scale, the tolerance, and its reason."""

from typing import NamedTuple


class Check(NamedTuple):
    comparison: str
    scale: str
    tolerance: float
    reason: str


ROUNDING = "rounding of the written numbers, measured over all cases"
KIND = "the largest of its kind in the file"

CHECKS = {
    "closure": Check("joints, points and coordinates of every row with the scene's text", KIND, 5e-11, ROUNDING),
    "laws": Check("prescribed coordinates with their laws", KIND, 1e-12, ROUNDING),
    "rates": Check("changes between rows with the integrals of their rates", KIND, 5e-7, "the rule's error beyond four times its estimate"),
    "equilibrium": Check("Newton's and Euler's equations of every body with the written forces", KIND, 5e-12, ROUNDING),
    "free-directions": Check("what joints transmit along the directions that they leave free", KIND, 1e-12, ROUNDING),
    "loads": Check("forces of loads with the expressions and tables of the scene", KIND, 1e-11, ROUNDING),
    "friction": Check("friction with its law and the written reactions", KIND, 1e-12, ROUNDING),
    "powers": Check("powers with forces along the written motion", KIND, 1e-11, ROUNDING),
    "known-reactions": Check("reactions that the scene gives over an angle", KIND, 1e-11, ROUNDING),
    "totals": Check("shaking forces, powers and energies with sums over all bodies", KIND, 1e-11, ROUNDING),
    "joint-forces": Check("magnitudes, directions and components of joint forces with the components along the ground", KIND, 1e-12, ROUNDING),
    "motion-equilibrium": Check("Newton's and Euler's equations of every body with loads, drives, friction and reactions", KIND, 1e-11, ROUNDING),
    "wanted": Check("where rows begin and end, and their speed, with the scene", "the number, or 1", 1e-9, ROUNDING),
    "impacts": Check("speeds after impacts with restitution times those before", "the largest speed", 1e-4, "speeds before impacts are extrapolated from rows"),
    "drives": Check("forces of drives with the scene", KIND, 1e-12, ROUNDING),
    "motors": Check("currents, electrical powers and efficiencies of motors with the circuit of the scene", KIND, 1e-12, ROUNDING),
    "stops": Check("coordinates with the ends that rigid stops leave", "one radian or metre, or more", 1e-14, "an impact is located to rounding"),
    "energy": Check("changes of kinetic energy and currents between rows with the power of all forces", KIND, 3e-7, "the tolerance of the integration"),
    "energies": Check("changes of potential energy and works between rows with powers", KIND, 2e-8, "the tolerance of the integration, and the rule's error beyond its estimate"),
    "energy-columns": Check("kinetic and potential energy and their balance with sums over bodies and loads", KIND, 1e-11, ROUNDING),
    "energy-balance": Check("the balance of energy of every row with zero", KIND, 1e-6, "the tolerance of the integration"),
    "summary": Check("energies and events of the summary with rows and events", KIND, 1e-7, "the tolerance of the integration"),
    "events": Check("changes of sign between rows with events, and events with their values", "the value, or 1", 1e-9, "an event is located to the tolerance of the integration"),
    "reduced": Check("m, ½m′, w and V of `reduce` with sums over all bodies", "the largest of the column and its terms", 1e-11, ROUNDING),
    "coefficients": Check("a, b and c of `reduce` in the equations of every body", KIND, 1e-11, ROUNDING),
    "slopes": Check("m and V of `reduce` with the integrals of ½m′ and w between rows", "the change between rows at the largest slope", 1e-7, "the rule's error beyond four times its estimate"),
    "runs": Check("m, ½m′, a and b of `runs` with both runs and with those of `reduce`", KIND, 2e-10, ROUNDING),
    "archive": Check("the table with the archive of the same name", "each number", 0.0, "the same bits"),
    "extrema": Check("extrema of the summary with the rows around them", "the largest extremum of the unit", 5e-8, "a polynomial through rows beyond its own error"),
    "places": Check("slopes at the places of extrema, over one row", "the largest extremum of the unit", 5e-5, "a polynomial through rows beyond its own error"),
    "order": Check("the abscissa grows or falls from row to row", "nothing: yes or no", 0.0, "yes or no"),
    "ratios": Check("changes of angles and travels between rows at rest with the integrals of velocity ratios", "the largest ratio", 1e-7, "the rule's error beyond four times its estimate"),
    "quotients": Check("velocity ratios and transmission angles with velocities and places", KIND, 1e-11, ROUNDING),
    "extents": Check("by how much bodies turn and slides travel, and dwells, with the rows", "the extent, or 1", 1e-9, "the error of extrema between rows"),
    "headings": Check("units of columns with what their names say", "nothing: words", 0.0, "words"),
    "sections": Check("internal forces of links with equilibrium of the part beyond each cut, and with their envelopes", KIND, 1e-11, ROUNDING),
    "cycle": Check("speeds, fluctuation, works and both ends of a cycle with its rows", KIND, 1e-7, "the tolerance of the integration"),
    "cycle-rates": Check("times and speeds of a cycle with the integrals of their rates over the coordinate", KIND, 1e-7, "the tolerance of the integration"),
    "cycle-rates-friction": Check("the same where friction turns with the sliding velocity", KIND, 1e-5, "rows do not meet the instants at which friction turns"),
    "cycle-equation": Check("m q̈ + ½m′ q̇² of a cycle with loads and drives, by `reduce`", "the largest term", 1e-8, "polynomials through rows of `reduce`"),
    "modes": Check("frequencies and damping ratios with eigenvalues", "the largest eigenvalue", 1e-13, ROUNDING),
    "equilibria": Check("the table of equilibria with its summary and the start of the motion", KIND, 1e-13, ROUNDING),
    "stability": Check("neighbouring equilibria, and changes of sign of the static force", "nothing: yes or no", 0.0, "yes or no"),
    "rest": Check("static forces at equilibria by `reduce`", "the largest load", 1e-9, "polynomials through rows of `reduce`"),
    "stiffness": Check("eigenvalues of equilibria with the slope of the static force over m by `reduce`", "the largest of all equilibria", 1e-7, "differences of polynomials through rows"),
    "matrices": Check("rows of A and C that are states", "1", 1e-13, ROUNDING),
    "eigenvalues": Check("eigenvalues in the characteristic polynomial of the written A", "the largest eigenvalue", 1e-9, ROUNDING),
    "nearest": Check("the equilibrium of `linearise` with the one of `equilibria` that is nearest to the start", KIND, 1e-12, ROUNDING),
    "linear": Check("A, B, C and D with differences of the equation of motion and of R = a q̈ + b q̇² + Σ c F", "the largest change of the row", 1e-7, "differences of polynomials through rows of `reduce`"),
    "contents": Check("masses, counts, the centre of mass and angles of `check` with the scene and a row at the assembly", "the number, or the size", 1e-11, ROUNDING),
    "range": Check("the ends of the rows of `reduce` with the limit positions of `check`", "the range", 1e-12, ROUNDING),
    "calibration": Check("the period of the calibrated scene by quadrature", "the period", 1e-10, ROUNDING),
    "table": Check("the table of `reduce` with its rows, beyond the errors that it states", "the scale that the table states", 1e-12, ROUNDING),
    "draws": Check("varied numbers with the grid and the generator of random numbers", "each number", 1e-13, ROUNDING),
    "statistics": Check("statistics of the summary with the rows", KIND, 1e-12, ROUNDING),
    "variants": Check("extrema of m of variants by sums over bodies", "the largest m", 5e-11, ROUNDING),
}

# By the number of a check of the product that a check here replaces, or belongs to.
NUMBERS = {
    12: "closure wanted stops order range",
    13: "rates ratios quotients slopes extrema places events cycle-rates cycle-rates-friction cycle-equation",
    14: "equilibrium motion-equilibrium free-directions coefficients sections linear matrices eigenvalues rest stiffness",
    15: "totals joint-forces powers energies energy-columns reduced extents contents calibration modes stability equilibria nearest cycle summary "
        "impacts statistics variants",
    16: "laws loads friction known-reactions drives motors draws",
    17: "archive runs table",
    18: "headings",
    20: "energy energy-balance",
}


def number(key):
    """The number of the check that a key belongs to."""
    return next(number for number, keys in NUMBERS.items() if key in keys.split())
