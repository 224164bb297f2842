// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Prints the poses of the camera in a recording (rtd record, rtd run --record): node pose_recording.mjs FILE.mcap
// npm install @mcap/core @mcap/support @foxglove/rosmsg @foxglove/rosmsg2-serialization
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapStreamReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";
import { readFile } from "node:fs/promises";

const reader = new McapStreamReader({ decompressHandlers: await loadDecompressHandlers() });
reader.append(await readFile(process.argv[2]));
const schemas = new Map();
const decoders = new Map();  // by channel, for channels of the pose topic
for (let record = reader.nextRecord(); record !== undefined; record = reader.nextRecord()) {
  if (record.type === "Schema") schemas.set(record.id, new TextDecoder().decode(record.data));
  if (record.type === "Channel" && record.topic === "/slam/pose") {
    decoders.set(record.id, new MessageReader(parse(schemas.get(record.schemaId), { ros2: true })));
  }
  if (record.type !== "Message" || !decoders.has(record.channelId)) continue;
  const { header, pose: { position: at } } = decoders.get(record.channelId).readMessage(record.data);
  const nanoseconds = String(header.stamp.nanosec).padStart(9, "0");
  console.log(`${header.stamp.sec}.${nanoseconds} ${header.frame_id}`, ...[at.x, at.y, at.z].map((m) => m.toFixed(3)));
}
