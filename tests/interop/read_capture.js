// Reads a recording with @mcap/core and @foxglove/omgidl-serialization and compares every field of every message, every
// attachment and the metadata with a JSON file that was written from the values themselves.
// usage: node read_capture.js NODE_MODULES_PARENT capture.mcap expected.json
"use strict";
const fs = require("fs");
const path = require("path");
const { createRequire } = require("module");

const [home, capturePath, expectedPath] = process.argv.slice(2);
const load = createRequire(path.join(path.resolve(home), "package.json"));
const { McapIndexedReader, McapStreamReader } = load("@mcap/core");
const { FileHandleReadable } = load("@mcap/nodejs");
const { parseIDL } = load("@foxglove/omgidl-parser");
const { MessageReader } = load("@foxglove/omgidl-serialization");
const fzstd = load("fzstd");

const decompressHandlers = { zstd: (bytes, size) => fzstd.decompress(bytes, new Uint8Array(Number(size))) };

// 64-bit numbers as decimal text, octets as hexadecimal: what JSON can hold without loss.
function plain(value) {
  if (typeof value === "bigint" || Number.isNaN(value)) return value.toString();
  if (value instanceof Uint8Array) return Buffer.from(value).toString("hex");
  if (ArrayBuffer.isView(value) || Array.isArray(value)) return Array.from(value, plain);
  if (value !== null && typeof value === "object") {
    return Object.fromEntries(Object.entries(value).map(([k, v]) => [k, plain(v)]));
  }
  return value;
}

let compared = 0;
function compare(actual, expected, where) {
  if (expected !== null && typeof expected === "object") {
    const keys = Object.keys(expected);
    const found = actual !== null && typeof actual === "object" ? Object.keys(actual) : [];
    for (const key of new Set([...keys, ...found])) {
      if (!keys.includes(key)) throw new Error(`${where}.${key}: not expected`);
      if (!found.includes(key)) throw new Error(`${where}.${key}: missing`);
      compare(actual[key], expected[key], `${where}.${key}`);
    }
    return;
  }
  compared += 1;
  if (actual !== expected) throw new Error(`${where}: ${String(actual).slice(0, 80)} is not ${String(expected).slice(0, 80)}`);
}

async function readMessages(reader) {
  const decoders = new Map();
  const channels = {};
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    if (schema.encoding !== "omgidl" || channel.messageEncoding !== "cdr") throw new Error("unexpected encoding");
    if (!decoders.has(channel.id)) {
      decoders.set(channel.id, new MessageReader(schema.name, parseIDL(new TextDecoder().decode(schema.data))));
    }
    const value = plain(decoders.get(channel.id).readMessage(message.data));
    (channels[channel.topic] ??= []).push({ log_ns: message.logTime.toString(), value });
  }
  return channels;
}

// Reads front to back without index: every CRC, also that of the data section, is checked on the way.
function streamThrough(bytes) {
  const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers });
  reader.append(bytes);
  let messages = 0;
  for (let record; (record = reader.nextRecord()); ) messages += record.type === "Message" ? 1 : 0;
  if (!reader.done()) throw new Error("stream reader: the file does not end");
  return messages;
}

async function main() {
  const expected = JSON.parse(fs.readFileSync(expectedPath, "utf8"));
  const handle = await fs.promises.open(capturePath, "r");
  const reader = await McapIndexedReader.Initialize({ readable: new FileHandleReadable(handle), decompressHandlers });
  const actual = { messages: await readMessages(reader), attachments: [], metadata: [] };
  for await (const a of reader.readAttachments()) {
    actual.attachments.push({ name: a.name, media_type: a.mediaType, data: plain(a.data) });
  }
  for await (const m of reader.readMetadata()) actual.metadata.push({ name: m.name, values: Object.fromEntries(m.metadata) });
  actual.message_count = reader.statistics.messageCount.toString();
  await handle.close();
  compare(actual, expected, "capture");
  const streamed = streamThrough(fs.readFileSync(capturePath));
  if (String(streamed) !== expected.message_count) throw new Error(`stream reader: ${streamed} messages`);
  console.log(`${compared} values equal in ${streamed} messages`);
}

main().catch((error) => {
  console.error(error.message);
  process.exit(1);
});
