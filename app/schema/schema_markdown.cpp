#include "app/schema/schema.hpp"
#include "app/schema/schema_export.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::app {
namespace {

constexpr const char* introduction = R"(# Scene reference

Every key of a scene file. This page is generated from the table that the program checks scenes against.

A scene is a TOML 1.0 file. Numbers are in SI units (m, kg, s, N, Pa, rad), or texts with a unit that UDUNITS-2 knows:
`young = "40 kPa"`, `angle = "180 degree"`; a list may mix them: `min = ["-5 mm", 0, 0]`. Paths that the scene reads are
relative to the scene file; `output.directory` is relative to the directory that the program runs in.
Keys that are marked *not supported yet* are refused.

)";

/// Vertical bars would end a cell.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

std::string type_of(const Shape& shape);

std::string number_type(const Shape& shape) {
  const std::string unit = shape.unit == "1" ? "number" : "number [" + shape.unit + "]";
  return shape.range.is_everything() ? unit : unit + ", " + shape.range.text();
}

std::string list_type(const Shape& shape) {
  const Shape& first = shape.items.front();
  const bool is_vector = shape.min_items == 3 && shape.max_items == 3 && first.type == Type::number;
  if (is_vector) return "vector" + number_type(first).substr(std::string("number").size());
  if (shape.type == Type::tuple) {
    std::string parts;
    for (const Shape& item : shape.items) parts += (parts.empty() ? "" : ", ") + type_of(item);
    return "[" + parts + "]";
  }
  std::string count;
  if (shape.min_items == shape.max_items)
    count = fmt::format(" of {}", shape.min_items);
  else if (shape.is_bounded())
    count = fmt::format(" of {} to {}", shape.min_items, shape.max_items);
  return fmt::format("list{}: {}", count, type_of(first));
}

std::string values_type(const Shape& shape) {
  std::string out;
  for (const Choice& c : shape.choices)
    out += fmt::format("{}`\"{}\"`{}", out.empty() ? "" : ", ", c.value, c.supported ? "" : " (*not supported yet*)");
  return out;
}

std::string type_of(const Shape& shape) {
  switch (shape.type) {
    case Type::number:
      return number_type(shape);
    case Type::integer:
      return "whole number, " + shape.range.text();
    case Type::text:
      return "text";
    case Type::boolean:
      return "`true`, `false`";
    case Type::choice:
      return values_type(shape);
    case Type::array:
    case Type::tuple:
      return list_type(shape);
    case Type::table:
    case Type::named_tables:
      return "table";
    case Type::reference:
      return fmt::format("[{0}](#{0})", shape.name);
    case Type::anything:
      return shape.name;
    case Type::one_of: {
      std::string out;
      for (const Shape& item : shape.items) out += (out.empty() ? "" : "; or ") + type_of(item);
      return out;
    }
  }
  return "";
}

std::string meaning(const Key& k) {
  if (k.refusal == "is not supported yet") return "*Not supported yet.* " + k.doc;
  return k.refusal.empty() ? k.doc : fmt::format("*Refused: {}.* {}", k.refusal, k.doc);
}

class Page {
 public:
  explicit Page(std::string text) : text_(std::move(text)) {}

  /// A heading, the keys of a table, and a section for each table among them.
  void section(const std::string& path, const std::string& doc, const Shape& shape) {
    text_ += fmt::format("## {}\n\n{}\n\n", path, doc);
    keys(shape);
    for (const Key& k : shape.keys)
      if (k.refusal.empty()) nested(path, k.name, k.doc, k.shape);
  }

  /// A section for a value that several keys take.
  void shared(const std::string& name, const std::string& doc, const Shape& shape) {
    text_ += fmt::format("## {}\n\n{}\n\n", name, doc);
    values(key(name, shape, doc));
    for (const Shape& item : shape.items) {
      if (item.type != Type::table) continue;
      keys(item);
      for (const Key& k : item.keys) nested(name, k.name, k.doc, k.shape);
    }
  }

  /// Tables anywhere in a value of this shape.
  void nested(const std::string& path, const std::string& name, const std::string& doc, const Shape& shape) {
    const std::string whole = path.empty() ? name : path + "." + name;
    if (shape.type == Type::table) section(whole, doc, shape);
    if (shape.type == Type::named_tables) nested(whole, "NAME", doc, shape.items.front());
    if (shape.type == Type::array && shape.items.front().type == Type::table)
      section(whole + "[]", doc, shape.items.front());
    if (shape.type == Type::one_of)
      for (const Shape& item : shape.items) nested(path, name, doc, item);
  }

  void keys(const Shape& shape) {
    if (shape.keys.empty()) return;
    text_ += "| key | type | default | meaning |\n|---|---|---|---|\n";
    for (const Key& k : shape.keys)
      text_ += fmt::format("| `{}` | {} | {} | {} |\n", k.name, cell(type_of(k.shape)), cell(default_of(k)),
                           cell(meaning(k)));
    text_ += "\n";
    for (const Exclusive& group : shape.exclusive) exclusive(group);
    for (const Key& k : shape.keys) values(k);
  }

  std::string finish() {
    while (text_.ends_with("\n\n")) text_.pop_back();
    return std::move(text_);
  }

 private:
  static std::string default_of(const Key& k) { return k.required ? "*required*" : k.default_text; }

  void exclusive(const Exclusive& group) {
    text_ +=
        fmt::format("{} of `{}`{}.\n\n", group.required ? "Exactly one" : "At most one", fmt::join(group.keys, "`, `"),
                    group.unless_needed ? ", or none where the scene states a `need`" : "");
  }

  /// What each value of a choice means.
  void values(const Key& k) {
    if (!k.refusal.empty()) return;
    std::string lines;
    add_values(k.shape, lines);
    if (!lines.empty()) text_ += fmt::format("Values of `{}`:\n\n{}\n", k.name, lines);
  }

  static void add_values(const Shape& shape, std::string& lines) {
    for (const Choice& c : shape.choices)
      if (c.supported && !c.doc.empty()) lines += fmt::format("- `\"{}\"`: {}\n", c.value, c.doc);
    for (const Shape& item : shape.items) add_values(item, lines);
  }

  std::string text_;
};

}  // namespace

std::string schema_as_markdown() {
  Page page(introduction);
  page.keys(scene_schema());
  for (const Key& k : scene_schema().keys)
    if (k.refusal.empty()) page.nested("", k.name, k.doc, k.shape);
  page.section("material", "An elastic material.", material_schema());
  page.shared(
      "region",
      "A selection by rest position: `\"all\"`, or a table with one of these keys. Regions nest up to 64 levels.",
      region_schema());
  page.shared("profile",
              "How a factor follows time: a word, a list of pairs of time and factor with ascending times, or a table.",
              profile_schema());
  return page.finish();
}

}  // namespace fascia::app
