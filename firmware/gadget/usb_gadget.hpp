// The gadget around the function: identity and connection, through configfs (Linux' gadget_configfs).
#pragma once

#include <string>

#include "firmware/update/usb_identity.hpp"
#include "protocol/base/result.hpp"

namespace enamel::fw {

/// `folder`: the gadget's folder in configfs, made and given its function by whoever started the program. Writes
/// identity and serial, then connects to the first USB device controller of `controllers`. kFileNotFound, kGadget.
[[nodiscard]] Result<void> connect_gadget(const std::string& folder, const UsbIdentity& identity,
                                          const std::string& serial, const std::string& controllers = "/sys/class/udc");
/// The host sees the probe go.
void disconnect_gadget(const std::string& folder) noexcept;

}  // namespace enamel::fw
