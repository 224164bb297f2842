// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// What happened, newest last: changes of tracking, services and the map. Pure data.

const kKept = 300;
const kLevels = { ok: "ok", initializing: "wait", lost: "bad" };
const kBadStates = ["failed", "gone"];

export class EventLog {
  constructor() {
    this.entries = [];      // {kind: tracking | service | map, level, text, stamp_s, position_s, pose}
    this.states = new Map();
  }

  /** A pose came. */
  tracking(tracking, playback) {
    const { state, map } = tracking;
    if (this.#changed("tracking", state)) this.#add("tracking", kLevels[state] ?? "warn", `tracking: ${state}`, tracking, playback);
    if (this.#changed("map", map) && this.entries.some(({ kind }) => kind === "map")) this.#add("map", "warn", `in map ${map}`, tracking, playback);
  }

  services(services, tracking, playback) {
    for (const { name, state, message } of services) {
      const bad = kBadStates.includes(state), level = bad ? "bad" : state === "degraded" ? "warn" : "ok";
      if (this.#changed(name, state)) this.#add("service", level, `${name}: ${state}${message && level !== "ok" ? `, ${message}` : ""}`, tracking, playback);
    }
  }

  map(text, tracking, playback) {
    this.#add("map", "ok", text, tracking, playback);
  }

  #changed(name, state) {
    const before = this.states.get(name);
    this.states.set(name, state);
    return before !== state;
  }

  #add(kind, level, text, tracking, playback) {
    this.entries.push({ kind, level, text, stamp_s: tracking?.stamp_s, position_s: playback?.position_s, pose: tracking?.pose ?? null, map: tracking?.map });
    if (this.entries.length > kKept) this.entries.shift();
  }
}
