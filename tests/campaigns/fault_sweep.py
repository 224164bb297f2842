# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""The faults of `tests/campaigns/stress.py faults`: what is swept, the tables and the drawing. Standard library only."""
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


# ---- the drawing ----
COLORS = {"off": "#888888", "semantic": "#d08a00", "geometry": "#2a7fbf", "rtd": "#c02a3a", "true-mask": "#3a9a4a"}
COLUMNS, WIDTH, HEIGHT, PLOT_W, PLOT_H, LEFT, TOP = 4, 290, 210, 220, 130, 52, 34
LOWEST_M, HIGHEST_M = 0.001, 3.0


def height_of(error: float) -> float:
    """y of an error in its panel: logarithmic; what is lost lies at the top."""
    clamped = min(max(error, LOWEST_M), HIGHEST_M)
    return PLOT_H * (1 - math.log(clamped / LOWEST_M) / math.log(HIGHEST_M / LOWEST_M))


def panel(name: str, points: list, modes: list) -> list:
    """`points`: (label, list of {mode: error}), from no fault to the strongest."""
    step = PLOT_W / max(1, len(points) - 1)
    svg = [f'<text x="{LEFT}" y="{TOP - 10}" class="title">{name}'
           f'{" [" + FAULTS[name].unit + "]" if FAULTS[name].unit else ""}</text>',
           f'<rect x="{LEFT}" y="{TOP}" width="{PLOT_W}" height="{PLOT_H}" class="frame"/>']
    for tick in (0.001, 0.01, 0.1, 1):
        y = TOP + height_of(tick)
        svg.append(f'<line x1="{LEFT}" x2="{LEFT + PLOT_W}" y1="{y:.1f}" y2="{y:.1f}" class="grid"/>'
                   f'<text x="{LEFT - 5}" y="{y + 4:.1f}" class="tick" text-anchor="end">{tick:g}</text>')
    for i, (label, _) in enumerate(points):
        svg.append(f'<text x="{LEFT + i * step:.1f}" y="{TOP + PLOT_H + 15}" class="tick" '
                   f'text-anchor="middle">{label}</text>')
    for mode in modes:
        medians = [(LEFT + i * step, TOP + height_of(statistics.median([run[mode] for run in runs])))
                   for i, (_, runs) in enumerate(points)]
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in medians)
        svg.append(f'<polyline points="{line}" fill="none" stroke="{COLORS[mode]}" stroke-width="2"/>')
        for (x, _), (_, runs) in zip(medians, points):
            y = TOP + height_of(max(run[mode] for run in runs))
            svg.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.2" fill="{COLORS[mode]}" fill-opacity="0.6"/>')
    return svg


def drawing(errors: dict, modes: list) -> str:
    """SVG with a panel for every fault: median as a line, worst seed as a dot, by strength."""
    names = list(dict.fromkeys(name for name, _ in errors if name))
    rows = math.ceil(len(names) / COLUMNS)
    width, height = COLUMNS * WIDTH, rows * HEIGHT + 40
    svg = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
           'font-family="sans-serif"><style>.title{font-size:13px;font-weight:bold}.tick{font-size:10px;fill:#444}'
           '.grid{stroke:#ddd}.frame{fill:none;stroke:#999}</style>'
           f'<rect width="{width}" height="{height}" fill="white"/>'
           '<text x="10" y="22" class="tick">ATE [m]; line: median, dot: worst seed; at the top: lost</text>']
    for i, mode in enumerate(modes):
        svg.append(f'<text x="{420 + 110 * i}" y="22" font-size="13" fill="{COLORS[mode]}">&#9644; {mode}</text>')
    for i, name in enumerate(names):
        points = [("none", errors[("", 0)])] if name != "sensor" else []
        points += [(str(strength), runs) for (fault, strength), runs in errors.items() if fault == name]
        x, y = WIDTH * (i % COLUMNS), 30 + HEIGHT * (i // COLUMNS)
        svg += [f'<g transform="translate({x},{y})">', *panel(name, points, modes), "</g>"]
    return "\n".join([*svg, "</svg>", ""])
