// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The page: connects the server's messages to the state, and the state to the panels and the scene.

import { Calls } from "./calls.js";
import { Connection, liveAddress } from "./connection.js";
import { Controls } from "./controls.js";
import { decode } from "./decode.js";
import { byId, setText } from "./dom.js";
import { EventsPanel } from "./events_panel.js";
import { FleetPanel } from "./fleet_panel.js";
import { Header } from "./header.js";
import { HistoryBar } from "./history_bar.js";
import { ImagePanel } from "./image_panel.js";
import { InspectCard } from "./inspect_card.js";
import { LayersPanel } from "./layers_panel.js";
import { PanelFrame } from "./panel_frame.js";
import { Plots } from "./plots.js";
import { PoseAge } from "./pose_age.js";
import { Questions } from "./questions.js";
import { ReplayBar } from "./replay_bar.js";
import { kOfImage, Session } from "./session.js";
import { Settings } from "./settings.js";
import { bindShortcuts } from "./shortcuts.js";
import { SystemPanel } from "./system_panel.js";
import { exposeHooks } from "./hooks.js";
import { ShareDialog } from "./share_dialog.js";
import { parseHash } from "./share.js";
import { hasEnded, isLive, situation } from "./waiting.js";

const kPanelPeriod_ms = 250, kFrugalPanelPeriod_ms = 1000;
const kOldImage_s = 3;
const kFrugalImagePause = 2;   // times the pause between two drawings of the map

class App {
  constructor() {
    this.settings = new Settings();
    this.session = new Session();
    this.age = new PoseAge();
    this.undecoded = { count: 0, reason: "" };
    this.calls = new Calls((message) => this.connection.send(message));
    this.questions = new Questions(this.calls);
    this.header = new Header((index) => this.select(index));
    this.image = new ImagePanel(this.settings, {
      onDrawn: (bitmap) => this.scene?.setCameraImage(bitmap), onSwitch: () => this.sendOptions(),
      pause_ms: () => (this.scene?.frugal ? kFrugalImagePause * this.scene.pace.period_ms : 0),
    });
    this.plots = new Plots();
    this.system = new SystemPanel();
    this.fleet = new FleetPanel((index) => this.select(index));
    this.historyBar = new HistoryBar((moment) => this.showMoment(moment));
    this.inspect = new InspectCard(this);
    this.events = new EventsPanel((event) => this.goTo(event));
    this.controls = new Controls(this.calls);
    this.replay = new ReplayBar(this.calls);
    this.asked = parseHash(location.hash);   // by the link that opened the page
    if (this.asked.layers) for (const name of Object.keys(this.settings.layers)) this.settings.layers[name] = this.asked.layers.includes(name);
    this.layers = new LayersPanel(this.settings, () => this.settingsChanged());
    this.share = new ShareDialog(this);
    this.chosen = this.asked.robot;
    this.frame = new PanelFrame(this.settings, () => this.settingsChanged());
    this.connection = new Connection(liveAddress(location), {
      open: () => this.forget(), close: () => this.calls.abandon(), text: (message) => this.receiveText(message),
      binary: (buffer) => this.receiveBinary(buffer),
    });
    byId("retry").addEventListener("click", () => this.connection.retryNow());
    bindShortcuts(this.actions());
    exposeHooks(this);
    setInterval(() => this.updatePanelsInTime(), kPanelPeriod_ms);
    document.addEventListener("visibilitychange", () => this.settingsChanged());
    this.settingsChanged();
    this.startScene();
  }

  get robot() {
    return this.session.robots.get(this.selected);
  }

  /** The 3D view is loaded last: without WebGL, or without three.js on the server, the panels work all the same.
      attempt: 2 and more after a server that was gone is back; a browser may remember that a module failed. */
  async startScene(attempt = 1) {
    this.sceneAttempt = attempt;
    try {
      const { Scene } = await import(attempt === 1 ? "./scene.js" : `./scene.js?attempt=${attempt}`);
      byId("no-scene").hidden = true;
      this.scene = new Scene(byId("map"), this.settings, (tracking) => this.measureAge(tracking));
      this.frame.bindView(this.scene);
      this.inspect.bind(this.scene);
      if (this.asked.view) {
        this.frame.setMode(this.asked.view.mode);
        this.scene.setView(this.asked.view);
      }
      this.showRobots();
    } catch (error) {
      byId("no-scene").hidden = false;
      setText(byId("no-scene-reason"), error.message);
      this.sceneFailed = true;
    }
    document.documentElement.classList.toggle("plain", this.scene?.software ?? true);
    this.sendOptions();
  }

  /** After a connection is opened the server sends everything again. */
  forget() {
    if (this.sceneFailed) {
      this.sceneFailed = false;
      this.startScene(this.sceneAttempt + 1);
    }
    this.session = new Session();
    this.age = new PoseAge();
    this.options = "";
    this.sendOptions();
    this.showRobots();
    this.updatePanels();
  }

  receiveText(message) {
    if (message.type === "answer") this.calls.answer(message);
    this.session.applyText(message, performance.now());
    if (message.type === "tracking" && message.robot === this.selected) {
      this.scene?.pace.pose(message);
      if (!this.scene) this.measureAge(message);
    }
    if (message.type === "boxes" && message.robot === this.selected) this.image.update(this.robot);
    this.afterMessage();
  }

  receiveBinary(buffer) {
    try {
      const message = decode(buffer);
      if (!message) return;
      this.session.applyBinary(message);
      if (kOfImage.includes(message.type)) {
        if (message.robot === this.selected) this.image.update(this.robot);
        return;
      }
    } catch (error) {
      this.undecoded = { count: this.undecoded.count + 1, reason: error.message };
    }
    this.afterMessage();
  }

