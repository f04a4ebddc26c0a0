"""Who walks: lengths of a body, its feet, its masses, and the skeleton it gives."""
