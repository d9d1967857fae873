#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "host/record/burst_stream.hpp"
#include "host/record/capture_tools.hpp"
#include "host/record/exchange_folder.hpp"
#include "tests/unit/protocol/sample_folder.hpp"

namespace enamel::host {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

class Exchange : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override { test::make_folder_sample(in_, GetParam()); }
  TempFolder folder_;
  std::string in_ = folder_ / "in";
  std::string capture_ = folder_ / "c.mcap";
  std::string out_ = folder_ / "out";
};
INSTANTIATE_TEST_SUITE_P(Bits, Exchange, ::testing::Values(8, 10, 16));

std::vector<std::string> files_of(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(entry.path().lexically_relative(folder).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

TEST_P(Exchange, every_pixel_and_time_is_read) {
  const auto reader = ExchangeReader::open(in_);
  ASSERT_TRUE(reader) << reader.error().message();
  ASSERT_EQ(reader->rows().size(), 3U);
  const auto burst = reader->burst(1);
  ASSERT_TRUE(burst) << burst.error().message();
  EXPECT_TRUE(proto::is_consistent(*burst));
  EXPECT_EQ(burst->burst_index, 3U);
  EXPECT_EQ(burst->burst_seq, 1U);
  EXPECT_EQ(burst->bit_depth, GetParam());
  EXPECT_EQ(burst->temp_centi_c, 3213);
  EXPECT_EQ(burst->meta[2].t_strobe_ns, 1041341333U);
  EXPECT_EQ(burst->meta[2].exposure_us, 3700U);
  for (int k = 0; k < 4; ++k) {
    const auto frame = proto::frame_bytes(*burst, k);
    const auto expected = test::frame_pixels(3, k, GetParam());
    EXPECT_TRUE(std::equal(frame.begin(), frame.end(), expected.begin(), expected.end()));
  }
}

TEST_P(Exchange, import_and_export_lose_nothing) {
  const auto imported = import_folder(in_, capture_, "test 1");
  ASSERT_TRUE(imported) << imported.error().message();
  EXPECT_EQ(imported->bursts, 3U);
  const auto exported = export_folder(capture_, out_);
  ASSERT_TRUE(exported) << exported.error().message();
  EXPECT_EQ(exported->bursts, 3U);
  EXPECT_EQ(exported->attachments, imported->attachments);
  ASSERT_EQ(files_of(out_), files_of(in_));
  for (const std::string& name : files_of(in_)) {
    if (name.ends_with(".png")) {
      const auto before = read_grey_png(in_ + "/" + name), after = read_grey_png(out_ + "/" + name);
      ASSERT_TRUE(before && after);
      EXPECT_EQ(before->pixels, after->pixels) << name;
      EXPECT_EQ(before->bits, after->bits) << name;
    } else {
      EXPECT_EQ(test::slurp(in_ + "/" + name), test::slurp(out_ + "/" + name)) << name;
    }
  }
  EXPECT_FALSE(fs::exists(capture_ + ".partial"));
}

TEST_P(Exchange, angles_of_the_axes_come_along_and_have_to_be_of_its_bursts) {
  const std::string head = "burst_id,rot_cmd_deg,swing_cmd_deg,rot_read_deg,swing_read_deg\n";
  test::spill(in_ + "/axes.csv", head + "3,15,-20,14.998,nan\n");
  ASSERT_TRUE(import_folder(in_, capture_, "test 1"));
  ASSERT_TRUE(export_folder(capture_, out_));
  EXPECT_EQ(test::slurp(out_ + "/axes.csv"), test::slurp(in_ + "/axes.csv"));

  const std::string refused = folder_ / "refused.mcap";
  for (const std::string& rows :
       {std::string("77,15,-20,,\n"), std::string("3,15,,,\n"), std::string("3,fifteen,0,,\n")}) {
    test::spill(in_ + "/axes.csv", head + rows);
    const auto done = import_folder(in_, refused, "test 1");
    ASSERT_FALSE(done) << rows;
    EXPECT_EQ(done.error().code, ErrorCode::kExchangeInvalid);
    EXPECT_NE(done.error().detail.find("axes.csv"), std::string::npos) << done.error().detail;
    EXPECT_FALSE(fs::exists(refused));
  }
}

TEST_P(Exchange, folder_and_recording_are_the_same_stream) {
  ASSERT_TRUE(import_folder(in_, capture_, "test 1"));
  const auto difference = capture_diff(in_, capture_, true);
  ASSERT_TRUE(difference) << difference.error().message();
  EXPECT_FALSE(difference->has_value());
  const auto folder = open_bursts(in_), file = open_bursts(capture_);
  EXPECT_EQ((*folder)->info().bursts, (*file)->info().bursts);
  EXPECT_EQ((*folder)->info().duration_ns(), (*file)->info().duration_ns());
  EXPECT_EQ((*folder)->rig_text(), (*file)->rig_text());
  EXPECT_EQ((*folder)->burst_with_id({4}).value(), (*file)->burst_with_id({4}).value());
  EXPECT_EQ((*folder)->burst_with_id({2}).error().code, ErrorCode::kBurstNotFound);
  EXPECT_EQ((*folder)->attachment("truth/poses.csv").value(), (*file)->attachment("truth/poses.csv").value());
  EXPECT_EQ((*folder)->attachment("../c.mcap").error().code, ErrorCode::kFileNotFound);
  EXPECT_TRUE(capture_verify(in_)->clean());
  EXPECT_TRUE(capture_verify(capture_)->clean());
}

TEST_P(Exchange, export_does_not_overwrite_bursts) {
  ASSERT_TRUE(import_folder(in_, capture_, "test 1"));
  EXPECT_EQ(export_folder(capture_, in_).error().code, ErrorCode::kFileWrite);
}

// Bad folders: what is done to a good one, and which code and words the answer has.
struct Fault {
  const char* name;
  void (*make)(const std::string& folder);
  ErrorCode code;
  const char* says;
};

void table(const std::string& folder, std::size_t line, const std::string& text) {
  const std::vector<std::string> good{"burst_id,t0_ns,t1_ns,t2_ns,t3_ns,exposure_us,temp_c", "0,1,2,3,4,3700,32.0",
                                      "3,11,12,13,14,3700,32.0", "4,21,22,23,24,3700,32.0"};
  std::string all;
  for (std::size_t i = 0; i < good.size(); ++i) all += (i == line ? text : good[i]) + "\n";
  test::spill(folder + "/bursts.csv", all);
}

void frame(const std::string& folder, const cv::Mat& image) { cv::imwrite(folder + test::frame_name(3, 2), image); }

const Fault kFaults[] = {
    {"NoRig", [](const std::string& f) { fs::remove(f + "/rig.json"); }, ErrorCode::kExchangeInvalid, "rig.json"},
    {"NanInRig", [](const std::string& f) { test::spill(f + "/rig.json", std::string("{\"a\": NaN}")); },
     ErrorCode::kRigInvalid, "rig.json"},
    {"NoTable", [](const std::string& f) { fs::remove(f + "/bursts.csv"); }, ErrorCode::kExchangeInvalid, "bursts.csv"},
    {"EmptyTable", [](const std::string& f) { test::spill(f + "/bursts.csv", std::string()); },
     ErrorCode::kExchangeInvalid, "bursts.csv:1"},
    {"OnlyHeader", [](const std::string& f) { test::spill(f + "/bursts.csv", test::kFolderTable.substr(0, 53)); },
     ErrorCode::kEmptyInput, "bursts.csv"},
    {"WrongHeader", [](const std::string& f) { table(f, 0, "id,t0"); }, ErrorCode::kExchangeInvalid, "bursts.csv:1"},
    {"MissingField", [](const std::string& f) { table(f, 2, "3,11,12,13,14,3700"); }, ErrorCode::kExchangeInvalid,
     "bursts.csv:3: 6 fields"},
    {"BlankLine", [](const std::string& f) { table(f, 2, ""); }, ErrorCode::kExchangeInvalid, "bursts.csv:3"},
    {"NotANumber", [](const std::string& f) { table(f, 3, "4,21,x,23,24,3700,32"); }, ErrorCode::kExchangeInvalid,
     "bursts.csv:4: t1_ns"},
    {"NanTemperature", [](const std::string& f) { table(f, 1, "0,1,2,3,4,3700,nan"); }, ErrorCode::kExchangeInvalid,
     "bursts.csv:2: temp_c"},
    {"InfiniteExposure", [](const std::string& f) { table(f, 1, "0,1,2,3,4,inf,32"); }, ErrorCode::kExchangeInvalid,
     "bursts.csv:2: exposure_us"},
    {"NegativeTime", [](const std::string& f) { table(f, 1, "0,-1,2,3,4,3700,32"); }, ErrorCode::kExchangeInvalid,
     "bursts.csv:2: t0_ns"},
    {"TimeGoesBack", [](const std::string& f) { table(f, 2, "3,11,13,12,14,3700,32"); }, ErrorCode::kExchangeInvalid,
     "bursts.csv:3: t2_ns"},
    {"IdTwice", [](const std::string& f) { table(f, 2, "0,11,12,13,14,3700,32"); }, ErrorCode::kExchangeInvalid,
     "bursts.csv:3: burst_id"},
    {"HugeNumber", [](const std::string& f) { table(f, 2, "99999999999999999999,11,12,13,14,3700,32"); },
     ErrorCode::kExchangeInvalid, "bursts.csv:3: burst_id"},
    {"MissingFrame", [](const std::string& f) { fs::remove(f + test::frame_name(3, 2)); }, ErrorCode::kExchangeInvalid,
     "bursts.csv:3: frame frames/000003_2.png"},
    {"EmptyFrame", [](const std::string& f) { test::spill(f + test::frame_name(3, 2), std::string()); },
     ErrorCode::kImageInvalid, "000003_2.png"},
    {"ForeignFrame", [](const std::string& f) { test::spill(f + test::frame_name(3, 2), std::string(400, 'x')); },
     ErrorCode::kImageInvalid, "000003_2.png"},
    {"OtherSize", [](const std::string& f) { frame(f, cv::Mat(14, 21, CV_8UC1, cv::Scalar(9))); },
     ErrorCode::kImageInvalid, "21 x 14"},
    {"OtherDepth", [](const std::string& f) { frame(f, cv::Mat(14, 20, CV_16UC1, cv::Scalar(9))); },
     ErrorCode::kImageInvalid, "16 bit"},
    {"Colour", [](const std::string& f) { frame(f, cv::Mat(14, 20, CV_8UC3, cv::Scalar(9, 8, 7))); },
     ErrorCode::kImageInvalid, "3 channels"},
    {"SizeUnlikeRig",
     [](const std::string& f) {
       test::spill(f + "/rig.json", std::string("{\"camera\": {\"width\": 640, \"height\": 480}}"));
     },
     ErrorCode::kImageInvalid, "640 x 480"},
};

TEST(Exchange, a_table_that_a_spreadsheet_saved_is_read) {
  const auto rows = host::parse_bursts_csv(
      "\xef\xbb\xbf"
      "burst_id;t0_ns;t1_ns;t2_ns;t3_ns;exposure_us;temp_c\r\n0;1;2;3;4;3700,0;32,5\r\n;;;;;;\r\n",
      "b.csv");
  ASSERT_TRUE(rows) << rows.error().detail;
  ASSERT_EQ(rows->size(), 1U);
  EXPECT_EQ((*rows)[0].temp_c, 32.5);
  EXPECT_EQ((*rows)[0].text, "0,1,2,3,4,3700.0,32.5");
  EXPECT_EQ((*rows)[0].line, 2);
  EXPECT_FALSE(
      host::parse_bursts_csv("burst_id;t0_ns;t1_ns;t2_ns;t3_ns;exposure_us;temp_c\n0;1,5;2;3;4;3700;32\n", "b.csv"));
}

class BadFolder : public ::testing::TestWithParam<Fault> {};
INSTANTIATE_TEST_SUITE_P(Faults, BadFolder, ::testing::ValuesIn(kFaults),
                         [](const auto& p) { return std::string(p.param.name); });

TEST_P(BadFolder, is_refused_with_file_and_line_and_leaves_no_recording) {
  const TempFolder folder;
  test::make_folder_sample(folder / "in", 8);
  GetParam().make(folder / "in");
  const auto result = import_folder(folder / "in", folder / "c.mcap", "test");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, GetParam().code) << result.error().message();
  EXPECT_NE(result.error().detail.find(GetParam().says), std::string::npos) << result.error().detail;
  EXPECT_FALSE(fs::exists(folder / "c.mcap"));
  EXPECT_FALSE(fs::exists(folder / "c.mcap.partial"));
}

TEST(BadPng, every_truncation_is_an_error_and_flips_never_crash) {
  const TempFolder folder;
  const std::string path = folder / "a.png";
  ASSERT_TRUE(write_grey_png(path, 20, 14, 8, test::frame_pixels(1, 0, 8)));
  const auto bytes = test::slurp(path);
  for (std::size_t n = 0; n < bytes.size() - 12; n += 5) {
    test::spill(path, std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)));
    EXPECT_FALSE(read_grey_png(path)) << n;
  }
  test::Random random(2);
  for (int i = 0; i < 200; ++i) {
    auto damaged = bytes;
    damaged[random.below(damaged.size())] ^= static_cast<std::uint8_t>(1U << random.below(8));
    test::spill(path, damaged);
    const auto image = read_grey_png(path);
    if (image) {
      EXPECT_EQ(image->pixels, test::frame_pixels(1, 0, 8));
    }
  }
}

