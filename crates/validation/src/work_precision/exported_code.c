#include "@p@.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

#define CALLS 2000
#define PASSES 7

static const double times[@count@] = {@times@};
static @p@_motion_terms motion;
@reactions@

static double now(void)
{
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

/* Of each call the least of several passes, so that what interrupts the program does not count: mean and worst of all. */
static void measure(@p@_parameters *parameters, @p@_inputs *inputs, const @p@_state *from, int is_step)
{
    static double least[CALLS];
    double sum = 0.0, worst = 0.0, empty = 1.0;
    int pass, k;
    for (pass = 0; pass < PASSES; pass++) {
        @p@_state state = *from;
        for (k = 0; k < CALLS; k++) {
            double begin = now(), between = now(), seconds;
            empty = between - begin < empty ? between - begin : empty;
            begin = now();
            if (is_step) {
                (void)@p@_step(parameters, inputs, @step@, &state);
            } else {
                (void)@coefficients@;
            }
            seconds = now() - begin;
            least[k] = pass == 0 || seconds < least[k] ? seconds : least[k];
            if (!is_step) {
                (void)@p@_step(parameters, inputs, @step@, &state);
            }
        }
    }
    for (k = 0; k < CALLS; k++) {
        const double seconds = least[k] > empty ? least[k] - empty : 0.0;
        sum += seconds;
        worst = seconds > worst ? seconds : worst;
    }
    printf("%.17g %.17g\n", sum / CALLS, worst);
}

int main(void)
{
    @p@_parameters parameters;
    @p@_inputs inputs;
    @p@_state state, start;
    double t = 0.0;
    int k;
    @p@_scene(&parameters, &inputs, &state);
    state.q = (@p@_real)@q@;
    state.q_dot = (@p@_real)@q_dot@;
    start = state;
    for (k = 0; k < @count@; k++) {
        /* As many steps as are needed for a millisecond at most. */
        const double span = times[k] - t;
        const int steps = (int)ceil(span / @step@ - 1e-9);
        int s;
        for (s = 0; s < steps; s++) {
            if (@p@_step(&parameters, &inputs, (@p@_real)(span / steps), &state) != @U@_OK) {
                return 0;
            }
        }
        t = times[k];
        printf("%.17g %.17g\n", (double)@p@_whole_coordinate(&state), (double)state.q_dot);
    }
    measure(&parameters, &inputs, &start, 0);
    measure(&parameters, &inputs, &start, 1);
    return 0;
}
