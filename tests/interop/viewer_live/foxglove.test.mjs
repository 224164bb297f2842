// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The viewer with Foxglove's own client library: channels, messages decoded by their schemas, services, parameters.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { requirePackage } from "../../support/viewer_page/fake_server.mjs";
import { Service, startViewer, stopAll } from "./rtd_process.mjs";

const { FoxgloveClient } = requirePackage("@foxglove/ws-protocol");
const { parse } = requirePackage("@foxglove/rosmsg");
const { MessageReader } = requirePackage("@foxglove/rosmsg2-serialization");
const WebSocket = requirePackage("ws");
const kPatience_ms = 30_000;

let services = [], client;
const channels = new Map(), offered = new Map();
const graph = { published: new Map(), subscribed: new Map(), services: new Map() };
let info;

before(async () => {
  const viewer = await startViewer();
  services = [viewer, new Service("slam"), new Service("filter", "--set", "filter.detector=off"),
              new Service("camera", "--source", "synthetic:office?frames=0", "--wait-for", "filter,slam")];
  client = new FoxgloveClient({ ws: new WebSocket(`ws://127.0.0.1:${viewer.port}`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
  client.on("serverInfo", (message) => { info = message; });
  client.on("advertise", (list) => list.forEach((channel) => channels.set(channel.topic, channel)));
  client.on("advertiseServices", (list) => list.forEach((service) => offered.set(service.name, service)));
  client.on("connectionGraphUpdate", (message) => {
    for (const { name, publisherIds } of message.publishedTopics) graph.published.set(name, publisherIds);
    for (const { name, subscriberIds } of message.subscribedTopics) graph.subscribed.set(name, subscriberIds);
    for (const { name, providerIds } of message.advertisedServices) graph.services.set(name, providerIds);
  });
});
after(async () => {
  client.close();
  await stopAll(services);
});

/** What `look` returns once it is there. */
async function eventually(look, what) {
  for (const until = Date.now() + kPatience_ms; Date.now() < until; await new Promise((wake) => setTimeout(wake, 50))) {
    const found = look();
    if (found) return found;
  }
  throw new Error(`${what} did not come`);
}

function nextMessage(channel) {
  const subscription = client.subscribe(channel.id);
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error(`no message on ${channel.topic}`)), kPatience_ms);
    const take = (event) => {
      if (event.subscriptionId !== subscription) return;
      clearTimeout(timer);
      client.off("message", take);
      client.unsubscribe(subscription);
      resolve(event);
    };
    client.on("message", take);
  });
}

test("the server introduces itself", async () => {
  await eventually(() => info, "serverInfo");
  for (const capability of ["time", "parameters", "services", "connectionGraph"])
    assert.ok(info.capabilities.includes(capability), capability);
  assert.ok(!info.capabilities.includes("clientPublish"), "off by default");
});

for (const topic of ["/slam/odometry", "/tf", "/camera/color/image_raw/compressed", "rtd/tracking", "rtd/status", "rtd/map"])
  test(`messages of ${topic} are read by their schema`, async () => {
    const channel = await eventually(() => channels.get(topic), topic);
    assert.equal(channel.schemaEncoding, "ros2msg");
    const reader = new MessageReader(parse(channel.schema, { ros2: true }));
    const event = await nextMessage(channel);
    assert.ok(Math.abs(Number(event.timestamp) * 1e-6 - Date.now()) < 10_000, "log time");
    const message = reader.readMessage(event.data);
    if (topic === "/slam/odometry") assert.equal(message.header.frame_id, "odom");
    if (topic === "rtd/status") assert.ok(["camera", "slam", "filter", "viewer"].includes(message.service));
    if (topic === "rtd/tracking") assert.ok(message.landmarks > 0);
  });

test("the graph names who publishes, subscribes and answers", async () => {
  client.subscribeConnectionGraph();
  for (const [part, name, who] of [
    ["published", "/slam/odometry", "rtd-slam"], ["published", "rtd/features", "rtd-filter"],
    ["subscribed", "rtd/features", "rtd-slam"], ["subscribed", "rtd/frame", "rtd-filter"],
    ["services", "/slam/reset", "rtd-slam"],
  ])
    await eventually(() => graph[part].get(name)?.includes(who), `${who} at ${name} in ${part}`);
});

test("commands are services and settings are parameters", async () => {
  const service = await eventually(() => offered.get("/filter/set_mode"), "/filter/set_mode");
  const answer = new Promise((resolve) => client.on("serviceCallResponse", resolve));
  const request = new TextEncoder().encode(JSON.stringify({ argument: "geometry" }));
  client.sendServiceCallRequest({ serviceId: service.id, callId: 5, encoding: "json", data: new DataView(request.buffer) });
  const { callId, data } = await answer;
  assert.equal(callId, 5);
  assert.equal(JSON.parse(new TextDecoder().decode(data)).success, true);

  let parameters = [];
  client.on("parameterValues", (message) => { parameters = message.parameters; });
  await eventually(() => {
    client.getParameters(["filter.mode"], "q");
    return parameters.some(({ name, value }) => name === "filter.mode" && value === "geometry");
  }, "filter.mode = geometry");
});
