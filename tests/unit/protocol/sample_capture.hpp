// A small recording that holds every kind of record, and a reader that collects all of one.
#pragma once

#include <gtest/gtest.h>

#include "protocol/capture/capture.hpp"
#include "tests/unit/protocol/random_messages.hpp"

namespace enamel::test {

inline constexpr const char* kRigText = "{\"format\": \"rig/1\", \"note\": \"\xC3\xA9 kept\"}\n";

inline capture::CaptureHeader sample_header() {
  return {.rig_text = kRigText, .program = "sample 1.0", .metadata = {{"seed", "7"}, {"session", "3"}}};
}

/// Writes `bursts` bursts of 16 x 12 pixels with notes between them; returns the records in order.
inline std::vector<capture::Record> write_sample(capture::CaptureWriter& out, int bursts) {
  std::vector<capture::Record> records;
  Random random(11);
  const auto log = [&](auto value, auto write) {
    const auto t = 5'000'000'000 + static_cast<std::int64_t>(records.size()) * 1'000'003;
    EXPECT_TRUE(write(value, t));
    records.push_back({t, std::move(value)});
  };
  proto::DeviceInfo info;
  randomize(random, info);
  log(info, [&](const auto& v, std::int64_t t) { return out.write_device_info(v, t); });
  for (int i = 0; i < bursts; ++i) {
    proto::Status status;
    randomize(random, status);
    log(status, [&](const auto& v, std::int64_t t) { return out.write_status(v, t); });
    log(camera_burst(10 + 2 * static_cast<std::uint64_t>(i), 16, 12),
        [&](const auto& v, std::int64_t t) { return out.write_burst(v, t); });
    proto::ShedNote note;
    randomize(random, note);
    note.burst_index = 11 + 2 * static_cast<std::uint64_t>(i);
    log(note, [&](const auto& v, std::int64_t t) { return out.write_shed(v, t); });
    proto::Event event;
    randomize(random, event);
    log(event, [&](const auto& v, std::int64_t t) { return out.write_event(v, t); });
  }
  return records;
}

struct Collected {
  std::vector<capture::Record> records;
  std::vector<Error> errors;
};

inline Collected collect(capture::CaptureReader& in) {
  Collected all;
  for (int guard = 0; guard < 10000; ++guard) {
    auto record = in.next();
    if (!record) {
      all.errors.push_back(record.error());
    } else if (*record) {
      all.records.push_back(std::move(**record));
    } else {
      return all;
    }
  }
  ADD_FAILURE() << "the reader does not end";
  return all;
}

}  // namespace enamel::test
