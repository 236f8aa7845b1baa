% The paper's MATLAB part, in GNU Octave: combines the exported tables of two kinetostatic runs, integrates the free motion of the
% reduced model, and compares both with what `dwell reduce --from` makes of the same files.
%
%   octave-cli reduce.m RUN_I RUN_II COORDINATE MOMENT REACTION REDUCED PERIOD ENERGY TOLERANCE
%
% RUN_I        uniform speed:        T = ½m′ q̇²,           F = b q̇²             (Jordi, Zayas and Cardona 2008, eqs. 4 and 5)
% RUN_II       uniform acceleration: T = m q̈ + ½m′ q̇²,     F = a q̈ + b q̇²
% COORDINATE, MOMENT, REACTION   names of columns; REACTION is NAME or, where REDUCED calls it otherwise, NAME=OTHER
% REDUCED      the table that `dwell reduce --from` wrote
% PERIOD, ENERGY   time of a revolution of the free motion (s) that has this kinetic energy (J): of another source
% TOLERANCE    of m, ½m′, a and b relative to their largest, and of the period relative to itself
%
% It ends with status 1 where a difference exceeds the tolerance.

function values = column (file, wanted)
  lines = strsplit (fileread (file), "\n");
  % The line above the first number.
  head = find (! cellfun (@isempty, regexp (lines, '^[-+.0-9]')), 1) - 1;
  names = strtrim (regexprep (strsplit (lines{head}, ","), {"^#", '\[[^\]]*\]', "\r"}, ""));
  k = find (strcmp (names, wanted), 1);
  if (isempty (k))
    error ("%s has no column %s, but %s", file, wanted, strjoin (names, ", "));
  endif
  values = csvread (file, head, 0)(:, k);
endfunction

function values = first_of (file, varargin)
  for k = 1:numel (varargin)
    try
      values = column (file, varargin{k});
      return;
    catch
    end_try_catch
  endfor
  error ("%s has none of the columns %s", file, strjoin (varargin, ", "));
endfunction

function run = read_run (file, coordinate, moment, reaction)
  run.q = column (file, coordinate);
  run.speed = first_of (file, [coordinate ".velocity"], "speed");
  run.acceleration = first_of (file, [coordinate ".acceleration"], "acceleration");
  run.moment = column (file, moment);
  run.force = column (file, reaction);
endfunction

% The coefficients of q̈ and of q̇² of a force, at each position of run i.
function [of_acceleration, of_square] = combined (one, two, of)
  at = @(values) interp1 (two.q, values, one.q, "spline");
  square = at (two.speed .^ 2);
  [f, g] = deal (one.(of), at (two.(of)));
  [a, b] = deal (one.acceleration, at (two.acceleration));
  [c, d] = deal (one.speed .^ 2, square);
  determinant = a .* d - b .* c;
  of_acceleration = (f .* d - g .* c) ./ determinant;
  of_square = (a .* g - b .* f) ./ determinant;
endfunction

% The time of the first revolution from 1 rad/s, s: m q̈ + ½m′ q̇² = 0 with the angle for the independent variable, so that the end is exact.
function period = free_motion (q, m, half_dm)
  around = [q; q(1) + 2 * pi];
  [m, half_dm] = deal (spline (around, [m; m(1)]), spline (around, [half_dm; half_dm(1)]));
  rates = @(x, y) [1 / y(2); -ppval(half_dm, x) / ppval(m, x) * y(2)];
  [~, y] = ode45 (rates, around([1, end]), [0; 1], odeset ("RelTol", 1e-11, "AbsTol", 1e-12));
  period = y(end, 1);
endfunction

function fails = compare (name, found, other, tolerance)
  difference = max (abs (found - other)) / max (abs (other));
  fails = ! (difference <= tolerance);
  printf ("  %-8s differs by %.1e of its largest value (tolerance %.0e)%s\n", name, difference, tolerance,
          mark_of (fails));
endfunction

function text = mark_of (fails)
  text = "";
  if (fails)
    text = "  FAILS";
  endif
endfunction

if (numel (argv ()) != 9)
  error ("nine arguments are wanted: see the first lines of this script");
endif
[one_file, two_file, coordinate, moment, reaction, reduced, period, energy, tolerance] = argv (){:};
names = strsplit (reaction, "=");
[reaction, name] = deal (names{[1, end]});
period = str2double (period);
energy = str2double (energy);
tolerance = str2double (tolerance);
one = read_run (one_file, coordinate, moment, reaction);
two = read_run (two_file, coordinate, moment, reaction);
% The end of a revolution is its beginning.
if (abs (one.q(end) - one.q(1) - 2 * pi) < 1e-6)
  one = structfun (@(values) values(1:end - 1), one, "UniformOutput", false);
endif
[m, half_dm] = combined (one, two, "moment");
[a, b] = combined (one, two, "force");
printf ("%s and run ii, %d positions\n", one_file, numel (one.q));
fails = compare ("m", m, column (reduced, "m"), tolerance);
fails |= compare ("half m'", half_dm, column (reduced, "half_dm"), tolerance);
fails |= compare ("a", a, column (reduced, [name ".a"]), tolerance);
fails |= compare ("b", b, column (reduced, [name ".b"]), tolerance);
% The same revolution with the energy of 1 rad/s at the first position takes so much longer.
expected = period * sqrt (energy / (0.5 * m(1)));
found = free_motion (one.q, m, half_dm);
difference = abs (found / expected - 1);
fails |= ! (difference <= tolerance);
printf ("  period   %.9f s, %.1e of itself from %.9f s%s\n", found, difference, expected, mark_of (! (difference <= tolerance)));
exit (double (fails), "force");
