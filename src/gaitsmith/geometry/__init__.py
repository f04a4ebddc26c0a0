"""Mathematics without people: rotations, curves, signals."""
