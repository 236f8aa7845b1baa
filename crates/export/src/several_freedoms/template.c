#include "@p@.h"

#include <math.h>

#ifdef __FAST_MATH__
#error "-ffast-math drops the sums that carry their rounding"
#endif

#define N @U@_COORDINATE_COUNT
#define PAIRS @U@_PAIR_COUNT
#define ORDER @order@
#define ZERO @zero@

static int is_finite(@p@_real x)
{
    return x - x >= ZERO;
}

static int all_finite(const @p@_real *x, int count)
{
    int k;
    for (k = 0; k < count; k++) {
        if (!is_finite(x[k])) {
            return 0;
        }
    }
    return 1;
}

static void clear(@p@_real *x, int count)
{
    int k;
    for (k = 0; k < count; k++) {
        x[k] = ZERO;
    }
}

static void motion_at(const @p@_real *q, @p@_motion_terms *terms)
{
@motion@}

@p@_status @p@_motion_terms_at(const @p@_real q[@U@_COORDINATE_COUNT], @p@_motion_terms *terms)
{
    @p@_status status = all_finite(q, N) ? @U@_OK : @U@_NOT_FINITE;
    if (status == @U@_OK) {
        motion_at(q, terms);
l|        if (!(all_finite(terms->m, N * N) && all_finite(terms->h, PAIRS * N) && all_finite(terms->w, @U@_LOAD_COUNT * N) && all_finite(terms->v, @U@_LOAD_COUNT))) {
z|        if (!(all_finite(terms->m, N * N) && all_finite(terms->h, PAIRS * N))) {
            status = @U@_OUT_OF_RANGE;
        }
    }
    if (status != @U@_OK) {
        clear(terms->m, N * N);
        clear(terms->h, PAIRS * N);
l|        clear(terms->w, @U@_LOAD_COUNT * N);
l|        clear(terms->v, @U@_LOAD_COUNT);
    }
    return status;
}

@reactions_at@
@positions_at@
@scene@

typedef struct {
    @p@_real m[N * N];
l|    @p@_real f[@U@_LOAD_COUNT];
} forces;

/* F of every load, and the mass matrix with what is added. */
static void forces_of(const @p@_parameters *p, const @p@_inputs *in, const @p@_motion_terms *t, const @p@_state *s, forces *out)
{
    int i;
    for (i = 0; i < N * N; i++) {
        out->m[i] = t->m[i];
    }
    for (i = 0; i < N; i++) {
        out->m[i * N + i] = out->m[i * N + i] + p->added_inertia[i];
    }
@forces@}

/* By coordinate the sum of h q_dot[i] q_dot[j], less that of w F. */
static void resistance_of(const @p@_motion_terms *t, const forces *f, const @p@_state *s, @p@_real *sum)
{
    int i, j, k, pair = 0;
    clear(sum, N);
    for (i = 0; i < N; i++) {
        for (j = i; j < N; j++) {
            const @p@_real product = s->q_dot[i] * s->q_dot[j];
            for (k = 0; k < N; k++) {
                sum[k] = sum[k] + t->h[pair * N + k] * product;
            }
            pair++;
        }
    }
l|    for (k = 0; k < @U@_LOAD_COUNT; k++) {
l|        for (i = 0; i < N; i++) {
l|            sum[i] = sum[i] - f->f[k] * t->w[k * N + i];
l|        }
l|    }
z|    (void)f;
}

/* Solves m x = b by m = L D L^T; b becomes x. */
static @p@_status solve(@p@_real *m, @p@_real *b)
{
    int i, j, k;
    for (j = 0; j < N; j++) {
        for (i = j; i < N; i++) {
            for (k = 0; k < j; k++) {
                m[i * N + j] = m[i * N + j] - m[i * N + k] * m[j * N + k] * m[k * N + k];
            }
        }
        if (!(m[j * N + j] > ZERO)) {
            return is_finite(m[j * N + j]) ? @U@_NO_INERTIA : @U@_NOT_FINITE;
        }
        for (i = j + 1; i < N; i++) {
            m[i * N + j] = m[i * N + j] / m[j * N + j];
        }
    }
    for (i = 0; i < N; i++) {
        for (k = 0; k < i; k++) {
            b[i] = b[i] - m[i * N + k] * b[k];
        }
    }
    for (i = N - 1; i >= 0; i--) {
        b[i] = b[i] / m[i * N + i];
        for (k = i + 1; k < N; k++) {
            b[i] = b[i] - m[k * N + i] * b[k];
        }
    }
    return @U@_OK;
}

/* Velocities, accelerations and the rates of currents. */
static @p@_status rates_of(const @p@_parameters *p, const @p@_inputs *in, const @p@_state *s, @p@_real *rates)
{
    @p@_motion_terms terms;
    forces f;
    int k;
    @p@_status status = @p@_motion_terms_at(s->q, &terms);
    if (status != @U@_OK) {
        return status;
    }
    forces_of(p, in, &terms, s, &f);
    resistance_of(&terms, &f, s, rates + N);
    for (k = 0; k < N; k++) {
        rates[k] = s->q_dot[k];
        rates[N + k] = -rates[N + k];
    }
    status = solve(f.m, rates + N);
@current_rates@    if (status == @U@_OK && !all_finite(rates, ORDER)) {
        status = @U@_NOT_FINITE;
    }
    return status;
}

@p@_status @p@_acceleration(@arguments@, @p@_real q_ddot[@U@_COORDINATE_COUNT])
{
    @p@_real rates[ORDER];
    const @p@_status status = rates_of(parameters, inputs, state, rates);
    int k;
    for (k = 0; k < N; k++) {
        q_ddot[k] = status == @U@_OK ? rates[N + k] : ZERO;
    }
    return status;
}

@reactions@@p@_status @p@_energies(@arguments@, @p@_real energies[2])
{
    @p@_motion_terms terms;
    forces f;
    int i, j;
    @p@_status status = @p@_motion_terms_at(state->q, &terms);
    forces_of(parameters, inputs, &terms, state, &f);
    clear(energies, 2);
    for (i = 0; i < N; i++) {
        for (j = 0; j < N; j++) {
            energies[0] = energies[0] + @half@ * f.m[i * N + j] * state->q_dot[i] * state->q_dot[j];
        }
    }
@potentials@    if (status == @U@_OK && !all_finite(energies, 2)) {
        status = @U@_NOT_FINITE;
    }
    if (status != @U@_OK) {
        clear(energies, 2);
    }
    return status;
}

@p@_status @p@_required_forces(@arguments@, const @p@_real q_ddot[@U@_COORDINATE_COUNT], @p@_real required[@U@_COORDINATE_COUNT])
{
    @p@_motion_terms terms;
    forces f;
    int i, j;
    @p@_status status = @p@_motion_terms_at(state->q, &terms);
    forces_of(parameters, inputs, &terms, state, &f);
    resistance_of(&terms, &f, state, required);
    for (i = 0; i < N; i++) {
        for (j = 0; j < N; j++) {
            required[i] = required[i] + f.m[i * N + j] * q_ddot[j];
        }
    }
    if (status == @U@_OK && !all_finite(required, N)) {
        status = @U@_NOT_FINITE;
    }
    if (status != @U@_OK) {
        clear(required, N);
    }
    return status;
}

