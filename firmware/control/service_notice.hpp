// What a service manager is told: started, alive, stopping. sd_notify's protocol, which is one datagram of text.
#pragma once

#include <string>
#include <string_view>

namespace enamel::fw {

/// Without $NOTIFY_SOCKET nobody is told anything.
class ServiceNotice {
 public:
  ServiceNotice();
  ~ServiceNotice();
  ServiceNotice(const ServiceNotice&) = delete;
  ServiceNotice& operator=(const ServiceNotice&) = delete;
  /// "READY=1", "WATCHDOG=1", "STOPPING=1".
  void tell(std::string_view state) noexcept;

 private:
  int fd_ = -1;
  std::string address_;
};

}  // namespace enamel::fw
