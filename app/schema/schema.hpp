#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

/// The one description of the scene format: checking, hints, the reference page and the JSON Schema come from it.
namespace fascia::app {

/// Allowed values of a number.
struct Range {
  double min = -std::numeric_limits<double>::infinity(), max = std::numeric_limits<double>::infinity();
  bool min_excluded = false, max_excluded = false;

  bool contains(double value) const;
  bool is_everything() const;
  /// "above -1 and below 0.5", "from 1 to 10"; empty where everything is allowed.
  std::string text() const;
};
Range above(double min);
Range at_least(double min);
Range between(double min, double max);  ///< limits included
Range inside(double min, double max);   ///< limits excluded

enum class Type {
  number,
  integer,
  text,
  boolean,
  choice,
  array,
  tuple,
  table,
  named_tables,
  one_of,
  reference,
  anything
};

/// A word that a key takes.
struct Choice {
  std::string value;
  std::string doc;
  bool supported = true;
};

struct Key;

/// Keys of a table that exclude one another.
struct Exclusive {
  std::vector<std::string> keys;
  bool required = true;        ///< exactly one; otherwise at most one
  bool unless_needed = false;  ///< none is enough where the scene states a need
};

/// What a value looks like.
struct Shape {
  Type type = Type::text;
  std::string unit;             ///< number: SI unit as UDUNITS spells it, "1" for a pure number
  Range range;                  ///< number, integer
  std::vector<Choice> choices;  ///< choice
  std::vector<Shape> items;     ///< array, named_tables: one; tuple: one each; one_of: the alternatives
  std::size_t min_items = 0;    ///< array, named_tables
  std::size_t max_items = std::numeric_limits<std::size_t>::max();
  std::vector<Key> keys;               ///< table
  std::vector<Exclusive> exclusive;    ///< table
  std::string selector;                ///< table: the key whose value, if not supported, makes the rest moot
  bool plain_names = false;            ///< named_tables: names become file names and column headers
  std::string name;                    ///< reference: what the target is called; text, anything: what it is
  bool of_lines = false;               ///< text: may have line breaks
  const Shape& (*target)() = nullptr;  ///< reference

  const Key* find(std::string_view key) const;
  bool is_bounded() const { return max_items != std::numeric_limits<std::size_t>::max(); }
};

/// A key of a table.
struct Key {
  std::string name;
  Shape shape;
  std::string doc;
  bool required = false;
  std::string default_text;  ///< for the reader of the manual
  std::string refusal;       ///< why this version takes no such key; empty where it does

  Key needed() const;
  Key defaults(std::string text) const;
  Key refused(std::string why) const;
  Key not_yet() const { return refused("is not supported yet"); }
};

Shape number(std::string unit, Range range = {});
Shape integer(Range range);
Shape text(std::string in_words = "a text");
Shape text_of_lines(std::string in_words);
Shape boolean();
Shape choice(std::vector<Choice> choices);
Shape array(Shape item, std::size_t min_items = 0, std::size_t max_items = std::numeric_limits<std::size_t>::max());
Shape tuple(std::vector<Shape> items);
Shape vector3(const std::string& unit, Range range = {});
Shape table(std::vector<Key> keys, std::vector<Exclusive> exclusive = {}, std::string selector = "");
Shape named_tables(Shape item, bool plain_names, std::size_t min_items = 0);
Shape one_of(std::vector<Shape> alternatives);
Shape reference(std::string name, const Shape& (*target)());
/// A value that somebody else checks.
Shape anything(std::string in_words);
Key key(std::string name, Shape shape, std::string doc);
/// A key of the format that this version refuses.
Key later(std::string name, std::string doc);

/// The scene, a table.
const Shape& scene_schema();

/// A selection of nodes, points or faces: `where`.
const Shape& region_schema();
Shape region_reference();

// The sections of the scene.
Key world_schema();
Key materials_schema();
Key bodies_schema();
Key constraints_schema();
Key loads_schema();
Key couplings_schema();
Key solver_schema();
Key probes_schema();
Key output_schema();
Key need_schema();

// Parts that several sections share.
const Shape& material_schema();
Shape body_material_schema();
const Shape& profile_schema();
Shape domain_schema();
Shape frames_schema();
Shape points_schema();
Shape weights_schema();
Key body_need_key();
Key over_key();
Key profile_key();
Key dial_key();
std::vector<Choice> field_choices();
std::vector<Choice> shell_field_choices();  ///< that only shells have

/// What a value of this shape is, for messages: `a length in m`, `"auto" or a whole number`.
std::string in_words(const Shape& shape);

/// Names of the keys that this version takes.
std::vector<std::string> supported_keys(const Shape& table);
/// Values of a choice that this version takes.
std::vector<std::string> supported_values(const Shape& choice);

}  // namespace fascia::app
