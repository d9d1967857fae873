// The text of protocol/idl/scanner.idl.
#pragma once

#include <string_view>

namespace enamel::proto {

[[nodiscard]] std::string_view idl_text() noexcept;

}  // namespace enamel::proto
