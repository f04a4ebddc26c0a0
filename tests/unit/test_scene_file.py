"""Files of scenes: what they say, and that all that is wrong in one is said at once."""

from __future__ import annotations

import re

import numpy as np
import pytest

import gaitsmith
from gaitsmith import FileFormatError, read_scene
from gaitsmith._toml_lines import line_at, lines_of
from gaitsmith.body.presets import body_from
from gaitsmith.plan.given import GivenSteps
from gaitsmith.plan.script import BeAt, Face, Follow, Lean, LookAt, Stand, Step, Tempo, Turn, WalkTo
from gaitsmith.plan.start import Start
from gaitsmith.plan.surroundings import Bar, Obstacle, Post
from gaitsmith.walks.learned import write_gait

CORNER = "[[obstacle]]\npoints = [[0, 0], [1, 0], [1, 1]]\n"
TEMPO = Tempo(step_length=0.4)


@pytest.fixture
def read(tmp_path):
    def reader(text):
        path = tmp_path / "scene.toml"
        path.write_text(text, encoding="utf-8")
        return read_scene(path)

    return reader


def test_every_key_is_read(read, tmp_path):
    (tmp_path / "ann.toml").write_text("height = 1.68\nmass = 61\n")
    (tmp_path / "steps.csv").write_text(
        "side,x,z,heading_deg\nL,0.05,0,6\nR,-0.05,0,-6\nL,0.05,0.5,6\nR,-0.05,0.5,-6\n"
    )
    (tmp_path / "way.csv").write_text("0,0\n0,2\n1,4\n")
    scene = read(
        """
        ground = "flat"
        [[walker]]
        name = "ann"
        body = "ann.toml"
        gait = "winter"
        legs = "elevation"
        start = {at = [1, -2.5], facing = 90}
        begin = 1.5
        do = "walk to 3,0 speed 0.9; stand 1"
        speed = 1.1
        cadence = 100
        step_width = 0.12
        toe_out = [4, 8]
        variation = 0.5
        seed = 7
        [[walker]]
        path = "way.csv"
        [[walker]]
        path = [[0, 0], [0, 3]]
        [[walker]]
        steps = "steps.csv"
        step_length = 0.5
        [[walker]]
        distance = 3
        body = 1.4
        toe_out = 5
        [walker.start]
        feet = {left = [0.1, 0.2, 5], right = [-0.1, 0.0, -5]}
        [[obstacle]]
        name = "table"
        points = [[2, 2], [3, 2], [3, 3]]
        [[bar]]
        begin = [0, 1]
        end = [1, 1]
        height = 1.5
        [[post]]
        at = [4, 4]
        radius = 0.1
        bottom = 1.0
        top = 2.0
        """
    )
    ann, way, line, steps, far = scene.walkers
    assert [w.name for w in scene.walkers] == ["ann", *(f"walker{i}" for i in (2, 3, 4, 5))]
    assert (ann.body.height, ann.body.mass, ann.gait, ann.begin) == (1.68, 61.0, "winter", 1.5)
    assert ann.start == Start((1.0, -2.5), np.radians(90.0))
    assert ann.do == [WalkTo((3.0, 0.0), Tempo(speed=0.9)), Stand(1.0)]
    assert (ann.speed, ann.cadence, ann.step_width) == (1.1, 100, 0.12)
    assert ann.toe_out == (np.radians(4.0), np.radians(8.0))
    assert (ann.variation, ann.seed) == (0.5, 7)
    assert [w.legs for w in scene.walkers] == ["elevation", *["kinematic"] * 4]
    assert way.path.length > 4.0
    assert line.path.straight
    assert isinstance(steps.steps, GivenSteps)
    assert steps.step_length == 0.5
    assert far.body == body_from(1.4)
    assert far.start.feet[0] == (0.1, 0.2, np.radians(5.0))
    assert scene.surroundings.obstacles == (Obstacle(((2, 2), (3, 2), (3, 3)), "table"),)
    assert scene.surroundings.bars == (Bar((0, 1), (1, 1), 1.5),)
    assert scene.surroundings.posts == (Post((4, 4), 0.1, 1.0, 2.0),)


def test_one_walker_may_stand_at_the_top_of_the_file(read):
    scene = read("body = 1.2\nstart = {at = [1, 2]}\n[[do]]\nwalk_to = [3, 2]\n[[do]]\nstand = 1\n")
    (walker,) = scene.walkers
    assert walker.name == "walker"
    assert walker.do == [WalkTo((3.0, 2.0)), Stand(1.0)]
    assert walker.start.place == (1.0, 2.0)


