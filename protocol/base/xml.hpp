// Text inside XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace enamel {

/// With & < > " as entities: fit for content and for attribute values in double quotes. Pure.
[[nodiscard]] std::string xml_escaped(std::string_view text);

}  // namespace enamel
