#include "app/scene/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace fascia::app {
namespace {

constexpr std::size_t max_kept = 1000;

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

/// Cuts a long text between two UTF-8 characters.
std::string shortened(std::string_view text, std::size_t limit = 60) {
  if (text.size() <= limit) return std::string(text);
  std::size_t end = limit;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return std::string(text.substr(0, end)) + "...";
}

/// Number of insertions, deletions, replacements and swaps of neighbours between two words.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = last;
    last = row;
  }
  return last[b.size()];
}

}  // namespace

Place Diagnostics::place(const Position& position, std::string_view path) const {
  return {position.from_override ? "--set" : file_, position.line, position.column, std::string(path)};
}

void Diagnostics::add(const Position& position, std::string_view path, std::string message) {
  add(place(position, path), std::move(message));
}

bool Diagnostics::is_full() const { return found_.size() >= max_kept; }

void Diagnostics::add(Place place, std::string message) {
  if (!is_full())
    found_.push_back({std::move(place), std::move(message)});
  else
    ++left_out_;
}

void Diagnostics::throw_if_any() {
  if (found_.empty()) return;
  std::stable_sort(found_.begin(), found_.end(), [](const Diagnostic& a, const Diagnostic& b) {
    const auto order = [](const Diagnostic& d) {
      return std::tuple(d.place.file == "--set", d.place.line, d.place.column);
    };
    return order(a) < order(b);
  });
  if (left_out_ > 0)
    found_.push_back(
        {{file_, found_.back().place.line, 1, ""}, fmt::format("{} more errors; correct the first ones", left_out_)});
  throw SceneError(std::move(found_));
}

std::string join(std::string_view path, std::string_view key) {
  const bool plain = !key.empty() && std::all_of(key.begin(), key.end(), is_plain);
  const std::string name = plain ? shortened(key) : in_quotes(key);
  return path.empty() ? name : fmt::format("{}.{}", path, name);
}

std::string join(std::string_view path, std::size_t index) { return fmt::format("{}[{}]", path, index); }

std::string one_line(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\n')
      out += "\\n";
    else if (c == '\t')
      out += "\\t";
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  return out;
}

std::string in_quotes(std::string_view text) { return fmt::format("\"{}\"", one_line(shortened(text))); }

std::string describe(const Value& value) {
  struct Describe {
    std::string operator()(const Date&) const { return "a date"; }
    std::string operator()(bool b) const { return b ? "true" : "false"; }
    std::string operator()(std::int64_t i) const { return fmt::format("{}", i); }
    std::string operator()(double d) const { return std::isfinite(d) ? fmt::format("{:#}", d) : fmt::format("{}", d); }
    std::string operator()(const std::string& s) const { return in_quotes(s); }
    std::string operator()(const Array& a) const {
      return a.empty() ? "an empty list" : fmt::format("a list of {}", a.size());
    }
    std::string operator()(const Table&) const { return "a table"; }
  };
  return std::visit(Describe{}, value.data);
}

std::string join_or(const std::vector<std::string>& parts) {
  std::string out;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i > 0) out += i + 1 == parts.size() ? " or " : ", ";
    out += parts[i];
  }
  return out;
}

std::string unknown_name(const std::string& what, const std::string& name, const std::vector<std::string>& known) {
  const std::string near = nearest(name, known);
  if (!near.empty()) return fmt::format("{} is no known {}; did you mean \"{}\"?", in_quotes(name), what, near);
  if (known.empty()) return fmt::format("{} is no known {}; the scene has none", in_quotes(name), what);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min<std::size_t>(known.size(), 8); ++i) names.push_back(in_quotes(known[i]));
  if (known.size() > names.size()) names.emplace_back("another");
  return fmt::format("{} is no known {}; must be {}", in_quotes(name), what, join_or(names));
}

std::string nearest(std::string_view word, const std::vector<std::string>& known) {
  if (word.size() > 64) return "";
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance && distance < candidate.size()) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

}  // namespace fascia::app
