"""The figure around a skeleton: rigid pieces for pictures, one skinned mesh for files.

:func:`~gaitsmith.skin.mannequin.build_mannequin` makes the pieces,
:func:`~gaitsmith.skin.build.build_skin` the mesh: a cage of quads around the bones of a
modelling pose (:mod:`~gaitsmith.skin.torso_cage`, :mod:`~gaitsmith.skin.limb_cage`), subdivided
with its weights (:mod:`~gaitsmith.skin.cage`) and carried to the rest pose
(:mod:`~gaitsmith.skin.sculpt`).
"""
