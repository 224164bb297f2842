// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// One sentence about where things stand, and one about what to do: the page is never blank without saying why.

import { reasons } from "./doubt.js";
import { vendorName } from "./format.js";

const kStale_ms = 3000;
const kLastFrames_ms = 15_000;   // a busy computer may need for one of them
const kSources = ["camera", "replay"];
const kStopped = ["finished", "gone"];

const kStates = {
  ok: ["ok", "Tracking", ""],
  initializing: ["wait", "Starting the map", "Move the camera slowly, and show it something with texture."],
  predicted: ["warn", "Predicted pose", "Nothing static is in view; the last motion is continued for a moment."],
  doubtful: ["warn", "Doubtful pose", "Much of the view contradicts it: a large object may be moving."],
  odometry: ["warn", "Pose from frame to frame", "The map is not recognised here; errors add up until it is."],
  "recently lost": ["warn", "Tracking just lost", "Point the camera at something it has seen before."],
  lost: ["bad", "Tracking lost", "Point the camera at a place it has seen before. The map is kept."],
  relocalizing: ["warn", "Place recognised", "The pose returns when the next frames confirm it."],
};

const report = (level, title, detail = "") => ({ level, title, detail });

/** connection: {state, address, retry_s}; hello: or null; robot: RobotState or undefined. level: ok, wait, warn, bad.
    quiet: the line at the top says enough when a map is shown. */
export function situation({ connection, hello, robot, now_ms }) {
  return ofConnection(connection, hello) ?? ofServices(robot, hello) ?? ofTracking(robot, now_ms);
}

function ofConnection({ state, address, retry_s }, hello) {
  if (state === "connecting") return report("wait", "Connecting", `to ${address}`);
  if (state !== "open") {
    const again = retry_s > 0 ? ` Next attempt in ${retry_s} s.` : "";
    return report("bad", "Not connected",
                  `Nothing answers at ${address}. Start "rtd viewer" or "rtd run --viewer" there.${again}`);
  }
  if (!hello) return report("wait", "Connected", "The server has not introduced itself yet.");
  if (hello.protocol !== 1) {
    return report("bad", "Page and server do not match",
                  `The server speaks protocol ${hello.protocol}, the page protocol 1. Reload the page.`);
  }
  return null;
}

function ofServices(robot, hello) {
  if (!robot || (robot.services.length === 0 && !robot.tracking)) {
    return report("wait", "Waiting for a robot",
                  `No service on DDS domain ${hello.domain} (${vendorName(hello.vendor)}) yet. Start "rtd run --source ..." in this domain.`);
  }
  const failed = robot.services.find((service) => service.state === "failed");
  if (failed) return report("bad", `${failed.name} failed`, failed.message || "Its log says why.");
  if (robot.tracking) return null;
  const running = (name) => robot.services.some((service) => service.name === name && !kStopped.includes(service.state));
  if (!kSources.some(running)) return report("wait", "Waiting for a camera", sourcesOf(robot).length > 0 ? "Neither a camera nor a replay is running." : "No camera or replay has reported yet.");
  if (!running("slam")) return report("wait", "Waiting for slam", "Images arrive, but rtd-slam is not running.");
  const busy = robot.services.filter((service) => service.state === "starting" || service.state === "ready");
  const reasons = busy.map(({ name, message }) => (message ? `${name}: ${message}` : `${name} is starting`));
  return report("wait", "Waiting for the first pose", reasons.join("; "));
}

/** Whether poses come. */
export const isLive = (robot, now_ms) => now_ms - robot.trackingAt_ms <= kStale_ms;

function ofTracking(robot, now_ms) {
  if (!isLive(robot, now_ms)) return withoutPoses(robot, now_ms - robot.trackingAt_ms);
  const [level, title, detail] = kStates[robot.tracking.state] ?? ["warn", `State: ${robot.tracking.state}`, ""];
  return report(level, title, [detail, ...reasons(robot)].join(" ").trim());
}

const sourcesOf = ({ services }) => services.filter(({ name }) => kSources.includes(name));

/** Whether its camera or recording has come to its end: one that died has not. */
export function hasEnded(robot) {
  const sources = sourcesOf(robot);
  return robot.playback?.state === "ended" || (sources.length > 0 && sources.every(({ state }) => state === "finished"));
}

function withoutPoses(robot, age_ms) {
  const { playback, services } = robot;
  if (playback?.state === "paused") return { ...report("wait", "Paused", `at ${playback.position_s.toFixed(1)} s of the recording`), quiet: true };
  const died = [...robot.deaths.keys()].filter((name) => ["camera", "filter", "slam"].includes(name));
  if (hasEnded(robot) && died.length > 0)
    return report("warn", `${died.join(" and ")} died on the way`, "The rest of the source was played: frames may be missing. The report of the run says more.");
  const slam = services.find((service) => service.name === "slam"), slamStopped = !slam || kStopped.includes(slam.state);
  if (hasEnded(robot) && !slamStopped && age_ms < kLastFrames_ms) return report("wait", "Waiting for the last poses", "The source has ended, and slam still runs.");
  if (hasEnded(robot)) return { ...report("wait", "The source has ended", "Its map stays as long as the viewer runs."), quiet: true };
  const sources = sourcesOf(robot), gone = sources.find(({ state }) => state === "gone");
  if (gone && sources.every(({ state }) => kStopped.includes(state))) return report("bad", `The ${gone.name} is gone`, "It sends no heartbeat: it died, was killed, or its host is away.");
  if (!slam && playback) return { ...report("wait", "No pose", `for ${Math.round(age_ms / 1000)} s of the recording`), quiet: true };
  if (slamStopped) return report("bad", "slam is gone", "Its last map is shown.");
  return report("warn", "No pose", `for ${Math.round(age_ms / 1000)} s. ${slam.message}`.trim());
}
