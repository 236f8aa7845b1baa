//! The equation of motion of a reduced model: integration, events, energy and period.
