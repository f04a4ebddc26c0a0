"""Build src/gaitsmith/data/neutral.json from the Rajagopal 2016 walk.

    python tools/build_neutral.py COORDINATES.sto

The closed stride of docs/gaits/neutral.md, as Fourier coefficients of the model's coordinates:
raw, and symmetrized. The measured file is not part of the project; see data/SOURCES.md.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

TARGET = Path(__file__).parent.parent / "src/gaitsmith/data/neutral.json"
PERIOD = 1.1445  # right strike to right strike on the force plates, s
FIRST = 0.4500  # first row used, s
OVERLAP = 0.2050  # s that are there twice
LEFT_STRIKE = 0.8355  # s
VEER = np.radians(-0.75)  # heading of the planted stride
SAMPLES, HARMONICS = 128, 8
COLUMNS = (
    *("pelvis_tilt", "pelvis_list", "pelvis_rotation", "pelvis_tx", "pelvis_ty", "pelvis_tz"),
    *("lumbar_extension", "lumbar_bending", "lumbar_rotation"),
    *(
        f"{name}_{side}"
        for side in "lr"
        for name in (
            *("hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle"),
            *("arm_flex", "arm_add", "arm_rot", "elbow_flex"),
        )
    ),
)
ODD = ("pelvis_list", "pelvis_rotation", "pelvis_tz", "lumbar_bending", "lumbar_rotation")
SOURCE = (
    "Derived from coordinates.sto of the example3DWalking of opensim-core (Rajagopal et al. 2016, "
    "IEEE Trans. Biomed. Eng. 63(10)): one stride, closed, re-phased, as Fourier coefficients."
)
LICENSE = (
    "Apache-2.0, Copyright (c) 2005-2017 Stanford University and the Authors; changed: one stride "
    "cut, closed, heading and drift removed, re-phased, symmetrized, kept to 8 harmonics"
)


def read(path: Path) -> dict[str, np.ndarray]:
    """Columns by the name of the coordinate."""
    lines = path.read_text(encoding="utf-8").splitlines()
    start = next(i for i, line in enumerate(lines) if line.strip() == "endheader") + 1
    names = lines[start].split("\t")
    table = np.array([line.split() for line in lines[start + 1 :] if line.strip()], dtype=float)
    out = {"time": table[:, 0]}
    for i, name in enumerate(names):
        if name.endswith("/value"):
            out[name.split("/")[-2]] = table[:, i]
    return out


def stride(data: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """128 samples of one period of every column, closed, phase 0 the left heel strike."""
    time = data["time"]
    tau = FIRST + PERIOD * np.arange(SAMPLES) / SAMPLES
    k = np.clip((tau - FIRST) / OVERLAP, 0.0, 1.0)
    w = 3 * k**2 - 2 * k**3
    phase = (tau - LEFT_STRIKE) / PERIOD
    out = {}
    for name in COLUMNS:
        column = np.array(data[name])
        if name == "pelvis_rotation":
            column = column - VEER
        if name in ("pelvis_tx", "pelvis_ty", "pelvis_tz"):
            drift = np.interp(FIRST + PERIOD, time, column) - np.interp(FIRST, time, column)
            column = column - drift * (time - FIRST) / PERIOD
        first = np.interp(tau, time, column)
        again = np.interp(np.minimum(tau + PERIOD, time[-1]), time, column)
        closed = np.where(k < 1.0, (1.0 - w) * again + w * first, first)
        spline = CubicSpline(
            np.append(phase, phase[0] + 1), np.append(closed, closed[0]), bc_type="periodic"
        )
        at = np.arange(SAMPLES) / SAMPLES
        out[name] = spline((at - phase[0]) % 1.0 + phase[0])
    return out


def symmetrized(columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Mean of the stride and its mirror image half a stride later."""
    half = SAMPLES // 2
    out = {}
    for name, column in columns.items():
        partner = (
            name[:-2] + {"_l": "_r", "_r": "_l"}[name[-2:]] if name[-2:] in ("_l", "_r") else name
        )
        mirrored = np.roll(columns[partner], -half)
        out[name] = 0.5 * (column + (-mirrored if name in ODD else mirrored))
    return out


def coefficients(columns: dict[str, np.ndarray]) -> dict[str, list[list[float]]]:
    """Cosine and sine coefficients of harmonics 0..8 of each column."""
    out = {}
    for name, column in columns.items():
        c = np.fft.rfft(column)[: HARMONICS + 1] / SAMPLES
        scale = np.full(HARMONICS + 1, 2.0)
        scale[0] = 1.0
        out[name] = [np.round(scale * c.real, 8).tolist(), np.round(-scale * c.imag, 8).tolist()]
    return out


def centered(columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Pelvis position without its mean along and across."""
    return {n: c - c.mean() if n in ("pelvis_tx", "pelvis_tz") else c for n, c in columns.items()}


def main() -> None:
    """Read the coordinates, write the file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("coordinates", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    options = parser.parse_args()
    raw = stride(read(options.coordinates))
    data = {
        "format": "gaitsmith-angles-1",
        "source": SOURCE,
        "license": LICENSE,
        "duration": PERIOD,
        "stride_length": 1.4385,
        "events": {"left": [0.0, 0.158, 0.485, 0.660], "right": [0.5, 0.658, 0.985, 0.160]},
        "raw": coefficients(centered(raw)),
        "symmetric": coefficients(centered(symmetrized(raw))),
    }
    lines = [f" {json.dumps(k)}: {json.dumps(v)}" for k, v in data.items()]
    options.output.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
