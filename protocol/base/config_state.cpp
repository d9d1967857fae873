#include "protocol/base/config_state.hpp"

#include <algorithm>
#include <numeric>

namespace enamel {
namespace {

using config_detail::Node;

/// Levenshtein distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replace = diagonal + (a[i] == b[j] ? 0U : 1U);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replace, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// "a[3].b" without its indices: "a[].b". Suggestions hold for every element.
std::string without_indices(std::string_view path) {
  std::string out;
  bool inside = false;
  for (const char c : path) {
    if (c == ']') inside = false;
    if (!inside) out += c;
    if (c == '[') inside = true;
  }
  return out;
}

std::string_view last_name(std::string_view path) { return path.substr(path.rfind('.') + 1); }

/// "a.b[2].c": is `table` one of "a", "a.b[2]"?
bool lies_in(std::string_view path, std::string_view table) {
  return path.size() > table.size() && path.starts_with(table) && path[table.size()] == '.';
}

/// One table of the dump with its keys and sub-tables in order of first appearance.
struct Section {
  std::string name;
  std::string header;
  std::vector<std::pair<std::string, const std::string*>> lines;  // "key = value", note
  std::vector<Section> children;

  Section& child(const std::string& wanted, const std::string& path) {
    for (Section& s : children) {
      if (s.name == wanted) return s;
    }
    const bool element = wanted.back() == ']';
    std::string bare = without_indices(path);
    for (std::size_t at = bare.find("[]"); at != std::string::npos; at = bare.find("[]")) bare.erase(at, 2);
    children.push_back({wanted, element ? "[[" + bare + "]]" : "[" + bare + "]", {}, {}});
    return children.back();
  }

  Section& find(std::string_view path) {
    Section* at = this;
    for (std::size_t begin = 0; begin < path.size();) {
      const std::size_t end = std::min(path.find('.', begin), path.size());
      at = &at->child(std::string(path.substr(begin, end - begin)), std::string(path.substr(0, end)));
      begin = end + 1;
    }
    return *at;
  }

  void print(std::string& out) const {
    if (!header.empty() && (!lines.empty() || header.starts_with("[["))) {
      out += (out.empty() ? "" : "\n") + header + "\n";
    }
    for (const auto& [line, note] : lines) out += line + (note->empty() ? "" : "  # " + *note) + "\n";
    for (const Section& section : children) section.print(out);
  }
};

}  // namespace

void ConfigReader::State::add_error(const std::string& path, std::string_view why) {
  if (first_error) return;
  const auto n = given.find(path);
  const std::string where = n != given.end() ? n->second.where : name;
  first_error = Error{ErrorCode::kConfigValue, where + (where.empty() ? "'" : ": '") + path + "' " + std::string(why)};
}

const Node* ConfigReader::State::claim(const std::string& path) {
  if (!known.insert(path).second && !first_error) {
    first_error = Error{ErrorCode::kInternal, "configuration key '" + path + "' is bound twice"};
  }
  const auto n = given.find(path);
  if (n == given.end()) return nullptr;
  if (n->second.is_table) {
    add_error(path, "must be a value, not a table");
    return nullptr;
  }
  return &n->second;
}

void ConfigReader::State::resolved(const std::string& path, std::string text, std::string_view doc,
                                   std::string_view range) {
  std::string note(doc);
  if (!range.empty()) note += (note.empty() ? "" : "; ") + std::string(range);
  bound.push_back({path, std::move(text), std::move(note)});
}

std::string ConfigReader::State::nearest_known(std::string_view path) const {
  const std::string wanted = without_indices(path);
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, last_name(wanted).size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::string plain = without_indices(candidate);
    // A key in the wrong table or without its unit suffix is as likely as a misspelt one.
    const bool same_start = last_name(wanted).size() > 2 && last_name(plain).starts_with(last_name(wanted));
    const std::size_t d = same_start ? 1 : edit_distance(wanted, plain);
    if (d < best_distance) {
      best_distance = d;
      best = plain;
    }
  }
  return best;
}

ConfigReader ConfigReader::table(std::string_view key) const { return {state_, full(key) + "."}; }

ConfigReader ConfigReader::table(std::string_view key, std::size_t i) const {
  std::string element = full(key) + "[" + std::to_string(i) + "]";
  state_->array_elements.push_back(element);
  return {state_, element + "."};
}

std::size_t ConfigReader::table_count(std::string_view key) {
  const std::string path = full(key);
  state_->known_arrays.insert(path);
  std::size_t n = 0;
  while (state_->given.contains(path + "[" + std::to_string(n) + "]")) ++n;
  const auto leaf = state_->given.find(path);
  if (leaf != state_->given.end()) {
    const auto* list = std::get_if<std::vector<double>>(&leaf->second.value);
    const bool empty_array = !leaf->second.is_table && list != nullptr && list->empty();
    if (!empty_array) state_->add_error(path, "must be an array of tables: [[" + path + "]]");
  }
  return n;
}

bool ConfigReader::has(std::string_view key) const {
  const std::string path = full(key);
  return state_->given.contains(path) || state_->given.contains(path + "[0]");
}

void ConfigReader::reject(std::string_view key, std::string_view why) { state_->add_error(full(key), why); }

Result<void> ConfigReader::finish() const {
  const State& s = *state_;
  if (s.first_error) return tl::unexpected<Error>(*s.first_error);
  const auto table_is_known = [&s](std::string_view path) {
    const bool element = path.ends_with(']') && s.known_arrays.contains(path.substr(0, path.rfind('[')));
    return element || std::any_of(s.known.begin(), s.known.end(), [&](const auto& k) { return lies_in(k, path); }) ||
           std::any_of(s.known_arrays.begin(), s.known_arrays.end(), [&](const auto& k) { return lies_in(k, path); });
  };
  for (const auto& [path, node] : s.given) {
    const bool known = node.is_table ? table_is_known(path) : s.known.contains(path) || s.known_arrays.contains(path);
    // The key inside an unknown table says more than the table does.
    const auto inner = s.given.upper_bound(path);
    if (known || (node.is_table && inner != s.given.end() && lies_in(inner->first, path))) continue;
    const std::string guess = s.nearest_known(path);
    return fail(ErrorCode::kConfigUnknownKey,
                node.where + ": unknown key '" + path + "'" + (guess.empty() ? "" : "; did you mean '" + guess + "'?"));
  }
  return {};
}

std::string ConfigReader::dump() const {
  Section root;
  for (const std::string& element : state_->array_elements) root.find(element);
  for (const State::Bound& b : state_->bound) {
    const std::size_t dot = b.path.rfind('.');
    Section& section = dot == std::string::npos ? root : root.find(std::string_view(b.path).substr(0, dot));
    section.lines.emplace_back(b.path.substr(dot == std::string::npos ? 0 : dot + 1) + " = " + b.text, &b.note);
  }
  std::string out;
  root.print(out);
  return out;
}

}  // namespace enamel