@pytest.mark.parametrize(
    ("table", "action"),
    [
        ("walk_to = [0, 3]", WalkTo((0.0, 3.0))),
        ("walk_to = [0, 3]\nspeed = 1.2\ncadence = 110", WalkTo((0, 3), Tempo(1.2, None, 110.0))),
        (
            "follow = [[1, 2], [3, 4]]\nstep_length = 0.4",
            Follow(((1, 2), (3, 4)), Tempo(None, 0.4)),
        ),
        ('step = "back 0.3"', Step("back", 0.3)),
        ('turn = "right 90"', Turn(-np.radians(90.0))),
        ("face = -45", Face(np.radians(-45.0))),
        ("look_at = [1, 1.5, 2]", LookAt((1.0, 1.5, 2.0))),
        ("look_ahead = true", LookAt(None)),
        ("stand = 2", Stand(2.0)),
        ('lean = "left 10"', Lean("left", np.radians(10.0))),
        ("be_at = [1, 2]\nfacing = 90", BeAt((1.0, 2.0), np.radians(90.0))),
        ('be_at = [1, 2]\nfeet = "side by side"', BeAt((1.0, 2.0))),
        (
            "be_at = [0, 0]\nfeet = {left = [0.1, 0, 0], right = [-0.1, 0, 0]}\nspeed = 1",
            BeAt((0.0, 0.0), None, ((0.1, 0.0, 0.0), (-0.1, 0.0, 0.0)), Tempo(1.0)),
        ),
        ('walk_to = [0, 3]\ngait = "winter"', WalkTo((0.0, 3.0), Tempo(gait="winter"))),
        ('action = "walk to 0,3"\nspeed = 1', WalkTo((0.0, 3.0), Tempo(1.0))),
    ],
)
def test_every_action_is_a_table(read, table, action):
    assert read(f"[[do]]\n{table}\n").walkers[0].do == [action]


FIVE = """ground = "slop"

[[walker]]
name = "ann"
bdy = 1.7
speed = -1
do = "wlak to 0,3; stand 1; turn up 3"

[[walker]]
name = "ben"
[[walker.do]]
walk_to = [0, 3]
[[walker.do]]
stand = 1
sped = 2
"""


