// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The runtime commands that the page knows: their words, and which of them destroy something. Others keep their names.

// Those that the panel has a button for; `rtd call` takes all.
export const kFilterModes = ["off", "semantic", "geometry", "rtd"];
const kModePrefix = "mode.";

/** kind: button, text (a field and a button), switch (two states), choice. confirm: asked before it is sent.
    idle: what the button says while it has nothing to do. */
const kKnown = {
  "/slam/reset": {
    group: "Map", kind: "button", label: "Reset map", danger: true,
    confirm: "Reset the map? Keyframes, landmarks and the trajectory are deleted. Save the map first if you need it.",
  },
  "/slam/save_map": { group: "Map", kind: "text", label: "Save map", placeholder: "name (optional)" },
  "/slam/load_map": {
    group: "Map", kind: "text", label: "Load map", placeholder: "name of a saved map", danger: true, required: true,
    confirm: "Load the map? It replaces the current one. Save the current map first if you need it.",
  },
  "/slam/localize_only": { group: "Map", kind: "switch", label: "Mode", off: "Map and localise", on: "Localise only" },
  "/filter/set_mode": { group: "Filter", kind: "choice", label: "Mode", choices: kFilterModes },
  "/recorder/start": { group: "Recording", kind: "text", label: "Start recording", placeholder: "name (optional)",
                       idle: "Recording …" },
  "/recorder/stop": { group: "Recording", kind: "button", label: "Stop recording", idle: "Not recording" },
};

const kElsewhere = /^\/(replay\/|slam\/ask$)/;   // a bar of its own; what the page asks by itself
const kKinds = { none: "button", bool: "switch", text: "text" };

/** The commands for the panel, in a fixed order. */
export function panelCommands(commands) {
  const order = Object.keys(kKnown);
  const rank = ({ name }) => (order.includes(name) ? order.indexOf(name) : order.length);
  return commands.filter(({ name }) => !kElsewhere.test(name)).map(describe)
    .sort((a, b) => rank(a) - rank(b) || a.name.localeCompare(b.name));
}

export function describe({ name, argument }) {
  const other = { group: "Other commands", kind: kKinds[argument] ?? "text", label: name, off: "Off", on: "On" };
  return { name, ...(kKnown[name] ?? other) };
}

/** The argument that holds now, from the heartbeats of the services; undefined if they do not say. */
export function currentArgument(name, services) {
  const metricsOf = (service) => services.find((one) => one.name === service)?.metrics ?? {};
  if (name === "/filter/set_mode")
    return Object.keys(metricsOf("filter")).find((key) => key.startsWith(kModePrefix))?.slice(kModePrefix.length);
  const localizes = metricsOf("slam").localize_only;
  return name === "/slam/localize_only" && localizes !== undefined ? String(localizes === 1) : undefined;
}

/** Whether the command would change nothing now, by the heartbeats; false if they do not say. */
export function isIdle(name, services) {
  const recording = services.find((one) => one.name === "record")?.metrics?.recording;
  return (name === "/recorder/start" && recording === 1) || (name === "/recorder/stop" && recording === 0);
}

export const offers = (commands, name) => commands.some((command) => command.name === name);
