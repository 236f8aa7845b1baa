/* What is run of a machine on the board: its self-test, instructions of a call, and a million steps. MACHINE and MACHINE_CAPITALS
   are the names of the export. */
#include "board.h"

#define JOINED(a, b) a##b
#define PASTED(a, b) JOINED(a, b)
#define OF(name) PASTED(MACHINE, name)
#define TEXT(name) #name
#define NAMED(name) TEXT(name)
#include NAMED(MACHINE.h)

int OF(_self_test)(void);
#ifdef WITH_RUST
int32_t rust_self_test(void);
#endif

#define CALLS 1000
#ifndef STEPS
#define STEPS 1000000
#endif

static uint32_t per_call(uint32_t instructions, uint32_t of_loop)
{
    return (instructions - of_loop) / CALLS;
}

void run(void)
{
    OF(_parameters) parameters;
    OF(_inputs) inputs;
    OF(_state) state;
    OF(_motion_terms) terms;
    OF(_reaction_terms) reactions;
    OF(_real) before[2], after[2], energy;
    volatile OF(_real) sink = 0;
    uint32_t start, loop, now, step = 0;
    int32_t k;

    say("self-test", OF(_self_test)());
#ifdef WITH_RUST
    say("self-test of Rust", rust_self_test());
#endif
    start = ticks();
    for (k = 0; k < CALLS; k++) {
        sink = (OF(_real))k * (OF(_real))0.00613;
    }
    loop = instructions_since(start);
    start = ticks();
    for (k = 0; k < CALLS; k++) {
        (void)OF(_coefficients)((OF(_real))k * (OF(_real))0.00613, &terms, &reactions);
        sink = terms.m;
    }
    say("instructions of coefficients, mean", per_call(instructions_since(start), loop));

    OF(_scene)(&parameters, &inputs, &state);
    (void)OF(_energies)(&parameters, &inputs, &state, before);
    for (k = 0; k < STEPS; k++) {
        start = ticks();
        if (OF(_step)(&parameters, &inputs, (OF(_real))0.001, &state) != 0) {
            say("stopped at step", k);
            return;
        }
        now = instructions_since(start);
        step = now > step ? now : step;
    }
    say("instructions of a step, at most", step);
    (void)OF(_energies)(&parameters, &inputs, &state, after);
    energy = before[0] + before[1];
    say("periods", state.periods);
    say("change of energy, 1e-9", (int64_t)((OF(_real))1e9 * ((after[0] + after[1]) - energy) / energy));
    (void)sink;
}
