"""Recipes to ways of walking: what ``compose`` does."""
