# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Looks at a finished run, step by step: python3 plot_run.py OUT [PLOT.png]

Needs python3-rtd-slam and python3-matplotlib. In a source tree: PYTHONPATH=common/python.
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import rtd_slam as rtd  # noqa: E402

# %% The run
if len(sys.argv) < 2:
    sys.exit(__doc__)
run = rtd.open(sys.argv[1])
print(run)
print(f"{len(run.poses)} poses over {run.poses.path_length_m:.2f} m, {len(run.keyframes)} keyframes")
for event in run.events:
    print("  event:", event)

# %% Figures of the frames
frames = run.frames
states, counts = np.unique(frames["state_name"], return_counts=True)
print("states:", ", ".join(f"{state} {count}" for state, count in zip(states, counts)))
print(f"latency: median {np.median(frames['latency_ms']):.1f} ms")
seconds = (frames["stamp_ns"] - frames["stamp_ns"][0]) * 1e-9

# %% The path from above (x, z of the first camera), and what was removed over time
figure, (path, removed) = plt.subplots(1, 2, figsize=(11, 4.5), constrained_layout=True)
position = run.poses.position_m
path.plot(position[:, 0], position[:, 2], label="final trajectory")
path.plot(run.keyframes.position_m[:, 0], run.keyframes.position_m[:, 2], ".", label="keyframes")
path.set(xlabel="x in m", ylabel="z in m", title="Path from above")
path.set_aspect("equal", adjustable="datalim")
path.legend()
share = frames["features_removed"] / np.maximum(1, frames["features_removed"] + frames["features_static"])
removed.plot(seconds, 100 * share)
removed.set(xlabel="time in s", ylabel="removed features in %", ylim=(0, 100), title="What moved")
plot = sys.argv[2] if len(sys.argv) > 2 else "run.png"
figure.savefig(plot, dpi=120)
print("plot:", plot)
