// The certificate of a known artefact: what is read, and what is refused before a scan begins.
#include "host/session/artefact_file.hpp"

#include <gtest/gtest.h>

namespace enamel::host {
namespace {

constexpr const char* kGood =
    R"({"spheres": [{"d_mm": 3.0}, {"d_mm": 3.5}, {"d_mm": 3.0}],
        "distances_mm": [[0, 1, 30.0, 0.002], [1, 2, 40.0, 0.002], [2, 0, 50.0, 0.003]]})";

std::string with(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
  const auto parsed = parse_artefact(text);
  if (parsed) return "accepted";
  EXPECT_EQ(parsed.error().code, ErrorCode::kArtefactFile);
  EXPECT_EQ(exit_code(parsed.error().code), 2);
  return parsed.error().detail;
}

TEST(ArtefactFile, is_read_as_it_stands) {
  const auto artefact = parse_artefact(kGood);
  ASSERT_TRUE(artefact) << artefact.error().message();
  EXPECT_EQ(artefact->diameters_mm, (std::vector<double>{3.0, 3.5, 3.0}));
  ASSERT_EQ(artefact->distances.size(), 3U);
  EXPECT_EQ(artefact->distances[2].i, 2U);
  EXPECT_EQ(artefact->distances[2].mm, 50.0);
  EXPECT_EQ(artefact->distances[2].sigma_mm, 0.003);
}

TEST(ArtefactFile, what_cannot_be_used_is_refused_by_name) {
  const auto expect = [](const std::string& text, const std::string& word) {
    EXPECT_NE(refusal(text).find(word), std::string::npos) << word << ": " << refusal(text);
  };
  expect("{", "");
  expect("[]", "");
  expect(R"({"spheres": []})", "distances_mm");
  expect(R"({"spheres": [{"d_mm": 3}], "distances_mm": []})", "fewer than two");
  expect(R"({"spheres": [{"d_mm": 3}, {"d_mm": 3}], "distances_mm": []})", "no distances");
  expect(with("3.5", "-3.5"), "sphere 1 has no positive diameter");
  expect(with("{\"d_mm\": 3.5}", "3.5"), "sphere 1 needs 'd_mm'");
  expect(with("[1, 2,", "[1, 3,"), "distance 1 names a sphere that is not there");
  expect(with("[1, 2,", "[1, -2,"), "distance 1 must be");
  expect(with("[1, 2,", "[1, 1,"), "to itself");
  expect(with("[2, 0,", "[1, 0,"), "stated twice");
  expect(with("0.003", "0"), "not positive");
  expect(with("0.003", "0.5"), "sigma above 0.1 mm");
  expect(with("30.0", "3.1"), "touch");
  expect(with("50.0", "70.1"), "form no triangle");
  EXPECT_EQ(refusal(with("50.0", "70.0")), "accepted") << "negative control: three in a row";
}

TEST(ArtefactFile, a_file_that_is_not_there_is_told_with_its_name) {
  const auto artefact = load_artefact("/no/such/clip.json");
  ASSERT_FALSE(artefact);
  EXPECT_EQ(artefact.error().code, ErrorCode::kFileNotFound);
}

}  // namespace
}  // namespace enamel::host
