#ifndef @U@_H
#define @U@_H

1|#include <stdint.h>
1|
typedef @real@ @p@_real;

typedef enum {
    @U@_OK = 0,
1|    @U@_OUT_OF_RANGE = 1, /* q is outside the range: outputs are zero, a state stays as it was */
n|    @U@_OUT_OF_RANGE = 1, /* the mechanism cannot be assembled at q: outputs are zero, a state stays as it was */
    @U@_NOT_FINITE = 2,   /* a number that is not finite came in or out: the same */
1|    @U@_NO_INERTIA = 3    /* m with everything added is not above zero: the same */
n|    @U@_NO_INERTIA = 3    /* the mass matrix with everything added is not positive definite: the same */
} @p@_status;

@counts@

/* Constants of the machine that may be changed. */
typedef struct {
n|    @p@_real added_inertia[@U@_COORDINATE_COUNT]; /* kg m2 or kg: added along each coordinate, such as a flywheel */
@parameters@} @p@_parameters;

/* What acts on it from outside; constant during a step. */
typedef struct {
@inputs@} @p@_inputs;

1|/* A state; set `carry` and `periods` to zero when you set the others. */
1|typedef struct {
1|    @p@_real q; /* @unit@: @coordinate@ */
1|    @p@_real q_dot; /* @unit@/s: its speed */
n|/* A state; set `carry` to zero when you set the others. */
n|typedef struct {
n|    @p@_real q[@U@_COORDINATE_COUNT]; /* rad or m */
n|    @p@_real q_dot[@U@_COORDINATE_COUNT]; /* rad/s or m/s */
@currents@    @p@_real carry[@order@]; /* what the sums have lost by rounding */
1|    int32_t periods; /* whole periods subtracted from q */
} @p@_state;

1|/* m q'' + half_dm q'^2 = sum of w F over the loads */
1|typedef struct {
1|    @p@_real m; /* @inertia_unit@: of the bodies */
1|    @p@_real half_dm; /* @inertia_unit@/@unit@ */
1l|    @p@_real w[@U@_LOAD_COUNT]; /* generalised force of one unit of each load */
1d|    @p@_real dw[@U@_LOAD_COUNT]; /* derivative of w of motors; 0 of others */
n|/* M q'' + sum of h q_dot[i] q_dot[j] = sum of w F over the loads */
n|typedef struct {
n|    @p@_real m[@U@_COORDINATE_COUNT * @U@_COORDINATE_COUNT]; /* mass matrix of the bodies, row by row */
n|    @p@_real h[@U@_PAIR_COUNT * @U@_COORDINATE_COUNT]; /* Christoffel terms: by pair, then coordinate; those of both orders of a pair */
nl|    @p@_real w[@U@_LOAD_COUNT * @U@_COORDINATE_COUNT]; /* generalised forces of one unit of each load */
v|    @p@_real v[@U@_LOAD_COUNT]; /* potential of one unit of each conservative load; 0 of others */
} @p@_motion_terms;

1r|/* reaction k = a[k] q'' + b[k] q'^2 + sum of c[load * @U@_REACTION_COUNT + k] F over the loads */
1r|typedef struct {
1r|    @p@_real a[@U@_REACTION_COUNT]; /* of q'' */
1r|    @p@_real b[@U@_REACTION_COUNT]; /* of q'^2 */
1rl|    @p@_real c[@U@_LOAD_COUNT * @U@_REACTION_COUNT]; /* reactions to one unit of each load */
nr|/* Reactions: sum of a q_ddot[i] + sum of b q_dot[i] q_dot[j] + sum of c F over the loads; each by reaction last */
nr|typedef struct {
nr|    @p@_real a[@U@_COORDINATE_COUNT * @U@_REACTION_COUNT]; /* by coordinate */
nr|    @p@_real b[@U@_PAIR_COUNT * @U@_REACTION_COUNT]; /* by pair */
nrl|    @p@_real c[@U@_LOAD_COUNT * @U@_REACTION_COUNT]; /* by load */
r|} @p@_reaction_terms;
r|
/* Parameters, inputs and initial state of the scene. */
void @p@_scene(@p@_parameters *parameters, @p@_inputs *inputs, @p@_state *state);

1|/* q with all revolutions. */
1|@p@_real @p@_whole_coordinate(const @p@_state *state);
1|
/* The coefficients at q. */
@p@_status @p@_motion_terms_at(@q@, @p@_motion_terms *terms);
r|@p@_status @p@_reaction_terms_at(@q@, @p@_reaction_terms *terms);
1r|/* Both at once. */
1r|@p@_status @p@_coefficients(@q@, @p@_motion_terms *motion, @p@_reaction_terms *reactions);

p|/* x and y of every point at q, m. */
p|@p@_status @p@_positions(@q@, @p@_real xy[2 * @U@_POINT_COUNT]);
p|
/* q'' of a state. */
@p@_status @p@_acceleration(@arguments@, @found_q_ddot@);

r|/* Every reaction of a state with its acceleration: the action of the joint's first body on its second. */
r|@p@_status @p@_reactions(@arguments@, @q_ddot@, @p@_real reactions[@U@_REACTION_COUNT]);
r|
/* Kinetic energy and potential, J. */
@p@_status @p@_energies(@arguments@, @p@_real energies[2]);

1|/* Inverse dynamics: what must act on the coordinate besides the loads, @force@, for a wanted q''. */
1|@p@_status @p@_required_force(@arguments@, @q_ddot@, @p@_real *force);
n|/* Inverse dynamics: what must act on each coordinate besides the loads, N m or N, for a wanted q''. */
n|@p@_status @p@_required_forces(@arguments@, @q_ddot@, @p@_real required[@U@_COORDINATE_COUNT]);

/* One step of h seconds by the classical Runge-Kutta method of fourth order. */
@p@_status @p@_step(const @p@_parameters *parameters, const @p@_inputs *inputs, @p@_real h, @p@_state *state);

#ifdef @U@_SELF_TEST
/* 0, or the number of the first check that failed. */
int @p@_self_test(void);
#endif

#endif
