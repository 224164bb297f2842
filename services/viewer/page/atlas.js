// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The robots of an atlas (docs/atlas.md) as one of them has them. Pure.

import { transform } from "./geometry.js";

/** The other robots that have met, in the map of the robot of that name: {name, pose (x y z qx qy qz qw of its camera)}.
    robots: of the message `atlas`. None while the robot itself has not met. */
export function companionsOf(robots, name) {
  const own = robots.find((robot) => robot.name === name);
  if (!own?.met) return [];
  return robots.filter((robot) => robot.met && robot.name !== name).map((robot) => ({ name: robot.name, pose: relative(own.map, robot.camera) }));
}

/** T_a_b of T_map_a and T_map_b. */
function relative(a, b) {
  const [x, y, z, w] = [-a[3], -a[4], -a[5], a[6]], [bx, by, bz, bw] = b.slice(3), pose = [];
  transform([0, 0, 0], [x, y, z, w], [b[0] - a[0], b[1] - a[1], b[2] - a[2]], pose, 0);
  return [...pose, w * bx + x * bw + y * bz - z * by, w * by - x * bz + y * bw + z * bx,
          w * bz + x * by - y * bx + z * bw, w * bw - x * bx - y * by - z * bz];
}
