// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Buttons for the runtime commands that the robot offers now. Each shows what the service answered.

import { byId, confirmed, el, setText } from "./dom.js";
import { currentArgument, describe, isIdle, panelCommands } from "./commands.js";

export class Controls {
  /** calls: Calls */
  constructor(calls) {
    this.calls = calls;
    this.shown = "";
  }

  /** allowed: whether commands are taken; refused: whether the server said that they are not. */
  update(robot, allowed, refused) {
    const commands = robot?.commands ?? [];
    byId("controls-none").hidden = commands.length > 0;
    byId("controls-off").hidden = !refused || commands.length === 0;
    const key = JSON.stringify([robot?.index, allowed, commands]);
    if (key !== this.shown) this.#build(robot, commands, allowed);
    this.shown = key;
    for (const command of commands) {
      showCurrent(command.name, currentArgument(command.name, robot.services));
      showIdle(describe(command), isIdle(command.name, robot.services));
    }
  }

  /** Presses the button of a command, for the keyboard. */
  press(name) {
    rowOf(name)?.querySelector("button")?.click();
  }

  #build(robot, commands, allowed) {
    const groups = new Map();
    for (const command of panelCommands(commands)) {
      if (!groups.has(command.group)) groups.set(command.group, []);
      groups.get(command.group).push(this.#row(robot.index, command, allowed));
    }
    byId("controls").replaceChildren(...[...groups].map(([title, rows]) =>
      el("fieldset", { class: "group", disabled: !allowed }, el("legend", {}, title), ...rows)));
  }

  #row(robot, command, allowed) {
    const answer = el("output", { class: "answer", "aria-live": "polite" });
    const send = (argument, button) => this.#call(robot, command, argument, button, answer);
    const row = el("div", { class: "command", "data-command": command.name }, ...this.#inputs(command, send), answer);
    return row;
  }

  #inputs(command, send) {
    if (command.kind === "button") return [actionButton(command, () => "", send)];
    if (command.kind === "text") return textInputs(command, send);
    const options = command.kind === "switch"
      ? [[command.off, "false"], [command.on, "true"]]
      : command.choices.map((choice) => [choice, choice]);
    return [el("div", { class: "choice", role: "group", "aria-label": command.label }, el("span", { class: "label" }, command.label),
               el("span", { class: "segments" }, ...options.map(([label, argument]) => choiceButton(label, argument, send))))];
  }

  async #call(robot, command, argument, button, answer) {
    if (command.confirm && !(await confirmed(command.confirm, command.label))) return;
    button.disabled = true;
    answer.className = "answer waiting";
    setText(answer, "Waiting for the answer …");
    const { success, message } = await this.calls.call(robot, command.name, argument);
    button.disabled = false;
    answer.className = `answer ${success ? "good" : "bad"}`;
    setText(answer, message || (success ? "Done." : "The command failed."));
    if (success && button.parentElement.classList.contains("segments")) press(button);
  }
}

const rowOf = (name) => byId("controls").querySelector(`[data-command="${CSS.escape(name)}"]`);

/** Which choice holds: from a heartbeat, or known once an answer confirmed it. */
function showCurrent(name, argument) {
  const chosen = argument && rowOf(name)?.querySelector(`.segments [data-argument="${argument}"]`);
  if (chosen && chosen.getAttribute("aria-pressed") !== "true") press(chosen);
}

function showIdle({ name, label, idle }, isIdle) {
  const row = rowOf(name), button = row?.querySelector("button");
  if (!idle || !button || row.querySelector(".answer.waiting")) return;
  button.disabled = isIdle;
  setText(button, isIdle ? idle : label);
}

function press(button) {
  for (const other of button.parentElement.children) other.setAttribute("aria-pressed", other === button);
}

function actionButton(command, argument, send) {
  const button = el("button", { type: "button", class: command.danger ? "danger" : "" }, command.label);
  button.addEventListener("click", () => send(argument(), button));
  return button;
}

function choiceButton(label, argument, send) {
  const button = el("button", { type: "button", "aria-pressed": "false", "data-argument": argument }, label);
  button.addEventListener("click", () => send(argument, button));
  return button;
}

function textInputs(command, send) {
  const input = el("input", { type: "text", placeholder: command.placeholder ?? "text", "aria-label": `${command.label}: ${command.placeholder ?? "text"}`,
                              spellcheck: "false", autocomplete: "off", required: Boolean(command.required) });
  const button = actionButton(command, () => input.value.trim(), (argument, pressed) => {
    if (input.reportValidity()) send(argument, pressed);
  });
  input.addEventListener("keydown", (event) => {
    if (event.key === "Enter") button.click();
  });
  return [el("div", { class: "field" }, input, button)];
}
