#ifdef @U@_SELF_TEST
static int differs(const @p@_real *found, const @p@_real *expected, int count, @p@_real tolerance)
{
    @p@_real size = ZERO;
    int k;
    for (k = 0; k < count; k++) {
        const @p@_real value = expected[k] < ZERO ? -expected[k] : expected[k];
        size = value > size ? value : size;
    }
    for (k = 0; k < count; k++) {
        const @p@_real difference = found[k] > expected[k] ? found[k] - expected[k] : expected[k] - found[k];
        if (!(difference <= tolerance * size)) {
            return 1;
        }
    }
    return 0;
}

int @p@_self_test(void)
{
    @p@_parameters parameters;
    @p@_inputs inputs;
    @p@_state state;
    @p@_real found[@most@], q_ddot[N];
    int k;
@checks@    @p@_scene(&parameters, &inputs, &state);
    parameters.added_inertia[0] = @no_inertia@;
    if (@p@_acceleration(&parameters, &inputs, &state, q_ddot) != @U@_NO_INERTIA) {
        return 3;
    }
    @p@_scene(&parameters, &inputs, &state);
    state.q[0] = @huge@;
    state.q[0] = state.q[0] * state.q[0];
    if (@p@_acceleration(&parameters, &inputs, &state, q_ddot) != @U@_NOT_FINITE || !all_finite(q_ddot, N)) {
        return 4;
    }
    return 0;
}

int main(void)
{
    return @p@_self_test();
}
#endif
