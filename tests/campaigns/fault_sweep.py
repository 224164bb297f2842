# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""The faults of `tests/campaigns/stress.py faults`: what is swept and the tables. Standard library only."""
import dataclasses
import math
import statistics

MODES = ("off", "semantic", "geometry", "rtd", "true-mask")
PARTS = ("semantic", "geometry")  # what rtd joins
LOST = math.inf                   # error of a run that lost its track


@dataclasses.dataclass(frozen=True)
class Fault:
    """`{}` in the parameters of the source and in the options of the program is the strength."""
    strengths: tuple
    unit: str = ""
    source: str = ""
    options: tuple = ()


FAULTS = {
    "steps": Fault((0.125, 0.25, 0.5, 1), "px", "disparity_step_px={}&noise_correlation_px=5"),
    "noise": Fault((0.05, 0.1, 0.2, 0.4), "px", "disparity_noise_px={}&noise_correlation_px=5"),
    "holes": Fault((0.15, 0.2, 0.3, 0.45), "", "holes={}&dark_holes=0.75&monitor_holes=0.9"),
    "flying": Fault((1, 2, 4, 6), "px", "flying_px={}&wrong_side_px={}"),
    "shadow": Fault((14, 20, 30, 40), "px", "shadow_px={}"),
    "registration": Fault((1, 2, 3, 5), "px", "registration_px={}&parallax_px_m={}"),
    "depth_error": Fault((0.005, 0.01, 0.02, 0.04), "", "depth_error={}"),
    "depth_lag": Fault((-5, 5, 10, 20), "ms", "depth_lag_ms={}"),
    "depth_missing": Fault((10, 5, 3, 2), "every", "depth_missing_every={}"),
    "rolling": Fault((10, 15, 21, 30), "ms", "rolling_shutter_ms={}&depth_shutter_ms=26"),
    "blur": Fault((5, 10, 20, 30), "ms", "blur_ms={}"),
    "exposure": Fault((0.5, 1, 1.5, 2), "EV", "exposure_ev={}"),
    "vignetting": Fault((0.2, 0.35, 0.5, 0.7), "", "vignetting={}"),
    "jpeg": Fault((90, 80, 60, 40), "quality", "jpeg={}"),
    "distortion": Fault((0.25, 0.5, 1, 1.5), "x fr1", "distortion={}"),
    "calibration": Fault((0.005, 0.01, 0.015, 0.02), "", "calibration_error={}"),
    "rate": Fault((60, 20, 15, 10), "Hz", "fps={}"),
    "drops": Fault((0.05, 0.1, 0.2, 0.3), "", "drops={}"),
    "recall": Fault((0.9, 0.78, 0.65, 0.5), "", options=("--detector-recall", "{}")),
    "cut_boxes": Fault((0.25, 0.5, 0.75, 1), "", options=("--detector-cut", "{}")),
    "combined": Fault((0.25, 0.5, 1, 1.5), "x"),
    "sensor": Fault(("kinect", "d435"), "", "sensor={}&drops=0.1"),
}
# Strength 1 of "combined"; each is multiplied by the strength.
COMBINED = {"holes": 0.2, "dark_holes": 0.6, "monitor_holes": 0.6, "flying_px": 2, "wrong_side_px": 2,
            "registration_px": 1.5, "parallax_px_m": 2, "depth_error": 0.01, "depth_lag_ms": 9,
            "rolling_shutter_ms": 21, "depth_shutter_ms": 26, "blur_ms": 10, "exposure_ev": 0.75, "vignetting": 0.25,
            "calibration_error": 0.005, "noise_correlation_px": 5, "drops": 0.1}
QUICK = ("holes", "flying", "depth_lag", "rolling", "recall", "combined")


def parameters(name: str, strength) -> str:
    """What the fault adds to the URI of the source."""
    if name == "combined":
        return "&".join(f"{key}={value * strength:g}" for key, value in COMBINED.items())
    return FAULTS[name].source.replace("{}", str(strength))


def source(scene: str, name: str, strength, seed: int, seconds: float) -> str:
    fps = strength if name == "rate" else 30
    uri = f"synthetic:{scene}?frames={round(seconds * fps)}&seed={seed}"
    return "&".join(part for part in (uri, parameters(name, strength) if name else "") if part)


def options(name: str, strength) -> list:
    return [text.replace("{}", str(strength)) for text in FAULTS[name].options] if name else []


def error_m(result: dict, min_coverage: float) -> float:
    """ATE of a run; LOST when there is none or too little of the way was tracked."""
    if result.get("ate_m") is None or result.get("coverage", 0) < min_coverage:
        return LOST
    return result["ate_m"]


def ratio(errors: dict) -> float:
    """rtd against the better of its parts; 1 when all of them are lost."""
    better = min(errors[part] for part in PARTS)
    if better == LOST:
        return 1 if errors["rtd"] == LOST else 0
    return errors["rtd"] / better


def metres(value: float) -> str:
    return "lost" if value == LOST else f"{value:.4f}"


def cell(errors: list) -> str:
    return f"{metres(statistics.median(errors))} / {metres(max(errors))}"


def table(errors: dict, modes: list) -> str:
    """`errors`: (fault, strength) -> list over the seeds of {mode: error in metres}."""
    with_ratio = {"rtd", *PARTS} <= set(modes)
    lines = ["ATE in m, median / worst of the seeds." + (" Ratio: rtd against the better of semantic and geometry, "
             "median / worst." if with_ratio else ""), "",
             "| fault | strength | " + " | ".join(modes) + (" | ratio |" if with_ratio else " |"),
             "|" + "---|" * (2 + len(modes) + with_ratio)]
    for (name, strength), seeds in errors.items():
        unit = FAULTS[name].unit if name else ""
        line = f"| {name or 'none'} | {strength} {unit}".rstrip() + " | "
        line += " | ".join(cell([run[mode] for run in seeds]) for mode in modes) + " |"
        if with_ratio:
            ratios = [ratio(run) for run in seeds]
            line += f" {statistics.median(ratios):.2f} / {max(ratios):.2f} |"
        lines.append(line)
    return "\n".join(lines)


def worst_cases(errors: dict, seeds: list, count: int) -> list:
    """(ratio, fault, strength, seed, errors of the modes), the worst first."""
    cases = [(ratio(run), name, strength, seed, run) for (name, strength), runs in errors.items()
             for seed, run in zip(seeds, runs)]
    return sorted(cases, key=lambda case: -case[0])[:count]