TEST(BadPng, of_fewer_than_eight_bits_is_refused) {
  const TempFolder folder;
  const std::string path = folder / "a.png";
  const cv::Mat stripes = cv::Mat_<std::uint8_t>(8, 8, 255);
  ASSERT_TRUE(cv::imwrite(path, stripes, {cv::IMWRITE_PNG_BILEVEL, 1}));
  const auto image = read_grey_png(path);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, ErrorCode::kImageInvalid);
  EXPECT_NE(image.error().detail.find("1 bit, neither 8 nor 16"), std::string::npos) << image.error().detail;
  ASSERT_TRUE(cv::imwrite(path, stripes));  // the control
  EXPECT_TRUE(read_grey_png(path));
}

TEST(ExchangePaths, attachments_cannot_leave_the_folder) {
  const TempFolder folder;
  auto out = ExchangeWriter::create(folder / "x", "{}");
  ASSERT_TRUE(out);
  for (const char* name : {"../evil", "/tmp/evil", "a/../../evil", "", "."}) {
    EXPECT_EQ(out->write_file(name, {}).error().code, ErrorCode::kExchangeInvalid) << name;
  }
  EXPECT_TRUE(out->write_file("truth/a/b.txt", {}));
}

TEST(ExchangeRows, are_written_as_they_are_read) {
  proto::Burst b = test::camera_burst(7, 4, 4);
  for (const int centi : {0, 5, -5, 3213, -50, -1234}) {
    b.temp_centi_c = static_cast<std::int16_t>(centi);
    const auto rows = parse_bursts_csv("burst_id,t0_ns,t1_ns,t2_ns,t3_ns,exposure_us,temp_c\n" + row_text(b), "x");
    ASSERT_TRUE(rows) << rows.error().message();
    EXPECT_NEAR(rows->front().temp_c, centi / 100.0, 1e-9);
    EXPECT_EQ(rows->front().burst_id, 7U);
  }
}

}  // namespace
}  // namespace enamel::host
