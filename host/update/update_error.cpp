#include "host/update/update_error.hpp"

namespace enamel::update {

UpdateError refused_by_probe(std::uint32_t number) {
  const image::RefusalText text = image::describe_refusal(number);
  if (text.what.empty()) {
    return {Exit::kTransfer, "the probe refused with number " + std::to_string(number),
            "its firmware is newer than this tool", "update this tool", number};
  }
  return {static_cast<Exit>(image::exit_code(static_cast<image::Refusal>(number))), std::string(text.what),
          std::string(text.cause), std::string(text.remedy), number};
}

UpdateError no_device(const std::string& wanted) {
  return {Exit::kNoDevice, wanted.empty() ? "no probe found" : "no probe " + wanted,
          "not connected, switched off, a charging-only cable, or a hub without power",
          "connect it by its own cable and wait for its light, then run `enamel-flash list`"};
}

UpdateError no_permission(const std::string& port) {
  return {
      Exit::kPermission, "no permission to open the probe at port " + port, "the system gives USB devices to root only",
      "write this line into /etc/udev/rules.d/70-enamel.rules, then run `udevadm control --reload` and plug it in "
      "again:\n"
      "  SUBSYSTEM==\"usb\", ATTR{idVendor}==\"1209\", ATTR{idProduct}==\"000[12]\", TAG+=\"uaccess\", MODE=\"0660\""};
}

UpdateError transfer_failed(const std::string& where, const std::string& fault) {
  return {Exit::kTransfer, "transfer broke off while " + where + ": " + fault,
          "cable, hub or power; or the probe was unplugged",
          "connect the probe by its own cable and run the same command again: what arrived is kept, and the old "
          "firmware boots"};
}

UpdateError cancelled() {
  return {Exit::kCancelled, "cancelled", "interrupted at the keyboard",
          "the old firmware stays in place; run the same command again to go on where it stopped"};
}

}  // namespace enamel::update
