#include "protocol/base/config_toml.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <set>

namespace enamel::config_detail {
namespace {

bool is_number(const toml::node& n) { return n.is_integer() || n.is_floating_point(); }

double as_double(const toml::node& n) {
  if (const auto* i = n.as_integer()) return static_cast<double>(i->get());
  return n.as_floating_point()->get();
}

Value array_value(const toml::array& a) {
  if (a.empty()) return std::vector<double>{};
  if (std::all_of(a.begin(), a.end(), [](const toml::node& n) { return is_number(n); })) {
    std::vector<double> out;
    for (const toml::node& n : a) out.push_back(as_double(n));
    return out;
  }
  if (std::all_of(a.begin(), a.end(), [](const toml::node& n) { return n.is_string(); })) {
    std::vector<std::string> out;
    for (const toml::node& n : a) out.push_back(n.as_string()->get());
    return out;
  }
  return Unsupported{"array of other things than numbers or strings"};
}

Value scalar_value(const toml::node& n) {
  if (const auto* b = n.as_boolean()) return b->get();
  if (const auto* i = n.as_integer()) return i->get();
  if (const auto* f = n.as_floating_point()) return f->get();
  if (const auto* s = n.as_string()) return s->get();
  if (const auto* a = n.as_array()) return array_value(*a);
  return Unsupported{"date or time"};
}

struct Flattener {
  std::string_view name;
  std::vector<Node> nodes;

  void add(const toml::node& n, std::string path, bool is_table) {
    const std::size_t line = n.source().begin.line;
    nodes.push_back({std::move(path), std::string(name) + ":" + std::to_string(line), is_table,
                     is_table ? Value{} : scalar_value(n)});
  }

  void walk(const toml::table& t, const std::string& prefix) {
    for (const auto& [key, node] : t) {
      const std::string path = prefix + std::string(key.str());
      if (const toml::table* sub = node.as_table()) {
        add(node, path, true);
        walk(*sub, path + ".");
      } else if (const toml::array* a = node.as_array();
                 a != nullptr && !a->empty() && a->is_homogeneous<toml::table>()) {
        for (std::size_t i = 0; i < a->size(); ++i) {
          const std::string element = path + "[" + std::to_string(i) + "]";
          add(*a->get(i), element, true);
          walk(*a->get(i)->as_table(), element + ".");
        }
      } else {
        add(node, path, false);
      }
    }
  }
};

template <class T>
std::string shortest(T v) {
  std::array<char, 48> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), v).ptr;
  std::string s(buffer.data(), end);
  if (s.find_first_of(".en") == std::string::npos) s += ".0";
  return s;
}

}  // namespace

Result<std::vector<Node>> flatten_toml(std::string_view text, std::string_view name) {
  Flattener f{name, {}};
  try {
    f.walk(toml::parse(text), "");
  } catch (const toml::parse_error& e) {
    return fail(ErrorCode::kConfigSyntax,
                std::string(name) + ":" + std::to_string(e.source().begin.line) + ": " + std::string(e.description()));
  }
  std::set<std::string_view> seen;
  for (const Node& n : f.nodes) {
    if (!seen.insert(n.path).second) {
      return fail(ErrorCode::kConfigSyntax, n.where + ": '" + n.path + "' is given twice in different spellings");
    }
  }
  return std::move(f.nodes);
}

std::string float_text(double v) { return shortest(v); }
std::string float_text(float v) { return shortest(v); }

std::string string_text(std::string_view s) {
  static constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string out = "\"";
  for (const char c : s) {
    const auto u = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (u < 0x20 || u == 0x7F) {
      out += "\\u00";
      out += kHex[u >> 4U];
      out += kHex[u & 0xFU];
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string_view type_name(const Value& v) {
  static constexpr std::array<std::string_view, 6> kNames = {"boolean", "integer",          "float",
                                                             "string",  "array of numbers", "array of strings"};
  if (const auto* u = std::get_if<Unsupported>(&v)) return u->what;
  return kNames.at(v.index());
}

}  // namespace enamel::config_detail
