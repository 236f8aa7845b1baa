#!/usr/bin/env bash
# The pages that the tests open, into the folder given: one of each command, one in space, and one of a hostile scene.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=$1
dwell=target/release/dwell
mkdir -p "$out"
run() {
    # Some of these end with a finding that fails or a way that ends early: their pages are pages, too.
    "$dwell" "$@" --html --pictures none --out "$out" >/dev/null 2>&1 || [ $? -eq 1 ]
}

run kinetostatics validation/slider-crank/scene.toml
run statics validation/press/scene.toml
# Forces at contacts: teeth with a pressure angle of 20°, a rack, a wheel that rolls, a cam's follower.
for contact in "planetary:radii = \[30, 20\]" "rack-pinion:radius = 20"; do
    name=${contact%%:*}
    sed "s/${contact#*:}/&, pressure-angle = 0.3490658503988659/" "validation/$name/scene.toml" >"$out/$name-teeth.toml"
    run kinetostatics "$out/$name-teeth.toml"
done
run kinetostatics validation/rolling-wheel/scene.toml
sed '/^\[requests\]/,$d' validation/cam/scene.toml >"$out/cam-whole.toml"
run kinetostatics "$out/cam-whole.toml"
{
    cat validation/spatial/bevel-differential.toml
    printf '\n[loads]\nbrake = { torque = "carrier", axis = [1, 0, 0], magnitude = -3.0 }\n\n[prescribed]\nduration = 1.0\nl = { speed = 2.0 }\nr = { speed = 0.5 }\n'
} >"$out/bevel.toml"
run kinetostatics "$out/bevel.toml"
run check validation/single-dwell/scene.toml
for command in simulate reduce calibrate runs; do
    run "$command" validation/single-dwell/scene.toml
done
run symbolic validation/four-bar/scene.toml
run sweep validation/four-bar/scene.toml --vary crank.mass=1,2,3
# All columns at 1001 positions.
sed '/^\[requests\]/,/^\[/{/^\[requests\]/d;/^\[/!d}' validation/single-dwell/scene.toml >"$out/whole-dwell.toml"
run kinematics "$out/whole-dwell.toml" --points 1001
run simulate "$out/whole-dwell.toml"
run kinematics validation/spatial/rssr.toml
run statics validation/spatial/wobble-plate.toml
run reduce validation/spatial/rssr.toml
{ cat validation/spatial/rssr.toml; printf '\n[prescribed]\nduration = 6.0\nq = { speed = 1.0 }\n'; } >"$out/space-forces.toml"
run kinetostatics "$out/space-forces.toml"
{ cat validation/spatial/rssr.toml; printf '\n[motion]\nduration = 3.0\ninitial-velocity = { q = 1.0 }\n'; } >"$out/space-motion.toml"
run simulate "$out/space-motion.toml"
run cycle validation/press/scene.toml
run cycle validation/slider-crank-friction/scene.toml
run equilibria validation/andrews/scene.toml
run linearise validation/double-pendulum/scene.toml
# A title and a note that would act if they were markup, in a scene with several units.
cat >"$out/hostile.toml" <<'SCENE'
title = "</title></script><script>alert('title')</script><img src=x onerror=\"alert('image')\">"
note = "<b onmouseover=alert(1)>bold</b> &amp; <!-- <script> \u2028"
[units]
length = "mm"
inertia = "kg m2"
[bodies.ground]
points = { A = [0, 0], D = [300, 0] }
[bodies.crank]
points = { A = [0, 0], B = [100, 0] }
[bodies.coupler]
points = { B = [0, 0], C = [250, 0] }
[bodies.rocker]
points = { D = [0, 0], C = [200, 0] }
[joints]
A = { revolute = ["ground.A", "crank.A"] }
B = { revolute = ["crank.B", "coupler.B"] }
C = { revolute = ["coupler.C", "rocker.C"] }
D = { revolute = ["ground.D", "rocker.D"] }
[actuators]
phi = { angle = ["ground", "crank"] }
[assembly]
coupler = 0.6
rocker = 1.8
SCENE
run kinematics "$out/hostile.toml"
