//! The functions of MATLAB: evaluation at many coordinates, and the rates of a state.

use crate::describe::describe;
use crate::export::Export;
use crate::identifiers::comment;
use crate::machine::{LoadEffect, PartKind, Resistance};
use crate::part::{CURVE, HEAD, TERMS};
use std::fmt::Write as _;

/// `NAME.m`: all functions at a column of coordinates.
pub(super) fn evaluation(export: &Export, name: &str) -> String {
    let machine = &export.machine;
    let mut text = format!(
        "function out = {name}(q)\n%{} The reduced model at the coordinates q, each row of a result for one of them.\n%\n",
        name.to_uppercase()
    );
    for line in describe(export) {
        _ = writeln!(text, "{}", format!("% {}", comment(&line)).trim_end());
    }
    text += "%\n% out.m q'' + out.half_dm q'^2 = sum of out.w F over the loads,\n% reaction k = out.a(:,k) q'' + out.b(:,k) q'^2 + sum of out.c(:,k,load) F. Outside the range everything is NaN.\npersistent d\nif isempty(d)\n";
    _ = writeln!(
        text,
        "  d = load(fullfile(fileparts(mfilename('fullpath')), '{name}_data.mat'));\nend\nq = q(:);\nn = numel(q);"
    );
    match machine.domain.revolutions {
        0 => text += "q(~(q >= d.domain(1) & q <= d.domain(2))) = NaN;\n",
        _ => {
            text += "q(~(abs(q) < 1e6 * d.domain(2))) = NaN;\nq = q - d.domain(2) * floor(q / d.domain(2));\n";
        }
    }
    _ = writeln!(
        text,
        "[cells, x, width] = place(q, d.domain(1), d.motion_cells, d.motion_index, d.motion_bins_per_unit);\n[out.m, out.half_dm] = curve(cells, {HEAD}, x, width);\nout.w = zeros(n, {loads});\nout.v = zeros(n, {loads});",
        loads = machine.loads.len()
    );
    let curves = export.parts[PartKind::Motion as usize].curves.len();
    for (k, load) in machine.loads.iter().enumerate() {
        let (number, place) = (k + 1, machine.place(k));
        _ = if load.effect.is_conservative() {
            writeln!(
                text,
                "[out.v(:,{number}), half] = curve(cells, {}, x, width);\nout.w(:,{number}) = -2 * half;",
                HEAD + CURVE * place
            )
        } else {
            writeln!(
                text,
                "out.w(:,{number}) = column(cells, x, {}, d.motion_places({column}), d.motion_constants({column}));",
                HEAD + CURVE * curves,
                column = place + 1
            )
        };
    }
    other_parts(export, &mut text);
    text += "end\n\n";
    text += PLACE;
    text += &POLYNOMIAL.replace("TERMS", &TERMS.to_string());
    text
}

/// Reactions and positions.
fn other_parts(export: &Export, text: &mut String) {
    let machine = &export.machine;
    for (kind, part) in [
        (PartKind::Reactions, "reactions"),
        (PartKind::Positions, "positions"),
    ] {
        let count = export.parts[kind as usize].columns.len();
        if count == 0 {
            continue;
        }
        _ = writeln!(
            text,
            "[cells, x] = place(q, d.domain(1), d.{part}_cells, d.{part}_index, d.{part}_bins_per_unit);\nvalues = zeros(n, {count});\nfor k = 1:{count}\n  values(:,k) = column(cells, x, {HEAD}, d.{part}_places(k), d.{part}_constants(k));\nend"
        );
        let reactions = machine.reactions.len();
        match kind {
            PartKind::Reactions => {
                _ = writeln!(
                    text,
                    "out.a = values(:, 1:{reactions});\nout.b = values(:, {}:{});\nout.c = reshape(values(:, {}:end), n, {reactions}, []);",
                    reactions + 1,
                    2 * reactions,
                    2 * reactions + 1
                );
            }
            PartKind::Motion | PartKind::Positions => *text += "out.xy = values;\n",
        }
    }
}

