"""Random commands on a scene, with valid and invalid options."""
import tomllib

METHODS = ["bdf", "esdirk34", "tr-bdf2", "tsit45", "dop853"]
# Weights with which commands are drawn. work-precision and validate take seconds, because they measure times and run all checks.
WEIGHTS = {
    "check": 22, "simulate": 16, "kinematics": 3, "statics": 3, "kinetostatics": 3, "reduce": 9, "equilibria": 13, "linearise": 12,
    "cycle": 5, "symbolic": 6, "export": 6, "calibrate": 5, "sweep": 5, "work-precision": 0.2, "schema": 0.1,
}
NONSENSE = ["", "0", "-1", "nan", "inf", "1e-30", "1e30", "1e400", "abc", "99999999999999999999", "-0", "1,5", "\u00e9", "--", "2/0"]


def name(rng):
    return rng.choices(list(WEIGHTS), list(WEIGHTS.values()))[0]


def arguments_of(rng, name, text, folder):
    """The arguments of a command on `scene.toml` in a folder; writes the other input files of the command there."""
    if name == "schema":
        return [name]
    arguments = [name, "scene.toml"]
    option = lambda option, *values: arguments.extend([option, pick(rng, values)])
    sometimes = lambda share=0.5: rng.random() < share
    if name == "simulate":
        if sometimes():
            option("--accuracy", "draft", "standard", "precise", "reference", "1e-3", "1e-5", "1e-7", "1e-9")
        else:
            fixed_method(rng, arguments, option)
            if sometimes(0.2):
                option("--atol", "1e-6", "1e-12")
            if sometimes(0.1):
                option("--max-step", "0.01", "0.1", "1")
        if sometimes(0.3):
            option("--sample-interval", "0.001", "0.01", "0.1", "1")
        elif sometimes(0.2):
            at = sorted(rng.uniform(0, rng.choice([0.05, 1, 10])) for _ in range(rng.randrange(1, 20)))
            (folder / "times").write_text("".join(f"{t}\n" for t in at))
            arguments += ["--times", "times"]
    elif name in ("kinematics", "statics", "kinetostatics"):
        if sometimes(0.7):
            option("--points", "2", "3", "7", "50", "361")
    elif name == "reduce":
        if sometimes(0.7):
            option("--points", "2", "9", "50", "721")
        if sometimes(0.3):
            option("--table-accuracy", "1e-4", "1e-8", "1e-12")
            if sometimes(0.4):
                option("--from", "0", "0.1", "-1")
                option("--to", "1", "0.3", "5")
        elif sometimes(0.2):
            option("--accuracy", "1e-4", "1e-9", "draft")
    elif name == "cycle":
        if sometimes(0.4):
            option("--fluctuation", "0.02", "0.1", "1")
        fixed_method(rng, arguments, option)
    elif name == "linearise" and sometimes():
        option("--about", "initial", "equilibrium")
    elif name == "symbolic":
        if sometimes():
            option("--format", "latex", "rust", "c", "python")
        if sometimes(0.3):
            option("--reaction", "A.x", "B.y")
    elif name == "export":
        option("--to", "c", "rust", "fmu", "fmu2", "matlab", "csv", "npz", "json")
        if sometimes():
            option("--accuracy", "1e-4", "1e-6", "1e-11")
        if sometimes(0.3):
            arguments.append("--float")
        if sometimes(0.2):
            option("--from", "0", "0.1", "-1")
            option("--until", "1", "0.3", "5")
    elif name == "calibrate":
        option("--parameter", *parameters(text))
        option("--period", *["0.1", "1", "2.5", "5", "7", "10"])
    elif name == "sweep":
        path = rng.choice(parameters(text))
        if sometimes():
            option("--vary", f"{path}=0.5:1.5:3", f"{path}=1,2")
        else:
            option("--vary", f"{path}~normal(1,0.1)", f"{path}±1%", f"{path}~uniform(0.5,1)")
            if sometimes(0.9):
                option("--samples", "1", "3")
        if sometimes(0.3):
            option("--result", "period", "m", "energy")
    if rng.random() < 0.03:
        arguments.append(rng.choice(["--points", "--frobnicate", "--rtol", "--accuracy", "1", "--vary", "--shard=1/2", "--out=scene.toml"]))
    return arguments


def fixed_method(rng, arguments, option):
    """A method and its tolerance. Methods of low order get no fine tolerance, with which they take a million steps."""
    if rng.random() < 0.8:
        option("--method", *METHODS)
    if arguments[-1] in ("tr-bdf2", "esdirk34"):
        option("--rtol", "1e-4", "1e-5", "1e-6")
    elif rng.random() < 0.5:
        option("--rtol", "1e-4", "1e-6", "1e-8", "1e-10", "1e-12")


def pick(rng, values):
    return rng.choice(NONSENSE) if rng.random() < 0.05 else rng.choice(values)


def parameters(text):
    """Paths of numbers of the scene's bodies."""
    try:
        bodies = tomllib.loads(text).get("bodies", {})
        found = [f"{name}.{key}" for name, of in bodies.items() for key in ("mass", "inertia") if key in of]
    except (tomllib.TOMLDecodeError, AttributeError, TypeError):
        found = []
    return found or ["crank.mass"]
