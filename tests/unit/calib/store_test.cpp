// The store of calibrations: what becomes current, what is refused, and that nothing is left half-done.
#include <gmock/gmock.h>

#include <filesystem>

#include "calib/io/rig_details.hpp"
#include "calib/io/rig_store.hpp"
#include "protocol/base/file.hpp"
#include "tests/support/rig_files.hpp"
#include "tests/support/run.hpp"

namespace enamel::calib {
namespace {

const std::string kJanuary = "2026-01-31T12:00:00Z", kMarch = "2026-03-01T08:30:00Z";

class Store : public testing::Test {
 protected:
  std::string text(const std::string& serial, const std::string& when) const {
    return test::solved_text(scene_, serial, when);
  }
  StoredRig current(const std::string& serial) const {
    const std::vector<StoredRig> stored = store_.list(serial).value();
    for (const StoredRig& s : stored)
      if (s.is_current) return s;
    return {};
  }

  test::CalibScene scene_ = test::make_calib_scene(1, 1);
  test::TempFolder folder_;
  RigStore store_{folder_ / "store"};
};

TEST_F(Store, keeps_versions_and_goes_back_and_forth) {
  const StoredRig first = store_.install(text("EN-7", kJanuary)).value();
  const StoredRig second = store_.install(text("EN-7", kMarch)).value();
  EXPECT_EQ(current("EN-7").id, second.id);
  EXPECT_EQ(store_.list("EN-7").value().size(), 2U);
  EXPECT_EQ(store_.revert("EN-7").value().id, first.id);
  EXPECT_EQ(current("EN-7").id, first.id);
  EXPECT_EQ(store_.revert("EN-7", second.id).value().id, second.id);
  EXPECT_EQ(current("EN-7").id, second.id);
  EXPECT_EQ(read_file(first.path).value(), text("EN-7", kJanuary)) << "byte for byte";
}

TEST_F(Store, the_same_file_twice_is_one_version) {
  ASSERT_TRUE(store_.install(text("EN-7", kJanuary)));
  ASSERT_TRUE(store_.install(text("EN-7", kJanuary)));
  EXPECT_EQ(store_.list("EN-7").value().size(), 1U);
}

TEST_F(Store, nothing_older_and_unknown_ids_are_named) {
  ASSERT_TRUE(store_.install(text("EN-7", kJanuary)));
  EXPECT_THAT(store_.revert("EN-7").error().detail, testing::HasSubstr("is the oldest"));
  EXPECT_THAT(store_.revert("EN-7", "x").error().detail, testing::HasSubstr("calibrate list"));
  EXPECT_THAT(store_.revert("EN-8").error().detail, testing::HasSubstr("no calibration of probe 'EN-8'"));
  EXPECT_EQ(store_.revert("../EN-7").error().code, ErrorCode::kFileNotFound);
}

TEST_F(Store, a_file_of_another_probe_does_not_become_current) {
  const StoredRig own = store_.install(text("EN-7", kMarch)).value();
  ASSERT_TRUE(write_file(folder_ / "store/EN-7/20250101-foreign.json", text("EN-8", kJanuary)));
  const auto reverted = store_.revert("EN-7", "20250101-foreign");
  ASSERT_FALSE(reverted);
  EXPECT_EQ(reverted.error().code, ErrorCode::kRigForeign);
  EXPECT_EQ(current("EN-7").id, own.id);
}

TEST_F(Store, a_changed_version_does_not_become_current) {
  const StoredRig first = store_.install(text("EN-7", kJanuary)).value();
  const StoredRig second = store_.install(text("EN-7", kMarch)).value();
  std::string changed = read_file(first.path).value();
  changed.replace(changed.find("\"width\": 640"), 12, "\"width\": 641");
  ASSERT_TRUE(write_file(first.path, changed));
  EXPECT_THAT(store_.revert("EN-7").error().detail, testing::HasSubstr("changed after solving"));
  EXPECT_EQ(current("EN-7").id, second.id);
}

TEST_F(Store, design_values_and_nameless_probes_are_not_installed) {
  const std::string nominal = R"({"format": "rig/1"})";
  EXPECT_EQ(store_.install(nominal).error().code, ErrorCode::kRigInvalid);
  for (const char* serial : {"", "..", "a/b", "-x"}) {
    const auto installed = store_.install(text(serial, kJanuary));
    ASSERT_FALSE(installed) << serial;
    EXPECT_THAT(installed.error().detail, testing::HasSubstr("names no probe"));
  }
  EXPECT_TRUE(store_.serials().empty());
}

TEST_F(Store, details_of_a_solved_rig_read_back) {
  Rig rig = parse_rig(text("EN-7", kMarch)).value();
  const RigDetails d = read_rig_details(rig);
  EXPECT_EQ(d.seal, RigSeal::kIntact);
  EXPECT_FALSE(d.is_nominal);
  EXPECT_EQ(d.calibrated_at, kMarch);
  ASSERT_EQ(d.parameter_names.size(), 22U);
  EXPECT_EQ(d.covariance(3, 3), 1e-10);
  ASSERT_TRUE(d.residuals);
  EXPECT_EQ(d.residuals->poses, 10);
  rig.text.replace(rig.text.find(kMarch), kMarch.size(), kJanuary);
  EXPECT_EQ(read_rig_details(rig).seal, RigSeal::kBroken);
}

TEST(RigDetails, ill_formed_parts_stay_empty) {
  Rig rig;
  for (const char* text : {"[]", "{", R"({"covariance": 3, "residuals": [], "sha256": 7, "calibrated_at": 1})",
                           R"({"covariance": {"parameters": ["a"], "matrix": [[1, 2]]}})"}) {
    rig.text = text;
    const RigDetails d = read_rig_details(rig);
    EXPECT_EQ(d.covariance.size(), 0) << text;
    EXPECT_FALSE(d.residuals);
    EXPECT_NE(d.seal, RigSeal::kIntact);
  }
}

}  // namespace
}  // namespace enamel::calib