  afterMessage() {
    if (this.generation !== this.session.generation) this.showRobots();
    this.scene?.request();
  }

  showRobots() {
    this.generation = this.session.generation;
    const robot = this.session.robotNamed(this.chosen);
    this.selected = robot?.index;
    if (this.session.announced) this.chosen ??= robot?.name;   // it stays when one comes whose name is before
    this.scene?.setRobots(this.session.robots, this.selected);
    this.sendOptions();
  }

  select(index) {
    this.selected = index;
    this.chosen = this.robot.name;
    this.age = new PoseAge();
    this.sendOptions();
    this.scene?.setRobots(this.session.robots, index);
    this.image.update(this.robot);
    this.updatePanels();
  }

  measureAge(tracking) {
    this.age.add(tracking.finished_ms, Date.now(), this.connection.clock.offset_ms);
  }

  /** Less often where drawing takes time from the robot, unless tracking or a recording changes its state. */
  updatePanelsInTime() {
    const states = [this.connection.state, this.robot?.tracking?.state, this.robot?.playback?.state].join();
    const period_ms = this.scene?.frugal && states === this.statesOfPanels ? kFrugalPanelPeriod_ms : 0;
    if (performance.now() - this.panelsUpdated_ms < period_ms - kPanelPeriod_ms / 2) return;
    this.statesOfPanels = states;
    this.updatePanels();
  }

  updatePanels() {
    this.panelsUpdated_ms = performance.now();
    const { session, robot, connection } = this, now_ms = performance.now(), now_s = now_ms / 1000;
    const link = { state: connection.state, address: connection.shownAddress, retry_s: connection.retry_s };
    const report = situation({ connection: link, hello: session.hello, robot, now_ms });
    this.report = report;
    const allowed = connection.state === "open" && session.hello?.control === true;
    const live = robot?.tracking != null && isLive(robot, now_ms);
    this.header.update({ report, session, robot, live, pose_ms: this.age.shown_ms(Date.now(), connection.clock.offset_ms) });
    byId("retry").hidden = connection.state !== "closed";
    if (allowed) this.questions.followDoubt(robot, now_ms, () => this.image.update(this.robot));
    if (this.frame.shows("plots")) this.plots.update(robot, now_s);
    if (this.frame.shows("system")) this.system.update(session, robot, connection, now_s);
    this.fleet.update(session, this.selected, link, now_ms);
    this.historyBar.update(robot, live);
    if (this.frame.shows("events")) this.events.update(robot);
    this.controls.update(robot, allowed, connection.state === "open" && session.hello?.control === false);
    this.replay.update(robot, allowed);
    if (this.asked.at_s !== undefined && this.replay.seekable) {
      this.replay.seek(this.asked.at_s);
      this.asked.at_s = undefined;
    }
    this.layers.update(session, robot);
    setText(byId("drawing"), this.scene?.pace.reason(this.scene.software) ?? "");
    const age_s = robot?.imageAge_s(now_ms) ?? 0;
    byId("image-age").hidden = !(age_s > kOldImage_s) || byId("image").hidden || this.image.frozen;
    setText(byId("image-age"), `${Math.round(age_s)} s ago`);
    if (!robot?.image) this.image.update(robot, robot !== undefined && hasEnded(robot));
    const { count, reason } = this.undecoded;
    setText(byId("undecoded"), count > 0 ? `${count} ${count === 1 ? "message" : "messages"} could not be read: ${reason}` : "");
  }

  /** event: of the log of the selected robot. */
  goTo({ position_s, pose, map }) {
    if (position_s !== undefined && this.replay.seekable) this.replay.seek(position_s);
    else if (pose) this.scene?.lookAt(this.selected, map, pose);
  }

  /** A moment of the history, or null: what is now. */
  showMoment(moment) {
    this.image.freeze(moment);
    this.scene?.showMoment(this.selected, moment);
  }

  settingsChanged() {
    this.frame.apply();
    this.layers.applyTheme();
    this.scene?.applySettings();
    this.sendOptions();
    this.updatePanels();
  }

  /** What is not shown is not sent. A recording may wait until the page is ready. */
  sendOptions() {
    const { layers, overlays } = this.settings;
    const image = this.selected !== undefined && this.frame.shows("image") && !document.hidden;
    const options = { op: "options", image, mask: image && overlays.mask, people: image && overlays.people,
                      features: image && overlays.features, depth: image && overlays.depth,
                      points: layers.points, dense: layers.dense, moving: layers.moving, plan: layers.plan, robot: this.selected,
                      ready: this.scene !== undefined || this.sceneFailed === true };
    const text = JSON.stringify(options);
    if (text !== this.options && this.connection.send(options)) this.options = text;
  }

  actions() {
    const mode = (name) => () => this.frame.setMode(name);
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    return {
      follow: mode("follow"), above: mode("above"), free: mode("free"), fit: () => this.scene?.fit(),
      move: (key) => this.scene?.nudge(...step[key], 1), zoom: (key) => this.scene?.nudge(0, 0, key === "+" ? 0.85 : 1.18),
      coloring: () => this.layers.nextColoring(), pause: () => this.replay.togglePause(), step: () => this.replay.step(),
      save: () => this.controls.press("/slam/save_map"), reset: () => this.controls.press("/slam/reset"),
      robot: () => this.nextRobot(), large: () => this.frame.toggleLarge(), theme: () => this.frame.nextTheme(),
      help: () => byId("help").showModal(), share: () => this.share.open(),
    };
  }

  nextRobot() {
    const indices = this.session.byName.map(({ index }) => index);
    if (indices.length > 1) this.select(indices[(indices.indexOf(this.selected) + 1) % indices.length]);
  }
}

new App();