const PLACE: &str = "\
% The numbers of the cell of each coordinate, the position in it from -1 to 1, and its width.
function [cells, x, width] = place(q, from, all, index, bins_per_unit)
if isempty(index)
  cells = zeros(numel(q), 3);
  x = 0 * q;
  width = 0 * q;
  return
end
bin = min(max(floor((q - from) * bins_per_unit), 0), numel(index) - 1);
bin(isnan(bin)) = 0;
cells = all(index(bin + 1), :);
x = (q - cells(:,1)) .* cells(:,2);
width = cells(:,3);
end

";

const POLYNOMIAL: &str = "\
% A function and half its slope.
function [value, half] = curve(cells, first, x, width)
half = 0 * x;
integral = 0 * x;
for j = TERMS:-1:1
  g = cells(:, first + 1 + j);
  half = half .* x + g;
  integral = (integral + g / j) .* x;
end
value = cells(:, first + 1) + width .* integral;
end

% A function of the cells, or a constant.
function value = column(cells, x, first, place, constant)
value = constant + 0 * x;
if place > 0
  value = 0 * x;
  for j = TERMS:-1:1
    value = value .* x + cells(:, first + TERMS * (place - 1) + j);
  end
end
end
";

/// `NAME_rates.m`: the rates of a state [q; q'], with the loads of the scene.
pub(super) fn rates(export: &Export, name: &str) -> String {
    let machine = &export.machine;
    let [q, q_dot] = machine.initial;
    let mut text = format!(
        "function dy = {name}_rates(t, y, F)\n%{}_RATES The rates of the state y = [q; q'], for ode45:\n%   [t, y] = ode45(@{name}_rates, [0 1], [{q}; {q_dot}], odeset('RelTol', 1e-9, 'AbsTol', 1e-9));\n% F has the force of every load; without it, those of the scene at the start. A rotor's inertia is part of m here.\nr = {name}(y(1));\nq_dot = y(2);\nm = r.m;\nforce = -r.half_dm * q_dot^2;\nif nargin < 3\n  F = zeros(1, {});\n",
        name.to_uppercase(),
        machine.loads.len()
    );
    for (k, load) in machine.loads.iter().enumerate() {
        let (number, value) = (k + 1, load.effect.scene_value());
        _ = match &load.effect {
            LoadEffect::Conservative { .. }
            | LoadEffect::Constant { .. }
            | LoadEffect::Input { .. } => writeln!(text, "  F({number}) = {value:e};"),
            LoadEffect::Damper { law, .. } | LoadEffect::VariableDamper { law, .. } => match law {
                Resistance::Linear => {
                    writeln!(text, "  F({number}) = -{value:e} * r.w({number}) * q_dot;")
                }
                Resistance::Quadratic => {
                    writeln!(text, "  F({number}) = {value:e} * abs(q_dot) * q_dot;")
                }
            },
            LoadEffect::Motor(motor) => {
                let constant = motor.gear_ratio * motor.torque_constant;
                writeln!(
                    text,
                    "  % The current follows the voltage at once: no inductance.\n  F({number}) = {constant:e} * ({value:e} - {constant:e} * r.w({number}) * q_dot) / {:e};",
                    motor.resistance
                )
            }
        };
    }
    text += "end\n";
    for (k, load) in machine.loads.iter().enumerate() {
        if let Some(motor) = load.effect.motor().filter(|_| load.effect.has_rotor()) {
            let reflected = motor.gear_ratio * motor.gear_ratio * motor.rotor_inertia;
            // The derivative of w by central differences.
            _ = writeln!(
                text,
                "h = 1e-5;\nlow = {name}(y(1) - h);\nhigh = {name}(y(1) + h);\ndw = (high.w({0}) - low.w({0})) / (2 * h);\nm = m + {reflected:e} * r.w({0})^2;\nforce = force - {reflected:e} * r.w({0}) * dw * q_dot^2;",
                k + 1
            );
        }
    }
    text += "force = force + sum(r.w .* F);\ndy = [q_dot; force / m];\nend\n";
    text
}
