// Whether other forms of a recording hold what it holds: every record, the rig, every attachment, the metadata.
// usage: interop_same original.mcap form.mcap...; exit code 1 with the first difference
#include <cstdio>
#include <string>

#include "protocol/capture/capture.hpp"

namespace {

using namespace enamel;

std::string first_difference(capture::CaptureReader& left, capture::CaptureReader& right) {
  left.rewind();
  const capture::CaptureInfo &a = left.info(), &b = right.info();
  if (b.truncated || !b.problems.empty()) return "called damaged: " + (b.problems.empty() ? "" : b.problems.front());
  if (a.bursts != b.bursts || a.statuses != b.statuses || a.events != b.events) return "counts differ";
  if (a.metadata != b.metadata) return "metadata differ";
  if (left.rig_text() != right.rig_text()) return "rig.json differs";
  for (std::size_t n = 0;; ++n) {
    const auto x = left.next();
    const auto y = right.next();
    if (!x || !y) return "record " + std::to_string(n) + ": " + (x ? y.error() : x.error()).message();
    if (*x != *y) return "record " + std::to_string(n) + " differs";
    if (!*x) break;
  }
  if (a.attachments.size() != b.attachments.size()) return "number of attachments differs";
  for (const auto& attachment : a.attachments) {
    const auto x = left.attachment(attachment.name);
    const auto y = right.attachment(attachment.name);
    if (!x || !y || *x != *y) return "attachment " + attachment.name + " differs";
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  auto original = capture::CaptureReader::open(argv[1]);
  if (!original) return 2;
  for (int i = 2; i < argc; ++i) {
    auto form = capture::CaptureReader::open(argv[i]);
    const std::string difference = form ? first_difference(*original, *form) : form.error().message();
    if (!difference.empty()) {
      std::printf("%s: %s\n", argv[i], difference.c_str());
      return 1;
    }
  }
  std::printf("%d forms hold the same\n", argc - 2);
  return 0;
}
