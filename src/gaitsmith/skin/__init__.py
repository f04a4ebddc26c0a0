"""The figure around a skeleton: rigid pieces for pictures, one skinned mesh for files."""
