// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The frame of the page: theme, text size, open and closed panels, tabs on a phone, the buttons above the map.

import { byId, setAttribute, setText } from "./dom.js";

const kThemes = ["auto", "light", "dark"];
const kThemeNames = { auto: "as the system", light: "light", dark: "dark" };
const kNarrow = "(max-width: 760px)";

export class PanelFrame {
  constructor(settings, onChange) {
    this.settings = settings;
    this.onChange = onChange;
    this.narrow = matchMedia(kNarrow);
    this.panels = [...document.querySelectorAll("details.panel")];
    this.tabs = [...document.querySelectorAll("[role=tab]")];
    this.modes = [...document.querySelectorAll("[data-mode]")];
    for (const panel of this.panels) this.#bindPanel(panel);
    for (const tab of this.tabs) this.#bindTab(tab);
    for (const button of this.modes) button.addEventListener("click", () => this.setMode(button.dataset.mode));
    byId("theme").addEventListener("click", () => this.nextTheme());
    byId("large").addEventListener("click", () => this.toggleLarge());
    byId("help-open").addEventListener("click", () => byId("help").showModal());
    byId("fit").addEventListener("click", () => this.view?.fit());
    this.narrow.addEventListener("change", onChange);
    settings.prefersLight.addEventListener("change", onChange);
  }

  bindView(scene) {
    this.view = scene;
    for (const button of [...this.modes, byId("fit")]) button.disabled = false;
    this.setMode("follow");
  }

  setMode(mode) {
    if (!this.view) return;
    this.view.setMode(mode);
    for (const button of this.modes) setAttribute(button, "aria-pressed", button.dataset.mode === mode);
  }

  /** Whether the panel is open, and on a phone its tab chosen. */
  shows(name) {
    const panel = byId(`panel-${name}`);
    return this.narrow.matches ? this.settings.tab === name : panel.open;
  }

  apply() {
    const { theme, themeChoice, large, tab } = this.settings, root = document.documentElement;
    setAttribute(root, "data-theme", theme);
    root.classList.toggle("large", large);
    setAttribute(document.body, "data-tab", tab);
    setAttribute(byId("large"), "aria-pressed", large);
    setAttribute(byId("theme"), "title", `Theme: ${kThemeNames[themeChoice]} (T)`);
    setText(byId("theme-name"), `Theme: ${kThemeNames[themeChoice]}`);
    for (const button of this.tabs) {
      const chosen = button.dataset.panel === tab;
      setAttribute(button, "aria-selected", chosen);
      button.tabIndex = chosen ? 0 : -1;
    }
    for (const panel of this.panels) {
      panel.open = this.narrow.matches || !this.settings.closedPanels.includes(panel.id);
    }
  }

  nextTheme() {
    const { settings } = this;
    settings.themeChoice = kThemes[(kThemes.indexOf(settings.themeChoice) + 1) % kThemes.length];
    this.#changed();
  }

  toggleLarge() {
    this.settings.large = !this.settings.large;
    this.#changed();
  }

  #bindPanel(panel) {
    panel.addEventListener("toggle", () => {
      if (this.narrow.matches) return;
      const closed = new Set(this.settings.closedPanels), before = closed.size;
      if (panel.open) closed.delete(panel.id);
      else closed.add(panel.id);
      if (closed.size === before) return;
      this.settings.closedPanels = [...closed];
      this.#changed();
    });
  }

  #bindTab(tab) {
    tab.addEventListener("click", () => {
      this.settings.tab = tab.dataset.panel;
      this.#changed();
    });
    tab.addEventListener("keydown", ({ key }) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[key];
      if (!step) return;
      const next = this.tabs[(this.tabs.indexOf(tab) + step + this.tabs.length) % this.tabs.length];
      next.click();
      next.focus();
    });
  }

  #changed() {
    this.settings.save();
    this.onChange();
  }
}
