// The kernel's side of FunctionFS and configfs, as far as plain files can stand in for it; the guest lane has the rest.
#include "firmware/gadget/functionfs.hpp"

#include <gtest/gtest.h>

#include "firmware/gadget/descriptors.hpp"
#include "firmware/gadget/usb_gadget.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/sha256.hpp"
#include "tests/support/run.hpp"

namespace enamel::fw {
namespace {

using test::TempFolder;

std::string hex_of(const std::vector<std::byte>& bytes) {
  return to_hex({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(Descriptors, are_what_the_kernel_reads) {
  // magic 3, length, full + high + super speed, one descriptor each; interface FE/01/02 named by string 1.
  EXPECT_EQ(hex_of(function_descriptors({}, Functional::kWithout)),
            "03000000330000000700000001000000010000000100000009040000"
            "00fe0102010904000000fe0102010904000000fe010201");
  const std::string with = hex_of(function_descriptors({}, Functional::kWith));
  EXPECT_EQ(with.substr(0, 48), "030000004e00000007000000020000000200000002000000");
  EXPECT_EQ(with.substr(48, 36), "0904000000fe010201092107e80300101001");
  EXPECT_EQ(with.size(), 2U * 0x4E);
  EXPECT_EQ(hex_of(function_strings()).substr(0, 36), "020000002900000001000000010000000904");
}

TEST(FunctionFs, says_that_nothing_is_mounted) {
  const TempFolder folder;
  SteadyClock clock;
  const auto port = FunctionFs::open(folder / "nothing", clock);
  ASSERT_FALSE(port.has_value());
  EXPECT_EQ(port.error().code, ErrorCode::kFileNotFound);
}

TEST(FunctionFs, writes_descriptors_then_strings) {
  const TempFolder folder;
  ASSERT_TRUE(write_file(folder / "ep0", "").has_value());
  SteadyClock clock;
  const auto port = FunctionFs::open(folder.path().string(), clock);
  ASSERT_TRUE(port.has_value());
  EXPECT_TRUE((*port)->functional_descriptor());
  const auto written = function_descriptors({}, Functional::kWith), names = function_strings();
  EXPECT_EQ(read_file(folder / "ep0").value_or(""), text_of(written) + text_of(names));
  // A file has no events: its end is a function that is gone.
  const auto event = (*port)->next(std::chrono::milliseconds(10));
  ASSERT_FALSE(event.has_value());
  EXPECT_EQ(event.error().code, ErrorCode::kGadget);
}

TEST(FunctionFs, a_kernel_that_takes_no_descriptors_is_named) {
  const TempFolder folder;
  std::filesystem::create_symlink("/dev/full", folder / "ep0");
  SteadyClock clock;
  const auto port = FunctionFs::open(folder.path().string(), clock);
  ASSERT_FALSE(port.has_value());
  EXPECT_EQ(port.error().code, ErrorCode::kGadget);
}

TEST(UsbGadget, gets_its_identity_and_the_first_controller) {
  const TempFolder folder;
  const std::string gadget = folder / "gadget", controllers = folder / "udc";
  ASSERT_TRUE(make_folder(gadget + "/strings/0x409").has_value());
  for (const char* name : {"idVendor", "idProduct", "bcdDevice", "UDC", "strings/0x409/serialnumber"}) {
    ASSERT_TRUE(write_file(gadget + "/" + name, "").has_value());
  }
  const UsbIdentity identity{0x1209, 0x0002, 0x0102};
  const auto alone = connect_gadget(gadget, identity, "EN2-7", controllers);
  ASSERT_FALSE(alone.has_value());
  EXPECT_EQ(alone.error().code, ErrorCode::kGadget) << "no controller";
  ASSERT_TRUE(make_folder(controllers + "/b.1").has_value());
  ASSERT_TRUE(make_folder(controllers + "/a.0").has_value());
  ASSERT_TRUE(connect_gadget(gadget, identity, "EN2-7", controllers).has_value());
  EXPECT_EQ(read_file(gadget + "/idProduct").value_or(""), "0x0002");
  EXPECT_EQ(read_file(gadget + "/bcdDevice").value_or(""), "0x0102");
  EXPECT_EQ(read_file(gadget + "/strings/0x409/serialnumber").value_or(""), "EN2-7");
  EXPECT_EQ(read_file(gadget + "/UDC").value_or(""), "a.0");
}

}  // namespace
}  // namespace enamel::fw