def test_all_that_is_wrong_is_said_at_once_with_its_place(read):
    with pytest.raises(FileFormatError) as caught:
        read(FIVE)
    text = str(caught.value)
    for said in (
        "line 1: ground: unknown ground 'slop'",
        "line 5: walker 1 (ann), bdy: unknown key, did you mean 'body'?",
        "line 6: walker 1 (ann), speed: must be above 0 meters per second, got -1",
        "line 7: walker 1 (ann), do: action 1 'wlak to 0,3': unknown action 'wlak'",
        "action 3 'turn up 3': unknown way 'up'",
        "line 15: walker 2 (ben), do 2, sped: unknown key, did you mean 'speed'?",
    ):
        assert said in text
    assert [int(n) for n in re.findall(r"line (\d+):", text)] == [1, 5, 6, 7, 15], "in order"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("walker = 3", "walker: must be tables [[walker]], got 3"),
        ("walker = []", "a scene needs at least one walker"),
        ("", "toml: say where to walk by one of do, path, steps, distance, got none"),
        ('do = "stand 1"\ndistance = 3', "one of do, path, steps, distance, got do and distance"),
        ('body = 1.2\n[[walker]]\ndo = "stand 1"', "line 1: body: belongs into a [[walker]] table"),
        ('do = "stand 1"\nbody = 3.5', "line 2: body: height must be"),
        ('do = "stand 1"\nbody = "nobody.toml"', "nobody.toml: cannot be read"),
        ('do = "stand 1"\nbody = true', "body: must be a height in meters, a name or a file"),
        ('do = "stand 1"\ngait = "nutral"', "Did you mean 'neutral'?"),
        ('do = "stand 1"\ngait = "x.gait.json"', "x.gait.json: no such file"),
        ('do = "stand 1"\nname = "a/b"', "name: the name of a walker must begin with a letter"),
        ("do = 3", "do: must be a script or [[do]] tables, got 3"),
        ("distance = nan", "distance: must be a finite number of meters, got nan"),
        ('distance = "3"', "distance: must be a number of meters, got '3'"),
        ("distance = 3\nseed = 1.5", "seed: must be a whole number"),
        ("distance = 3\nbegin = -1", "begin: must be at least 0 seconds, got -1"),
        ("distance = 3\ntoe_out = [1]", "toe_out: must be [left, right], 2 finite numbers"),
        ("path = [[0, 0], [0, 0]]", "points 1 and 2 of the path are the same"),
        ('path = "gone.csv"', "gone.csv: no such file"),
        ("path = 1", "path: must be points or the name of a CSV file, got 1"),
        ('path = "0,0 0,3"\nstart = {at = [1, 1]}', "path says itself where it begins"),
        ("steps = true", "steps: must be the name of a CSV file or a list"),
        (
            "distance = 3\nstart = {at = [0]}",
            "start, at: must be [x, z], 2 finite numbers, got",
        ),
        ("distance = 3\nstart = {at = [5000, 0]}", "start, at: must be within 1000 m of 0,0"),
        ("distance = 3\nstart = {facng = 1}", "start, facng: unknown key, did you mean 'facing'?"),
        ("distance = 3\nstart = 4", "start: must be a table, got 4"),
        ("distance = 3\nstart = {feet = {left = [0, 0, 0]}}", 'feet: must be "side by side" or'),
        (
            "distance = 3\nstart = {at = [9, 9], feet = {left = [1, 0, 0], right = [0, 0, 0]}}",
            "start: start at 9,9 is not the middle of the feet",
        ),
        ("[[do]]\n", "do 1: must have exactly one of walk_to, follow"),
        ("[[do]]\nface = 1\nstand = 1", "got face and stand"),
        ("[[do]]\nstand = 1\nspeed = 1", "speed is of walk_to, follow and be_at, not of stand"),
        ("[[do]]\nwalk_to = [1, 2]\nfacing = 1", "facing is of be_at, not of walk_to"),
        ('[[do]]\nwalk_to = [1, 2]\ngait = "wintr"', "do 1, gait: unknown gait 'wintr'"),
        ('[[do]]\nwalk_to = [1, 2]\ngait = "my gait"', "gait: must be a name or a file without"),
        ('do = "stand 1; walk to 0,3 gait wintr"', "do: action 2: unknown gait 'wintr'"),
        ('do = "walk to 0,3 gait gone.gait.json"', "gone.gait.json: no such file"),
        ("[[do]]\nlook_ahead = false", "look_ahead can only be true"),
        ('[[do]]\nturn = "up 3"', "line 1: do 1: action 1 'turn up 3': unknown way 'up'"),
        ('[[do]]\naction = "stand 1; stand 2"', "one table is one action"),
        ("[[do]]\nwalk_to = [0, 1]\nspeed = 0", "do 1, speed: must be above 0 meters per second"),
        (
            "distance = 1\n[[obstacle]]\npoints = [[0, 0], [1, 1], [1, 0], [0, 1]]",
            "obstacle 1: points: must be the corners of a simple polygon in order: Self-inters",
        ),
        ("distance = 1\n[[obstacle]]\npoints = [[0, 0], [1, 1]]", "a polygon needs three corners"),
        ("distance = 1\n[[obstacle]]\npoints = [[0, 0], [1, 1], [2, 2]]", "obstacle 1: points"),
        ("distance = 1\n[[obstacle]]\n", "obstacle 1, points: is missing"),
        (
            f"distance = 1\n{CORNER}height = 0.01",
            "line 4: obstacle 1, height: must be at least 0.02",
        ),
        (
            f"distance = 1\n{CORNER}height = 11",
            "line 4: obstacle 1, height: must be at most 10 met",
        ),
        (f"distance = 1\n{CORNER}height = nan", "line 4: obstacle 1, height: must be a finite nu"),
        (f"distance = 1\n{CORNER}height = 'low'", "line 4: obstacle 1, height: must be a number"),
        (f"distance = 1\n{CORNER}heigth = 1", "line 4: obstacle 1, heigth: unknown key, did you"),
        ('distance = 1\nground = "none.toml"', "none.toml: cannot be read: No such file"),
        (
            "distance = 1\n[[post]]\nat = [0, 0]\ntop = 1\nbottom = 2",
            "top 1 m must be above",
        ),
        ("distance = 1\n[[bar]]\nbegin = [0, 0]\nend = [1, 0]", "bar 1, height: is missing"),
        (
            '[[walker]]\nname = "a"\ndistance = 1\n[[walker]]\nname = "A"\ndistance = 1',
            "line 5: walker 2 (A), name: walker 1 has the same name 'A'",
        ),
        ("distance = ;\n", "not a TOML file: Invalid value (at line 1"),
    ],
)
def test_what_is_wrong_is_named(read, text, says):
    with pytest.raises(FileFormatError) as caught:
        read(text)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_files_are_found_beside_the_scene(read, tmp_path, monkeypatch):
    (tmp_path / "way.csv").write_text("0,0\n0,2\n")
    (tmp_path / "else").mkdir()
    monkeypatch.chdir(tmp_path / "else")
    assert read('path = "way.csv"').walkers[0].path.length == 2.0


def test_gaits_of_actions_are_read_from_files(read, tmp_path):
    """A name with a suffix is a file beside the scene; what it holds goes along."""
    learned = gaitsmith.learn(gaitsmith.walk(distance=6.0, body=1.6, fps=60.0), name="own")
    write_gait(learned, tmp_path / "own.gait.json")
    scene = read('do = "walk to 0,1.5 gait own.gait.json"')
    assert scene.walkers[0].gaits["own.gait.json"]["name"] == "own"
    motion = gaitsmith.perform(scene, fps=20.0).motions[0]
    (tmp_path / "own.gait.json").unlink()
    again = gaitsmith.regenerate(motion)
    np.testing.assert_array_equal(again.rotations, motion.rotations)


def test_lines_of_tables_and_keys():
    lines = lines_of(
        'a = 1\n[[walker]]\nname = "x"\ndo = """\nfake = 1\n"""\n[walker.start]\nat = [\n0,\n1]\n'
        "[[walker]]\n[[walker.do]]\nstand = 1\n[[walker.do]]\nstand = 2\n"
    )
    assert lines["a",] == 1
    assert lines["walker", 0, "name"] == 3
    assert ("walker", 0, "fake") not in lines
    assert lines["walker", 0, "start", "at"] == 8
    assert lines["walker", 1, "do", 1, "stand"] == 15
    assert line_at(("walker", 1, "do", 1, "sped"), lines) == 14
    assert line_at(("gone",), lines) is None
