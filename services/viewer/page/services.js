// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// What the heartbeats of the services say: the metrics that people look for, and which host is how far off.

const kHostName = "host_name.";
const kHidden = /^(host_id$|host_name\.|clock\.|in:|out:|acknowledged:|replay\.(at|begin)_s$)/;
const kDrops = /(dropped|lost|lost_in_transit|lost_in_queue|broken|defective|without_image|without_mask)$/;
const kTroubles = /^(topic\.|peer\.|hung$)/;

export const badness = { failed: 3, gone: 2, degraded: 2, starting: 1, ready: 1, running: 0, finished: 0 };

/** {name, state, message, host, age_ms, drops, troubles: [text], metrics: [[name, value]], clocks: [{peer, offset_ms}]} */
export function summarize(service) {
  const metrics = Object.entries(service.metrics ?? {});
  return {
    name: service.name, state: service.state, message: service.message, age_ms: service.age_ms, host: hostOf(metrics),
    drops: metrics.filter(([name]) => kDrops.test(name) && !kHidden.test(name)).reduce((sum, [, value]) => sum + value, 0),
    troubles: metrics.filter(([name, value]) => kTroubles.test(name) && value > 0).map(([name]) => name),
    metrics: metrics.filter(([name]) => !kHidden.test(name) && !kTroubles.test(name)),
    clocks: clocksOf(metrics),
  };
}

/** A metric has the name in its own: metrics have no other place for a text. */
function hostOf(metrics) {
  const named = metrics.find(([name]) => name.startsWith(kHostName));
  return named ? named[0].slice(kHostName.length) : "";
}

/** The services host by host, the host of most of them first; of one host those with troubles first. */
export function byHost(summaries) {
  const sizes = new Map();
  for (const { host } of summaries) sizes.set(host, (sizes.get(host) ?? 0) + 1);
  return [...summaries].sort((a, b) => sizes.get(b.host) - sizes.get(a.host) || a.host.localeCompare(b.host)
    || badness[b.state] - badness[a.state] || a.name.localeCompare(b.name));
}

/** Metrics clock.PEER.offset_ms and clock.PEER.round_trip_ms, present for peers on other hosts. */
function clocksOf(metrics) {
  const values = new Map(metrics);
  return metrics.flatMap(([name, offset_ms]) => {
    const peer = /^clock\.(.+)\.offset_ms$/.exec(name)?.[1];
    return peer ? [{ peer, offset_ms, round_trip_ms: values.get(`clock.${peer}.round_trip_ms`) }] : [];
  });
}

/** One line about where objects are detected and how fast; "" without a detector. */
export function detectorLine(services) {
  const detector = services.find((service) => service.name === "detector");
  if (!detector) return "";
  const { host, metrics } = summarize(detector), values = new Map(metrics);
  const latency = values.has("latency_p50_ms")
    ? `${values.get("latency_p50_ms").toFixed(0)} ms p50, ${(values.get("latency_p99_ms") ?? NaN).toFixed(0)} ms p99`
    : values.has("detect_ms") ? `${values.get("detect_ms").toFixed(0)} ms per image` : "";
  const rate = values.has("rate_hz") ? `${values.get("rate_hz").toFixed(1)} images/s` : "";
  const elsewhere = host !== "" && !services.some((other) => other !== detector && summarize(other).host === host);
  return [elsewhere ? `on ${host}` : "on the robot's host", detector.message, latency, rate].filter(Boolean).join(" · ");
}

/** Messages that a link has passed, from its metrics "out:TOPIC" and "in:TOPIC": [{direction, topic, messages}]. */
export function linkTopics(services) {
  return services.filter((service) => service.name.startsWith("link")).flatMap((link) =>
    Object.entries(link.metrics ?? {}).flatMap(([name, messages]) => {
      const [, direction, topic] = /^(out|in):(.+)$/.exec(name) ?? [];
      return direction ? [{ direction, topic, messages }] : [];
    }));
}
