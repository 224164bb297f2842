// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// window.rtdViewer: what tests and scripts may read of the page. It changes nothing.

export function exposeHooks(app) {
  window.rtdViewer = Object.freeze({
    /** What a user would see, as data. */
    state: () => ({
      connection: app.connection.state, report: app.report, hello: app.session.hello, link: app.session.link,
      selected: app.selected, robots: [...app.session.robots.values()].map(summary), undecoded: app.undecoded.count,
      scene: app.scene ? app.scene.modes.mode : "none",
    }),
    /** Of the selected robot, all its maps: points received, points slam has, keyframes. */
    get counts() {
      const count = (name) => app.robot?.count(name) ?? 0;
      return { points: count("pointCount"), pointsTotal: count("pointTotal"), keyframes: count("posedCount") };
    },
    get fps() { return app.scene?.framesPerSecond ?? 0; },
    /** Share of the points that were drawn last: less than 1 only while a slow graphics driver is busy. */
    get drawnShare() { return app.scene?.look.share ?? 0; },
    get poseAgeP50() { return app.age.p50_ms; },
    get reconnects() { return app.connection.reconnects; },
    /** Draws without a pause for so many seconds: frames per second. */
    measureFps: (seconds) => app.scene?.measure(seconds) ?? Promise.resolve(0),
  });
}

function summary(robot) {
  const { index, name, tracking, playback, truthError, commands, services, movers, image } = robot;
  return { index, name, tracking, playback, truthError, commands, services, movers, imageStamp_s: image?.stamp_s ?? null,
           maps: [...robot.maps.values()].map((map) => ({ id: map.id, keyframes: map.posedCount, points: map.pointCount,
                                                          trajectory: map.trajectory.length, truth: map.truth.length / 3,
                                                          dense: pointsOf(map.dense), moving: pointsOf(map.moving), plan: map.plan !== null })) };
}

const pointsOf = ({ parts }) => parts.reduce((sum, { positions }) => sum + positions.length / 3, 0);
