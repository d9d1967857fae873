// Writes a recording again with the official writer in the forms that the specification allows, messages of another
// program's channel among ours, and one form in which a message is missing (the control).
// usage: node write_variants.js NODE_MODULES_PARENT capture.mcap OUT_FOLDER; prints the names of the files
"use strict";
const fs = require("fs");
const path = require("path");
const { createRequire } = require("module");

const [home, capturePath, out] = process.argv.slice(2);
const load = createRequire(path.join(path.resolve(home), "package.json"));
const { McapStreamReader, McapWriter, TempBuffer } = load("@mcap/core");
const fzstd = load("fzstd");

// An LZ4 frame of one stored block: magic, descriptor (blocks of 4 MB, no sums) with its check byte, block, end mark.
function lz4Stored(data) {
  if (data.length > 4 << 20) throw new Error("one block holds 4 MB");
  const frame = Buffer.alloc(7 + 4 + data.length + 4);
  Buffer.from("04224d18607073", "hex").copy(frame);
  frame.writeUInt32LE((data.length | 0x80000000) >>> 0, 7);
  Buffer.from(data).copy(frame, 11);
  return frame;
}

function records(bytes) {
  const decompressHandlers = { zstd: (data, size) => fzstd.decompress(data, new Uint8Array(Number(size))) };
  const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers });
  reader.append(bytes);
  const all = [];
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "DataEnd") break;
    all.push(record);
  }
  return all;
}

async function write(all, name, options, { foreign = false, drop = -1 } = {}) {
  const writable = new TempBuffer();
  const writer = new McapWriter({ writable, ...options });
  const ids = { schema: new Map(), channel: new Map() };
  let stranger;
  let messages = 0;
  for (const record of all) {
    if (record.type === "Header") await writer.start({ profile: record.profile, library: "another program" });
    if (record.type === "Schema" && !ids.schema.has(record.id)) {
      if (foreign && stranger === undefined) {
        const schemaId = await writer.registerSchema({ name: "Note", encoding: "jsonschema", data: Buffer.from("{}") });
        const channel = { topic: "/notes", schemaId, messageEncoding: "json", metadata: new Map([["by", "another"]]) };
        stranger = await writer.registerChannel(channel);
      }
      ids.schema.set(record.id, await writer.registerSchema(record));
    }
    if (record.type === "Channel" && !ids.channel.has(record.id)) {
      ids.channel.set(record.id, await writer.registerChannel({ ...record, schemaId: ids.schema.get(record.schemaId) }));
    }
    if (record.type === "Message") {
      if (messages++ === drop) continue;
      await writer.addMessage({ ...record, channelId: ids.channel.get(record.channelId) });
      if (stranger !== undefined) await writer.addMessage({ ...record, channelId: stranger, data: Buffer.from("{}") });
    }
    if (record.type === "Attachment") await writer.addAttachment(record);
    if (record.type === "Metadata") await writer.addMetadata(record);
  }
  await writer.end();
  const file = path.join(out, `${name}.mcap`);
  fs.writeFileSync(file, writable.get());
  console.log(file);
}

async function main() {
  const all = records(fs.readFileSync(capturePath));
  const none = { useStatistics: false, useSummaryOffsets: false, repeatSchemas: false, repeatChannels: false };
  const bare = { ...none, useAttachmentIndex: false, useMetadataIndex: false, useMessageIndex: false, useChunkIndex: false };
  const lz4 = { compressChunk: (data) => ({ compression: "lz4", compressedData: lz4Stored(data) }) };
  await write(all, "as-it-comes", {});
  await write(all, "no-chunks", { useChunks: false });
  await write(all, "no-chunks-no-summary", { ...bare, useChunks: false });
  await write(all, "one-message-a-chunk", { chunkSize: 1 });
  await write(all, "one-chunk", { chunkSize: 1 << 28 });
  await write(all, "no-statistics", { useStatistics: false });
  await write(all, "no-summary-offsets", { useSummaryOffsets: false });
  await write(all, "no-repeated-schemas", { repeatSchemas: false, repeatChannels: false });
  await write(all, "no-chunk-index", { useChunkIndex: false });
  await write(all, "no-message-index", { useMessageIndex: false });
  await write(all, "no-attachment-index", { useAttachmentIndex: false, useMetadataIndex: false });
  await write(all, "no-summary", bare);
  await write(all, "lz4", lz4);
  await write(all, "other-channels", {}, { foreign: true });
  await write(all, "other-channels-no-chunks", { useChunks: false }, { foreign: true });
  await write(all, "other-ids", { startChannelId: 700 });
  await write(all, "control", {}, { drop: 4 });
}

main().catch((error) => {
  console.error(error.stack);
  process.exit(1);
});
