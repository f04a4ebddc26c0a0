"""Several people in one place: each with a body, a gait and a script of its own."""
