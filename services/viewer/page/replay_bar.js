// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Position, pause, step, seek and speed of a replay, below the map.

import { byId, setAttribute, setText } from "./dom.js";
import { offers } from "./commands.js";
import { clockTime } from "./format.js";

export class ReplayBar {
  constructor(calls) {
    this.calls = calls;
    this.slider = byId("seek");
    byId("pause").addEventListener("click", () => this.togglePause());
    byId("step").addEventListener("click", () => this.step());
    byId("speed").addEventListener("change", ({ target }) => this.#call("/replay/speed", target.value));
    this.slider.addEventListener("input", () => {
      this.seeking = true;
      this.#label(Number(this.slider.value));
    });
    this.slider.addEventListener("change", () => this.seek(Number(this.slider.value)));
  }

  update(robot, allowed) {
    this.robot = robot;
    this.allowed = allowed;
    const playback = robot?.playback;
    byId("replay").hidden = !playback;
    if (!playback) return;
    const usable = (name) => allowed && offers(robot.commands, name);
    byId("pause").disabled = !usable("/replay/pause");
    byId("step").disabled = !usable("/replay/step");
    byId("speed").disabled = !usable("/replay/speed");
    this.slider.disabled = !usable("/replay/seek");
    this.#show(playback);
  }

  get seekable() {
    return !byId("replay").hidden && !this.slider.disabled;
  }

  togglePause() {
    const { playback } = this.robot ?? {};
    if (playback && !byId("pause").disabled) this.#call("/replay/pause", String(playback.state === "playing"));
  }

  step() {
    if (this.robot?.playback && !byId("step").disabled) this.#call("/replay/step", "");
  }

  async seek(position_s) {
    await this.#call("/replay/seek", position_s.toFixed(2));
    this.seeking = false;
  }

  #show({ state, position_s, length_s, speed }) {
    const playing = state === "playing";
    setText(byId("pause"), playing ? "Pause" : "Play");
    setAttribute(byId("pause"), "data-icon", playing ? "pause" : "play");
    setText(byId("replay-state"), state === "ended" ? "ended" : "");
    setAttribute(this.slider, "max", length_s);
    const select = byId("speed");
    if (document.activeElement !== select) select.value = String(speed);
    if (this.seeking) return;
    this.slider.value = position_s;
    this.length_s = length_s;
    this.#label(position_s);
  }

  #label(position_s) {
    const text = `${clockTime(position_s)} / ${clockTime(this.length_s)}`;
    setText(byId("position"), text);
    setAttribute(this.slider, "aria-valuetext", text);
  }

  async #call(name, argument) {
    const answer = byId("replay-answer"), { success, message } = await this.calls.call(this.robot.index, name, argument);
    answer.className = `answer ${success ? "good" : "bad"}`;
    setText(answer, message);
  }
}
