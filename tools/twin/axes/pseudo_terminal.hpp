// A serial line without hardware: the simulated controller holds one end, a program opens the other by its name.
#pragma once

#include <string>

#include "protocol/base/result.hpp"

namespace enamel::twin {

/// One thread.
class PseudoTerminal {
 public:
  /// Raw from the first byte. kHal: the system has none left.
  [[nodiscard]] static Result<PseudoTerminal> open();
  PseudoTerminal(PseudoTerminal&& other) noexcept;
  PseudoTerminal& operator=(PseudoTerminal&&) = delete;
  ~PseudoTerminal() { close(); }

  [[nodiscard]] const std::string& port() const { return port_; }
  /// The controller's end; never blocks; -1 once closed. Hangs up while nobody has the port open.
  [[nodiscard]] int controller() const { return controller_; }
  void close() noexcept;

 private:
  PseudoTerminal() = default;
  int controller_ = -1;
  std::string port_;
};

/// A name of the user's choice for a port, as a symbolic link that goes with this object.
class PortName {
 public:
  /// A link that is there, of a program that was killed, is replaced; anything else is not. kFileWrite.
  [[nodiscard]] static Result<PortName> create(const std::string& name, const std::string& port);
  PortName(PortName&& other) noexcept;
  PortName& operator=(PortName&&) = delete;
  ~PortName();

 private:
  PortName(std::string name, std::string port) : name_(std::move(name)), port_(std::move(port)) {}
  std::string name_, port_;
};

}  // namespace enamel::twin
