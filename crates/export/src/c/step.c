static void move_state(const @p@_state *from, @p@_real h, const @p@_real *rates, @p@_state *to)
{
1|    to->q = from->q + h * rates[0];
1|    to->q_dot = from->q_dot + h * rates[1];
n|    int k;
n|    for (k = 0; k < N; k++) {
n|        to->q[k] = from->q[k] + h * rates[k];
n|        to->q_dot[k] = from->q_dot[k] + h * rates[N + k];
n|    }
@move_currents@}

/* Adds to a sum and to what it has lost by rounding. */
static void add(@p@_real *sum, @p@_real *carry, @p@_real change)
{
    const @p@_real corrected = change - *carry;
    const @p@_real next = *sum + corrected;
    *carry = (next - *sum) - corrected;
    *sum = next;
}

@p@_status @p@_step(const @p@_parameters *parameters, const @p@_inputs *inputs, @p@_real h, @p@_state *state)
{
    @p@_real k1[@rates@], k2[@rates@], k3[@rates@], k4[@rates@];
    const @p@_real half = @half@ * h, sixth = h / @six@;
    @p@_state s = *state;
    int k;
    @p@_status status = is_finite(h) ? rates_of(parameters, inputs, state, k1) : @U@_NOT_FINITE;
    if (status == @U@_OK) {
        move_state(state, half, k1, &s);
        status = rates_of(parameters, inputs, &s, k2);
    }
    if (status == @U@_OK) {
        move_state(state, half, k2, &s);
        status = rates_of(parameters, inputs, &s, k3);
    }
    if (status == @U@_OK) {
        move_state(state, h, k3, &s);
        status = rates_of(parameters, inputs, &s, k4);
    }
    if (status != @U@_OK) {
        return status;
    }
    for (k = 0; k < @rates@; k++) {
        k1[k] = sixth * (k1[k] + @two@ * (k2[k] + k3[k]) + k4[k]);
    }
    s = *state;
1|    add(&s.q, &s.carry[0], k1[0]);
1|    add(&s.q_dot, &s.carry[1], k1[1]);
n|    for (k = 0; k < N; k++) {
n|        add(&s.q[k], &s.carry[k], k1[k]);
n|        add(&s.q_dot[k], &s.carry[N + k], k1[N + k]);
n|    }
@add_currents@
n|    if (!(all_finite(s.q, N) && all_finite(s.q_dot, N))) {
n|        return @U@_NOT_FINITE;
n|    }
1o|    if (s.q >= PERIOD || s.q < ZERO) {
1o|        @p@_real next, carry = s.carry[0];
1o|        if (s.q >= PERIOD) {
1o|            s.periods++;
1o|            next = s.q - PERIOD_COARSE;
1o|            carry = carry + PERIOD_FINE;
1o|        } else {
1o|            s.periods--;
1o|            next = s.q + PERIOD_COARSE;
1o|            carry = (carry - PERIOD_FINE) + ((next - PERIOD_COARSE) - s.q);
1o|        }
1o|        /* The rest of the period is too much for a carry: the next step begins at q itself. */
1o|        s.q = next - carry;
1o|        s.carry[0] = (s.q - next) + carry;
1o|    }
1e|    status = wrap(&s.q);
1e|    if (status != @U@_OK) {
1e|        return status;
1e|    }
    *state = s;
    return @U@_OK;
}

