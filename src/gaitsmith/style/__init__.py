"""Styles of walking mixed from Cycles [KN12]: several go in, one new Cycle comes out."""
