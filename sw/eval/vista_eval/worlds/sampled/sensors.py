"""The cameras of a sampled flight, and the poses that come with it.

every flight   noise of 1 to 2.5 grey levels, gains that agree within 3 %, up to 0.6 px of defocus and 3 ms
               of exposure, up to 25 % of vignetting, a weak veil towards the sun
30 %           one fault besides, each as likely: noise of 2.5 to 10 grey levels; 0.8 to 2 px of defocus on
               one lens; 4 to 10 ms of exposure; gains that differ by up to 12 %; 50 % of vignetting;
               glare; dirt on 1 to 4 % of one lens; rows of the right camera off by 0.1 to 0.5 px
25 %           a fault of the poses, each as likely: 10 to 60 ms of delay; drift of up to 0.3 m/s and
               0.3 degrees/s; one to four frames without a new pose
"""

from __future__ import annotations

import numpy as np

from vista_eval.render.course import NO_FAULTS, PoseFaults
from vista_eval.render.optics import FlawedSensor
from vista_eval.render.rig import PAPER_RIG, Rig
from vista_eval.worlds.draws import draws, log_uniform, some_seed

FAULTY, LOST = 0.3, 0.25  # shares of the flights with a fault of a camera, of the poses
FAULTS = ("noise", "defocus", "motion", "gain", "vignetting", "glare", "dirt", "rows")
POSE_FAULTS = ("delay", "drift", "drop-out")


def fault_of(seed: int) -> str:
    """The fault of the cameras; empty: none."""
    rng = draws(seed, "fault")
    return str(rng.choice(FAULTS)) if rng.random() < FAULTY else ""


def sensor(seed: int) -> FlawedSensor:
    rng, fault = draws(seed, "sensor"), fault_of(seed)
    noise_grey = log_uniform(rng, 2.5, 10.0) if fault == "noise" else log_uniform(rng, 1.0, 2.5)
    mismatch = rng.uniform(-0.12, 0.12) if fault == "gain" else rng.uniform(-0.03, 0.03)
    defocus, dirt = rng.uniform(0.0, 0.6, 2), np.zeros(2)
    one = int(rng.integers(2))
    if fault == "defocus":
        defocus[one] = rng.uniform(0.8, 2.0)
    if fault == "dirt":
        dirt[one] = rng.uniform(0.01, 0.04)
    return FlawedSensor(
        gain=(1.0, float(1 + mismatch)),
        defocus_px=(float(defocus[0]), float(defocus[1])),
        exposure_s=float(rng.uniform(0.004, 0.010) if fault == "motion" else rng.uniform(0.0003, 0.003)),
        vignetting=0.5 if fault == "vignetting" else float(rng.uniform(0.0, 0.25)),
        glare=float(rng.uniform(0.1, 0.4) if fault == "glare" else rng.uniform(0.0, 0.03)),
        dirt=(float(dirt[0]), float(dirt[1])),
    ).with_noise(noise_grey)


def rig(seed: int) -> Rig:
    if fault_of(seed) != "rows":
        return PAPER_RIG
    rng = draws(seed, "rig")
    return PAPER_RIG.with_rows_off(float(rng.choice([-1, 1]) * rng.uniform(0.1, 0.5)))


def pose_faults(seed: int, frames: int) -> PoseFaults:
    rng = draws(seed, "poses")
    if rng.random() >= LOST:
        return NO_FAULTS
    match str(rng.choice(POSE_FAULTS)):
        case "delay":
            return PoseFaults(delay_s=float(rng.uniform(0.01, 0.06)))
        case "drift":
            drift_m_s, drift_deg_s = (float(rate) for rate in rng.uniform(0.0, 0.3, 2))
            return PoseFaults(drift_m_s=drift_m_s, drift_deg_s=drift_deg_s, seed=some_seed(rng))
        case _:
            return PoseFaults(lost=((int(rng.integers(5, frames - 4)), int(rng.integers(1, 5))),))
