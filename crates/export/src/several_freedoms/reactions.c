static void reactions_at(const @p@_real *q, @p@_reaction_terms *terms)
{
@reaction_terms@}

@p@_status @p@_reaction_terms_at(const @p@_real q[@U@_COORDINATE_COUNT], @p@_reaction_terms *terms)
{
    @p@_status status = all_finite(q, N) ? @U@_OK : @U@_NOT_FINITE;
    if (status == @U@_OK) {
        reactions_at(q, terms);
l|        if (!(all_finite(terms->a, N * @U@_REACTION_COUNT) && all_finite(terms->b, PAIRS * @U@_REACTION_COUNT) && all_finite(terms->c, @U@_LOAD_COUNT * @U@_REACTION_COUNT))) {
z|        if (!(all_finite(terms->a, N * @U@_REACTION_COUNT) && all_finite(terms->b, PAIRS * @U@_REACTION_COUNT))) {
            status = @U@_OUT_OF_RANGE;
        }
    }
    if (status != @U@_OK) {
        clear(terms->a, N * @U@_REACTION_COUNT);
        clear(terms->b, PAIRS * @U@_REACTION_COUNT);
l|        clear(terms->c, @U@_LOAD_COUNT * @U@_REACTION_COUNT);
    }
    return status;
}

