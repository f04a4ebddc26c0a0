"""Built-in styles made by rule from neutral: what is published of them, as numbers.

None is recorded. Each takes the built-in neutral walk (one measured man) and changes it as the
cited findings say; where they give only a direction, the size is ours. ``docs/styles.md`` shows
and explains each. :mod:`gaitsmith.style.restyle` makes them.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Rule:
    """How a walk differs from neutral. Lengths are leg lengths, angles degrees, the rest factors.

    Attributes
    ----------
    about
        One line: what it is.
    sources
        Findings it is built from.
    step, cadence
        Of the preferred pace.
    double
        Share of the stride added to each double support.
    width, toe_out, circumduction
        Step width and toe-out added; how far the swinging foot goes out.
    crouch, bounce, sway
        Hips lower; vertical and sideways path of the hips.
    strike, off, lift
        Added to the pitch of the sole at heel strike (negative: flatter, then toes first); pitch
        at toe-off; height of the swinging foot added.
    tilt, turn, drop
        Pelvis: forward tilt added; turns about the vertical and drops of the hips.
    lean, slump, twist, roll
        Trunk: forward lean, bend of the upper back; turns of the chest; sway to the bearing foot.
    head, nod, tip
        Head: pitch down in space; its own movement; tilt to the bearing foot.
    swing, arms_out, arms_forward, roll_in
        Upper arms: swing; abduction, flexion and inward roll added.
    elbow, elbow_swing
        Flexion of the elbow added; its movement.
    shrug, hunch
        Shoulders: raised; drawn forward.
    knees_out
        Knees turned out against half way between pelvis and foot.
    """

    about: str = "a measured man's walk, made symmetric"
    sources: str = ""
    step: float = 1.0
    cadence: float = 1.0
    double: float = 0.0
    width: float = 0.0
    toe_out: float = 0.0
    circumduction: float = 0.0
    crouch: float = 0.0
    bounce: float = 1.0
    sway: float = 1.0
    strike: float = 0.0
    off: float = 1.0
    lift: float = 0.0
    tilt: float = 0.0
    turn: float = 1.0
    drop: float = 1.0
    lean: float = 0.0
    slump: float = 0.0
    twist: float = 1.0
    roll: float = 0.0
    head: float = 0.0
    nod: float = 1.0
    tip: float = 0.0
    swing: float = 1.0
    arms_out: float = 0.0
    arms_forward: float = 0.0
    roll_in: float = 0.0
    elbow: float = 0.0
    elbow_swing: float = 1.0
    shrug: float = 0.0
    hunch: float = 0.0
    knees_out: float = 0.0


#: The styles by name.
RULES: dict[str, Rule] = {
    "angry": Rule(
        about="leans into long, quick, hard steps, elbows bent, fists low",
        sources="Halovic & Kroos 2018; Gross, Crane & Fredrickson 2012; Montepare 1987",
        step=1.12,
        cadence=1.12,
        crouch=0.02,
        toe_out=5.0,
        lift=0.03,
        strike=9.0,
        off=1.05,
        bounce=1.15,
        sway=0.8,
        turn=1.3,
        lean=10.0,
        slump=2.0,
        twist=1.3,
        head=9.0,
        swing=1.35,
        arms_out=9.0,
        roll_in=14.0,
        elbow=38.0,
        shrug=8.0,
        hunch=6.0,
    ),
    "careful": Rule(
        about="as on ice: short, flat-footed, wide steps, arms held out a little",
        sources="Cham & Redfern 2002; Fong 2009",
        step=0.62,
        cadence=0.95,
        double=0.04,
        width=0.06,
        toe_out=6.0,
        crouch=0.015,
        bounce=0.7,
        strike=-16.0,
        off=0.6,
        turn=0.7,
        lean=4.0,
        slump=2.0,
        twist=0.6,
        head=14.0,
        nod=0.6,
        swing=0.35,
        arms_out=20.0,
        arms_forward=4.0,
        elbow=22.0,
        elbow_swing=0.4,
    ),
    "childlike": Rule(
        about="quick and bouncing, arms and head swinging free",
        sources="Hausdorff 1999; Lythgo 2009; Dusing & Thorpe 2007",
        step=0.92,
        cadence=1.2,
        width=0.02,
        bounce=2.1,
        sway=1.3,
        lift=0.065,
        off=1.1,
        turn=1.3,
        drop=1.2,
        lean=-2.0,
        twist=1.9,
        roll=3.0,
        head=-4.0,
        nod=2.0,
        tip=6.0,
        swing=1.5,
        arms_out=14.0,
        elbow=12.0,
        elbow_swing=1.5,
    ),
    "elderly": Rule(
        about="short, flat steps, bent forward, little turn of pelvis and trunk",
        sources="Almarwani 2016; Cury 2021; Hernandez 2009",
        step=0.72,
        cadence=0.94,
        double=0.03,
        width=0.03,
        toe_out=12.0,
        crouch=0.045,
        bounce=0.7,
        sway=1.2,
        strike=-8.0,
        off=0.75,
        tilt=4.0,
        turn=0.5,
        drop=0.8,
        lean=7.0,
        slump=16.0,
        twist=0.5,
        head=4.0,
        nod=0.8,
        swing=0.5,
        arms_out=4.0,
        elbow=22.0,
        elbow_swing=0.6,
        hunch=12.0,
        knees_out=8.0,
    ),
    "fearful": Rule(
        about="fast, short steps, shoulders up, elbows bent and close, knees soft",
        sources="Halovic & Kroos 2018; Roether 2009",
        step=0.66,
        cadence=1.1,
        toe_out=-6.0,
        crouch=0.06,
        bounce=0.7,
        strike=-10.0,
        off=0.75,
        turn=0.6,
        lean=5.0,
        slump=12.0,
        twist=0.5,
        head=6.0,
        nod=0.6,
        swing=0.3,
        arms_out=-2.0,
        arms_forward=2.0,
        roll_in=18.0,
        elbow=72.0,
        elbow_swing=0.8,
        shrug=14.0,
        hunch=14.0,
        width=-0.01,
    ),
    "happy": Rule(
        about="long, springing steps, upright, arms swinging wide",
        sources="Gross, Crane & Fredrickson 2012; Halovic & Kroos 2018; Montepare 1987",
        step=1.08,
        cadence=1.06,
        bounce=1.6,
        lift=0.04,
        off=1.2,
        turn=1.2,
        lean=-4.0,
        twist=1.4,
        roll=1.5,
        head=-6.0,
        nod=1.4,
        tip=2.0,
        swing=1.6,
        arms_out=7.0,
        elbow=6.0,
        elbow_swing=1.5,
        shrug=-3.0,
        hunch=-6.0,
        arms_forward=6.0,
    ),
    "hurried": Rule(
        about="quick steps, leaning forward, elbows bent",
        sources="Schulz 2012 (fast walks); CMU 07 and OSU quick walk, as measured",
        step=1.06,
        cadence=1.22,
        toe_out=-5.0,
        crouch=0.04,
        bounce=0.9,
        sway=0.7,
        strike=2.0,
        turn=1.2,
        lean=7.0,
        twist=1.1,
        head=2.0,
        swing=1.15,
        arms_out=2.0,
        elbow=48.0,
        elbow_swing=0.9,
    ),
    "proud": Rule(
        about="slow and tall, chest out, head high, the trunk swaying, arms held off",
        sources="Northumbria study 2025 (perceived dominance); Gross, Crane & Fredrickson 2012",
        step=1.0,
        cadence=0.9,
        width=0.02,
        toe_out=10.0,
        strike=6.0,
        bounce=1.1,
        turn=1.1,
        lean=-6.0,
        slump=-9.0,
        twist=1.3,
        roll=4.5,
        head=-9.0,
        swing=1.05,
        arms_out=10.0,
        elbow=6.0,
        shrug=2.0,
        hunch=-14.0,
    ),
    "sad": Rule(
        about="slow, short steps, slumped, head down, arms hanging still, swaying",
        sources="Michalak 2009; Adolph 2021; Gross, Crane & Fredrickson 2012",
        step=0.78,
        cadence=0.84,
        toe_out=-3.0,
        double=0.02,
        bounce=0.6,
        sway=1.5,
        strike=-7.0,
        off=0.85,
        turn=0.7,
        lean=3.0,
        slump=17.0,
        twist=0.6,
        roll=1.5,
        head=25.0,
        nod=0.7,
        swing=0.35,
        arms_out=-2.0,
        elbow=-8.0,
        elbow_swing=0.4,
        shrug=-4.0,
        hunch=17.0,
    ),
    "sneaky": Rule(
        about="creeping: low, leaning, high slow feet that land toes first, hands ready",
        sources="general knowledge of animators, no measurement",
        step=0.72,
        cadence=0.6,
        double=0.06,
        width=0.01,
        crouch=0.11,
        bounce=0.5,
        sway=1.2,
        strike=-24.0,
        off=0.75,
        lift=0.13,
        turn=1.3,
        lean=20.0,
        slump=14.0,
        twist=0.8,
        head=4.0,
        swing=0.5,
        arms_out=10.0,
        roll_in=4.0,
        elbow=62.0,
        elbow_swing=0.8,
        shrug=8.0,
        hunch=10.0,
        knees_out=6.0,
    ),
    "swagger": Rule(
        about="wide and easy, shoulders rolling, arms off the sides",
        sources="OSU swagger walk, as measured; Northumbria study 2025",
        step=0.95,
        cadence=0.92,
        knees_out=3.0,
        width=0.15,
        toe_out=15.0,
        circumduction=0.03,
        crouch=0.01,
        bounce=1.2,
        sway=1.5,
        turn=1.4,
        lean=-3.0,
        slump=2.0,
        twist=1.7,
        roll=4.0,
        head=-3.0,
        tip=3.0,
        swing=1.2,
        arms_out=18.0,
        roll_in=12.0,
        elbow=28.0,
        elbow_swing=1.3,
        shrug=3.0,
    ),
    "tired": Rule(
        about="slow, shuffling steps, knees soft, shoulders hanging, head nodding",
        sources="Granacher 2010; Nagano 2014; Santos 2019 (findings are mixed)",
        step=0.84,
        cadence=0.86,
        double=0.025,
        width=0.03,
        toe_out=9.0,
        crouch=0.04,
        bounce=0.9,
        sway=1.7,
        strike=-10.0,
        off=0.75,
        tilt=2.0,
        lean=6.0,
        slump=14.0,
        twist=0.9,
        roll=3.0,
        head=17.0,
        nod=2.2,
        tip=2.0,
        swing=0.65,
        arms_out=-1.0,
        elbow=-12.0,
        shrug=-6.0,
        hunch=15.0,
    ),
}
