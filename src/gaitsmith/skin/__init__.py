"""The figure around a skeleton: one skinned mesh, for pictures and for files.

:func:`~gaitsmith.skin.build.build_skin` makes it: a cage of quads around the bones of a
modelling pose (:mod:`~gaitsmith.skin.torso_cage`, :mod:`~gaitsmith.skin.limb_cage`,
:mod:`~gaitsmith.skin.hand`), subdivided with its weights (:mod:`~gaitsmith.skin.cage`) and
carried to the rest pose (:mod:`~gaitsmith.skin.sculpt`). A rig that rests in another pose than
the T-pose is put into it first (:mod:`~gaitsmith.skin.t_pose`).
"""
