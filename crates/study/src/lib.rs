//! One function per command: from a scene to results, findings and figures.
